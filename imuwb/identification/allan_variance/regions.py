"""The averaging times that one term dominates, and the slope of a free line there."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.allan_variance.problem import LETTERS, Problem, whitener
from imuwb.identification.region import SHARE, Region
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_limit

#: slope of the Allan deviation of each pure process
NOMINAL = dict(zip(LETTERS, (-1.0, -0.5, 0.0, 0.5, 1.0), strict=True))


def regions(problem: Problem, squared: Floats, covariance: Floats, level: float) -> tuple[Region, ...]:
    """Return the region of each term that has one; periodic lines are taken off the curve first.

    Args:
        problem: the Allan variances, (k,).
        squared: (5,) fitted squares of Q, N, B, K, R.
        covariance: (k, k) of the Allan variances.
        level: confidence level of the intervals of the slopes.
    """
    parts = problem.design * squared
    share = parts / (parts.sum(axis=1) + problem.by_lines)[:, None]
    dominated: list[Region] = []
    for t, letter in enumerate(LETTERS):
        inside = np.flatnonzero((share[:, t] > SHARE) & (problem.variance > 0))
        if inside.size < 2:  # noqa: PLR2004 - a slope needs two points
            continue
        inside = np.arange(inside[0], inside[-1] + 1)
        variance = problem.variance[inside]
        if (variance > 0).all():
            spread = covariance[np.ix_(inside, inside)]
            dominated.append(free_slope(letter, problem.tau[inside], variance, spread, level))
    return tuple(dominated)


def free_slope(letter: str, tau: Floats, variance: Floats, covariance: Floats, level: float) -> Region:
    """Return the region of a term with the slope of its Allan deviation, by generalised least squares.

    Args:
        letter: letter of the term.
        tau: (k,) s, averaging times.
        variance: (k,) Allan variances.
        covariance: (k, k) of the Allan variances.
        level: confidence level of the slope's interval.
    """
    whiten = whitener(covariance / np.outer(variance, variance))
    design = whiten @ np.stack([np.ones(tau.size), np.log(tau)], axis=1)
    inverse = np.linalg.inv(design.T @ design)
    slope = float((inverse @ design.T @ (whiten @ np.log(variance)))[1]) / 2
    sigma = float(inverse[1, 1]) ** 0.5 / 2
    half = normal_limit(level) * sigma
    estimate = Estimate(slope, slope - half, slope + half, sigma)
    return Region(letter, float(tau[0]), float(tau[-1]), estimate, NOMINAL[letter])
