"""The sum Q, N, B, K from the variance of wavelet coefficients, scale by scale (GMWM).

S. Guerrier and others (2013), "Wavelet-variance-based estimation for composite stochastic processes". Daubechies' wavelet of
four taps does not see a straight line, so a ramp has no effect. Haar's wavelet gives half the Allan variance, so it would repeat
the Allan fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import fft, linalg, optimize, special

from imuwb.arrays import Floats, Integers, alone
from imuwb.compiled import compiled
from imuwb.identification.allan_variance.problem import scaled_inverse
from imuwb.identification.coefficient import READ_OUT, interval
from imuwb.identification.likelihood.fit import TERMS
from imuwb.identification.spectral.lines import Line
from imuwb.identification.sum_fit import ACCEPTED, SumFit, widening
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import chi_square_tail, normal_quantile
from imuwb.stochastic import Process, Sum
from imuwb.texts import number_text

_R3 = 3**0.5
#: taps of the maximal-overlap transform, scaled to a gain of 1 at frequency 0
SMOOTH = np.array([1 + _R3, 3 + _R3, 3 - _R3, 1 - _R3]) / 8
DETAIL = SMOOTH[::-1] * np.array([1.0, -1.0, 1.0, -1.0])
OVERSAMPLED = 8  #: coefficients kept in the duration of a wavelet; more would add no information
FEWEST = 4  #: least number of independent coefficients of a scale
FEWEST_SAMPLES = 64  #: least number of samples, which give four scales
SELF_SIMILAR = 9  #: level from which the wavelet variance of flicker no longer changes
GRID = 48  #: frequencies per octave
ROUNDS = 8  #: repetitions of a fit, each with the covariance of the one before
LEAST = 1e-12  #: floor of the variances in the weights, as a share of the largest variance
MUCH = 15.0  #: reduction of chi-square that justifies leaving out another scale


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class WaveletVariance:
    """Mean squares (unit²) of a record's wavelet coefficients."""

    n: int  #: samples
    dt: float  #: s
    scale: Floats  #: (j,) s, 2^j dt for level j = 1, 2, ...
    variance: Floats  #: (j,)
    terms: Integers  #: (j,) number of coefficients before any are thinned out

    def __repr__(self) -> str:
        """Return the range of scales."""
        return (
            f"wavelet variances of {self.n} samples at {1 / self.dt:.6g} Hz: {self.scale.size} scales from "
            f"{number_text(float(self.scale[0]))} to {number_text(float(self.scale[-1]))} s"
        )


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class WaveletFit(SumFit):
    """A sum of processes fitted to wavelet variances."""

    shortest: float  #: s; the sum explains the variances from this scale up

    def __repr__(self) -> str:
        """Return the coefficients and how well they explain the variances."""
        return self.text(f"wavelet-variance fit from {number_text(self.shortest)} s")


def wavelet_variance(values: Floats, dt: float) -> WaveletVariance:
    """Return the wavelet variances of an evenly spaced record without gaps, without the coefficients at its ends.

    Args:
        values: (n,) samples.
        dt: s.

    Raises:
        ValueError: fewer than 64 samples.
    """
    if values.size < FEWEST_SAMPLES:
        raise ValueError(
            f"{values.size} samples are too few for wavelet variances; they need at least {FEWEST_SAMPLES}"
        )
    with alone(values.size):
        variances, terms = _variances(values - values.mean())
    levels = np.arange(1.0, len(variances) + 1)
    return WaveletVariance(values.size, dt, 2.0**levels * dt, np.array(variances), np.array(terms))


def _variances(smooth: Floats) -> tuple[list[float], list[int]]:
    """Return the mean square of the details at each level, and their number; the series is overwritten."""
    size = smooth.size
    variances: list[float] = []
    terms: list[int] = []
    stride, level = 1, 1
    while True:
        step = 2 ** (level - 1) // stride
        left = size - (2**level - 1) * 3
        if left < FEWEST * 2**level:
            break
        power = _level(smooth, step, SMOOTH, DETAIL)
        smooth = smooth[: smooth.size - 3 * step]
        variances.append(power)
        terms.append(left)
        level += 1
        if 2 ** (level - 1) // stride > OVERSAMPLED // 2:
            smooth, stride = smooth[::2].copy(), 2 * stride
    return variances, terms


@compiled(reorder=True)
def _level(values: Floats, step: int, smooth: Floats, detail: Floats) -> float:  # pragma: no cover - compiled
    """Smooth a series in place, which leaves three steps at its end unchanged, and return the mean square of the details."""
    count = values.size - 3 * step
    power = 0.0
    for i in range(count):
        a, b, c, d = values[i], values[i + step], values[i + 2 * step], values[i + 3 * step]
        values[i] = smooth[3] * a + smooth[2] * b + smooth[1] * c + smooth[0] * d
        w = detail[3] * a + detail[2] * b + detail[1] * c + detail[0] * d
        power += w * w
    return power / count


