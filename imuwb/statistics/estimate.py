"""A value with its interval, as every estimator gives it and every table shows it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value, and the interval that holds the truth as often as the level of its result says.

    An end that nothing bounds is infinite; both ends are nan where no interval can be given.
    """

    value: float
    lower: float
    upper: float
    sigma: float | None = None  #: standard deviation, where the estimator gives one
    unit: str = ""  #: name of the SI unit; empty: that of the samples

    def __contains__(self, value: float) -> bool:
        """Return whether the interval holds a value."""
        return self.lower <= value <= self.upper

    def scaled(self, factor: float, unit: str) -> Estimate:
        """Return the estimate in another unit; a negative factor turns the interval round."""
        low, high = sorted((self.lower * factor, self.upper * factor))
        sigma = None if self.sigma is None else self.sigma * abs(factor)
        return Estimate(self.value * factor, low, high, sigma, unit)

    def shifted(self, offset: float) -> Estimate:
        """Return the estimate of the value plus a known number."""
        return replace(self, value=self.value + offset, lower=self.lower + offset, upper=self.upper + offset)

    def __str__(self) -> str:
        """Return the value with its interval."""
        text = f"{self.value:.4g}"
        if not math.isnan(self.lower):
            text += f" [{self.lower:.4g}, {self.upper:.4g}]"
        return f"{text} {self.unit}".rstrip()


@dataclass(frozen=True, slots=True)
class Coefficient:
    """A noise coefficient, which a record may not show: ``value`` is then None, and ``upper`` its limit.

    A limit is one-sided, at the level of its result; an infinite one says that nothing bounds the coefficient.
    """

    value: float | None
    lower: float | None
    upper: float
    unit: str = ""  #: name of the SI unit; empty: it follows from the samples'
    at: float | None = None  #: s, averaging time at which it is read off its own line

    def in_unit(self, unit: str) -> Coefficient:
        """Return the coefficient with the name of its SI unit."""
        return replace(self, unit=unit)

    def __str__(self) -> str:
        """Return the value with its interval, or the limit."""
        if self.value is None:
            text = f"< {self.upper:.4g}" if math.isfinite(self.upper) else "unknown"
        else:
            text = f"{self.value:.4g} [{self.lower or 0.0:.4g}, {self.upper:.4g}]"
        return f"{text} {self.unit}".rstrip()


#: A coefficient that nothing bounds.
UNKNOWN = Coefficient(None, None, math.inf)
