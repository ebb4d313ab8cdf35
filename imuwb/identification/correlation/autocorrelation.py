"""Autocorrelation of a record, and whether a first-order Gauss-Markov process explains it (Quinchia, 4.1 and 5.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft, optimize

from imuwb.identification.likelihood.cosine_spectrum import CosineSpectrum, cosine_spectrum
from imuwb.statistics.distributions import chi_square_tail, normal_limit
from imuwb.stochastic import GaussMarkov

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

TENABLE = 0.01  #: probability of a misfit as large; below it, first order does not explain the record
GROUP = 2**0.5  #: last frequency over first, of what is judged together
FEWEST = 32  #: coefficients that are judged together, the lowest
SHORTEST = 1e-5  #: sampling intervals; a process of such a Tc is white
UNKNOWN = 30.0  #: of a logarithm; wider intervals say nothing
LONG = 1_000_000  #: samples, from which on the transform is of half the length of numbers
SHOWN = 2000  #: lags that are kept


@dataclass(frozen=True, slots=True)
class GaussMarkovFit:
    """The first-order Gauss-Markov process that makes a record likeliest, and whether it explains it."""

    sigma: float  #: unit
    sigma_interval: tuple[float, float]
    Tc: float  #: s
    Tc_interval: tuple[float, float]
    tenable: bool
    misfit: float  #: chi-square of the spectrum over its degrees of freedom
    probability: float  #: of a misfit as large by chance

    def process(self) -> GaussMarkov:
        """Return the process."""
        return GaussMarkov(self.sigma, self.Tc)


@dataclass(frozen=True, eq=False, slots=True)
class Autocorrelation:
    """The normalised autocorrelation of a record."""

    lag: Floats  #: (k,) s, the first 0
    value: Floats  #: (k,)
    band: float  #: +-, within which white noise stays at a lag, with probability ``level``
    level: float
    variance: float  #: unit²
    falls_to: float | None  #: s, where it first is below 1/e; the papers' reading of Tc
    gauss_markov: GaussMarkovFit | None


def autocorrelation(values: Floats, dt: float, longest: float | None = None, *, level: float = 0.95) -> Autocorrelation:
    """Return the autocorrelation, the mean taken off, by fast Fourier transform.

    r(k) = sum x(i) x(i+k) / sum x(i)²: the biased estimate, which is a correlation at every lag.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        longest: lag in s; None: a tenth of the record. Of many lags 2,000 are kept, denser near 0.
        level: of the band and of the intervals.

    Raises:
        ValueError: a constant channel, or fewer than 16 samples.
    """
    n = values.size
    if n < 16 or np.ptp(values) == 0:  # noqa: PLR2004 - fewer have no shape
        message = f"{n} samples, {'all alike' if n else 'none'}: there is no autocorrelation; it takes 16 that vary"
        raise ValueError(message)
    centered = values - values.mean()
    most = min(max(round((n * dt / 10 if longest is None else longest) / dt), 1), n - 1)
    size = fft.next_fast_len(n + most, real=True)
    variance = float(np.mean(np.square(centered)))
    # Of a long record half the digits do, to a part in a million: chance alone makes a thousandth.
    digits = np.float32 if n > LONG else np.float64
    power = np.abs(fft.rfft((centered / variance**0.5).astype(digits), size))
    np.square(power, out=power)
    covariance = fft.irfft(power, size)[: most + 1].astype(np.float64)
    every = covariance / covariance[0]
    below = np.flatnonzero(every < np.exp(-1))
    falls_to = None
    if below.size:
        k = int(below[0])
        falls_to = float((k - (np.exp(-1) - every[k]) / (every[k - 1] - every[k])) * dt)
    kept = np.arange(most + 1)
    if most > SHOWN:
        kept = np.unique(
            np.rint(np.concatenate([np.arange(SHOWN // 4), np.geomspace(SHOWN // 4, most, SHOWN)])).astype(np.int64)
        )
    band = normal_limit(level) / n**0.5
    try:
        fitted = fit_gauss_markov(cosine_spectrum(centered, dt), level)
    except ValueError:
        fitted = None
    return Autocorrelation(kept.astype(np.float64) * dt, every[kept], band, level, variance, falls_to, fitted)


def fit_gauss_markov(spectrum: CosineSpectrum, level: float = 0.95) -> GaussMarkovFit:
    """Return the likeliest first-order Gauss-Markov process, found in the spectrum of the whole record.

    The likelihood weighs every frequency by what it tells; an exponential laid through the first lags of a
    correlation, whose errors hang together, does not. White noise is such a process of a Tc far below dt.
    """
    index: Floats = np.concatenate([spectrum.index.astype(np.float64), (spectrum.first + spectrum.last) / 2])
    power = np.concatenate([(spectrum.low + spectrum.ramp * spectrum.trend()) ** 2, spectrum.power])
    count = np.concatenate([np.ones(spectrum.low.size), spectrum.count])
    f = index / (2 * spectrum.n * spectrum.dt)

    def density(log_time: float) -> Floats:
        return GaussMarkov(1.0, float(np.exp(log_time))).power_spectral_density(f, spectrum.dt).clip(1e-300)

    def deviance(log_time: float) -> float:
        shape = density(log_time)
        scale = float(count @ (power / shape)) / count.sum()  # the likeliest sigma² for this Tc
        return float(count @ np.log(shape)) + count.sum() * float(np.log(scale))

    ends = float(np.log(spectrum.dt * SHORTEST)), float(np.log(spectrum.n * spectrum.dt * 10))
    grid = np.linspace(*ends, 80)
    best = int(np.argmin([deviance(t) for t in grid]))
    around = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
    at = float(optimize.minimize_scalar(deviance, bounds=around, method="bounded", options={"xatol": 1e-9}).x)
    shape = density(at)
    square = float(count @ (power / shape)) / count.sum()
    # Information of (log sigma², log Tc): half the count-weighted products of the density's relative slopes.
    step = 1e-4
    slope = (np.log(density(at + step)) - np.log(density(at - step))) / (2 * step)
    slopes = np.stack([np.ones(f.size), slope])
    inverse = np.linalg.pinv((slopes * count) @ slopes.T / 2)
    z = normal_limit(level)
    # Far beyond the record's length a correlation time is not known at all.
    half_square, half_time = (z * np.sqrt(np.diag(inverse))).clip(0, UNKNOWN)
    group = (np.log(f[-1] / f) / np.log(GROUP)).astype(np.int64)
    # The lowest frequencies are too few for the law of large numbers: they are one group.
    few = np.cumsum(count) < FEWEST
    group[few] = group[few].min(initial=int(group.max()))
    total = np.bincount(group, count)
    excess = np.bincount(group, count * (power / (shape * square) - 1))
    filled = total > 0
    chi2 = float(np.sum(excess[filled] ** 2 / (2 * total[filled])))
    freedom = max(int(filled.sum()) - 2, 1)
    probability = float(chi_square_tail(chi2, freedom))
    sigma, tc = square**0.5, float(np.exp(at))
    return GaussMarkovFit(
        sigma, (sigma * float(np.exp(-half_square / 2)), sigma * float(np.exp(half_square / 2))),
        tc, (tc * float(np.exp(-half_time)), tc * float(np.exp(half_time))),
        probability > TENABLE, chi2 / freedom, probability,
    )  # fmt: skip
