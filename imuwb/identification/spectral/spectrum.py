"""Power spectral density by Welch's method with frequency averaging, and the sum Q, N, B, K fitted to it.

Quinchia, 4.3 and 5.4; IEEE 1293, annex I. A Welch estimate is one-sided: twice IEEE's N², B²/(2 pi f) and
K²/(2 pi f)², which are two-sided.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from imuwb.arrays import Floats
from imuwb.identification.likelihood.fit import GROUP, TERMS, explained, profiled
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.identification.region import SHARE, Region
from imuwb.identification.spectral.lines import Line
from imuwb.identification.spectral.welch import independent, welch
from imuwb.identification.sum_fit import SumFit, widening
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import chi_square_limits, chi_square_tail, normal_limit
from imuwb.stochastic import Process, Sum
from imuwb.texts import number_text

LONGEST = 1 << 20  #: samples of a segment (Quinchia, 5.4)
WIDTH = 1.08  #: ratio of the last frequency to the first in an averaged band
FIRST = 3  #: lowest bins, in which the window spreads the drift
FEWEST_BANDS = 8  #: least number of bands in a fit; four terms need more than four
LINE_BINS = 6  #: bins of the line search that are left out on both sides of a line
NOMINAL = dict(zip(TERMS, (2.0, 0.0, -1.0, -2.0), strict=True))  #: slope of the density of each pure process


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class PowerSpectrum:
    """A one-sided density (unit²/Hz) in frequency bands, with its intervals."""

    n: int  #: samples
    dt: float  #: s
    segment: int  #: samples
    level: float
    frequency: Floats  #: (k,) Hz
    density: Floats  #: (k,)
    lower: Floats  #: (k,)
    upper: Floats  #: (k,)
    degrees_of_freedom: Floats  #: (k,)
    raw: Floats  #: (segment // 2 + 1,) density at i/(segment dt), averaged over segments only (Quinchia, figures 12a and 14a)
    sides: int = 1

    @property
    def raw_frequency(self) -> Floats:
        """Return the frequencies of the density before frequency averaging, Hz."""
        return np.arange(self.raw.size) / (self.segment * self.dt)

    def __repr__(self) -> str:
        """Return the range of frequencies and the segments."""
        return (
            f"one-sided spectrum of {self.n} samples at {1 / self.dt:.6g} Hz: {self.frequency.size} bands from "
            f"{number_text(float(self.frequency[0]))} to {number_text(float(self.frequency[-1]))} Hz, segments of "
            f"{self.segment} samples, {100 * self.level:g} % intervals"
        )


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class SpectralFit(SumFit):
    """A sum of processes fitted to a spectrum."""

    regions: tuple[Region, ...]
    highest: float  #: Hz; the sum explains the spectrum up to this frequency

    def density(self, frequency: Floats, dt: float) -> Floats:
        """Return the fitted sum's one-sided density."""
        return 2 * self.processes.power_spectral_density(frequency, dt)

    def __repr__(self) -> str:
        """Return the coefficients and how well they explain the spectrum."""
        return self.text(f"spectral fit up to {number_text(self.highest)} Hz")


def power_spectrum(values: Floats, dt: float, segment: int = LONGEST, *, level: float = 0.95) -> PowerSpectrum:
    """Return the one-sided density, averaged over segments and over bands of frequency.

    Segments have Hann windows and overlap by half; a straight line is taken off each.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        segment: longest segment (samples); a shorter record is one segment.
        level: confidence level of the intervals.

    Raises:
        ValueError: fewer than 64 samples.
    """
    n = values.size
    size = min(segment, n)
    if size < 64:  # noqa: PLR2004 - fewer samples give no useful spectrum
        raise ValueError(
            f"the segment has {size} samples; a spectrum needs at least 64: record for longer, or take longer segments"
        )
    total, count = welch(values, dt, size)
    edges = np.unique(np.rint(np.geomspace(FIRST, total.size - 1, max(round(np.log((total.size - 1) / FIRST) / np.log(WIDTH)), 1) + 1)).astype(np.int64))  # fmt: skip
    width = np.diff(edges).astype(np.float64)
    density = np.add.reduceat(total[: edges[-1]], edges[:-1]) / width
    frequency = np.add.reduceat(np.arange(edges[-1], dtype=np.float64), edges[:-1]) / width / (size * dt)
    freedom = 2 * np.array([independent(count, w) for w in width])
    lower, upper = (density * factor for factor in chi_square_limits(level, freedom))
    return PowerSpectrum(n, dt, size, level, frequency, density, lower, upper, freedom, total)


