"""The probability that the largest of several correlated normal variables exceeds a value."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.statistics.distributions import normal_tails, scipy

NODES = 48
DECAY = 40.0  #: the integral ends where the density has fallen by exp(-20)
LIKELY = 1.0  #: value below which the probability counts as 1
COARSE = 0.05  #: sum of probabilities from which the pairs are not needed
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(NODES)


def both_tails(limit: float, correlation: Floats) -> Floats:
    """Return the probability that two standard normal variables are both farther from 0 than a limit, for each correlation."""
    end = (limit**2 + DECAY) ** 0.5
    z = limit + (_NODES + 1) * (end - limit) / 2
    rest = np.sqrt(np.maximum(1 - correlation**2, 1e-12))[:, None]
    along = correlation[:, None] * z
    inner = scipy.special.ndtr((along - limit) / rest) + scipy.special.ndtr((-along - limit) / rest)
    density = np.exp(-(z**2) / 2) / np.sqrt(2 * np.pi)
    return (end - limit) * (inner * density) @ _WEIGHTS


def largest_tail(limit: float, count: int, correlation: Floats) -> float:
    """Return an upper bound of the probability that any of several standard normal variables is farther from 0 than a limit.

    The sum of the probabilities, less those of pairs along a tree (Hunter, J. Appl. Prob. 13, 1976; for a change point Worsley,
    Biometrika 69, 1982): close for small probabilities, and never too small.

    Args:
        limit: above 0.
        count: number of variables.
        correlation: (count - 1,) correlations of the pairs of a tree.
    """
    if limit < LIKELY:
        return 1.0
    single = count * float(normal_tails(limit))
    return single - float(both_tails(limit, correlation).sum())
