"""The sensors of a family, and those outside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.identification.family.observations import Observations
from imuwb.identification.family.random_effects import RandomEffects, random_effects
from imuwb.identification.family.scores import Errors, far, in_tails, score
from imuwb.statistics.distributions import normal_tails

FEWEST = 5  #: sensors, for a family
SHARE, MOST = 0.1, 50  #: sensors that may be outside: a tenth, and never more than this
NEAR = 2.5  #: score of the most distant sensor that is left, below which none is outside: a tenth of sensors far out would have 3


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


def outside(sensors: Members, error: float) -> tuple[tuple[Outside, ...], RandomEffects]:
    """Return the sensors outside the family, and the family without them.

    Up to a tenth of the sensors are taken away one after the other, each time the most improbable one, whose distance is compared
    with the predictive interval of those that are left (deleted residual). All up to the last significant one are outside, so that
    several do not hide each other (generalised extreme studentised deviate, Rosner, Technometrics 25, 1983). Without any sensor
    outside, a false one is found with at most about the probability ``error``.
    """
    family = sensors.family()
    left = np.ones(sensors.mean.size, dtype=bool)
    found: list[tuple[Outside, RandomEffects]] = []
    most = min(int(np.ceil(SHARE * left.size)), MOST) if left.size >= FEWEST else 0
    current = family
    for _ in range(most):
        places = np.flatnonzero(left)
        distance = np.abs(_scores(sensors.of(left), current))
        if distance.max() < NEAR:
            break
        worst = places[int(distance.argmax())]
        left[worst] = False
        current = sensors.of(left).family(current)
        value = float(_scores(sensors.of(np.arange(left.size) == worst), current, new=True)[0])
        found.append(
            (Outside(int(sensors.sensor[worst]), value, min(1.0, places.size * float(normal_tails(value)))), current)
        )
    last = max((i + 1 for i, (one, _) in enumerate(found) if one.probability <= error), default=0)
    return tuple(one for one, _ in found[:last]), found[last - 1][1] if last else family


def _scores(sensors: Members, family: RandomEffects, *, new: bool = False) -> Floats:
    """Return the distances of sensors from the mean of a family; ``new``: of sensors that it was fitted without."""
    variance = family.between + sensors.variance + (float(family.covariance[0, 0]) if new else 0.0)
    error = np.full(variance.size, family.errors[0])
    scores = score(sensors.mean - family.coefficients[0], variance, error)
    tail = far(scores)
    scores[tail] = in_tails(scores[tail], variance[tail], sensors.errors.of(tail))
    return scores
