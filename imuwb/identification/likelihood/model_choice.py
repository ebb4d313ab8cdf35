"""Which sum of processes explains a record best: by information criterion, and on the half that it was not fitted to.

All sums have one likelihood, that of the same cosine coefficients. The correlation time of a Gauss-Markov term is searched on a
grid and then refined. An autoregressive model is compared with Burg's coefficients.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.likelihood.cosine_spectrum import FEWEST, CosineSpectrum
from imuwb.identification.likelihood.fit import TERMS, spectrum_without
from imuwb.identification.likelihood.problem import CLOSE, LikelihoodProblem, Solution
from imuwb.identification.spectral.lines import Line
from imuwb.stochastic import Autoregressive, GaussMarkov, Process, Sum

#: Letters of ``TERMS``; M is a Gauss-Markov term. Sums with Q are compared where a record shows quantization.
SUMS = ("N", "NB", "NK", "NBK", "NM", "NMK", "NMM", "QN", "QNB", "QNK", "QNBK", "QNM", "QNMK", "QNMM")
GRID = 12  #: correlation times in the first search
SEARCHING = 0.05  #: change of the deviance that ends a solution during the search of correlation times
SWEEPS = 3  #: refinements of each of several correlation times in turn
REFINEMENTS = 6  #: steps of the golden section
QUANTIZED = 2.7  #: reduction of the deviance by quantization, above which sums with Q are compared
CLEAR = 10.0  #: difference of BIC that is called clear (Kass and Raftery 1995)


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class ModelCandidate:
    """One sum, and how well it explains the record."""

    name: str  #: such as "N + GM + K"
    processes: Sum  #: sum with the likeliest parameters, without terms of size 0
    parameters: int  #: number of free parameters
    deviance: float  #: -2 log likelihood plus a constant of the record
    aic: float
    bic: float
    #: sum of the deviances of each half under the fit to the other half; None for autoregressive models
    out_of_sample: float | None
    aic_excess: float = 0.0  #: AIC minus that of the best sum
    bic_excess: float = 0.0  #: BIC minus that of the best sum
    out_of_sample_excess: float | None = None  #: ``out_of_sample`` minus that of the best sum

    def compared(self, best: ModelCandidate) -> ModelCandidate:
        """Return the candidate with its differences from the best one."""
        known = self.out_of_sample is not None and best.out_of_sample is not None
        return replace(
            self,
            aic_excess=self.aic - best.aic,
            bic_excess=self.bic - best.bic,
            out_of_sample_excess=(self.out_of_sample or 0.0) - (best.out_of_sample or 0.0) if known else None,
        )

    def __repr__(self) -> str:
        """Return the sum, its parameters and its BIC over the best sum's."""
        return f"{self.name} ({self.processes}), BIC {self.bic_excess:+.1f}"


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class ModelChoice:
    """The candidates, in the order of BIC."""

    candidates: tuple[ModelCandidate, ...]
    highest: float  #: Hz; the comparison uses the spectrum up to this frequency
    clear: bool  #: the BIC of the best is lower than the next by 10, and the best is also best out of sample

    @property
    def best(self) -> ModelCandidate:
        """Return the sum with the least BIC."""
        return self.candidates[0]

    def __repr__(self) -> str:
        """Return the best sum and the next ones."""
        others = "; ".join(f"{c.name} {c.bic_excess:+.1f}" for c in self.candidates[1:4])
        return f"{'clearly ' if self.clear else ''}best sum: {self.best.name} ({self.best.processes}); BIC of the next: {others}"


