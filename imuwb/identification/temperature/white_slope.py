"""The slope of the Allan curve where white noise dominates: fitted freely, next to the nominal -1/2 (El-Diasty, 4.1)."""

from collections.abc import Mapping

import numpy as np

from imuwb.identification.allan_variance.moments import moments
from imuwb.identification.allan_variance.overlapping import AllanDeviation
from imuwb.identification.allan_variance.regions import free_slope
from imuwb.identification.region import SHARE, Region
from imuwb.statistics import Coefficient
from imuwb.stochastic import Sum

MOST = 10  #: octaves; longer averaging times add little information


def white_slope(
    curve: AllanDeviation, processes: Sum, coefficients: Mapping[str, Coefficient], level: float = 0.95
) -> Region | None:
    """Return the averaging times at which random walk dominates, and the slope of a free line there; None for fewer than two.

    The line is fitted by generalised least squares, with the covariance of the curve's points under the sum.

    Args:
        curve: at octaves.
        processes: the identified sum.
        coefficients: Q, N, B and K of the sum.
        level: confidence level of the slope's interval.
    """
    white = coefficients["N"].value
    if white is None:
        return None
    share = white**2 / curve.averaging_time / processes.allan_variance(curve.averaging_time, curve.dt)
    inside = np.flatnonzero((share > SHARE) & (curve.deviation > 0))
    if inside.size < 2:  # noqa: PLR2004 - a slope needs two points
        return None
    inside = np.arange(inside[0], inside[-1] + 1)[:MOST]
    factor, tau, variance = curve.factor[inside], curve.averaging_time[inside], curve.deviation[inside] ** 2
    n = int(curve.terms[0]) + 2 * int(curve.factor[0]) - 1
    squared = np.array([(coefficients[letter].value or 0.0) ** 2 for letter in "QNBK"])
    spread = moments(tuple(int(m) for m in factor), n).covariance(squared, 0.0, curve.dt)
    return free_slope("N", tau, variance, spread, level)