@lru_cache(maxsize=4)
def _expectations(levels: int) -> Floats:
    """Return the wavelet variances of Q, N, B and K of size 1 in units of dt, (levels, 4), from the taps of the filters."""
    variance = np.zeros((levels, 4))
    smooth = np.ones(1)
    for j in range(levels):
        wavelet = spread_convolve(smooth, DETAIL, 2**j)
        walk = np.cumsum(wavelet)
        variance[j, 0] = float(np.sum(np.diff(wavelet, prepend=0.0, append=0.0) ** 2))
        variance[j, 1] = float(wavelet @ wavelet)
        # The increments of an averaged walk have variance 2/3 and covariance 1/6.
        variance[j, 3] = float(2 / 3 * walk @ walk + 1 / 3 * walk[1:] @ walk[:-1])
        variance[j, 2] = _flicker(wavelet) if j < SELF_SIMILAR else variance[j - 1, 2]
        smooth = spread_convolve(smooth, SMOOTH, 2**j)
    return variance


def spread_convolve(series: Floats, taps: Floats, step: int) -> Floats:
    """Return the convolution with taps at a spacing of ``step`` samples."""
    out = np.zeros(series.size + (taps.size - 1) * step)
    for k, tap in enumerate(taps):
        out[k * step : k * step + series.size] += tap * series
    return out


def _flicker(wavelet: Floats) -> float:
    """Return the variance of averaged flicker of B = 1 after a filter that removes constants."""
    size = fft.next_fast_len(2 * wavelet.size, real=True)
    correlation = fft.irfft(np.abs(fft.rfft(wavelet, size)) ** 2, size)[: wavelet.size]
    lag = np.arange(wavelet.size, dtype=np.float64)
    covariance = -(
        special.xlogy((lag + 1) ** 2, lag + 1)
        + special.xlogy((lag - 1) ** 2, np.abs(lag - 1))
        - 2 * special.xlogy(lag**2, lag)
    ) / (2 * np.pi)
    return float(correlation[0] * covariance[0] + 2 * correlation[1:] @ covariance[1:])


@lru_cache(maxsize=4)
def _responses(levels: int) -> tuple[Floats, Floats, Floats]:
    """Return frequencies and widths, over the sampling rate, and each level's squared gain there, (levels, k)."""
    edges = np.geomspace(2.0 ** -(levels + 4), 0.5, (levels + 3) * GRID + 1)
    f = np.sqrt(edges[1:] * edges[:-1])
    return f, np.diff(edges), _gains(f, levels)


def _gains(f: Floats, levels: int) -> Floats:
    """Return each level's squared gain, (levels, k), at frequencies over the sampling rate."""
    smooth = np.ones(f.size)
    rows: list[Floats] = []
    for j in range(levels):
        c, s = np.cos(np.pi * f * 2**j) ** 2, np.sin(np.pi * f * 2**j) ** 2
        rows.append(smooth * s**2 * (1 + 2 * c))
        smooth = smooth * c**2 * (1 + 2 * s)
    return np.array(rows)


def fit_wavelet_variance(variances: WaveletVariance, lines: Sequence[Line] = (), *, level: float = 0.95) -> WaveletFit:
    """Return the sum of quantization, white, flicker and random-walk noise that fits by generalised least squares.

    Args:
        variances: from ``wavelet_variance``.
        lines: sinusoids found in the spectrum; their frequencies and amplitudes are held.
        level: confidence level of the intervals.

    Raises:
        ValueError: fewer than six scales, or a variance of 0 (a constant channel).
    """
    levels = variances.scale.size
    if levels <= len(TERMS) + 1 or not variances.variance.all():
        raise ValueError(
            f"{levels} scales{'' if variances.variance.all() else ', one with a variance of 0'}; a fit needs at least {len(TERMS) + 2} "
            "scales, none of 0: record for longer, or check the channel"
        )
    whole = _Scales.of(variances, lines)
    fits = [whole.fit()]
    # A sensor's own filter changes the shortest scales. They are left out until the sum explains the rest, if that helps enough.
    for first in range(1, levels - len(TERMS) - 1):
        if fits[-1].probability > ACCEPTED:
            break
        fits.append(whole.since(first).fit())
    gains = [fits[0].chi2 - fit.chi2 - MUCH * (first + 1) * (first > 0) for first, fit in enumerate(fits)]
    first = int(np.argmax(gains))
    fit, scales = fits[first], whole.since(first)
    misfit = fit.chi2 / fit.freedom
    spread = scales.covariance(fit.squared) * widening(misfit, fit.probability)
    coefficients = _coefficients(scales.variance, scales.design, fit.squared, spread, level)
    terms: list[Process] = [TERMS[x](c.value) for x in TERMS if (c := coefficients[x]).value]
    return WaveletFit(level, coefficients, Sum(tuple(terms)), misfit, fit.probability, float(variances.scale[first]))


