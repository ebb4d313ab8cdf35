"""A value with its interval, as all estimators give it and all tables show it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value, and the interval that contains the truth with the probability ``level`` of the result that it is part of.

    An end without a bound is infinite. Both ends are nan where there is no interval.
    """

    value: float
    lower: float
    upper: float
    sigma: float | None = None  #: standard deviation, where the estimator gives one
    unit: str = ""  #: name of the SI unit; empty: the unit of the samples, or 1

    def __contains__(self, value: float) -> bool:
        """Return whether the interval contains a value."""
        return self.lower <= value <= self.upper

    def scaled(self, factor: float, unit: str) -> Estimate:
        """Return the estimate in another unit; a negative factor exchanges the ends."""
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
    """A noise coefficient. If the record does not show it, ``value`` is None and ``upper`` is its limit.

    A limit is one-sided, at the ``level`` of the result that it is part of. An infinite limit means that the record does
    not bound the coefficient.
    """

    value: float | None
    lower: float | None
    upper: float
    unit: str = ""  #: name of the SI unit; empty: it follows from the unit of the samples
    at: float | None = None  #: s, averaging time at which it is read on its own line

    def in_unit(self, unit: str) -> Coefficient:
        """Return the coefficient with this name of its SI unit."""
        return replace(self, unit=unit)

    def __str__(self) -> str:
        """Return the value with its interval, or the limit."""
        if self.value is None:
            text = f"< {self.upper:.4g}" if math.isfinite(self.upper) else "unknown"
        else:
            text = f"{self.value:.4g} [{self.lower or 0.0:.4g}, {self.upper:.4g}]"
        return f"{text} {self.unit}".rstrip()


#: A coefficient without a bound.
UNKNOWN = Coefficient(None, None, math.inf)
