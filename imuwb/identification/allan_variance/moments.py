"""The sampling distribution of overlapping Allan variances: exact second moments.

The Allan variance at factor m is the mean of z² over 2 tau², z(k) = theta(k+2m) - 2 theta(k+m) + theta(k). For Gaussian noise the
covariance of two such means is a double sum of squared covariances of z. Those follow from the generalised covariance of theta: a
multiple of 1 at lag 0 only, |t|, t² ln|t| and |t|³ for quantization, white, flicker and random-walk noise. Greenhall and Riley
(2003, "Uncertainty of stability variances based on finite differences") sum them for one m and tabulate approximations of the
equivalent degrees of freedom. Here the sums are computed exactly, also between different m, so that a fit knows the correlations
of its points.

One difference from that paper is intended. Greenhall and Riley take phase samples that are averages, but the angle of a gyro is
the plain sum of its samples. For white noise at m = 1 the degrees of freedom are then 2/3 of the number of terms, not 4/5.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import special

from imuwb.arrays import Floats, Integers

#: exponents alpha of the rate's density f^alpha, in the order of all tables here
EXPONENTS = (2, 0, -1, -2)  # quantization Q, white N, flicker B, random walk K
NEAR = 24  #: lags on each side of a corner that are all summed
FAR = 30  #: lag, over m + q, beyond which flicker is computed from its series
SCALED = 64  #: averaging factor above which only m/n matters
FEW = 16  #: ratio of record length to averaging time, above which the ends of the record have no effect
FARTHEST = 4096  #: ratio of lag to averaging time, beyond which differences are not correlated
RATIO = 1.12  #: ratio of successive lags far from a corner


def _flicker_phase(lag: Floats) -> Floats:
    """Return the generalised covariance of averaged flicker phase noise (exponent 1)."""
    size = np.abs(lag)
    near = np.minimum(size, 1000.0)
    exact = special.xlogy((near + 1) ** 2, near + 1) + special.xlogy((near - 1) ** 2, np.abs(near - 1))
    exact -= 2 * special.xlogy(near**2, near)
    return -np.where(size < 1000, exact, 2 * np.log(np.maximum(size, 1.0)) + 3)  # noqa: PLR2004 - where the limit is reached


def _flicker(lag: Floats) -> Floats:
    return special.xlogy(lag**2, np.abs(lag)) / (2 * np.pi)


def _random_walk(lag: Floats) -> Floats:
    return np.abs(lag) ** 3 / 12


_KERNELS: dict[int, Callable[[Floats], Floats]] = {
    2: lambda lag: (lag == 0).astype(np.float64), 1: _flicker_phase, 0: lambda lag: -np.abs(lag) / 2, -1: _flicker,
    -2: _random_walk,
}  # fmt: skip


def _grid(m: int, q: int, first: int, last: int) -> tuple[Floats, Floats]:
    """Return some lags between first and last, and the weights that make a sum over them a sum over all lags."""
    steps = [*range(NEAR + 1)]
    while steps[-1] < last - first:
        steps.append(int(np.ceil(steps[-1] * RATIO)))
    offsets = np.array(steps)
    corners = np.unique([a * m - b * q for a in range(3) for b in range(3)])
    lags = (corners[:, None] + np.concatenate([-offsets[::-1], offsets])[None, :]).ravel()
    lags = np.unique(np.clip(lags, first, last))
    weights = np.zeros(lags.size)
    gaps = np.diff(lags) / 2
    weights[:-1] += gaps
    weights[1:] += gaps
    weights[0] += 0.5
    weights[-1] += 0.5
    return lags.astype(np.float64), weights


def _pairs(lags: Floats, n_m: int, n_q: int) -> Floats:
    """Return the number of pairs of n_m and n_q terms at each lag."""
    return np.minimum(n_m, n_q - lags) - np.maximum(0, -lags)


def _cross(kernel: Callable[[Floats], Floats], lags: Floats, m: int, q: int) -> Floats:
    """Return the covariance of z at factor m with z at factor q, a lag later."""
    total = np.zeros_like(lags)
    # The unit is the longer factor, so that t² ln|t| is small where its differences are small.
    unit = float(max(m, q)) if kernel is _flicker else 1.0
    shifts: dict[int, int] = {}  # between the points of the two second differences; some coincide
    for a, wa in enumerate((1, -2, 1)):
        for b, wb in enumerate((1, -2, 1)):
            shifts[b * q - a * m] = shifts.get(b * q - a * m, 0) + wa * wb
    for shift, weight in shifts.items():
        total += weight * kernel((lags + shift) / unit)
    # At long lags the terms cancel except for rounding errors, which add up over a million lags.
    distance = np.abs(lags + q - m)
    if kernel is _random_walk:  # four differences of a cubic are 0
        return np.where(distance >= m + q, 0.0, total)
    if kernel is _flicker:  # the fourth derivative of t² ln t is -2/t², the sixth -12/t⁴
        far = np.maximum(distance, 1.0)
        series = -((float(m) * q / far) ** 2) / np.pi * (1 + (m * m + q * q) / (2 * far**2))
        return np.where(distance > FAR * (m + q), series, total * unit**2)
    return total


@lru_cache(maxsize=4096)
def equivalent_degrees_of_freedom(m: int, n: int, exponent: int) -> float:
    """Return the degrees of freedom of the chi-square law of the Allan variance at factor m of n samples.

    Args:
        m: averaging factor, at most n/2.
        n: number of samples (terms: n + 1 - 2 m).
        exponent: alpha of the power law, 2 ... -2.
    """
    terms = n + 1 - 2 * m
    if exponent == 1 or n <= FEW * m:
        return _summed(m, n, exponent)
    # For long averages, the correlations depend on lag/m only; for phase noise this is not so.
    reference = SCALED if exponent <= 0 and m > SCALED else m
    flat, rising = _long(reference, exponent)
    return terms / (m / reference * flat - (m / reference) ** 2 * rising / terms)


@lru_cache(maxsize=512)
def _long(m: int, exponent: int) -> tuple[float, float]:
    """Return two sums over all lags: squared correlations of second differences, and those times the lag."""
    lags, weights = _grid(m, m, -FARTHEST * m, FARTHEST * m)
    squared = weights * (_cross(_KERNELS[exponent], lags, m, m) / _variance(m, exponent)) ** 2
    return float(squared.sum()), float(squared @ np.abs(lags))


def _variance(m: int, exponent: int) -> float:
    return float(_cross(_KERNELS[exponent], np.zeros(1), m, m)[0])


def _summed(m: int, n: int, exponent: int) -> float:
    """Return the degrees of freedom from the sum over all lags of the record."""
    terms = n + 1 - 2 * m
    lags, weights = _grid(m, m, 1 - terms, terms - 1)
    gamma = _cross(_KERNELS[exponent], lags, m, m)
    return (_variance(m, exponent) * terms) ** 2 / float((weights * _pairs(lags, terms, terms)) @ gamma**2)


@dataclass(frozen=True, eq=False, slots=True)
class Moments:
    """Second moments of the Allan variances at k factors, for each pair of processes Q, N, B, K of size 1."""

    factor: Integers  #: (k,)
    squares: Floats  #: (k, k, 4, 4)
    linear: Floats  #: (k, k, 4) moments of the cross terms with a ramp

    def scaled(self, wider: Floats) -> Moments:
        """Return the moments of variances whose scatter is larger by these factors, (k,)."""
        both = np.outer(wider, wider)
        return Moments(self.factor, self.squares * both[:, :, None, None], self.linear * both[:, :, None])

    def covariance(self, squared: Floats, ramp: float, dt: float) -> Floats:
        """Return the covariance of the Allan variances.

        Args:
            squared: (4,) Q², N², B², K².
            ramp: R.
            dt: s.
        """
        # Units of theta²: 1, dt, dt², dt³ for the four kernels.
        p = squared * dt ** np.arange(4)
        total = np.einsum("ijtu,t,u->ij", self.squares, p, p)
        if ramp:
            mean = ramp * (self.factor * dt) ** 2  # mean of z
            total += 4 * np.outer(mean, mean) * (self.linear @ p)
        tau = self.factor * dt
        return total / (4 * np.outer(tau, tau) ** 2)


@lru_cache(maxsize=32)
def moments(factor: tuple[int, ...], n: int) -> Moments:
    """Return the second moments for these averaging factors of n samples."""
    k = len(factor)
    kernels = [_KERNELS[exponent] for exponent in EXPONENTS]
    squares, linear = np.zeros((k, k, 4, 4)), np.zeros((k, k, 4))
    for i, m in enumerate(factor):
        for j in range(i, k):
            q = factor[j]
            n_m, n_q = n + 1 - 2 * m, n + 1 - 2 * q
            lags, weights = _grid(m, q, 1 - n_m, n_q - 1)
            weights *= _pairs(lags, n_m, n_q)
            gamma = np.stack([_cross(kernel, lags, m, q) for kernel in kernels])
            squares[i, j] = squares[j, i] = 2 * (gamma * weights) @ gamma.T / (n_m * n_q)
            linear[i, j] = linear[j, i] = gamma @ weights / (n_m * n_q)
    return Moments(np.array(factor), squares, linear)
