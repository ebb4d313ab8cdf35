"""Intervals of the spread of a family, from the distribution of weighted sums of squares (Viechtbauer, Statist. Med. 26, 2007)."""

from collections.abc import Callable

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.family.members import Members
from imuwb.identification.family.observations import Observations
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import chi_square_quantile, normal_quantile

DOUBLINGS, HALVINGS = 60, 60


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


def spread_of(value: float, error: float, typical: float, level: float) -> Coefficient:
    """Return a standard deviation from an estimated variance and its sampling variance; for rows that stand for limits.

    The sum of the variance and of a typical sampling variance is about a multiple of a chi-square variable, whose degrees of freedom
    follow from the sampling variance.

    Args:
        value: estimated variance.
        error: sampling variance of ``value``; 0: it is not estimated.
        typical: sampling variance of a typical row.
        level: of the interval.
    """
    if error <= 0:
        return Coefficient(None, None, np.inf)
    whole = value + typical
    degrees = 2 * whole**2 / error
    tail = (1 - level) / 2
    lower, upper, limit = (
        max(whole * degrees / float(chi_square_quantile(p, degrees)) - typical, 0.0)
        for p in (1 - tail, tail, 1 - level)
    )
    if lower > 0 and value > 0:
        return Coefficient(value**0.5, min(lower, value) ** 0.5, max(upper, value) ** 0.5)
    return Coefficient(None, None, max(limit, value) ** 0.5)


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
