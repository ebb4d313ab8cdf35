"""Autoregressive models of a record: Burg's model of each order, its standard errors, and whether it is tenable.

x(n) = -sum alpha_k x(n-k) + beta0 w(n) (Quinchia, eq. 9; El-Diasty's tables of filtered data). alpha of a model
of order 1 is -1 for a random walk and 0 for white noise. Other libraries, such as R, give phi = -alpha.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy import fft, linalg

from imuwb.arrays import Booleans, Floats, blocks_of
from imuwb.compiled import compiled
from imuwb.identification.correlation.burg import Burg, burg
from imuwb.notes import Note
from imuwb.statistics.distributions import chi_square_tail, normal_limit
from imuwb.stochastic import Autoregressive

WHITE_LAGS = 20  #: lags of the innovations' autocorrelation that are tested, beyond those that the fit makes small
BLOCK = 1024  #: samples; a block stays in the fastest cache while all lags use it
AT_ONCE = 1 << 18  #: samples in the segments of a spectrum that are transformed at once
GRID = 4096  #: samples in a segment of the innovations' spectrum
RANDOM_WALK = 0.99  #: with alpha of order 1 below -0.99, the series is called a random walk
WHITE = 0.02  #: with |alpha| of order 1 below 0.02, the series is called white noise
TENABLE = 0.01  #: probability of the Ljung-Box statistic, below which innovations are not white


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Order:
    """The model of one order, with standard errors of alpha."""

    order: int
    alpha: Floats  #: (p,)
    alpha_sigma: Floats  #: (p,) Bartlett's, valid for any series
    #: (p,) valid only if the series is autoregressive of this order: √((1 - alpha²)/n) for order 1
    alpha_sigma_if_ar: Floats
    significant: Booleans  #: (p,) whether alpha is significant at ``level``
    beta0: float  #: unit
    aicc: float
    bic: float
    fpe: float  #: unit²
    largest_pole: float  #: magnitude
    stable: bool
    beta0_ratio: float = 1.0  #: beta0 over that of order 1
    aicc_excess: float = 0.0  #: AICc minus that of order 1
    bic_excess: float = 0.0  #: BIC minus that of order 1

    def compared(self, first: Order) -> Order:
        """Return the model with its differences from the model of order 1."""
        ratio = self.beta0 / first.beta0
        return replace(self, beta0_ratio=ratio, aicc_excess=self.aicc - first.aicc, bic_excess=self.bic - first.bic)

    def __repr__(self) -> str:
        """Return the coefficients with their standard errors."""
        alphas = ", ".join(f"{a:.6g} ± {s:.1g}" for a, s in zip(self.alpha, self.alpha_sigma, strict=True))
        return f"AR({self.order}): alpha {alphas}; beta0 {self.beta0:.6g}{'' if self.stable else '; NOT stable'}"


@dataclass(frozen=True, eq=False, slots=True)
class Whiteness:
    """Test of whether the innovations of one order are white (Ljung and Box, 20 lags more than the order)."""

    order: int
    statistic: float
    probability: float  #: probability that chance makes so large a statistic
    largest: float  #: magnitude of the largest correlation within the lags
    white: bool  #: whether innovations are white at the 1 % level; the order is then tenable


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class AutoregressiveFit:
    """Models of orders 1 ... p of one record."""

    dt: float  #: s; the models are valid at this step only
    n: int  #: samples
    mean: float  #: taken off before the fit
    level: float  #: level of significance of the coefficients
    orders: tuple[Order, ...]
    chosen: int  #: order, by BIC
    whiteness: tuple[Whiteness, ...]  #: tests of the requested orders and of the chosen order
    reading: Note  #: what the model of order 1 means

    def process(self, order: int) -> Autoregressive:
        """Return the model of an order as a process.

        Raises:
            ValueError: the model is not stable; the message names the pole.
        """
        model = self.orders[order - 1]
        return Autoregressive(tuple(model.alpha), model.beta0, self.dt)

    def __repr__(self) -> str:
        """Return the chosen model, the orders that are tenable, and the reading of order 1."""
        tenable = ", ".join(str(w.order) for w in self.whiteness if w.white) or "no order"
        return (
            f"autoregressive models of orders 1 to {len(self.orders)}, step {self.dt:g} s; least BIC: "
            f"{self.orders[self.chosen - 1]}; white innovations: {tenable} of {', '.join(str(w.order) for w in self.whiteness)}; "
            f"order 1: {self.reading}"
        )


def fit_autoregressive(
    values: Floats,
    dt: float,
    orders: int = 20,
    *,
    level: float = 0.99,
    test: Sequence[int] = (1, 3),
    breaks: Sequence[int] = (),
) -> AutoregressiveFit:
    """Return the autoregressive models of all orders up to ``orders``.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        orders: highest order.
        level: level of significance of the coefficients.
        test: orders whose innovations are tested for whiteness; the chosen order is always tested.
        breaks: indices before which samples are missing.

    Raises:
        ValueError: too few samples, or a constant channel.
    """
    models = burg(values, orders, breaks)
    n, highest = models.n, len(models.alpha) - 1
    edges = [0, *sorted(breaks), values.size]
    parts = [values[a:b] for a, b in pairwise(edges) if b - a > highest]
    innovations = [_errors(part, models.mean, np.ascontiguousarray(models.alpha[highest])) for part in parts]
    density = _density(innovations[0] if len(parts) == 1 else np.concatenate(innovations), models.alpha[highest])
    del innovations
    covariances = fft.irfft(density)[: highest + 1]
    z = normal_limit(level)
    fitted: list[Order] = []
    for p in range(1, highest + 1):
        alpha, variance = models.alpha[p], float(models.variance[p])
        sigma = _bartlett(alpha, covariances, density, n)
        pole = float(np.abs(np.roots([1.0, *alpha])).max())
        likelihood = n * np.log(max(variance, 1e-300))
        k = p + 1  # the coefficients and the mean
        fitted.append(Order(
            p, alpha, sigma, models.standard_errors(p), np.abs(alpha) > z * sigma, variance**0.5,
            float(likelihood + 2 * k + 2 * k * (k + 1) / max(n - k - 1, 1)), float(likelihood + k * np.log(n)),
            variance * (n + k) / max(n - k, 1), pole, pole < 1,
        ))  # fmt: skip
    chosen = min(fitted, key=lambda order: order.bic).order
    tested = sorted({p for p in (*test, chosen) if 1 <= p <= highest})
    whiteness = tuple(_whiteness(parts, models, p) for p in tested)
    return AutoregressiveFit(
        dt,
        n,
        models.mean,
        level,
        tuple(order.compared(fitted[0]) for order in fitted),
        chosen,
        whiteness,
        _reading(fitted[0]),
    )


def _density(innovations: Floats, alpha: Floats) -> Floats:
    """Return the series' density at GRID/2 + 1 frequencies, scaled so that its mean over the circle is the variance.

    The innovations are nearly white, so their spectrum does not leak and a coarse grid is enough. The model's gain is then applied.
    """
    size = min(GRID, 1 << max(innovations.size // 8, 2).bit_length() - 1)
    pieces = innovations[: innovations.size // size * size].reshape(-1, size)
    window, power = np.hanning(size), np.zeros(size // 2 + 1)
    for some in blocks_of(len(pieces), max(AT_ONCE // size, 1)):
        power += (np.abs(fft.rfft(pieces[some] * window, axis=1)) ** 2).sum(axis=0)
    power /= len(pieces) * np.sum(window**2)
    fine = np.interp(np.linspace(0, 1, GRID // 2 + 1), np.linspace(0, 1, power.size), power)
    return fine / np.abs(fft.rfft([1.0, *alpha], GRID)) ** 2


def _bartlett(alpha: Floats, covariances: Floats, density: Floats, n: int) -> Floats:
    """Return the standard errors of alpha for a linear process of any density.

    alpha solves g_i = sum_j a_j r(i - j) = 0. Bartlett's formula for sample autocovariances gives the covariance G of g: the
    mean over frequencies of 2 Re(A e^(-iwi)) Re(A e^(-iwj)) S²/n. The covariance of alpha is R^-1 G R^-1.
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


