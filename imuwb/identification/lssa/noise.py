"""The structure of a series' noise, and its estimated parameters."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy import linalg, optimize

from imuwb.arrays import Floats, Integers
from imuwb.identification.correlation.burg import burg
from imuwb.identification.lssa.trigonometric import Lattice
from imuwb.identification.lssa.whitening import (
    Chain,
    Whitening,
    dense,
    first_order,
    gauss_markov,
    random_walk,
    recursion,
    white,
)

NoiseKind = Literal["local", "white", "autoregressive", "gauss-markov", "random-walk", "covariance"]
TURNS = 3  #: alternating estimates of noise and constituents
MOST_ORDERS = 64
SLOWEST = 10.0  #: record lengths; Gauss-Markov noise of a longer correlation time is a random walk
FASTEST = 0.05  #: sampling intervals; Gauss-Markov noise of a shorter correlation time is white


@dataclass(frozen=True, eq=False, slots=True)
class Noise:
    """A structure of the noise; its level is always estimated.

    With ``local`` no structure is known: the noise at a frequency is estimated from the frequencies around it.

    Raises:
        ValueError: an order or a correlation time out of its range.
    """

    kind: NoiseKind = "white"
    order: int = 0  #: order of autoregressive noise
    correlation_time: float | None = None  #: s, of Gauss-Markov noise; None: it is estimated
    covariance: Floats | None = field(default=None, repr=False)  #: (n, n)

    def __post_init__(self) -> None:
        """Check the parameters."""
        if self.kind == "autoregressive" and not 1 <= self.order <= MOST_ORDERS:
            raise ValueError(f"the order of the autoregressive noise is {self.order}; it must be 1 to {MOST_ORDERS}")
        if self.correlation_time is not None and not 0 < self.correlation_time < math.inf:
            raise ValueError(f"the correlation time is {self.correlation_time} s; it must be above 0")
        if self.kind == "covariance" and self.covariance is None:
            raise ValueError("noise of kind covariance needs a covariance")


@dataclass(frozen=True, eq=False, slots=True)
class NoiseFit:
    """A structure with its estimated parameters."""

    noise: Noise
    whitening: Whitening
    alpha: Floats  #: (p,) alpha of Quinchia's eq. 9; empty if the noise is not autoregressive
    correlation_time: float | None = None  #: s


def fitted_noise(
    time: Floats, values: Floats, columns: Floats, lattice: Lattice | None, noise: Noise, weights: Floats | None = None
) -> NoiseFit:
    """Return the noise of a series; its parameters and the constituents are estimated in alternation.

    Args:
        time: (n,) s.
        values: (n,).
        columns: (n, k) columns of the constituents.
        lattice: lattice of the time stamps.
        noise: the structure.
        weights: (n,) inverse variances of white noise.

    Raises:
        ValueError: weights with other noise, AR(p) without a lattice or with too many gaps, a covariance of another size.
    """
    n, nothing = time.size, np.empty(0)
    if weights is not None:
        suits = weights.shape == (n,) and (weights >= 0).all() and weights.any()
        if noise.kind not in ("white", "local") or not suits:
            raise ValueError(
                "weights need white noise, one weight for each sample, each 0 or more; for other noise, give its covariance instead"
            )
        return NoiseFit(noise, white(n, weights), nothing)
    if noise.kind in ("white", "local"):
        return NoiseFit(noise, white(n), nothing)
    if noise.kind == "random-walk":
        return NoiseFit(noise, random_walk(time), nothing)
    if noise.covariance is not None:
        if len(noise.covariance) != n:
            raise ValueError(
                f"a covariance of {len(noise.covariance)} samples for a series of {n} samples; the sizes must be equal"
            )
        return NoiseFit(noise, dense(noise.covariance), nothing)
    if noise.kind == "gauss-markov" and noise.correlation_time is not None:
        return NoiseFit(noise, gauss_markov(time, noise.correlation_time), nothing, noise.correlation_time)
    residual = values
    if columns.shape[1]:
        residual = values - columns @ linalg.lstsq(columns, values, check_finite=False)[0]
    fit = None
    for _ in range(TURNS):
        fit = _estimated(time, lattice, residual, noise)
        rows = fit.whitening.rows(np.column_stack([columns, values]))
        share = linalg.lstsq(rows[:, :-1], rows[:, -1], check_finite=False)[0] if columns.shape[1] else nothing
        residual = values - columns @ share
    assert fit is not None  # noqa: S101 - TURNS is above 0
    return fit


def _estimated(time: Floats, lattice: Lattice | None, residual: Floats, noise: Noise) -> NoiseFit:
    if noise.kind == "gauss-markov":
        return _gauss_markov(time, residual, noise)
    if lattice is None:
        raise ValueError("autoregressive noise needs evenly spaced samples; Gauss-Markov and local noise do not")
    steps = np.diff(lattice.index)
    if noise.order == 1 and (steps > 1).any():
        return _first_order(residual, steps, noise)
    alpha = burg(residual, noise.order, (np.flatnonzero(steps > 1) + 1).tolist()).alpha[noise.order]
    even = recursion(lattice.index, lattice.interval, alpha) if noise.order > 1 else first_order(steps, float(alpha[0]))
    return NoiseFit(noise, even, alpha)


def _first_order(residual: Floats, steps: Integers, noise: Noise) -> NoiseFit:
    """Return AR(1) noise of a series with gaps, by likelihood."""
    best = _smallest(
        lambda a: _misfit(first_order(steps, a), residual), np.linspace(-0.98, 0.98, 15), (-0.999999, 0.999999)
    )
    return NoiseFit(noise, first_order(steps, best), np.array([best]))


def _gauss_markov(time: Floats, residual: Floats, noise: Noise) -> NoiseFit:
    first, last = np.log([FASTEST * float(np.median(np.diff(time))), SLOWEST * float(time[-1])])
    tried = np.linspace(first, last, 25)
    best = math.exp(_smallest(lambda x: _misfit(gauss_markov(time, math.exp(x)), residual), tried, (first, last)))
    return NoiseFit(noise, gauss_markov(time, best), np.empty(0), best)


def _misfit(chain: Chain, residual: Floats) -> float:
    """Return -2 log likelihood at the likeliest level."""
    rows = chain.rows(residual[:, None])[:, 0]
    return float(rows.size * np.log(np.mean(rows**2)) - 2 * np.log(chain.scale).sum())


def _smallest(misfit: Callable[[float], float], tried: Floats, limits: tuple[float, ...]) -> float:
    """Return the minimum of a misfit: the best of a grid, refined."""
    values = [misfit(float(x)) for x in tried]
    k = int(np.argmin(values))
    bounds = (tried[k - 1] if k else limits[0], tried[k + 1] if k + 1 < tried.size else limits[-1])
    return float(optimize.minimize_scalar(misfit, bounds=bounds, method="bounded", options={"xatol": 1e-9}).x)
