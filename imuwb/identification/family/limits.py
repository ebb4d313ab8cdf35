"""Logs that give a limit only, as observations of a family: without them its mean is too large and its spread too small.

A log gives a limit where its estimate r of the square of a coefficient is not above the error σ of r; mostly r is 0. The upper end c of
a probability with the quantile z is then c² = r + z σ, and the likelihood of a coefficient θ is exp(-((θ² - r)/σ)²/2). Each such factor
is replaced by the normal observation that leaves mean and variance of ln θ as they are, given all other logs (expectation propagation,
Minka, UAI 2001). Where the restricted likelihood is largest with these observations, that with the limits is, too: at the fixed point
its slope does not depend on how the observations move.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.identification.family.observations import Observations
from imuwb.identification.family.random_effects import RandomEffects, random_effects
from imuwb.statistics.distributions import scipy

ROUNDS, CLOSE = 100, 1e-4  #: of the search; change of mean and spread, in units of the scatter, at which it ends
SWEEPS = 3  #: over the limits for each fit of the family
LEAST = (
    1e-6  #: precision against that of a log with a value, below which a limit says nothing: it is far above the family
)
FARTHEST = 5.0  #: ln θ/c, beyond which the likelihood is 0
_X, _WEIGHTS = np.polynomial.hermite_e.hermegauss(40)


@dataclass(frozen=True, eq=False, slots=True)
class Limits:
    """The m logs that give a limit only."""

    sensor: Integers  #: (m,) number of the sensor; sensors without any value have the numbers after those that have one
    upper: Floats  #: (m,) natural logarithm of the limit
    share: Floats  #: (m,) of the limit's square that the estimate of the square has; 0: the log has no estimate
    probability: Floats  #: (m,) that the coefficient is below it, above 0.5
    temperature: Floats  #: (m,) °C; nan: not known

    @classmethod
    def none(cls) -> Limits:
        """Return no limits."""
        return cls(np.zeros(0, dtype=np.int64), *(np.zeros(0) for _ in range(4)))

    def at(self, slope: float, reference: float) -> Limits:
        """Return the limits as they would be at one temperature, °C; those without a temperature stay."""
        away = np.where(np.isfinite(self.temperature), self.temperature - reference, 0.0)
        return replace(self, upper=self.upper - slope * away)


def with_limits(rows: Observations, limits: Limits, start: RandomEffects) -> tuple[RandomEffects, Observations]:
    """Return the family with the limits counted, and the observations that stand for the limits that say something.

    Args:
        rows: that have a value.
        limits: of other logs of the same sensors, or of further ones.
        start: the family of ``rows`` alone.
    """
    fit, stand = start, _normal(limits.sensor[:0], limits.upper[:0], limits.upper[:0])
    if not limits.sensor.size:
        return fit, stand
    error = float(np.median(rows.variance))
    precision, at = np.zeros_like(limits.upper), limits.upper
    for _ in range(ROUNDS):
        for _ in range(SWEEPS):
            precision, at = _sweep(rows, limits, fit, precision, at)
        telling = precision > LEAST / error
        stand = _normal(limits.sensor[telling], at[telling], 1 / precision[telling])
        last, fit = fit, random_effects(joined(rows, stand), start=fit)
        away = abs(fit.coefficients[0] - last.coefficients[0]) + abs(fit.between**0.5 - last.between**0.5)
        if away < CLOSE * (fit.between + fit.within + error) ** 0.5:
            break
    return fit, stand


def joined(one: Observations, other: Observations) -> Observations:
    """Return the rows of both."""
    parts = (
        np.concatenate([getattr(one, name), getattr(other, name)])
        for name in ("sensor", "y", "variance", "half", "time", "temperature")
    )
    return Observations(*parts, logarithmic=one.logarithmic)


def _normal(sensor: Integers, y: Floats, variance: Floats) -> Observations:
    unknown = np.full(y.size, np.nan)
    return Observations(sensor, y, variance, np.full(y.size, np.inf), unknown, unknown, logarithmic=True)


def _sweep(
    rows: Observations, limits: Limits, fit: RandomEffects, precision: Floats, at: Floats
) -> tuple[Floats, Floats]:
    """Return precision and place of the observation of each limit, given those of all other logs."""
    mean, sensor = float(fit.coefficients[0]), limits.sensor
    count = max(rows.sensors, int(sensor.max()) + 1)
    value, own = 1 / (rows.variance + fit.within), precision / (1 + precision * fit.within)
    whole = np.bincount(rows.sensor, value, count) + np.bincount(sensor, own, count)
    pull = np.bincount(rows.sensor, value * (rows.y - mean), count) + np.bincount(sensor, own * (at - mean), count)
    between = fit.between / (1 + fit.between * (whole[sensor] - own))
    expected: Floats = mean + between * (pull[sensor] - own * (at - mean))
    variance = between + fit.within
    # First and second derivative of the logarithm of ∫ N(x; expected, variance) exp(-p(x)²/2) dx, from the mean of those of -p²/2.
    x = expected[:, None] + np.sqrt(variance)[:, None] * _X - limits.upper[:, None]
    z = (scipy.special.ndtri(limits.probability) / (1 - limits.share))[:, None]
    p, slope = (
        z * (np.exp(2 * np.minimum(x, FARTHEST)) - limits.share[:, None]),
        2 * z * np.exp(2 * np.minimum(x, FARTHEST)),
    )
    weight = _WEIGHTS * np.exp(((p**2).min(axis=1, keepdims=True) - p**2) / 2)
    weight /= weight.sum(axis=1, keepdims=True)
    first = -(weight * p * slope).sum(axis=1)
    curve = (weight * (slope**2 + 2 * p * slope - (p * slope + first[:, None]) ** 2)).sum(axis=1)
    there = (curve > 0) & (variance * curve < 1)
    safe = np.where(there, curve, 1.0)
    return np.where(there, safe / np.where(there, 1 - variance * safe, 1.0), 0.0), np.where(
        there, expected + first / safe, expected
    )
