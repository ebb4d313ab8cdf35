"""The noise of one record in one call: lines, Allan curve, three estimators, stationarity, and the sum of processes to use.

The order of the steps matters. Periodic lines are found first, because each fit needs them. The Allan variances are fitted to
all samples; gaps are bridged. The likelihood of the spectrum, which has the least error, and the wavelet variances need evenly
spaced samples, so they use the longest part without gaps. Their agreement with the Allan fit, and a test of stationarity, show
whether the coefficients can be trusted. A comparison of sums shows whether a Gauss-Markov process explains the record better.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal, TypeVar

import numpy as np

from imuwb.arrays import Floats, Integers, alone
from imuwb.identification.allan_variance.fit import AllanFit, fit_allan
from imuwb.identification.allan_variance.overlapping import AllanDeviation, Uncertainty, allan
from imuwb.identification.correlation.burg import burg
from imuwb.identification.likelihood.cosine_spectrum import CosineSpectrum
from imuwb.identification.likelihood.fit import LikelihoodFit, fit_cosine_spectrum, spectrum_without
from imuwb.identification.likelihood.model_choice import ModelChoice, choose_model
from imuwb.identification.record.stationarity import Stationarity, stationarity
from imuwb.identification.spectral.lines import Line, find_lines, passing_text
from imuwb.identification.wavelet.variance import WaveletFit, fit_wavelet_variance, wavelet_variance
from imuwb.notes import Note
from imuwb.sampling import longest_part
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.stochastic import Autoregressive, GaussMarkov, Sinusoid, Sum
from imuwb.texts import coefficients_text, seconds_text

Computed = TypeVar("Computed")

AR_ORDERS = (1, 3)  #: autoregressive models that are compared (Quinchia; El-Diasty)
SETTLED = 20.0  #: averaging time, in units of 1/band, above which a filter removes less than 1/250 of white noise
LONG_ENOUGH = (
    0.5  #: share of the record in its longest part without gaps, below which only the Allan curve is identified
)


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class NoiseIdentification:
    """The noise of one record. A part that the record does not allow is None, and a note gives the reason."""

    n: int  #: samples
    dt: float  #: s
    level: float  #: confidence level of all intervals and limits
    mean: float  #: mean of the samples that the likelihood uses
    curve: AllanDeviation
    lines: tuple[Line, ...]  #: those that both halves of the record show; the error model has them
    passing: tuple[Line, ...]  #: lines of one half only; the fits leave them out, and no model has them
    allan: AllanFit | None
    likelihood: LikelihoodFit | None
    wavelet: WaveletFit | None
    stationarity: Stationarity | None
    choice: ModelChoice | None
    notes: tuple[Note, ...]

    @property
    def headline(self) -> Literal["likelihood", "allan"]:
        """Return the name of the estimator with the least error that the record allows."""
        return "allan" if self.likelihood is None else "likelihood"

    @property
    def estimators(self) -> dict[str, Mapping[str, Coefficient]]:
        """Return the coefficients of each estimator; where there is no Allan fit, its coefficients are unknown."""
        unknown = dict.fromkeys("QNBKR", UNKNOWN)
        fits = {"likelihood": self.likelihood, "wavelet": self.wavelet}
        others = {name: fit.coefficients for name, fit in fits.items() if fit is not None}
        return {"allan": unknown if self.allan is None else self.allan.coefficients, **others}

    @property
    def coefficients(self) -> Mapping[str, Coefficient]:
        """Return Q, N, B, K and R of the headline's estimator."""
        return self.estimators[self.headline]

    @property
    def differences(self) -> tuple[str, ...]:
        """Return the coefficients whose intervals do not overlap between two estimators, such as "N: allan and wavelet"."""
        return tuple(
            sorted(
                f"{letter}: {first} and {second}"
                for (first, a), (second, b) in combinations(self.estimators.items(), 2)
                for letter in a.keys() & b.keys()
                if a[letter].upper < (b[letter].lower or 0.0) or b[letter].upper < (a[letter].lower or 0.0)
            )
        )

    @property
    def agree(self) -> bool:
        """Return whether the intervals of all estimators overlap, coefficient by coefficient."""
        return not self.differences

    @property
    def prefers_gauss_markov(self) -> bool:
        """Return whether a sum with a Gauss-Markov process explains the record clearly best."""
        best = None if self.choice is None or not self.choice.clear else self.choice.best.processes
        return best is not None and any(isinstance(term, GaussMarkov) for term in best.terms)

    @property
    def processes(self) -> Sum:
        """Return the sum for an error model: terms whose intervals do not begin at 0, or a clearly better sum, and lines."""
        lines = [line.process(self.dt) for line in self.lines]
        if self.choice is not None and self.prefers_gauss_markov:
            return Sum((*self.choice.best.processes.terms, *lines))
        if self.likelihood is not None:
            return Sum((*self.likelihood.identified.terms, *lines))
        return self.allan_processes

    @property
    def allan_processes(self) -> Sum:
        """Return the sum of the Allan fit without the lines that are not in both halves of the record."""
        fitted = Sum() if self.allan is None else self.allan.processes
        passing = {line.frequency for line in self.passing}
        return Sum(tuple(x for x in fitted.terms if not (isinstance(x, Sinusoid) and x.frequency in passing)))

    def __repr__(self) -> str:
        """Return the headline in a few lines."""
        rows = [
            f"noise of {self.n} samples at {1 / self.dt:.6g} Hz ({seconds_text(self.n * self.dt)}), by {self.headline}:",
            f"  {coefficients_text(self.coefficients)}",
            f"  sum: {self.processes}",
            f"  estimators {'agree' if self.agree else 'differ in ' + '; '.join(self.differences)}",
        ]
        rows += [f"  {line}" for line in self.lines]
        rows += [f"  {part}" for part in (self.stationarity, self.choice, *self.notes) if part is not None]
        return "\n".join(rows)


