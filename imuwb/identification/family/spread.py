"""Intervals of the spread of a family, from the distribution of weighted sums of squares (Viechtbauer, Statist. Med. 26, 2007)."""

from collections.abc import Callable

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.family.members import Members
from imuwb.identification.family.observations import Observations
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import chi_square_limits, chi_square_quantile, normal_quantile

DOUBLINGS, HALVINGS = 60, 60
FEWEST = 8.0  #: degrees of freedom of a variance that is sure to be above 0: twice its error


def between_spread(sensors: Members, value: float, error: float, level: float) -> Coefficient:
    """Return the standard deviation between sensors.

    Args:
        sensors: of the family.
        value: estimated variance.
        error: sampling variance of ``value``.
        level: of the interval.
    """

    def statistic(variance: float) -> float:
        weight = 1 / (sensors.variance + variance)
        return float(weight @ (sensors.mean - np.average(sensors.mean, weights=weight)) ** 2)

    return _spread(statistic, sensors.mean.size - 1, value, error, level, float(np.var(sensors.mean)))


def within_spread(rows: Observations, value: float, error: float, level: float) -> Coefficient:
    """Return the standard deviation from log to log of one sensor, beyond the sampling errors; arguments as above."""
    repeated = rows.of(rows.sums(np.ones_like(rows.y))[rows.sensor] > 1)
    count = np.unique(repeated.sensor).size

    def statistic(variance: float) -> float:
        weight = 1 / (repeated.variance + variance)
        total = repeated.sums(weight)
        mean: Floats = repeated.sums(weight * repeated.y) / np.where(total > 0, total, 1.0)
        return float(weight @ (repeated.y - mean[repeated.sensor]) ** 2)

    return _spread(statistic, repeated.y.size - count, value, error, level, float(np.var(rows.y)))


def spread_of(value: float, error: float, level: float) -> Coefficient:
    """Return a standard deviation from an estimated variance and its sampling variance, as a multiple of a chi-square variable.

    For rows that stand for limits: their scatter says nothing beyond the estimate.
    """
    degrees = 2 * value**2 / error if error > 0 else 0.0
    if degrees < FEWEST:
        return Coefficient(None, None, (value + normal_quantile(level) * error**0.5) ** 0.5)
    lower, upper = (float(factor) for factor in chi_square_limits(level, degrees))
    return Coefficient(value**0.5, (value * lower) ** 0.5, (value * upper) ** 0.5)


def _spread(
    statistic: Callable[[float], float], freedom: int, value: float, error: float, level: float, scale: float
) -> Coefficient:
    """Return a standard deviation with its interval; or its limit, where the sampling errors explain the scatter.

    Where the scatter is smaller than the sampling errors alone make likely, the limit comes from the error of the estimate.
    """
    if freedom < 1:
        return Coefficient(None, None, np.inf)
    tail = (1 - level) / 2
    lower = _at(statistic, float(chi_square_quantile(1 - tail, freedom)), scale)
    if lower > 0 and value > 0:
        upper = _at(statistic, float(chi_square_quantile(tail, freedom)), scale)
        return Coefficient(value**0.5, min(lower, value) ** 0.5, max(upper, value) ** 0.5)
    limit = _at(statistic, float(chi_square_quantile(1 - level, freedom)), scale)
    return Coefficient(None, None, (max(limit, value) or normal_quantile(level) * error**0.5) ** 0.5)


def _at(statistic: Callable[[float], float], wanted: float, scale: float) -> float:
    """Return the variance at which a falling statistic has a value; 0 if it is smaller everywhere."""
    if statistic(0.0) <= wanted:
        return 0.0
    low, high = 0.0, max(scale, 1e-12)
    for _ in range(DOUBLINGS):
        if statistic(high) < wanted:
            break
        low, high = high, 2 * high
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if statistic(middle) > wanted else (low, middle)
    return (low + high) / 2