def choose_model(
    values: Floats,
    dt: float,
    lines: Sequence[Line] = (),
    *,
    highest: float | None = None,
    sums: Sequence[str] = SUMS,
    models: Sequence[Autoregressive] = (),
    spectrum: CosineSpectrum | None = None,
) -> ModelChoice:
    """Return sums of processes, ranked by how well they explain an evenly spaced record without gaps.

    Args:
        values: (n,) samples.
        dt: s.
        lines: sinusoids; their frequencies are left out.
        highest: Hz; the spectrum above is left out, such as where a sensor's own filter shows.
        sums: texts of the letters Q, N, B, K, and M for a Gauss-Markov process.
        models: autoregressive models of this record, compared without a fit.
        spectrum: spectrum of the record, if it has been computed.

    Raises:
        ValueError: fewer than 512 samples.
        KeyError: an unknown letter.
    """
    if values.size < 2 * FEWEST:
        raise ValueError(
            f"{values.size} samples are too few to compare sums; the comparison needs at least {2 * FEWEST}"
        )
    half = values.size // 2
    first, second = (
        _Record(spectrum_without(part, dt, lines), highest) for part in (values[:half], values[half : 2 * half])
    )
    whole = _Record(spectrum_without(values, dt, lines) if spectrum is None else spectrum, highest)
    without, everything = (whole.fit(text).deviance for text in ("NBK", "QNBK"))
    if without - everything < QUANTIZED:
        sums = [text for text in sums if "Q" not in text]
    candidates: list[ModelCandidate] = []
    for text in sorted(sums, key=lambda text: text.count("M")):
        if text.count("M") > 1 and len(sums) > 1 and not _gauss_markov_may_win(candidates):
            continue
        fitted = whole.fit(text)
        a, b = first.fit(text, fitted.times), second.fit(text, fitted.times)
        out = first.deviance(b.processes, b.squared) + second.deviance(a.processes, a.squared)
        k = len(text) + text.count("M")
        name = " + ".join(text).replace("M", "GM")
        candidates.append(_candidate(name, fitted.sum(), k, fitted.deviance, whole.count, out))
    for model in models:
        deviance = whole.deviance([model], np.ones(1))
        candidates.append(_candidate(
            f"AR({len(model.alpha)})", Sum((model,)), len(model.alpha) + 1, deviance, whole.count, None
        ))  # fmt: skip
    return _ranked(candidates, float(whole.problem([TERMS["N"](1.0)]).frequency[-1]))


def _ranked(candidates: Sequence[ModelCandidate], highest: float) -> ModelChoice:
    ranked = sorted(candidates, key=lambda c: c.bic)
    best = ranked[0]
    tested = [c.out_of_sample for c in ranked if c.out_of_sample is not None]
    clear = (
        len(ranked) > 1 and ranked[1].bic - best.bic > CLEAR and best.out_of_sample in (None, min(tested, default=None))
    )
    return ModelChoice(tuple(c.compared(best) for c in ranked), highest, clear)


def _gauss_markov_may_win(candidates: Sequence[ModelCandidate]) -> bool:
    """Return whether sums with one Gauss-Markov term come near those with flicker; two such terms imitate flicker."""
    single, flicker = (
        min((c.bic for c in candidates if term in c.name.split(" + ")), default=np.inf) for term in ("GM", "B")
    )
    return bool(single < flicker + CLEAR)


def _candidate(name: str, processes: Sum, k: int, deviance: float, n: float, out: float | None) -> ModelCandidate:
    return ModelCandidate(name, processes, k, deviance, deviance + 2 * k, deviance + k * float(np.log(n)), out)


@dataclass(frozen=True, eq=False, slots=True)
class _Fitted:
    processes: list[Process]  #: processes of size 1
    squared: Floats
    deviance: float
    times: tuple[float, ...]  #: correlation times, s

    def sum(self) -> Sum:
        kinds = {type(make(1.0)): make for make in TERMS.values()}
        terms: list[Process] = []
        for process, square in zip(self.processes, self.squared, strict=True):
            size = float(square) ** 0.5
            if size > 0:
                terms.append(
                    GaussMarkov(size, process.Tc) if isinstance(process, GaussMarkov) else kinds[type(process)](size)
                )
        return Sum(tuple(terms))