def fit_spectrum(spectrum: PowerSpectrum, lines: Sequence[Line] = (), highest: float = float("inf")) -> SpectralFit:
    """Return the sum of quantization, white, flicker and random-walk noise that fits a spectrum by Whittle's likelihood.

    Args:
        spectrum: from ``power_spectrum``.
        lines: sinusoids; bands that contain a line are left out.
        highest: Hz; bands above are left out, such as those that a filter has changed.

    Raises:
        ValueError: a density of 0 (a constant channel), or fewer than 8 bands.
    """
    kept = spectrum.frequency <= highest
    edge = WIDTH**0.5
    for line in lines:
        reach = LINE_BINS * line.resolution
        kept &= (spectrum.frequency * edge < line.frequency - reach) | (
            spectrum.frequency / edge > line.frequency + reach
        )
    if kept.sum() < FEWEST_BANDS or not spectrum.density[kept].all():
        raise ValueError(
            f"{kept.sum()} bands of frequency are left, and {np.count_nonzero(spectrum.density[kept] == 0)} of them have a "
            f"density of 0; a fit needs at least {FEWEST_BANDS} bands, none of 0: record for longer, or check the channel"
        )
    f = spectrum.frequency[kept]
    none = np.zeros(0)
    problem = LikelihoodProblem(
        none, none, np.zeros((len(TERMS), 0, 0)), f, spectrum.density[kept] / 2, spectrum.degrees_of_freedom[kept],
        np.stack([make(1.0).power_spectral_density(f, spectrum.dt) for make in TERMS.values()], axis=1), 0.0,
        np.zeros(2, dtype=np.int64),
    )  # fmt: skip
    problem, misfit, freedom = explained(problem)
    probability = float(chi_square_tail(misfit, freedom))
    best = problem.solve(range(len(TERMS)), ramp=False)
    inflation = widening(misfit / freedom, probability)
    coefficients = profiled(problem, best, spectrum.level, ramped=False, inflation=inflation)
    terms: list[Process] = [TERMS[x](c.value) for x in TERMS if (c := coefficients[x]).value]
    regions = _regions(problem, best.squared, spectrum.level, inflation)
    return SpectralFit(
        spectrum.level, coefficients, Sum(tuple(terms)), misfit / freedom, probability, regions, float(problem.frequency[-1])
    )  # fmt: skip


def _regions(problem: LikelihoodProblem, squared: Floats, level: float, inflation: float) -> tuple[Region, ...]:
    """Return the frequencies that each term dominates, and the slope of a free line there."""
    parts = problem.design * squared
    share = parts / parts.sum(axis=1, keepdims=True)
    regions: list[Region] = []
    for t, (letter, nominal) in enumerate(NOMINAL.items()):
        inside = share[:, t] > SHARE
        if inside.sum() < 3:  # noqa: PLR2004 - a slope needs three points
            continue
        f, power, count = problem.frequency[inside], problem.power[inside], problem.count[inside]
        if f[-1] < GROUP * f[0]:
            continue
        # The expectation of the log of a chi-square mean is not the log of the mean.
        y = np.log(power) - (special.digamma(count / 2) - np.log(count / 2))
        # Near half the rate a sampled process is no power law, so the slope is relative to the process's own density.
        y = y - np.log(parts[inside, t]) + nominal * np.log(f)
        design = np.stack([np.ones(f.size), np.log(f)], axis=1)
        weighted = design * (count / 2)[:, None]
        inverse = np.linalg.inv(design.T @ weighted)
        slope = float((inverse @ weighted.T @ y)[1])
        sigma = float(np.sqrt(inverse[1, 1] * inflation))
        half = normal_limit(level) * sigma
        estimate = Estimate(slope, slope - half, slope + half, sigma)
        regions.append(Region(letter, float(f[0]), float(f[-1]), estimate, nominal))
    return tuple(regions)
