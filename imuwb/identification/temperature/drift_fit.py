"""Least squares of a slow drift in a record whose noise has a white and a slow part.

The cosine coefficients of white noise, of a random walk and nearly those of flicker are independent, so generalised least squares
needs a weight for each coefficient only. The ratio of the slow noise to the white noise is the likeliest one (restricted
likelihood, Patterson and Thompson 1971), which does not count what the drift's columns explain.
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

    @staticmethod
    def of(length: int, interval: float, kept: int | None = None) -> "Weights":
        """Return the weights for white noise alone, then with flicker, then with a random walk.

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
        return Weights(table, np.log(table).sum(axis=1))


@dataclass(frozen=True, eq=False, slots=True)
class DriftFit:
    """The columns' factors in one series."""

    factors: Floats  #: (p,)
    covariance: Floats  #: (p, p)
    deviance: float  #: -2 log restricted likelihood, plus a constant of the series
    white: float  #: variance of a cosine coefficient by white noise, unit²
    weight: Floats  #: (m,) inverse variances of the coefficients, white noise being 1
    freedom: int  #: degrees of freedom of ``white``


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
    inverse = 1 / (weights.variance + blurred)
    pairs = (x[:, :, None] * x[:, None, :]).reshape(len(x), p * p)
    inside = (inverse @ pairs).reshape(-1, p, p)
    across = inverse @ (x * series[:, None])
    total = inverse @ series**2
    factors = np.linalg.solve(inside, across[:, :, None])[:, :, 0]
    rest = (total - np.einsum("gp,gp->g", factors, across)).clip(1e-300)
    freedom = len(x) - p
    plain = np.linalg.slogdet(x.T @ x)[1]
    deviance = weights.log_variance + np.linalg.slogdet(inside)[1] - plain + freedom * np.log(rest / freedom)
    best = int(np.argmin(deviance))
    white = float(rest[best]) / freedom
    covariance = white * np.linalg.inv(inside[best]) / np.outer(size, size)
    return DriftFit(factors[best] / size, covariance, float(deviance[best]), white, inverse[best], freedom)
