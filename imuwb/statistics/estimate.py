"""A value with its interval, as all estimators give it and all tables show it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from imuwb.errors import UsageError
from imuwb.units import Unit, coefficient_units, si_unit, unit, units_of


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

    def to(self, name: str) -> Estimate:
        """Return the estimate in another unit of the same quantity.

        Raises:
            UsageError: there is no such unit, or it is one of another quantity.
        """
        own, wanted = _units(self.unit or "1", name)
        value, low, high = (wanted.from_si(own.to_si(number)) for number in (self.value, self.lower, self.upper))
        sigma = None if self.sigma is None else self.sigma * own.factor / wanted.factor
        return Estimate(value, low, high, sigma, wanted.name)

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
    letter: str = field(default="", compare=False, metadata={"document": False})  #: Q, N, B, K or R; empty: unknown

    def to(self, name: str) -> Coefficient:
        """Return the coefficient in another unit of the same quantity: ``fit.coefficients["N"].to("deg/√h")``.

        A coefficient whose unit follows from that of the samples, which are in SI units, takes any unit of its letter.

        Raises:
            UsageError: there is no such unit, or it is one of another quantity.
        """
        own, wanted = _units(self.unit or _si_of(self.letter, name), name)
        value, low = (None if x is None else wanted.from_si(own.to_si(x)) for x in (self.value, self.lower))
        return replace(self, value=value, lower=low, upper=wanted.from_si(own.to_si(self.upper)), unit=wanted.name)

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


def _units(own: str, wanted: str) -> tuple[Unit, Unit]:
    """Return two units of one quantity.

    Raises:
        UsageError: they are of different quantities.
    """
    before, after = unit(own), unit(wanted)
    if before.dimension != after.dimension:
        raise UsageError(
            f"{after.name} is a unit of {_words(after)}; the value is in {before.name}, a unit of {_words(before)}: "
            f"write one of {', '.join(units_of(before.dimension))}"
        )
    return before, after


def _si_of(letter: str, wanted: str) -> str:
    """Return the SI unit of a coefficient whose samples are of the sensor that the wanted unit is of.

    Raises:
        UsageError: the coefficient is never in that unit.
    """
    after = unit(wanted)
    if not letter:
        return si_unit(after.dimension)
    possible = [coefficient_units(axis, letter)[0] for axis in ("gyro", "accel")]
    if after.dimension not in [own.dimension for own in possible]:
        names = " or ".join(f"{', '.join(units_of(own.dimension))} ({_words(own)})" for own in possible)
        raise UsageError(f"{after.name} is a unit of {_words(after)}, which {letter} is not; write one of {names}")
    return si_unit(after.dimension)


def _words(measure: Unit) -> str:
    return measure.dimension.replace("_", " ")
