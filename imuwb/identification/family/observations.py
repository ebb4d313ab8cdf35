"""The estimates of one coefficient in many logs, on the scale on which their errors are about normal."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.statistics.distributions import chi_square_quantile, log_gamma_moments, normal_limit

NARROWEST = 1e-9  #: relative width of an interval; a narrower one is of a value that is known, not estimated
#: degrees of freedom: a square with fewer has no interval above 0; one with more has an error that is as good as normal
FEWEST_DEGREES, MOST_DEGREES = 1.0, 1e9
STEPS = 4000  #: of the degrees of freedom between these


@dataclass(frozen=True, eq=False, slots=True)
class Observations:
    """One coefficient in n logs of several sensors."""

    sensor: Integers  #: (n,) number of the sensor, from 0; each number occurs
    y: Floats  #: (n,) natural logarithm of the value, without the mean error of a logarithm; or the value, on a linear scale
    variance: Floats  #: (n,) of the sampling error of y
    half: Floats  #: (n,) half of the degrees of freedom of the square, whose logarithm makes the sampling error; inf: the error is normal
    time: Floats  #: (n,) s; nan: not known
    temperature: Floats  #: (n,) °C; nan: not known
    logarithmic: bool

    @property
    def sensors(self) -> int:
        """Return the number of sensors."""
        return int(self.sensor.max()) + 1 if self.sensor.size else 0

    def sums(self, values: Floats) -> Floats:
        """Return the sum of values of each sensor."""
        return np.bincount(self.sensor, values, self.sensors).astype(np.float64)

    def of(self, rows: Booleans) -> Observations:
        """Return some rows; the sensors keep their numbers."""
        parts = (getattr(self, name)[rows] for name in ("sensor", "y", "variance", "half", "time", "temperature"))
        return Observations(*parts, logarithmic=self.logarithmic)

    def at(self, slope: float, reference: float) -> Observations:
        """Return the observations as they would be at one temperature, °C; rows without a temperature stay."""
        away = np.where(np.isfinite(self.temperature), self.temperature - reference, 0.0)
        return replace(self, y=self.y - slope * away)


def observations(
    sensor: Integers, value: Floats, lower: Floats, upper: Floats, *,
    level: float, time: Floats | None = None, temperature: Floats | None = None, squares: bool = True, logarithmic: bool = True,
) -> Observations:  # fmt: skip
    """Return estimates on the scale on which they are compared; rows without an interval must be left out before (``usable``).

    A coefficient whose square is estimated has an error that is about the logarithm of a chi-square variable; its degrees of freedom
    follow from the ratio of the ends of its interval. Its logarithm then has the variance ψ'(ν/2)/4 and the mean error
    (ψ(ν/2) - ln(ν/2))/2 (Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 1, 17.8).

    Args:
        sensor: (n,) number of the sensor.
        value: (n,) estimates, above 0 on a logarithmic scale.
        lower: (n,) lower ends of the intervals.
        upper: (n,) upper ends.
        level: probability of the intervals.
        time: (n,) s; None: not known.
        temperature: (n,) °C; None: not known.
        squares: whether the squares of the coefficients are estimated; else the errors are normal on the scale.
        logarithmic: whether values are compared by their ratios; else by their differences.
    """
    unknown = np.full(value.size, np.nan)
    time, temperature = (unknown if x is None else np.asarray(x, float) for x in (time, temperature))
    half = np.full(value.size, np.inf)
    if not logarithmic:
        variance = ((upper - lower) / (2 * normal_limit(level))) ** 2
        return Observations(sensor, value.astype(float), variance, half, time, temperature, logarithmic=False)
    y, width = np.log(value), np.log(upper / lower)
    variance = (width / (2 * normal_limit(level))) ** 2
    if squares:
        half = degrees_of_freedom(width, level) / 2
        mean, variance = log_gamma_moments(half)
        y, variance = y - mean / 2, variance / 4
    return Observations(sensor, y, variance, half, time, temperature, logarithmic=True)


def usable(value: Floats, lower: Floats, upper: Floats, *, logarithmic: bool = True) -> Booleans:
    """Return which estimates have an interval of both ends; on a logarithmic scale, above 0."""
    with np.errstate(invalid="ignore"):
        sound = np.isfinite(value) & np.isfinite(lower) & np.isfinite(upper) & (lower <= value) & (value <= upper)
        sound &= upper - lower > NARROWEST * np.abs(value)
        return sound & (lower > 0) if logarithmic else sound


def degrees_of_freedom(width: Floats, level: float) -> Floats:
    """Return the degrees of freedom of squares from the natural logarithm of the ratio of the ends of the coefficients' intervals.

    They are interpolated between known ones, with a relative error below 1e-5.
    """
    freedom, widths = _widths(level)
    return np.exp(np.interp(-np.log(width), -np.log(widths), np.log(freedom)))


@lru_cache(maxsize=8)
def _widths(level: float) -> tuple[Floats, Floats]:
    """Return degrees of freedom, and the widths of the intervals that they make, which fall."""
    freedom = np.geomspace(FEWEST_DEGREES, MOST_DEGREES, STEPS)
    upper, lower = (chi_square_quantile(p, freedom) for p in ((1 + level) / 2, (1 - level) / 2))
    return freedom, np.log(upper / lower) / 2
