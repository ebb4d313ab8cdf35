"""What a series is known to hold besides noise, estimated together with every line (Pagiatakis 1999)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

TRENDS = ("none", "constant", "linear", "quadratic")


@dataclass(frozen=True, slots=True)
class Constituents:
    """Known constituents.

    Raises:
        ValueError: one that cannot be.
    """

    trend: str = "linear"  #: none, constant, linear (with a constant), quadratic (with both)
    jumps: tuple[float, ...] = ()  #: s; from there on there is another level
    forced: tuple[float, ...] = ()  #: Hz, of lines that are known to be there
    exponentials: tuple[float, ...] = ()  #: s; time constants of transients that die away from the first sample on

    def __post_init__(self) -> None:
        """Check what can be checked."""
        if self.trend not in TRENDS:
            message = f"a trend {self.trend!r}; it must be one of {', '.join(TRENDS)}"
            raise ValueError(message)
        for what, unit, found in (("line", "Hz", self.forced), ("transient", "s", self.exponentials)):
            if not all(0 < x < math.inf for x in found):
                message = f"a {what} of {', '.join(f'{x:g}' for x in found)} {unit}; each must be above 0"
                raise ValueError(message)
        if not all(math.isfinite(x) for x in self.jumps):
            message = f"jumps at {', '.join(f'{x:g}' for x in self.jumps)} s; each must be a time"
            raise ValueError(message)

    @property
    def names(self) -> tuple[str, ...]:
        """Return what each column stands for."""
        return (
            *("constant", "trend", "quadratic trend")[: TRENDS.index(self.trend)],
            *(f"jump at {x:g} s" for x in self.jumps),
            *(f"transient of {x:g} s" for x in self.exponentials),
            *(f"{part} of {x:g} Hz" for x in self.forced for part in ("cosine", "sine")),
        )

    def columns(self, time: Floats) -> Floats:
        """Return their course, (n, k) without unit: powers of time from -1 to 1, and the rest at most 1."""
        span = float(time[-1] - time[0]) or 1.0
        even = 2 * (time - time[0]) / span - 1
        found = [even**power for power in range(TRENDS.index(self.trend))]
        found += [(time >= x).astype(float) for x in self.jumps]
        found += [np.exp(-(time - time[0]) / x) for x in self.exponentials]
        for x in self.forced:
            phase = 2 * np.pi * x * (time - time[0])
            found += [np.cos(phase), np.sin(phase)]
        return np.stack(found, axis=1) if found else np.empty((time.size, 0))
