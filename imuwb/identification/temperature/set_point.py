"""What the noise of one sensor axis is at one temperature, from one record or several.

The coefficients are those of the likelihood (``likelihood_fit``), of all records at that temperature together; AR(1) is Burg's
with Bartlett's standard error; the slope is that of a free line where random walk rules the Allan curve.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.identification.allan_variance.overlapping import allan
from imuwb.identification.coefficient import interval
from imuwb.identification.likelihood.fit import (
    ACCEPTED,
    FEWEST_BINS,
    TERMS,
    LikelihoodFit,
    fit_problem,
    spectrum_without,
)
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.identification.spectral.lines import find_lines
from imuwb.identification.temperature.bias import Mean
from imuwb.identification.temperature.first_order import first_order_of
from imuwb.identification.temperature.record import residuals
from imuwb.identification.temperature.thermal_trend import joined, lowest, restricted
from imuwb.identification.temperature.white_slope import white_slope
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import normal_limit
from imuwb.stochastic import RateRamp

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.identification.allan_variance.fit import Region
    from imuwb.identification.allan_variance.overlapping import AllanDeviation
    from imuwb.identification.likelihood.cosine_spectrum import CosineSpectrum
    from imuwb.identification.spectral.lines import Line
    from imuwb.identification.temperature.first_order import FirstOrder
    from imuwb.identification.temperature.record import Record

    Floats = NDArray[np.float64]

LETTERS = tuple(TERMS)


@dataclass(frozen=True, eq=False, slots=True)
class SetPoint:
    """One axis at one temperature. SI."""

    celsius: float  #: mean
    samples: int
    duration: float  #: s
    coefficients: dict[str, Coefficient]  #: Q, N, B, K
    fit: LikelihoodFit
    problem: LikelihoodProblem  #: up to the frequency that the sum explains
    first: FirstOrder
    deviation: Coefficient  #: standard deviation of the samples, a drift with time and temperature taken off
    region: Region | None  #: averaging times that random walk rules, and the slope of a free line there
    curve: AllanDeviation
    means: tuple[Mean, ...]  #: of each record
    lines: tuple[Line, ...]  #: sinusoids left out
    absent: tuple[str, ...] = ()  #: coefficients that were known to be absent

    @property
    def ramped(self) -> bool:
        """Whether a ramp was found, which is then part of the likelihood."""
        return any(isinstance(term, RateRamp) for term in self.fit.processes.terms)

    @property
    def inflation(self) -> float:
        """By how much a sum that does not explain the spectrum widens intervals (Birge)."""
        return max(self.fit.misfit, 1.0) if self.fit.probability < ACCEPTED else 1.0


def identify(records: Sequence[Record], dt: float, *, level: float = 0.95, band: float = float("inf")) -> SetPoint:
    """Return the noise at one temperature.

    Args:
        records: of one axis, each at that temperature.
        dt: s.
        level: of intervals and limits.
        band: Hz, up to which no filter has changed the spectrum.

    Raises:
        ValueError: a record of fewer than 1024 samples, a constant one, or too little below ``band``.
    """
    trends, rests = zip(*(residuals(record) for record in records), strict=True)
    longest = int(np.argmax([rest.size for rest in rests]))
    lines = tuple(line for line in find_lines(rests[longest], dt, level) if line.frequency <= band)
    # Whether one record at a steady temperature has a ramp is for the fit to decide.
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


def _mean(record: Record, dt: float) -> Mean:
    duration = record.values.size * dt
    value = float(record.values.mean())
    return Mean(record.celsius, value, record.start + duration / 2, duration, record.rising, record.log)


def _problem(
    spectra: Sequence[CosineSpectrum], trends: Sequence[Floats] | None, dt: float, band: float
) -> LikelihoodProblem:
    kinds = [make(1.0) for make in TERMS.values()]
    parts = [LikelihoodProblem.of(spectrum, kinds).below(band) for spectrum in spectra]
    if min(part.power.size for part in parts) < FEWEST_BINS:
        message = f"too little of the spectrum lies below {band:.3g} Hz, above which a filter changed it"
        raise ValueError(message)
    if trends is None:
        return parts[0]
    return joined([
        restricted(part, spectrum, lowest(trend, dt)) for part, spectrum, trend in zip(parts, spectra, trends, strict=True)
    ])  # fmt: skip


def _deviation(values: Floats, spectra: Sequence[CosineSpectrum], level: float) -> Coefficient:
    """Return the samples' standard deviation; how surely, tell the powers of their cosines, which are nearly independent."""
    square = float(np.einsum("i,i", values, values)) / values.size
    total = sum(float(s.power @ s.count + s.low @ s.low) for s in spectra)
    scatter = sum(float(2 * (s.power**2) @ s.count + 2 * (s.low**4).sum() / 3) for s in spectra) ** 0.5
    return Coefficient(square**0.5, *interval(square, square * scatter / total, level))


def log_sigma(found: Coefficient, level: float) -> float | None:
    """Return the standard error of a coefficient's logarithm, from its interval; None where it has no value."""
    if found.value is None:
        return None
    z = normal_limit(level)
    if found.lower:
        return float(np.log(found.upper / found.lower)) / (2 * z)
    return float(np.log(found.upper / found.value)) / z
