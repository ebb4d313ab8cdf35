"""Logs that give a limit only, as observations of a family: without them its mean is too large and its spread too small.

A log gives a limit where its estimate r of the square of a coefficient is not above the error σ of r; mostly r is 0. The upper end c of
a probability with the quantile z is then c² = r + z σ, and the likelihood of a coefficient θ is f(θ) = exp(-p²/2), p = (θ² - r)/σ, as
that of imuwb's likelihood fits. Each such factor is replaced by the normal observation that leaves mean and variance of ln θ as they
are, given all other logs, and the family is fitted again until neither changes (expectation propagation, Minka, UAI 2001). At the fixed
point the slope of the restricted likelihood is that of the approximated likelihood of the limits.

Values that are just above their error count with the error of a chi-square variable, so the mean remains a few per cent too large
(tests/studies/fleet_limits.md).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.identification.family.observations import Observations
from imuwb.identification.family.random_effects import RandomEffects, random_effects
from imuwb.statistics.distributions import scipy

ROUNDS, CLOSE = 200, 1e-4  #: of the search; change of mean and spreads, in units of the scatter, at which it ends
SHARE = 0.7  #: of the way to the new observations that a round goes
FARTHEST = 70.0  #: ln θ/c, beyond which p is as large as it need be
LARGEST = 200.0  #: p, beyond which f is 0
LEAST = 1e-9  #: variance of ln θ
TELLING = (
    1e-6  #: precision against that of a log with a value, below which a limit says nothing: it is far above the family
)
CONTRADICTION = 1e-4  #: probability, shared by the limits, below which a limit contradicts the values of its own sensor
HALVINGS = 50  #: of the search for a mode
WEAK = 0.5  #: share by which a factor narrows ln θ, below which its observation follows from the slope of ln f
_EDGES = np.array([-9.0, -5.0, -2.5, 0.0, 2.5, 5.0, 9.0])  #: of panels of an integral, in standard deviations
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)


@dataclass(frozen=True, eq=False, slots=True)
class Limits:
    """The m logs that give a limit only."""

    sensor: Integers  #: (m,) number of the sensor; sensors without any value have the numbers after those that have one
    upper: Floats  #: (m,) natural logarithm of the limit
    share: (
        Floats  #: (m,) of the limit's square that the estimate of the square has, below 1; 0: the log has no estimate
    )
    probability: Floats  #: (m,) that the coefficient is below it, above 0.5
    temperature: Floats  #: (m,) °C; nan: not known

    @classmethod
    def none(cls) -> Limits:
        """Return no limits."""
        return cls(np.zeros(0, dtype=np.int64), *(np.zeros(0) for _ in range(4)))

    def of(self, kept: Booleans) -> Limits:
        """Return some of the limits."""
        return Limits(
            *(getattr(self, name)[kept] for name in ("sensor", "upper", "share", "probability", "temperature"))
        )

    def at(self, slope: float, reference: float) -> Limits:
        """Return the limits as they would be at one temperature, °C; those without a temperature stay."""
        away = np.where(np.isfinite(self.temperature), self.temperature - reference, 0.0)
        return replace(self, upper=self.upper - slope * away)

    def rise(self, x: Floats) -> tuple[Floats, Floats]:
        """Return p and half of its slope, (m, k), at the natural logarithms x, (m, k), of coefficients."""
        z = (scipy.special.ndtri(self.probability) / (1 - self.share))[:, None]
        half = z * np.exp(2 * np.minimum(x - self.upper[:, None], FARTHEST))
        return half - z * self.share[:, None], half


def with_limits(rows: Observations, limits: Limits, start: RandomEffects) -> tuple[RandomEffects, Observations]:
    """Return the family with the limits counted, and the normal observations that stand for them.

    Args:
        rows: that have a value.
        limits: of other logs of the same sensors, or of further ones.
        start: the family of ``rows`` alone.
    """
    fit, precision, pull = start, np.zeros(limits.upper.size), np.zeros(limits.upper.size)
    error = float(np.median(rows.variance))
    stand = _standing(limits, precision, pull, 0.0)
    # The search begins with a spread that has room for the limits: in one without any, they would say nothing of it.
    room = float(np.var(np.concatenate([rows.y, np.minimum(limits.upper, rows.y.max())])))
    fit = replace(start, between=max(start.between, room)) if limits.upper.size else start
    for _ in range(ROUNDS if limits.upper.size else 0):
        new_precision, new_pull = matched(limits, *_cavity(rows, limits, fit, precision, pull))
        precision, pull = precision + SHARE * (new_precision - precision), pull + SHARE * (new_pull - pull)
        stand = _standing(limits, precision, pull, TELLING / (error + fit.between + fit.within))
        last, fit = fit, random_effects(joined(rows, stand), start=fit if fit.between > 0 else None)
        changes = [
            fit.coefficients[0] - last.coefficients[0],
            fit.between**0.5 - last.between**0.5,
            fit.within**0.5 - last.within**0.5,
        ]
        settled = np.all(np.abs(new_precision - precision) <= CLOSE * (new_precision + 1 / error))
        if settled and np.abs(changes).sum() < CLOSE * (fit.between + fit.within + error) ** 0.5:
            break
    return fit, stand


def contradicting(rows: Observations, limits: Limits, fit: RandomEffects) -> Booleans:
    """Return which limits the values of their own sensors make improbable, (m,).

    Args:
        rows: that have a value.
        limits: of other logs.
        fit: the family of ``rows``.
    """
    nothing = np.zeros(limits.upper.size)
    if not nothing.size:
        return np.zeros(0, dtype=bool)
    mean, variance = _cavity(rows, limits, fit, nothing, nothing)
    x, weight = _panels(limits, mean, variance)
    density = np.exp(-((x - mean[:, None]) ** 2) / (2 * variance[:, None])) / np.sqrt(2 * np.pi * variance[:, None])
    chance = (weight * density * scipy.special.ndtr(-limits.rise(x)[0])).sum(axis=1)
    return (limits.sensor < rows.sensors) & (chance < CONTRADICTION / max(limits.upper.size, 1))


def matched(limits: Limits, mean: Floats, variance: Floats) -> tuple[Floats, Floats]:
    """Return precision, and precision times place, of the normal observation of each limit, (m,); 0 where a limit says nothing.

    Args:
        limits: m of them.
        mean: (m,) of ln θ, given all other logs.
        variance: (m,)
    """
    x, weight = _panels(limits, mean, variance)
    p, half = limits.rise(x)
    log = -((x - mean[:, None]) ** 2) / (2 * variance[:, None]) - p**2 / 2
    weight = weight * np.exp(log - log.max(axis=1, keepdims=True))
    weight /= weight.sum(axis=1, keepdims=True)
    middle = (weight * x).sum(axis=1)
    left = (weight * (x - middle[:, None]) ** 2).sum(axis=1)
    # The same by the mean slope of ln f and the mean of its curvature, where the difference of two variances is small.
    slope = -2 * half * p
    first = (weight * slope).sum(axis=1)
    curve = (weight * (4 * half * (half + p) - (slope - first[:, None]) ** 2)).sum(axis=1)
    weak = variance * curve < WEAK
    narrowed = np.where(weak, 1 - variance * curve, 1.0)
    precision = np.where(weak, curve / narrowed, 1 / left - 1 / variance)
    pull = np.where(weak, (mean * curve + first) / narrowed, middle / left - mean / variance)
    there = precision > 0
    return np.where(there, precision, 0.0), np.where(there, pull, 0.0)


def joined(one: Observations, other: Observations) -> Observations:
    """Return the rows of both."""
    parts = (
        np.concatenate([getattr(one, name), getattr(other, name)])
        for name in ("sensor", "y", "variance", "half", "time", "temperature")
    )
    return Observations(*parts, logarithmic=one.logarithmic)


def _standing(limits: Limits, precision: Floats, pull: Floats, least: float) -> Observations:
    """Return the normal observations of the limits that say more than ``least``."""
    telling = precision > least
    unknown, normal = np.full(int(telling.sum()), np.nan), np.full(int(telling.sum()), np.inf)
    place, variance = pull[telling] / precision[telling], 1 / precision[telling]
    return Observations(limits.sensor[telling], place, variance, normal, unknown, unknown, logarithmic=True)


def _cavity(
    rows: Observations, limits: Limits, fit: RandomEffects, precision: Floats, pull: Floats
) -> tuple[Floats, Floats]:
    """Return mean and variance of ln θ of the log of each limit, (m,), given the family and all other logs of its sensor."""
    mean, sensor = float(fit.coefficients[0]), limits.sensor
    count = max(rows.sensors, int(sensor.max()) + 1)
    value = 1 / (rows.variance + fit.within)
    own, own_pull = (part / (1 + precision * fit.within) for part in (precision, pull - precision * mean))
    whole = np.bincount(rows.sensor, value, count) + np.bincount(sensor, own, count)
    pulls = np.bincount(rows.sensor, value * (rows.y - mean), count) + np.bincount(sensor, own_pull, count)
    between = fit.between / (1 + fit.between * np.maximum(whole[sensor] - own, 0.0))
    return mean + between * (pulls[sensor] - own_pull), np.maximum(between + fit.within, LEAST)


def _panels(limits: Limits, mean: Floats, variance: Floats) -> tuple[Floats, Floats]:
    """Return nodes and weights, (m, k), of integrals of N(mean, variance) times a function of p: dense where either changes."""
    sigma = np.sqrt(variance)
    with np.errstate(divide="ignore"):
        flat = limits.upper + np.log(limits.share) / 2  # where p is 0
    low, high = (
        np.minimum(mean, np.where(limits.share > 0, flat, np.minimum(mean, limits.upper) - 5.0)),
        np.maximum(mean, flat),
    )
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        p, half = (part[:, 0] for part in limits.rise(middle[:, None]))
        above = (mean - middle) / variance < 2 * half * p
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    p, half = (part[:, 0] for part in limits.rise(low[:, None]))
    narrow = 1 / np.sqrt(1 / variance + np.maximum(4 * half * (half + p), 0.0))
    z = scipy.special.ndtri(limits.probability) / (1 - limits.share)
    end = np.maximum(limits.upper + np.log(limits.share + LARGEST / z) / 2, low + 9 * narrow)
    change = np.where(limits.share > 0, flat, limits.upper)
    width = np.minimum(1 / (2 * z * np.maximum(limits.share, 1e-3)), 0.3)
    edges = np.concatenate(
        [at[:, None] + by[:, None] * _EDGES for at, by in ((mean, sigma), (low, narrow), (change, width))], axis=1
    )
    least = np.minimum(mean - 9 * sigma, low - 9 * narrow)
    edges = np.sort(np.clip(edges, least[:, None], end[:, None]), axis=1)
    half_width = np.diff(edges, axis=1)[:, :, None] / 2
    x = edges[:, :-1, None] + half_width * (1 + _NODES)
    return x.reshape(len(mean), -1), (half_width * _WEIGHTS).reshape(len(mean), -1)
