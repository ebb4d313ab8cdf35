"""Quantiles and tail probabilities of the distributions that estimates and tests need.

They come from ``scipy.special``, which is imported at the first call: this takes a tenth of a second, and ``scipy.stats``, which wraps
the same functions, a second. Quantiles of the normal distribution come from the standard library, with an error below 1e-15.
"""

from statistics import NormalDist
from typing import Any, cast

import lazy_loader
import numpy as np
from numpy.typing import ArrayLike

from imuwb.arrays import Floats

scipy: Any = lazy_loader.load("scipy")
_NORMAL = NormalDist()
EXTREME = 37.0  #: largest normal value whose tail is a number


def normal_quantile(probability: float) -> float:
    """Return the value that a standard normal variable stays below with this probability."""
    return _NORMAL.inv_cdf(probability)


def normal_limit(level: float) -> float:
    """Return z: a standard normal variable lies within +-z with probability ``level``."""
    return normal_quantile((1 + level) / 2)


def student_limit(level: float, freedom: float) -> float:
    """Return t: a Student variable lies within +-t with probability ``level``."""
    return float(scipy.special.stdtrit(freedom, (1 + level) / 2))


def chi_square_quantile(probability: float, freedom: ArrayLike) -> Any:  # noqa: ANN401 - a number for a number, an array for an array
    """Return the value that a chi-square variable stays below with this probability."""
    return 2 * scipy.special.gammaincinv(np.asarray(freedom, dtype=np.float64) / 2, probability)


def chi_square_tail(value: ArrayLike, freedom: ArrayLike) -> Any:  # noqa: ANN401 - a number, or an array
    """Return the probability that a chi-square variable exceeds a value."""
    return scipy.special.chdtrc(freedom, np.maximum(value, 0.0))


def chi_square_limits(level: float, freedom: ArrayLike) -> tuple[Any, Any]:
    """Return the factors that turn an estimated variance into the ends of its interval.

    Args:
        level: confidence level of the interval.
        freedom: degrees of freedom; the estimate is about the true variance times chi-square over ``freedom``.
    """
    nu, tail = np.asarray(freedom, dtype=np.float64), (1 - level) / 2
    return nu / chi_square_quantile(1 - tail, nu), nu / chi_square_quantile(tail, nu)


def pearson3_quantile(probability: float, skewness: float) -> float:
    """Return the value that a Pearson III variable stays below with this probability: mean 0, variance 1, skewness 0 or more."""
    if skewness < 1e-6:  # noqa: PLR2004 - normal to nine digits
        return normal_quantile(probability)
    shape = 4 / skewness**2
    return float((cast("Floats", scipy.special.gammaincinv(shape, probability)) - shape) / shape**0.5)


def student_score(value: ArrayLike, freedom: ArrayLike) -> Floats:
    """Return the standard normal values that are as improbable as values of Student variables."""
    tail = scipy.special.ndtri(scipy.special.stdtr(freedom, -np.abs(np.asarray(value, float))))
    return -np.sign(value) * np.maximum(tail, -EXTREME)


def normal_tails(score: ArrayLike) -> Floats:
    """Return the probability that a standard normal variable is farther from 0 than a value."""
    return 2 * scipy.special.ndtr(-np.abs(np.asarray(score, float)))


def log_gamma_moments(half: ArrayLike) -> tuple[Floats, Floats]:
    """Return mean and variance of the logarithm of a chi-square variable over its degrees of freedom.

    Args:
        half: half of the degrees of freedom.
    """
    half = np.asarray(half, dtype=np.float64)
    mean = scipy.special.digamma(half) - np.log(half)
    return mean, scipy.special.polygamma(1, half)