class _Record:
    """The cosine coefficients of a record, with the covariances and densities that were already computed."""

    def __init__(self, spectrum: CosineSpectrum, highest: float | None) -> None:
        self._spectrum = spectrum
        self._parts: dict[Process, tuple[Floats, Floats]] = {}
        self._last: dict[int, Floats] = {}
        self._inside = slice(None) if highest is None else spectrum.frequency <= highest
        self.count = float(spectrum.count[self._inside].sum() + spectrum.low.size)

    def problem(self, processes: Sequence[Process]) -> LikelihoodProblem:
        s, inside = self._spectrum, self._inside
        for process in processes:
            if process not in self._parts:
                self._parts[process] = s.covariance(process), s.density(process)[inside]
        covariances, densities = zip(*(self._parts[process] for process in processes), strict=True)
        return LikelihoodProblem(
            s.low, s.trend(), np.stack(covariances), s.frequency[inside], s.power[inside],
            s.count[inside].astype(np.float64), np.stack(densities, axis=1), s.ramp, np.array([0, s.low.size]),
        )  # fmt: skip

    def deviance(self, processes: Sequence[Process], squared: Floats) -> float:
        return self.problem(processes).deviance(squared)

    def fit(self, text: str, times: tuple[float, ...] = ()) -> _Fitted:
        """Return the likeliest sum of these letters; correlation times are searched over the record, or only near ``times``."""
        fixed = [TERMS[letter](1.0) for letter in text if letter != "M"]
        count = text.count("M")
        if not count:
            return self._solved(fixed, ())
        s = self._spectrum
        ends = np.log(3 * s.dt), np.log(s.n * s.dt / 2)
        chosen = [float(np.log(t)) for t in times]
        for _ in range(count - len(chosen)):  # one more term at a time, at the correlation time that helps most
            grid = np.linspace(*ends, GRID)
            chosen.append(float(min(grid, key=lambda t: self._deviance(fixed, [*chosen, float(t)]))))
        step = (ends[1] - ends[0]) / (GRID - 1) if not times else 0.5
        # Two terms compete for one part of the spectrum: each is refined in turn, at first over a wider span.
        for sweep in range(SWEEPS if count > 1 and not times else 1):
            for place in range(count):
                chosen[place] = self._refined(fixed, chosen, place, step * (2.0 if count > 1 and not sweep else 1.0))
        return self._solved(fixed, tuple(float(np.exp(t)) for t in sorted(chosen)))

    def _refined(self, fixed: list[Process], chosen: list[float], place: int, step: float) -> float:
        """Return the best value near a chosen one, by golden section."""

        def at(t: float) -> float:
            return self._deviance(fixed, [*chosen[:place], t, *chosen[place + 1 :]])

        ratio = (5**0.5 - 1) / 2
        low, high = chosen[place] - step, chosen[place] + step
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        at_a, at_b = at(a), at(b)
        for _ in range(REFINEMENTS):
            if at_a < at_b:
                high, b, at_b = b, a, at_a
                a = high - ratio * (high - low)
                at_a = at(a)
            else:
                low, a, at_a = a, b, at_b
                b = low + ratio * (high - low)
                at_b = at(b)
        return a if at_a < at_b else b

    def _deviance(self, fixed: list[Process], log_times: list[float]) -> float:
        return self._solved(fixed, tuple(float(np.exp(t)) for t in log_times), SEARCHING).deviance

    def _solved(self, fixed: list[Process], times: tuple[float, ...], close: float = CLOSE) -> _Fitted:
        processes = [*fixed, *(GaussMarkov(1.0, t) for t in times)]
        # Similar correlation times have similar squares, so the last solution is the start of the next.
        last = self._last.get(len(processes)) if times else None
        start = None if last is None else last.clip(last.max() * 1e-9)
        solution: Solution = self.problem(processes).solve(range(len(processes)), ramp=False, start=start, close=close)
        self._last[len(processes)] = solution.squared
        return _Fitted(processes, solution.squared, solution.deviance, times)