def identify(
    values: Floats,
    dt: float,
    *,
    time: Integers | None = None,
    breaks: Sequence[int] = (),
    averaging_times: str | Sequence[float] = "octave",
    uncertainty: Uncertainty = "edf",
    level: float = 0.95,
    lines: bool = True,
    estimators: bool = True,
    choose: bool = False,
    band: float = math.inf,
    fast: bool = False,
) -> NoiseIdentification:
    """Return the noise of a rate or specific force series that is at rest.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        time: (n,) ns, for a record with gaps: averages then bridge the gaps.
        breaks: indices before which samples are missing.
        averaging_times: those of the curve: ``"octave"``, ``"log:N"``, ``"all"``, or times in s; fits use octaves.
        uncertainty: how the intervals of the curve are computed: ``"edf"`` or ``"printed"``, as in ``allan``.
        level: confidence level of all intervals and limits.
        lines: whether periodic lines are searched; the fits then include or leave out the lines.
        estimators: whether the likelihood, the wavelet variances and the test of stationarity are computed too.
        choose: whether sums of processes are compared, also with Gauss-Markov and autoregressive terms.
        band: Hz; a filter has changed the spectrum above it. Fits use the spectrum below it.
        fast: whether the curve is thinned at long averaging times, as in ``allan``; fits are not.

    Raises:
        ValueError: fewer than 2 samples, samples that are not finite, or no averaging time within the record.
    """
    values = np.asarray(values, dtype=np.float64)
    curve = allan(
        values, dt, averaging_times, level=level, uncertainty=uncertainty, breaks=breaks, time=time, fast=fast
    )
    octaves = curve
    if averaging_times != "octave" or fast:
        octaves = allan(values, dt, "octave", level=level, breaks=breaks, time=time)
    part = values[longest_part(breaks, values.size)]
    whole = part.size >= LONG_ENOUGH * values.size
    reasons = _Reasons()
    if not whole:
        reasons.add(
            "gaps", "the longest part without gaps is less than half of the record, so there is an Allan fit only"
        )
    in_band = tuple(line for line in find_lines(part, dt, level) if line.frequency <= band) if lines and whole else ()
    fit = reasons.attempt("no-fit", "no fit", lambda: fit_allan(octaves, in_band, SETTLED / band))
    others = (None, None, None, None)
    if estimators and whole:
        others = _others(part, dt, in_band, level, band, reasons, choose=choose)
    passing = tuple(line for line in in_band if not line.in_both_halves)
    if passing:
        reasons.add("passing-lines", passing_text(passing))
    lasting = tuple(line for line in in_band if line.in_both_halves)
    return NoiseIdentification(
        values.size, dt, level, float(part.mean()), curve, lasting, passing, fit, *others, reasons.notes
    )


def _others(
    values: Floats, dt: float, lines: Sequence[Line], level: float, band: float, reasons: _Reasons, *, choose: bool
) -> tuple[LikelihoodFit | None, WaveletFit | None, Stationarity | None, ModelChoice | None]:
    """Return the likelihood fit, the wavelet fit, the test of stationarity, and the choice of a sum if it is wanted."""
    spectrum = reasons.attempt("no-likelihood", "no likelihood", lambda: spectrum_without(values, dt, lines))
    likelihood = None
    if spectrum is not None:
        likelihood = reasons.attempt(
            "no-likelihood", "no likelihood", lambda: fit_cosine_spectrum(spectrum, level=level, highest=band)
        )
    wavelet = reasons.attempt("no-wavelet", "no wavelet variance", lambda: _wavelet(values, dt, lines, level, band))
    steady = reasons.attempt("no-stationarity", "no test of stationarity", lambda: stationarity(values, dt))
    if not choose:
        return likelihood, wavelet, steady, None
    highest = None if likelihood is None else likelihood.highest
    with alone(values.size):
        choice = reasons.attempt(
            "no-choice", "no choice of a sum", lambda: _choice(values, dt, lines, spectrum, highest)
        )
    return likelihood, wavelet, steady, choice


def _wavelet(values: Floats, dt: float, lines: Sequence[Line], level: float, band: float) -> WaveletFit:
    if band < 0.5 / dt:
        raise ValueError(f"a filter has changed the spectrum above {band:.3g} Hz; the shortest wavelets use that part")
    return fit_wavelet_variance(wavelet_variance(values, dt), lines, level=level)


def _choice(
    values: Floats, dt: float, lines: Sequence[Line], spectrum: CosineSpectrum | None, highest: float | None
) -> ModelChoice:
    models = burg(values, max(AR_ORDERS))
    regressions = [Autoregressive(tuple(models.alpha[p]), float(models.variance[p]) ** 0.5, dt) for p in AR_ORDERS]
    return choose_model(values, dt, lines, highest=highest, models=regressions, spectrum=spectrum)


class _Reasons:
    def __init__(self) -> None:
        self.notes: tuple[Note, ...] = ()

    def add(self, name: str, text: str) -> None:
        self.notes = (*self.notes, Note(name, text))

    def attempt(self, name: str, what: str, compute: Callable[[], Computed]) -> Computed | None:
        """Return a part of the result; None, with a note, where the record does not allow it."""
        try:
            return compute()
        except ValueError as error:
            self.add(name, f"{what}: {error}")
            return None
