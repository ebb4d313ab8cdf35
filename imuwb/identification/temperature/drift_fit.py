"""Least squares of a slow drift in a record whose noise has a white and a slow part.

The cosine coefficients of white noise, of a random walk and nearly those of flicker are independent, so generalised least squares
needs a weight for each coefficient only. A short record does not tell which slow noise it has, and the likeliest one follows the
noise of this very record: weights that are chosen so give errors that are too small (Kackar and Harville 1984). So every estimate is
the mean over all slow noises, each as probable as the record makes it, and its covariance contains their differences. Their
likelihood is the restricted one (Patterson and Thompson 1971), which does not count what the drift's columns explain.
"""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.stochastic import FlickerNoise, RandomWalk

CROSSINGS = 14  #: frequencies at which the slow noise may equal the white noise
LONGEST = 8.0  #: record lengths; slow noise that crosses white noise below this frequency does not show


@dataclass(frozen=True, eq=False, slots=True)
class Weights:
    """The variances of cosine coefficients of a record, for each ratio of slow to white noise."""

    variance: Floats  #: (g, m) variances, white noise being 1
    log_variance: Floats  #: (g,) sums of the logarithms of the variances
    log_chance: Floats  #: (g,) logarithms of the probabilities before the record is seen

    @staticmethod
    def of(length: int, interval: float, kept: int | None = None) -> "Weights":
        """Return the weights for white noise alone, then with flicker, then with a random walk: before a record, all three are equally probable.

        Args:
            length: number of means in the record.
            interval: s, over which each mean is taken.
            kept: number of coefficients, from the lowest on; None: all but that of the record's mean.
        """
        f = np.arange(1, length if kept is None else kept + 1) / (2 * length * interval)
        crossing = np.geomspace(f[0] / LONGEST, f[-1] / 2, CROSSINGS)
        variance = [np.ones(f.size)]
        for process in (FlickerNoise(1.0), RandomWalk(1.0)):
            density = process.power_spectral_density(f, interval)
            at = np.exp(np.interp(np.log(crossing), np.log(f), np.log(density)))
            at[crossing < f[0]] = density[0] * (f[0] / crossing[crossing < f[0]]) ** (
                2 if process == RandomWalk(1.0) else 1
            )
            variance += [1 + density / a for a in at]
        table = np.stack(variance)
        chance = np.concatenate([[1.0], np.full(2 * CROSSINGS, 1 / CROSSINGS)]) / 3
        return Weights(table, np.log(table).sum(axis=1), np.log(chance))


@dataclass(frozen=True, eq=False, slots=True)
class DriftFit:
    """The columns' factors in one series: means over the slow noises, and their values with each."""

    factors: Floats  #: (p,)
    covariance: Floats  #: (p, p)
    deviance: float  #: -2 log restricted likelihood, of all slow noises together, plus a constant of the series
    white: float  #: variance of a cosine coefficient by white noise, unit²
    freedom: int  #: degrees of freedom of the variance of white noise
    probability: Floats  #: (g,) of each slow noise
    factors_each: Floats  #: (g, p)
    white_each: Floats  #: (g,)
    weight_each: Floats  #: (g, m) inverse variances of the coefficients, white noise being 1
    inverse_each: Floats  #: (g, p, p) covariances of the factors, white noise being 1


def fit_drift(series: Floats, columns: Floats, weights: Weights, blurred: Floats | float = 0.0) -> DriftFit:
    """Return the factors of columns in a series.

    The noise of the columns adds to the variance by which a residual is divided (Deming). It does not add to the variances whose
    logarithms count: a column with more noise would else count as worse than it is.

    Args:
        series: (m,) its cosine coefficients.
        columns: (m, p) those of the columns, which are independent of each other.
        weights: of these coefficients.
        blurred: (m,) variances by the noise of the columns, the series' own white noise being 1.

    Raises:
        ValueError: columns that depend on each other.
    """
    p = columns.shape[1]
    size = np.linalg.norm(columns, axis=0)
    if not size.all() or np.linalg.svd(columns / size, compute_uv=False)[-1] < 1e-6:  # noqa: PLR2004 - a rounding error
        raise ValueError("columns of a drift depend on each other")
    x = columns / size
    weight = 1 / (weights.variance + blurred)
    pairs = (x[:, :, None] * x[:, None, :]).reshape(len(x), p * p)
    inside = (weight @ pairs).reshape(-1, p, p)
    across = weight @ (x * series[:, None])
    inverse = np.linalg.inv(inside)
    factors = np.einsum("gpq,gq->gp", inverse, across)
    rest = (weight @ series**2 - np.einsum("gp,gp->g", factors, across)).clip(1e-300)
    freedom = len(x) - p
    plain = np.linalg.slogdet(x.T @ x)[1]
    each = weights.log_variance + np.linalg.slogdet(inside)[1] - plain + freedom * np.log(rest / freedom)
    evidence = weights.log_chance - each / 2
    top = float(evidence.max())
    probability = np.exp(evidence - top)
    deviance = -2 * (top + float(np.log(probability.sum())))
    probability /= probability.sum()
    white, factors, inverse = rest / freedom, factors / size, inverse / np.outer(size, size)
    mean = probability @ factors
    apart = factors - mean
    covariance = np.tensordot(probability * white, inverse, 1) + (probability * apart.T) @ apart
    return DriftFit(
        mean, covariance, deviance, float(probability @ white), freedom, probability, factors, white, weight, inverse
    )
