"""Power spectral density by Welch's method with frequency averaging, and the sum Q, N, B, K fitted to it.

Quinchia, 4.3 and 5.4; IEEE 1293, annex I. A Welch estimate is one-sided: twice IEEE's N², B²/(2 pi f) and
K²/(2 pi f)², which are two-sided.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import special

from imuwb.identification.likelihood.fit import ACCEPTED, GROUP, TERMS, explained, profiled
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.identification.spectral.welch import independent, welch
from imuwb.statistics.distributions import chi_square_limits, chi_square_tail, normal_limit
from imuwb.stochastic import Sum

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.identification.spectral.lines import Line
    from imuwb.statistics import Coefficient
    from imuwb.stochastic import Process

    Floats = NDArray[np.float64]

LONGEST = 1 << 20  #: samples of a segment, as Quinchia's
WIDTH = 1.08  #: of an averaged band, last frequency over first
FIRST = 3  #: bins from 0 on that the window spreads the drift over
SHARE = 0.6  #: of the density; a term with more rules its region


@dataclass(frozen=True, eq=False, slots=True)
class PowerSpectrum:
    """A one-sided density in frequency bands, with its intervals. unit²/Hz."""

    n: int
    dt: float
    segment: int  #: samples
    level: float
    frequency: Floats  #: (k,) Hz
    density: Floats  #: (k,)
    lower: Floats  #: (k,)
    upper: Floats  #: (k,)
    degrees_of_freedom: Floats  #: (k,)
    sides: int = 1


@dataclass(frozen=True, slots=True)
class SpectralRegion:
    """Frequencies that one term rules, and the slope a free line has there."""

    letter: str
    start: float  #: Hz
    end: float  #: Hz
    slope: float
    lower: float
    upper: float
    nominal: float


@dataclass(frozen=True, eq=False, slots=True)
class SpectralFit:
    """The sum fitted to a spectrum."""

    level: float
    coefficients: dict[str, Coefficient]  #: Q, N, B, K
    processes: Sum
    regions: tuple[SpectralRegion, ...]
    highest: float  #: Hz, up to which the sum explains the spectrum
    misfit: float
    probability: float

    def density(self, frequency: Floats, dt: float) -> Floats:
        """Return the fitted sum's one-sided density."""
        return 2 * self.processes.power_spectral_density(frequency, dt)


def power_spectrum(values: Floats, dt: float, segment: int = LONGEST, *, level: float = 0.95) -> PowerSpectrum:
    """Return the one-sided density, averaged over segments and over bands of frequency.

    Hann windows, half overlapping; each segment's straight line is taken off.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        segment: samples of a segment at most; a shorter record is one segment.
        level: of the intervals.

    Raises:
        ValueError: fewer than 64 samples.
    """
    n = values.size
    size = min(segment, n)
    if size < 64:  # noqa: PLR2004 - fewer have no spectrum worth the name
        message = f"a segment of {size} samples; a spectrum needs at least 64"
        raise ValueError(message)
    total, count = welch(values, dt, size)
    edges = np.unique(np.rint(np.geomspace(FIRST, total.size - 1, max(round(np.log((total.size - 1) / FIRST) / np.log(WIDTH)), 1) + 1)).astype(np.int64))  # fmt: skip
    width = np.diff(edges).astype(np.float64)
    density = np.add.reduceat(total[: edges[-1]], edges[:-1]) / width
    frequency = np.add.reduceat(np.arange(edges[-1], dtype=np.float64), edges[:-1]) / width / (size * dt)
    freedom = 2 * np.array([independent(count, w) for w in width])
    lower, upper = (density * factor for factor in chi_square_limits(level, freedom))
    return PowerSpectrum(n, dt, size, level, frequency, density, lower, upper, freedom)


def fit_spectrum(spectrum: PowerSpectrum, lines: Sequence[Line] = (), highest: float = float("inf")) -> SpectralFit:
    """Fit the sum of quantization, white, flicker and random-walk noise to a spectrum, by Whittle's likelihood.

    Args:
        spectrum: from ``power_spectrum``.
        lines: sinusoids; bands that hold one are left out.
        highest: Hz; bands above are left out: a filter has changed them.

    Raises:
        ValueError: a density of 0 (a constant channel), or fewer than 8 bands.
    """
    kept = spectrum.frequency <= highest
    edge = WIDTH**0.5
    for line in lines:
        reach = 6 * line.resolution
        kept &= (spectrum.frequency * edge < line.frequency - reach) | (
            spectrum.frequency / edge > line.frequency + reach
        )
    if kept.sum() < 8 or not spectrum.density[kept].all():  # noqa: PLR2004 - four terms need more
        message = "the spectrum is 0 somewhere, or holds too few bands to fit"
        raise ValueError(message)
    f = spectrum.frequency[kept]
    none = np.zeros(0)
    problem = LikelihoodProblem(
        none, none, np.zeros((len(TERMS), 0, 0)), f, spectrum.density[kept] / 2, spectrum.degrees_of_freedom[kept],
        np.stack([make(1.0).power_spectral_density(f, spectrum.dt) for make in TERMS.values()], axis=1), 0.0,
    )  # fmt: skip
    problem, misfit, freedom = explained(problem)
    probability = float(chi_square_tail(misfit, freedom))
    best = problem.solve(range(len(TERMS)), ramp=False)
    inflation = max(misfit / freedom, 1.0) if probability < ACCEPTED else 1.0
    coefficients = profiled(problem, best, spectrum.level, ramped=False, inflation=inflation)
    terms: list[Process] = [TERMS[x](c.value) for x in TERMS if (c := coefficients[x]).value]
    regions = _regions(problem, best.squared, spectrum.level, inflation)
    return SpectralFit(
        spectrum.level,
        coefficients,
        Sum(tuple(terms)),
        regions,
        float(problem.frequency[-1]),
        misfit / freedom,
        probability,
    )


def _regions(problem: LikelihoodProblem, squared: Floats, level: float, inflation: float) -> tuple[SpectralRegion, ...]:
    """Return where each term makes most (60 %) of the density, and the slope of a free line there."""
    parts = problem.design * squared
    share = parts / parts.sum(axis=1, keepdims=True)
    z = normal_limit(level)
    found: list[SpectralRegion] = []
    for t, (letter, nominal) in enumerate(zip(TERMS, (2.0, 0.0, -1.0, -2.0), strict=True)):
        inside = share[:, t] > SHARE
        if inside.sum() < 3:  # noqa: PLR2004 - a slope needs points
            continue
        f, power, count = problem.frequency[inside], problem.power[inside], problem.count[inside]
        if f[-1] < GROUP * f[0]:
            continue
        # log of a chi-square mean: its expectation is not the log of the mean
        y = np.log(power) - (special.digamma(count / 2) - np.log(count / 2))
        # A sampled process is no power law near half the rate: the slope is its departure from its own density.
        y = y - np.log(parts[inside, t]) + nominal * np.log(f)
        design = np.stack([np.ones(f.size), np.log(f)], axis=1)
        weighted = design * (count / 2)[:, None]
        inverse = np.linalg.inv(design.T @ weighted)
        slope = float((inverse @ weighted.T @ y)[1])
        half = z * float(np.sqrt(inverse[1, 1] * inflation))
        found.append(SpectralRegion(letter, float(f[0]), float(f[-1]), slope, slope - half, slope + half, nominal))
    return tuple(found)
