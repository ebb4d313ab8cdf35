"""The averaging times at which noise coefficients are read, and the interval of a coefficient whose square is estimated."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.statistics.distributions import chi_square_limits, normal_limit

FEWEST_DEGREES = 3.0  #: degrees of freedom of a square, below which an interval begins at 0
#: s, averaging time at which IEEE 952 reads a coefficient on its own line; B is read on the flat part
READ_OUT = {"Q": 3**0.5, "N": 1.0, "B": None, "K": 3.0, "R": 2**0.5}


def interval(square: float, sigma: float, level: float) -> tuple[float, float]:
    """Return the ends of the interval of a coefficient whose square was estimated with this standard error.

    A positive quadratic estimate is about a scaled chi-square, which is skewed for few degrees of freedom and never reaches 0.
    The lower end is still 0 where chance alone can explain the term.
    """
    z = normal_limit(level)
    freedom = 2 * square**2 / sigma**2
    if freedom < FEWEST_DEGREES:
        return 0.0, float(square + z * sigma) ** 0.5
    low, high = chi_square_limits(level, freedom)
    return (float(square * low) ** 0.5 if square > z * sigma else 0.0), float(square * high) ** 0.5


def printed_half_width(clusters: Floats, level: float) -> Floats:
    """Return z/√(2 (N/n - 1)), the papers' relative error of an Allan deviation (Quinchia, eq. 15; Hassaballa, eq. 10).

    Args:
        clusters: N/n, samples of the record over samples of a cluster.
        level: of the interval; 0.683 for one sigma, as in Quinchia's table 4.
    """
    return normal_limit(level) / np.sqrt(2 * np.maximum(clusters - 1, 0.5))
