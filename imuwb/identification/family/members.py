"""The sensors of a family, and those outside it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.identification.family.observations import Observations
from imuwb.identification.family.random_effects import RandomEffects, random_effects
from imuwb.identification.family.scores import Errors, score
from imuwb.statistics.distributions import normal_tails, scipy

FEWEST = 5  #: sensors, for a family
SHARE = 0.3  #: of the sensors that may be outside
FIRST = 50  #: steps of the search; it goes on as long as each finds one
ENOUGH = (
    25  #: sensors; in a smaller family the steps of the search share the error (Rosner tested his method from 25 on)
)
NEAR = (
    2.5  #: distance from the median, in standard deviations by the median deviation, within which no sensor is outside
)
NORMAL_DEVIATION = 0.6745  #: median deviation of a standard normal variable
DOUBLINGS = 40  #: of a distance, in the search for the one at which a sensor is outside


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

    def one(self, place: int) -> Members:
        """Return one sensor."""
        return self.of(np.arange(self.mean.size) == place)

    def at(self, mean: float) -> Members:
        """Return sensors with the same errors and another mean."""
        return replace(self, mean=np.full_like(self.mean, mean))

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
    score: float  #: standard normal value that is as improbable in the family without all that are outside
    probability: float  #: that chance puts any of the sensors so far out


@dataclass(frozen=True, eq=False, slots=True)
class Sorted:
    """A family and the sensors outside it."""

    outside: tuple[Outside, ...]
    family: RandomEffects  #: without them
    more: bool  #: whether the search ended at its bound: more sensors may be outside


def members(rows: Observations, within: float) -> Members:
    """Return the means of the sensors that have rows; ``within`` is the variance from log to log."""
    a = 1 / (rows.variance + within)
    weight, count = rows.sums(a), rows.sums(np.ones_like(a)).astype(np.int64)
    there = count > 0
    whole = np.where(there, weight, 1.0)
    errors = Errors(a / whole[rows.sensor], rows.half, rows.sensor)
    every = Members(np.arange(rows.sensors), count, rows.sums(a * rows.y) / whole, 1 / whole, errors)
    return every.of(there)


def outside(sensors: Members, error: float) -> Sorted:
    """Return the sensors outside the family, and the family without them.

    Up to three tenths of the sensors are taken away one after the other, each time the most improbable one, whose distance is compared
    with the predictive interval of those that are left (deleted residual). All up to the last significant one are outside, so that
    several do not hide each other (generalised extreme studentised deviate, Rosner, Technometrics 25, 1983). In a small family the
    steps share the error. Without any sensor outside, a false one is found with at most about the probability ``error``; much more
    seldom where the errors of the logs are larger than the spread.
    """
    family = sensors.family()
    left = np.ones(sensors.mean.size, dtype=bool)
    taken: list[int] = []
    last, best, most = 0, family, _most(left.size)
    current, far = family, _from_median(sensors) >= NEAR
    while len(taken) < most and (len(taken) < FIRST or last == len(taken)) and np.any(far & left):
        distance = np.abs(_distances(sensors.of(left), current))
        worst = int(np.flatnonzero(left)[int(distance.argmax())])
        left[worst] = False
        taken.append(worst)
        others = sensors.of(left)
        current = others.family(current)
        value = _score_against(sensors.one(worst), others, current)
        if trials(sensors.mean.size) * float(normal_tails(value)) <= error:
            last, best = len(taken), current
    inside = np.ones_like(left)
    inside[taken[:last]] = False
    return Sorted(tuple(_against(sensors, inside, best, taken[:last])), best, more=0 < last == most)


def _against(sensors: Members, inside: Booleans, family: RandomEffects, taken: list[int]) -> Iterator[Outside]:
    """Yield the sensors that were taken away, against the family of the others."""
    for place in taken:
        value = _score_against(sensors.one(place), sensors.of(inside), family)
        chance = min(1.0, trials(inside.size) * float(normal_tails(value)))
        yield Outside(int(sensors.sensor[place]), value, chance)


def reach(sensors: Members, count: int, error: float) -> tuple[float, float]:
    """Return beyond which means the most distant sensor of a family is outside; infinite on a side where none is.

    It is compared with the family of the others, with errors like those of a typical sensor.

    Args:
        sensors: of the family, without those outside.
        count: sensors with those outside.
        error: as in ``outside``.
    """
    family = sensors.family()
    worst = int(np.abs(_distances(sensors, family)).argmax())
    others = sensors.of(np.arange(sensors.mean.size) != worst)
    family = others.family(family)
    typical = sensors.one(int(np.argsort(sensors.variance)[sensors.mean.size // 2]))
    mean, sigma = float(family.coefficients[0]), (family.between + float(typical.variance[0])) ** 0.5

    def allowed(away: float) -> float:
        """Return how far from being improbable enough a sensor is at a distance from the mean."""
        return trials(count) * float(normal_tails(_score_against(typical.at(mean + away), others, family))) - error

    def end(side: float) -> float:
        away = side * sigma
        for _ in range(DOUBLINGS):
            if allowed(away) < 0:
                return mean + float(scipy.optimize.brentq(allowed, 0.0, away, rtol=1e-4))
            away *= 2
        return side * np.inf

    return end(-1.0), end(1.0)


def trials(count: int) -> int:
    """Return the number of tests that share the error of a family of ``count`` sensors."""
    return count * (1 if count >= ENOUGH else max(_most(count), 1))


def _most(count: int) -> int:
    """Return how many of the sensors of a family may be outside."""
    return int(np.ceil(SHARE * count)) if count >= FEWEST else 0


def _from_median(sensors: Members) -> Floats:
    """Return the distances of sensors from their median, which sensors outside do not widen: the search needs those far from it only."""
    away = np.abs(sensors.mean - np.median(sensors.mean))
    return away / np.maximum(np.median(away) / NORMAL_DEVIATION, np.sqrt(sensors.variance))


def _distances(sensors: Members, family: RandomEffects) -> Floats:
    """Return the distances of sensors from the mean of their family, as scores without the error of its spread."""
    variance = family.between + sensors.variance
    return score(sensors.mean - family.coefficients[0], variance, np.zeros_like(variance), sensors.errors.of)


def _score_against(sensor: Members, others: Members, family: RandomEffects) -> float:
    """Return the score of a sensor in the family of the others."""
    mean = float(family.covariance[0, 0])
    weight = mean / (family.between + others.variance)
    # The variance of the mean rises with the variance between sensors too, by the sum of its squared weights.
    error = (1 + float(weight @ weight)) ** 2 * family.errors[0]
    size, variance = sensor.mean - family.coefficients[0], sensor.variance + family.between + mean
    return float(score(size, variance, np.array([error]), sensor.errors.of)[0])
