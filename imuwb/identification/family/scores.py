"""Differences of estimates as standard normal values."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.statistics.distributions import pearson3_score, student_score

FEWEST, MOST = 1.0, 1e6  #: degrees of freedom


def score(size: Floats, variance: Floats, third: Floats, error: Floats) -> Floats:
    """Return the standard normal values that are as improbable as differences.

    Args:
        size: (k,) differences; their expectation is 0.
        variance: (k,) their variances, as they are estimated.
        third: (k,) their third cumulants, which make them skew.
        error: (k,) sampling variances of ``variance``; the degrees of freedom are Satterthwaite's.
    """
    sigma = np.sqrt(variance)
    return pearson3_score(student_score(size / sigma, freedom(variance, error)), third / sigma**3)


def freedom(variance: Floats, error: Floats) -> Floats:
    """Return Satterthwaite's degrees of freedom of estimated variances from their sampling variances."""
    known = np.maximum(error, 2 * variance**2 / MOST)
    return np.clip(2 * variance**2 / known, FEWEST, MOST)
