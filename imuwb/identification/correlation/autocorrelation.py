"""Autocorrelation of a record, and whether a first-order Gauss-Markov process explains it (Quinchia, 4.1 and 5.2)."""

from dataclasses import dataclass

import numpy as np
from scipy import fft, optimize

from imuwb.arrays import Complexes, Floats, alone, standard_deviation
from imuwb.compiled import compiled
from imuwb.identification.likelihood.cosine_spectrum import CosineSpectrum, cosine_spectrum
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import chi_square_tail, normal_limit
from imuwb.stochastic import GaussMarkov
from imuwb.texts import number_text

TENABLE = 0.01  #: probability of the misfit, below which a first-order process does not explain the record
GROUP = 2**0.5  #: ratio of the last frequency to the first in a group that is tested as one
FEWEST = 32  #: number of the lowest coefficients, which are one group
FEWEST_SAMPLES = 16
SHORTEST = 1e-5  #: sampling intervals; a process with so short a Tc is white noise
WIDEST = 30.0  #: half width of the interval of a logarithm; wider ones are cut here
SHORTEST_PIECE = 1 << 14  #: samples that are transformed at once, at least
SHOWN = 2000  #: number of lags that are kept, approximately
VAGUE = 100.0  #: ratio of the ends of Tc's interval, above which the record does not show Tc


@dataclass(frozen=True, slots=True, repr=False)
class GaussMarkovFit:
    """The first-order Gauss-Markov process that makes a record likeliest, and whether it explains the record."""

    sigma: Estimate
    Tc: Estimate  #: s
    tenable: bool  #: the process alone explains the record
    misfit: float  #: chi-square of the spectrum over its degrees of freedom
    probability: float  #: probability that chance makes so large a misfit

    def process(self) -> GaussMarkov:
        """Return the process."""
        return GaussMarkov(self.sigma.value, self.Tc.value)

    @property
    def vague(self) -> bool:
        """Return whether the record does not show Tc: its interval spans more than a factor of 100."""
        return self.Tc.upper > VAGUE * self.Tc.lower

    def __repr__(self) -> str:
        """Return sigma, Tc, and whether the process alone explains the record."""
        verdict = "explains" if self.tenable else "does not explain"
        return f"Gauss-Markov sigma {self.sigma}, Tc {self.Tc}: this process alone {verdict} the record (p = {self.probability:.2g})"


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Autocorrelation:
    """The normalised autocorrelation of a record."""

    lag: Floats  #: (k,) s, the first 0
    value: Floats  #: (k,)
    band: float  #: at each lag, white noise stays within +-band with probability ``level``
    level: float
    variance: float  #: unit²
    falls_to: float | None  #: s, lag at which the correlation first falls to 1/e, which papers read as Tc
    gauss_markov: GaussMarkovFit | None  #: None: the record is too short for a fit

    def __repr__(self) -> str:
        """Return the lags, where the correlation falls to 1/e, and the Gauss-Markov process."""
        falls = "stays above 1/e" if self.falls_to is None else f"falls to 1/e at {number_text(self.falls_to)} s"
        fit = "" if self.gauss_markov is None else f"; {self.gauss_markov}"
        return f"autocorrelation to a lag of {number_text(float(self.lag[-1]))} s: {falls}{fit}"


def autocorrelation(values: Floats, dt: float, longest: float | None = None, *, level: float = 0.95) -> Autocorrelation:
    """Return the autocorrelation of a record less its mean, by fast Fourier transform.

    r(k) = sum x(i) x(i+k) / sum x(i)²: the biased estimate, which stays within +-1 at every lag.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        longest: s, longest lag; None: a tenth of the record. Of many lags about 2,000 are kept, more densely near 0.
        level: level of the band and of the intervals.

    Raises:
        ValueError: a constant channel, or fewer than 16 samples.
    """
    n = values.size
    if n < FEWEST_SAMPLES or np.ptp(values) == 0:
        raise ValueError(
            f"{n} samples{' that are all equal' if n else ''}: no autocorrelation; it needs at least {FEWEST_SAMPLES} that vary"
        )
    mean = float(values.mean())
    most = min(max(round((n * dt / 10 if longest is None else longest) / dt), 1), n - 1)
    sigma = standard_deviation(values)
    with alone(n):
        every = _covariance(values, mean, sigma, most)
        every /= every[0]
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
        fitted = fit_gauss_markov(cosine_spectrum(values, dt), level)
    except ValueError:
        fitted = None
    return Autocorrelation(kept.astype(np.float64) * dt, every[kept], band, level, sigma**2, falls_to, fitted)


def _covariance(values: Floats, mean: float, sigma: float, most: int) -> Floats:
    """Return the sums of products of samples less their mean, over sigma², at the lags 0 ... ``most``.

    The transform of a piece is multiplied with that of this piece and the next one, so memory is that of the longest lag. A series
    that begins half a transform later has the same transform, but for the sign of every second frequency.
    """
    piece = fft.next_fast_len(max(most, min(values.size, SHORTEST_PIECE)))
    total, padded = np.zeros(piece + 1, np.complex128), np.zeros(2 * piece)
    later = np.empty(0, np.complex128)
    # Piece by piece from the end: what follows a piece is known then.
    for first in reversed(range(0, values.size, piece)):
        part = values[first : first + piece]
        np.subtract(part, mean, out=padded[: part.size])
        padded[: part.size] /= sigma
        padded[part.size : piece] = 0.0
        own = np.fft.rfft(padded)  # numpy frees the tables of a transform, while scipy keeps them
        _add_products(own, later, total)
        later = own
    return np.fft.irfft(total, 2 * piece)[: most + 1]


@compiled()
def _add_products(own: Complexes, later: Complexes, total: Complexes) -> None:  # pragma: no cover - compiled
    for k in range(own.size):
        both = own[k]
        if later.size:
            both += later[k] if k % 2 == 0 else -later[k]
        total[k] += own[k].conjugate() * both


def fit_gauss_markov(spectrum: CosineSpectrum, level: float = 0.95) -> GaussMarkovFit:
    """Return the first-order Gauss-Markov process that makes a record's cosine spectrum likeliest.

    The likelihood weighs each frequency by its information. An exponential through the first lags of the autocorrelation
    does not, because the errors of those lags are correlated. White noise is such a process with Tc far below dt.

    Args:
        spectrum: spectrum of the whole record.
        level: confidence level of the intervals.
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
    # A correlation time far longer than the record has no finite interval.
    half_square, half_time = (z * np.sqrt(np.diag(inverse))).clip(0, WIDEST)
    group = (np.log(f[-1] / f) / np.log(GROUP)).astype(np.int64)
    # The lowest frequencies are too few for the law of large numbers, so they are one group.
    lowest = np.cumsum(count) < FEWEST
    group[lowest] = group[lowest].min(initial=int(group.max()))
    total = np.bincount(group, count)
    excess = np.bincount(group, count * (power / (shape * square) - 1))
    filled = total > 0
    chi2 = float(np.sum(excess[filled] ** 2 / (2 * total[filled])))
    freedom = max(int(filled.sum()) - 2, 1)
    probability = float(chi_square_tail(chi2, freedom))
    sigma, tc = square**0.5, float(np.exp(at))
    return GaussMarkovFit(
        Estimate(sigma, sigma * float(np.exp(-half_square / 2)), sigma * float(np.exp(half_square / 2))),
        Estimate(tc, tc * float(np.exp(-half_time)), tc * float(np.exp(half_time)), unit="s"),
        probability > TENABLE, chi2 / freedom, probability,
    )  # fmt: skip