def _whiteness(parts: Sequence[Floats], models: Burg, order: int) -> Whiteness:
    taps = np.ascontiguousarray(models.alpha[order])
    most = order + WHITE_LAGS
    products = np.sum([_products(_errors(part, models.mean, taps), most) for part in parts], axis=0)
    r = products[1:] / products[0]
    sizes = np.array([part.size - order for part in parts])
    lags = np.arange(1, most + 1)
    n = int(sizes.sum())
    # The correlation of white noise at a lag has the variance products/n² (Ljung and Box give it for one part).
    counts = np.maximum(sizes[:, None] - lags, 0).sum(axis=0).clip(1)
    statistic = float(n * (n + 2) * np.sum(r**2 / counts))
    probability = float(chi_square_tail(statistic, WHITE_LAGS))
    return Whiteness(order, statistic, probability, float(np.abs(r).max()), probability > TENABLE)


@compiled(reorder=True)
def _errors(values: Floats, mean: float, alpha: Floats) -> Floats:  # pragma: no cover - compiled
    """Return x(n) + sum alpha_k x(n-k) for each n that has all the samples; x are the values less the mean."""
    p = alpha.size
    out = np.empty(values.size - p)
    for low in range(0, out.size, BLOCK):
        part = out[low : low + BLOCK]
        around = values[low : low + part.size + p] - mean
        part[:] = around[p:]
        for k in range(p):
            before = around[p - 1 - k : p - 1 - k + part.size]
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


def _reading(first: Order) -> Note:
    alpha = float(first.alpha[0])
    if alpha < -RANDOM_WALK:
        return Note("random-walk", "alpha is near -1: the series is close to a random walk")
    if abs(alpha) < WHITE:
        return Note("white-noise", "alpha is near 0: the series is close to white noise")
    if alpha > 0:
        return Note("opposite", f"alpha is {alpha:.4g}: successive values tend to opposite signs")
    text = f"alpha is {alpha:.4g}: successive values are alike, between white noise (0) and a random walk (-1)"
    return Note("alike", text)
