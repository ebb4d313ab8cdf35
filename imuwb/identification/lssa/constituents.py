"""Known constituents of a series, which are estimated together with every line (Pagiatakis 1999)."""

import math
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats

TRENDS = ("none", "constant", "linear", "quadratic")


@dataclass(frozen=True, slots=True)
class Constituents:
    """The known constituents of a series.

    Raises:
        ValueError: a value out of its range.
    """

    trend: str = "linear"  #: none, constant, linear (with a constant), quadratic (with both)
    jumps: tuple[float, ...] = ()  #: s, times from which the level is another
    forced: tuple[float, ...] = ()  #: Hz, frequencies of known lines
    exponentials: tuple[float, ...] = ()  #: s, time constants of transients that begin at the first sample

    def __post_init__(self) -> None:
        """Check the values."""
        if self.trend not in TRENDS:
            raise ValueError(f"trend is {self.trend!r}; it must be one of {', '.join(TRENDS)}")
        for name, unit, values in (("forced", "Hz", self.forced), ("exponentials", "s", self.exponentials)):
            if not all(0 < x < math.inf for x in values):
                raise ValueError(f"{name} is {', '.join(f'{x:g}' for x in values)} {unit}; each must be above 0")
        if not all(math.isfinite(x) for x in self.jumps):
            raise ValueError(f"jumps is {', '.join(f'{x:g}' for x in self.jumps)} s; each must be a finite time")

    @property
    def names(self) -> tuple[str, ...]:
        """Return the name of each column."""
        return (
            *("constant", "trend", "quadratic trend")[: TRENDS.index(self.trend)],
            *(f"jump at {x:g} s" for x in self.jumps),
            *(f"transient of {x:g} s" for x in self.exponentials),
            *(f"{part} of {x:g} Hz" for x in self.forced for part in ("cosine", "sine")),
        )

    def columns(self, time: Floats) -> Floats:
        """Return the columns, (n, k), without unit: powers of time from -1 to 1, and the others with a maximum of 1."""
        span = float(time[-1] - time[0]) or 1.0
        even = 2 * (time - time[0]) / span - 1
        columns = [even**power for power in range(TRENDS.index(self.trend))]
        columns += [(time >= x).astype(float) for x in self.jumps]
        columns += [np.exp(-(time - time[0]) / x) for x in self.exponentials]
        for x in self.forced:
            phase = 2 * np.pi * x * (time - time[0])
            columns += [np.cos(phase), np.sin(phase)]
        return np.stack(columns, axis=1) if columns else np.empty((time.size, 0))