@dataclass(frozen=True, eq=False, slots=True)
class _Fit:
    squared: Floats  #: (4,)
    chi2: float
    freedom: int
    probability: float


@dataclass(frozen=True, eq=False, slots=True)
class _Scales:
    """Wavelet variances to be explained, with what their covariance follows from."""

    variance: Floats  #: (j,) without the part of the lines
    terms: Floats  #: (j,) number of coefficients
    of_lines: Floats  #: (j, j) covariance from the uncertainty of the lines' amplitudes
    design: Floats  #: (j, 4) variances of processes of size 1
    gains: Floats  #: (j, k) squared gain at each frequency
    width: Floats  #: (k,) width of each step of frequency, over the sampling rate
    parts: Floats  #: (k, 4) densities of processes of size 1

    @staticmethod
    def of(variances: WaveletVariance, lines: Sequence[Line]) -> _Scales:
        dt, levels = variances.dt, variances.scale.size
        variance, of_lines = variances.variance.copy(), np.zeros((levels, levels))
        for line in lines:
            part = line.amplitude.value**2 / 2 * _gains(np.array([line.frequency * dt]), levels)[:, 0]
            variance -= part
            of_lines += np.outer(part, part) * (line.power_sigma / line.amplitude.value**2) ** 2
        f, width, gains = _responses(levels)
        parts = np.stack([make(1.0).power_spectral_density(f / dt, dt) / dt for make in TERMS.values()], axis=1)
        design = _expectations(levels) * np.array([1 / dt**2, 1 / dt, 1.0, dt])
        return _Scales(variance, variances.terms.astype(np.float64), of_lines, design, gains, width, parts)

    def since(self, first: int) -> _Scales:
        """Return the problem without its ``first`` shortest scales."""
        rest = slice(first, None)
        return _Scales(
            self.variance[rest], self.terms[rest], self.of_lines[rest, rest], self.design[rest], self.gains[rest], self.width, self.parts
        )  # fmt: skip

    def covariance(self, squared: Floats) -> Floats:
        """Return the covariance of the variances if these squares are true: the integral of twice the product of spectra."""
        seen = self.gains * (self.parts @ squared)
        # The factor is 4, not 2, because the grid has no negative frequencies.
        return 4 * (seen * self.width) @ seen.T / np.minimum.outer(self.terms, self.terms) + self.of_lines

    def fit(self) -> _Fit:
        """Return the non-negative squares; the covariance is taken from the fit, and the fit is repeated."""
        weight = 1 / np.abs(self.variance).clip(float(np.abs(self.variance).max()) * LEAST)
        columns = self.design * weight[:, None]
        size = np.linalg.norm(columns, axis=0)
        squared = optimize.nnls(columns / size, self.variance * weight)[0] / size
        for _ in range(ROUNDS):
            root = linalg.cholesky(self.covariance(squared), lower=True)
            white = linalg.solve_triangular(root, self.design, lower=True)
            size = np.linalg.norm(white, axis=0)
            squared = optimize.nnls(white / size, linalg.solve_triangular(root, self.variance, lower=True))[0] / size
        residual = self.variance - self.design @ squared
        root = linalg.cholesky(self.covariance(squared), lower=True)
        chi2 = float(np.sum(linalg.solve_triangular(root, residual, lower=True) ** 2))
        freedom = max(residual.size - int(np.count_nonzero(squared)), 1)
        return _Fit(squared, chi2, freedom, float(chi_square_tail(chi2, freedom)))


def _coefficients(
    variance: Floats, design: Floats, squared: Floats, spread: Floats, level: float
) -> dict[str, Coefficient]:
    """Return intervals by a scaled chi-square, or one-sided limits where a term is 0."""
    root = linalg.cholesky(spread, lower=True)
    white = linalg.solve_triangular(root, design, lower=True)
    data = linalg.solve_triangular(root, variance, lower=True)
    active = np.flatnonzero(squared > 0)
    coefficients: dict[str, Coefficient] = {}
    for t, letter in enumerate(TERMS):
        columns = white[:, np.union1d(active, [t])]
        place = int(np.flatnonzero(np.union1d(active, [t]) == t)[0])
        inverse = scaled_inverse(columns.T @ columns)
        sigma = float(inverse[place, place]) ** 0.5
        if squared[t] > 0:
            ends = interval(float(squared[t]), sigma, level)
            coefficients[letter] = Coefficient(float(squared[t]) ** 0.5, *ends, at=READ_OUT[letter])
            continue
        free = float((inverse @ columns.T @ data)[place])
        limit = max(free, 0.0) + normal_quantile(level) * sigma
        coefficients[letter] = Coefficient(None, None, limit**0.5, at=READ_OUT[letter])
    return coefficients
