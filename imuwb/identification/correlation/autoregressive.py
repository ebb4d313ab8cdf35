"""Autoregressive models of a record: Burg's of every order, how sure they are, and whether they are tenable.

x(n) = -sum alpha_k x(n-k) + beta0 w(n) (Quinchia, eq. 9; El-Diasty's tables of filtered data). alpha of an order
1 model is -1 for a random walk and 0 for white noise. Other libraries, R's among them, give phi = -alpha.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft, linalg

from imuwb.compiled import compiled
from imuwb.identification.correlation.burg import burg
from imuwb.statistics.distributions import chi_square_tail, normal_limit
from imuwb.stochastic import Autoregressive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

WHITE_LAGS = 20  #: of the innovations' autocorrelation, behind those that the model itself makes small
BLOCK = 1024  #: samples that stay in the fastest cache while all lags use them
GRID = 4096  #: samples of a segment of the innovations' spectrum
RANDOM_WALK, WHITE = 0.99, 0.02  #: |alpha_1| from, and up to, which an order 1 model is said to be one


@dataclass(frozen=True, eq=False, slots=True)
class Order:
    """The model of one order. Standard errors are of alpha as estimated from this record."""

    order: int
    alpha: Floats  #: (p,)
    alpha_sigma: Floats  #: (p,) Bartlett's: true whatever the series is
    alpha_sigma_if_ar: (
        Floats  #: (p,) true only if the series is autoregressive of this order: √((1 - alpha²)/n) for order 1
    )
    significant: NDArray[np.bool_]  #: (p,) at ``level``
    beta0: float  #: unit
    aicc: float
    bic: float
    fpe: float  #: unit²
    largest_pole: float  #: magnitude
    stable: bool


@dataclass(frozen=True, eq=False, slots=True)
class Whiteness:
    """Whether the innovations of one order are white (Ljung and Box, 20 lags more than the order)."""

    order: int
    statistic: float
    probability: float  #: of a statistic as large by chance
    largest: float  #: correlation within the lags, in magnitude


@dataclass(frozen=True, eq=False, slots=True)
class AutoregressiveFit:
    """Models of orders 1 ... p of one record."""

    dt: float  #: s; the models hold at this step only
    n: int
    mean: float  #: taken off
    level: float  #: of the significance of coefficients
    orders: tuple[Order, ...]
    chosen: int  #: order, by BIC
    whiteness: tuple[Whiteness, ...]  #: of the orders asked for, and the chosen one
    reading: str  #: what the order 1 model says

    def process(self, order: int) -> Autoregressive:
        """Return the model of an order as a process.

        Raises:
            ValueError: it is not stable; the message names the pole.
        """
        found = self.orders[order - 1]
        return Autoregressive(tuple(found.alpha), found.beta0, self.dt)


def fit_autoregressive(
    values: Floats,
    dt: float,
    orders: int = 20,
    *,
    level: float = 0.99,
    test: Sequence[int] = (1, 3),
    breaks: Sequence[int] = (),
) -> AutoregressiveFit:
    """Fit autoregressive models of all orders up to ``orders``.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        orders: highest order.
        level: at which a coefficient is called significant.
        test: orders whose innovations are tested for whiteness; the chosen one always is.
        breaks: indices at which samples are missing before.

    Raises:
        ValueError: too few samples, or a constant channel.
    """
    models = burg(values, orders, breaks)
    n, highest = models.n, len(models.alpha) - 1
    edges = [0, *sorted(breaks), values.size]
    parts = [np.ascontiguousarray(values[a:b]) - models.mean for a, b in pairwise(edges) if b - a > highest]
    innovations = np.concatenate([_errors(part, np.ascontiguousarray(models.alpha[highest])) for part in parts])
    density = _density(innovations, models.alpha[highest])
    covariances = fft.irfft(density)[: highest + 1]
    z = normal_limit(level)
    found: list[Order] = []
    for p in range(1, highest + 1):
        alpha, variance = models.alpha[p], float(models.variance[p])
        sigma = _bartlett(alpha, covariances, density, n)
        ideal = _ideal(models.alpha[: p + 1], models.variance, n)
        pole = float(np.abs(np.roots([1.0, *alpha])).max())
        likelihood = n * np.log(max(variance, 1e-300))
        k = p + 1  # the mean, and one for each coefficient
        found.append(Order(
            p, alpha, sigma, ideal, np.abs(alpha) > z * sigma, variance**0.5,
            float(likelihood + 2 * k + 2 * k * (k + 1) / max(n - k - 1, 1)), float(likelihood + k * np.log(n)),
            variance * (n + k) / max(n - k, 1), pole, pole < 1,
        ))  # fmt: skip
    chosen = min(found, key=lambda order: order.bic).order
    tested = sorted({p for p in (*test, chosen) if 1 <= p <= highest})
    whiteness = tuple(_whiteness(parts, models.alpha[p], p) for p in tested)
    return AutoregressiveFit(dt, n, models.mean, level, tuple(found), chosen, whiteness, _reading(found[0]))


def _density(innovations: Floats, alpha: Floats) -> Floats:
    """Return the series' density at GRID/2 + 1 frequencies, its mean over the circle the variance.

    The innovations are nearly white, so their spectrum neither leaks nor needs a fine grid; the model colours it.
    """
    size = min(GRID, 1 << max(innovations.size // 8, 2).bit_length() - 1)
    pieces = innovations[: innovations.size // size * size].reshape(-1, size)
    window = np.hanning(size)
    power = np.mean(np.abs(fft.rfft(pieces * window, axis=1)) ** 2, axis=0) / np.sum(window**2)
    fine = np.interp(np.linspace(0, 1, GRID // 2 + 1), np.linspace(0, 1, power.size), power)
    return fine / np.abs(fft.rfft([1.0, *alpha], GRID)) ** 2


def _bartlett(alpha: Floats, covariances: Floats, density: Floats, n: int) -> Floats:
    """Return the standard errors of alpha for a linear process of any density.

    alpha solves g_i = sum_j a_j r(i - j) = 0; Bartlett's covariance of sample autocovariances makes that of g
    a mean over frequencies of 2 Re(A e^(-iwi)) Re(A e^(-iwj)) S², and alpha follows by R.
    """
    p = alpha.size
    w = np.pi * np.arange(density.size) / (density.size - 1)
    response = np.exp(-1j * np.outer(np.arange(p + 1), w)) * np.array([1.0, *alpha])[:, None]
    turned = np.exp(1j * np.outer(np.arange(1, p + 1), w)) * response.sum(axis=0)
    weights = np.ones(density.size)
    weights[[0, -1]] = 0.5
    weights *= density**2 / (density.size - 1)
    inner = 2 * (turned.real * weights) @ turned.real.T / n
    inverse = linalg.pinvh(linalg.toeplitz(covariances[:p]))
    return np.sqrt(np.diag(inverse @ inner @ inverse).clip(0))


def _ideal(alpha: Sequence[Floats], variance: Floats, n: int) -> Floats:
    """Return the standard errors if the series is autoregressive of the highest order given.

    beta0²/n R^-1, whose diagonal follows from the models of lower orders (Levinson): R^-1 = sum of a_k a_k'/v_k.
    """
    p = len(alpha) - 1
    diagonal = np.zeros(p)
    for k in range(p):  # the model of order k, newest value last, in rows 0 ... k
        diagonal[: k + 1] += np.append(alpha[k][::-1], 1.0) ** 2 / variance[k]
    return np.sqrt(diagonal * variance[p] / n)


def _whiteness(parts: Sequence[Floats], alpha: Floats, order: int) -> Whiteness:
    taps = np.ascontiguousarray(alpha)
    most = order + WHITE_LAGS
    products = np.sum([_products(_errors(part, taps), most) for part in parts], axis=0)
    r = products[1:] / products[0]
    sizes = np.array([part.size - order for part in parts])
    lags = np.arange(1, most + 1)
    n = int(sizes.sum())
    # Under whiteness a lag's correlation has the variance of its number of products over n² (Ljung and Box, for one part).
    counts = np.maximum(sizes[:, None] - lags, 0).sum(axis=0).clip(1)
    statistic = float(n * (n + 2) * np.sum(r**2 / counts))
    return Whiteness(order, statistic, float(chi_square_tail(statistic, WHITE_LAGS)), float(np.abs(r).max()))


@compiled(reorder=True)
def _errors(values: Floats, alpha: Floats) -> Floats:  # pragma: no cover - compiled
    """Return x(n) + sum alpha_k x(n-k) wherever all of it is there."""
    p = alpha.size
    out = values[p:].copy()
    for low in range(0, out.size, BLOCK):
        part = out[low : low + BLOCK]
        for k in range(p):
            before = values[p - 1 - k + low : p - 1 - k + low + part.size]
            for i in range(part.size):
                part[i] += alpha[k] * before[i]
    return out


@compiled(reorder=True)
def _products(values: Floats, lags: int) -> Floats:  # pragma: no cover - compiled
    """Return sum x(i) x(i+k) for k = 0 ... lags."""
    out = np.zeros(lags + 1)
    for low in range(0, values.size, BLOCK):
        for k in range(lags + 1):
            early = values[low : max(min(low + BLOCK, values.size - k), low)]
            late = values[low + k : low + k + early.size]
            total = 0.0
            for i in range(early.size):
                total += early[i] * late[i]
            out[k] += total
    return out


def _reading(first: Order) -> str:
    alpha = float(first.alpha[0])
    if alpha < -RANDOM_WALK:
        return "alpha is near -1: the series is as good as a random walk"
    if abs(alpha) < WHITE:
        return "alpha is near 0: the series is as good as white noise"
    kind = "each value resembles the last" if alpha < 0 else "each value opposes the last"
    return (
        f"alpha is {alpha:.4g}: {kind}, between white noise (0) and a random walk (-1)"
        if alpha < 0
        else f"alpha is {alpha:.4g}: {kind}"
    )
