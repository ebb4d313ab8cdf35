"""The sensors of a family, and those outside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.identification.family.observations import Observations
from imuwb.identification.family.random_effects import RandomEffects, random_effects
from imuwb.identification.family.scores import Errors, score
from imuwb.statistics.distributions import normal_tails

FEWEST = 5  #: sensors, for a family
SHARE, MOST = 0.1, 50  #: sensors that may be outside: a tenth, and never more than this
ENOUGH = 25  #: sensors from which on the search for several outside finds no more false ones than that for one (Rosner)
NEAR = 2.5  #: score of the most distant sensor, below which none is outside
CLOSER = 0.7  #: the same in a small family: share of the largest score that is possible there


@dataclass(frozen=True, eq=False, slots=True)
class Members:
    """The k sensors of a family, each with its mean over its logs."""

    sensor: Integers  #: (k,) number of the sensor
    logs: Integers  #: (k,) of each
    mean: Floats  #: (k,)
    variance: Floats  #: (k,) of the mean, from sampling and from log to log; not that between sensors
    errors: Errors  #: of the logs in the means

    def of(self, rows: Booleans) -> Members:
        """Return some of the sensors."""
        return Members(self.sensor[rows], self.logs[rows], self.mean[rows], self.variance[rows], self.errors.of(rows))

    def family(self, start: RandomEffects | None = None) -> RandomEffects:
        """Return mean and spread of the sensors; ``start``: those of nearly the same sensors."""
        unknown, normal = np.full(self.mean.size, np.nan), np.full(self.mean.size, np.inf)
        rows = Observations(
            np.arange(self.mean.size), self.mean, self.variance, normal, unknown, unknown, logarithmic=True
        )
        return random_effects(rows, start=start)


@dataclass(frozen=True, slots=True)
class Outside:
    """A sensor outside its family."""

    sensor: int
    score: float  #: standard normal value that is as improbable in the family without it
    probability: float  #: that chance puts any of the sensors so far out


def members(rows: Observations, within: float) -> Members:
    """Return the means of the sensors that have rows; ``within`` is the variance from log to log."""
    a = 1 / (rows.variance + within)
    weight, count = rows.sums(a), rows.sums(np.ones_like(a)).astype(np.int64)
    there = count > 0
    whole = np.where(there, weight, 1.0)
    errors = Errors(a / whole[rows.sensor], rows.half, rows.sensor)
    every = Members(np.arange(rows.sensors), count, rows.sums(a * rows.y) / whole, 1 / whole, errors)
    return every.of(there)


def outside(sensors: Members, error: float, known: Booleans | None = None) -> tuple[tuple[Outside, ...], RandomEffects]:
    """Return the sensors outside the family, and the family without them.

    Up to a tenth of the sensors are taken away one after the other, each time the most improbable one, whose distance is compared
    with the predictive interval of those that are left (deleted residual). All up to the last significant one are outside, so that
    several do not hide each other (generalised extreme studentised deviate, Rosner, Technometrics 25, 1983). In a small family the
    steps share the error. Without any sensor outside, a false one is found with at most about the probability ``error``.

    Args:
        sensors: of the family.
        error: probability that a family without any sensor outside has one.
        known: (k,) sensors that may be outside; None: all.
    """
    family = sensors.family()
    left = np.ones(sensors.mean.size, dtype=bool)
    found: list[tuple[Outside, RandomEffects]] = []
    current = family
    for _ in range(_most(left.size)):
        places = np.flatnonzero(left)
        distance = np.abs(_distances(sensors.of(left), current)) * (1.0 if known is None else known[left])
        if distance.max() < _near(left.size, _most(left.size)):
            break
        worst = places[int(distance.argmax())]
        left[worst] = False
        others = sensors.of(left)
        current = others.family(current)
        value = _new(sensors.of(np.arange(left.size) == worst), others, current)
        chance = min(1.0, trials(left.size) * float(normal_tails(value)))
        found.append((Outside(int(sensors.sensor[worst]), value, chance), current))
    last = max((i + 1 for i, (one, _) in enumerate(found) if one.probability <= error), default=0)
    return tuple(one for one, _ in found[:last]), found[last - 1][1] if last else family


def trials(count: int) -> int:
    """Return the number of tests that share the error of a family of ``count`` sensors."""
    return count * (1 if count >= ENOUGH else max(_most(count), 1))


def _most(count: int) -> int:
    """Return how many of the sensors of a family may be outside."""
    return min(int(np.ceil(SHARE * count)), MOST) if count >= FEWEST else 0


def _near(count: int, most: int) -> float:
    """Return the score of the most distant sensor, below which none is outside.

    Sensors outside widen the spread by which they are measured: ``most`` of them, all equally far, have no larger score than
    √((n - most) (n - 1) / (n most)), however far they are.
    """
    return min(NEAR, CLOSER * ((count - most) * (count - 1) / (count * most)) ** 0.5)


def _distances(sensors: Members, family: RandomEffects) -> Floats:
    """Return the distances of sensors from the mean of their family, as scores without the error of its spread."""
    variance = family.between + sensors.variance
    return score(sensors.mean - family.coefficients[0], variance, np.zeros_like(variance), sensors.errors.of)


def _new(sensor: Members, others: Members, family: RandomEffects) -> float:
    """Return the score of a sensor in the family of the others."""
    mean = float(family.covariance[0, 0])
    weight = mean / (family.between + others.variance)
    # The variance of the mean rises with the variance between sensors too, by the sum of its squared weights.
    error = (1 + float(weight @ weight)) ** 2 * family.errors[0]
    size, variance = sensor.mean - family.coefficients[0], sensor.variance + family.between + mean
    return float(score(size, variance, np.array([error]), sensor.errors.of)[0])
