"""The noise of one sensor axis at one temperature, from one record or several.

The coefficients are likelihood estimates (``likelihood.fit``) from all records at that temperature together. AR(1) is by Burg's
method with Bartlett's standard error. The slope is that of a free line fitted to the Allan curve where random walk dominates.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.allan_variance.overlapping import AllanDeviation, allan
from imuwb.identification.coefficient import interval
from imuwb.identification.likelihood.cosine_spectrum import CosineSpectrum
from imuwb.identification.likelihood.fit import (
    FEWEST_BINS,
    TERMS,
    LikelihoodFit,
    fit_problem,
    spectrum_without,
)
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.identification.region import Region
from imuwb.identification.spectral.lines import Line, find_lines
from imuwb.identification.sum_fit import widening
from imuwb.identification.temperature.bias import RecordMean
from imuwb.identification.temperature.first_order import FirstOrder, first_order_of
from imuwb.identification.temperature.record import Record, residuals
from imuwb.identification.temperature.thermal_trend import joined, lowest, restricted
from imuwb.identification.temperature.white_slope import white_slope
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import normal_limit
from imuwb.stochastic import RateRamp

LETTERS = tuple(TERMS)


@dataclass(frozen=True, eq=False, slots=True)
class SetPoint:
    """One axis at one temperature, in SI."""

    celsius: float  #: mean
    samples: int
    duration: float  #: s
    coefficients: dict[str, Coefficient]  #: Q, N, B, K
    fit: LikelihoodFit
    problem: LikelihoodProblem  #: likelihood problem up to the highest frequency that the sum explains
    ar1: FirstOrder
    deviation: Coefficient  #: standard deviation of the samples without a drift with time and temperature
    region: Region | None  #: averaging times at which random walk dominates, and the slope of a free line there
    curve: AllanDeviation
    means: tuple[RecordMean, ...]  #: mean of each record
    lines: tuple[Line, ...]  #: sinusoids that the fit leaves out
    absent: tuple[str, ...] = ()  #: coefficients that are known to be absent

    def __repr__(self) -> str:
        """Return the temperature and the coefficients, in one line."""
        sizes = ", ".join(f"{letter} {c}" for letter, c in self.coefficients.items())
        return f"{self.celsius:.4g} °C, {self.samples} samples: {sizes}, {self.ar1}"

    @property
    def ramped(self) -> bool:
        """Return whether the fit has a ramp, which is then part of the likelihood."""
        return any(isinstance(term, RateRamp) for term in self.fit.processes.terms)

    @property
    def squared(self) -> Floats:
        """Return Q², N², B² and K², (4,); 0 for a coefficient without a value."""
        return np.array([(self.coefficients[letter].value or 0.0) ** 2 for letter in LETTERS])

    @property
    def inflation(self) -> float:
        """Return the factor on variances if the sum does not explain the spectrum (Birge)."""
        return widening(self.fit.misfit, self.fit.probability)


def set_point_of(records: Sequence[Record], dt: float, *, level: float = 0.95, band: float = float("inf")) -> SetPoint:
    """Return the noise at one temperature.

    Args:
        records: records of one axis, all at that temperature.
        dt: s.
        level: confidence level of intervals and limits.
        band: Hz, up to which no filter has changed the spectrum.

    Raises:
        ValueError: a record of fewer than 1024 samples, a constant record, or too few frequencies below ``band``.
    """
    trends, rests = zip(*(residuals(record) for record in records), strict=True)
    longest = int(np.argmax([rest.size for rest in rests]))
    lines = tuple(line for line in find_lines(rests[longest], dt, level) if line.frequency <= band)
    # For one record at a constant temperature, the fit decides whether there is a ramp.
    steady = len(records) == 1 and trends[0].shape[1] == 1
    spectra = [spectrum_without(x, dt, lines) for x in ([records[0].values] if steady else rests)]
    problem = _problem(spectra, None if steady else trends, dt, band)
    fit = fit_problem(problem, level)
    whole = np.concatenate(rests)
    breaks = [int(b) for b in np.cumsum([rest.size for rest in rests])[:-1]]
    curve = allan(whole, dt, "octave", level=level, breaks=breaks, fast=True)
    return SetPoint(
        float(np.average([r.celsius for r in records], weights=[r.values.size for r in records])),
        whole.size,
        whole.size * dt,
        {letter: fit.coefficients[letter] for letter in LETTERS},
        fit,
        problem.below(fit.highest * (1 + 1e-12)),
        first_order_of(whole, dt, breaks),
        _deviation(whole, spectra, level),
        white_slope(curve, fit.identified, fit.coefficients, level),
        curve,
        tuple(_mean(record, dt) for record in records),
        lines,
    )


def _mean(record: Record, dt: float) -> RecordMean:
    duration = record.values.size * dt
    value = float(record.values.mean())
    return RecordMean(record.celsius, value, record.start + duration / 2, duration, record.rising, record.log)


def _problem(
    spectra: Sequence[CosineSpectrum], trends: Sequence[Floats] | None, dt: float, band: float
) -> LikelihoodProblem:
    kinds = [make(1.0) for make in TERMS.values()]
    parts = [LikelihoodProblem.of(spectrum, kinds).below(band) for spectrum in spectra]
    if min(part.power.size for part in parts) < FEWEST_BINS:
        raise ValueError(f"too few frequencies lie below {band:.3g} Hz, above which a filter changed the spectrum")
    if trends is None:
        return parts[0]
    return joined([
        restricted(part, spectrum, lowest(trend, dt)) for part, spectrum, trend in zip(parts, spectra, trends, strict=True)
    ])  # fmt: skip


def _deviation(values: Floats, spectra: Sequence[CosineSpectrum], level: float) -> Coefficient:
    """Return the samples' standard deviation; its interval comes from the powers of their nearly independent cosines."""
    square = float(np.einsum("i,i", values, values)) / values.size
    total = sum(float(s.power @ s.count + s.low @ s.low) for s in spectra)
    scatter = sum(float(2 * (s.power**2) @ s.count + 2 * (s.low**4).sum() / 3) for s in spectra) ** 0.5
    return Coefficient(square**0.5, *interval(square, square * scatter / total, level))


def log_sigma(coefficient: Coefficient, level: float) -> float | None:
    """Return the standard error of a coefficient's logarithm, from its interval; None if it has no value."""
    if coefficient.value is None:
        return None
    z = normal_limit(level)
    if coefficient.lower:
        return float(np.log(coefficient.upper / coefficient.lower)) / (2 * z)
    return float(np.log(coefficient.upper / coefficient.value)) / z
