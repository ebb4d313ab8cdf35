"""The sum Q, N, B, K, R that makes a record likeliest, with intervals from its likelihood.

The Allan variance condenses a record to some twenty correlated figures. The likelihood of the cosine coefficients uses all of
the record, and its errors are near the Cramer-Rao bound. The value of a term is its likeliest size. A term whose likeliest size
is 0 has an upper limit and no value. A term whose interval begins at 0 may be absent.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.allan_variance.problem import scaled_inverse
from imuwb.identification.coefficient import READ_OUT, interval
from imuwb.identification.likelihood.cosine_spectrum import CosineSpectrum, cosine_spectrum
from imuwb.identification.likelihood.problem import LikelihoodProblem, Solution
from imuwb.identification.spectral.lines import Line
from imuwb.identification.sum_fit import ACCEPTED, SumFit, widening
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import chi_square_quantile, chi_square_tail, normal_limit, normal_quantile
from imuwb.stochastic import FlickerNoise, Process, Quantization, RandomWalk, RateRamp, Sum, WhiteNoise
from imuwb.texts import number_text

TERMS: dict[str, Callable[[float], Process]] = {
    "Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk,
}  # fmt: skip
#: reduction of the deviance for which the sum takes a ramp; chance gives it in about 1 % of records
RAMP_EVIDENCE = 10.8
#: relative error of a real sensor's density that does not count against the sum when the highest frequency is chosen
TOLERATED = 0.02
MUCH = 15.0  #: reduction of chi-square that justifies leaving out another group of bins
GROUP = 2**0.5  #: ratio of the last frequency to the first in a group of bins
FEWEST_GROUPS = 8
FEWEST_BINS = 20  #: bins of the spectrum in a fit
FARTHEST = 60  #: doublings of a square in the search for the end of its interval
SURE = 300.0  #: degrees of freedom of a term, above which its interval is that of a scaled chi-square
LINE_BINS = 6.0  #: bins of the line search that are left out on both sides of a line


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class LikelihoodFit(SumFit):
    """A sum of processes fitted to a record by likelihood."""

    deviance: float  #: -2 log likelihood plus a constant of the record
    highest: float  #: Hz; the sum explains the spectrum up to this frequency

    @property
    def identified(self) -> Sum:
        """Return the terms whose interval does not begin at 0."""
        sure = [x for x in TERMS if (c := self.coefficients[x]).value is not None and (c.lower or 0.0) > 0]
        ramp = [term for term in self.processes.terms if isinstance(term, RateRamp)]
        return Sum((*(TERMS[x](self.coefficients[x].value or 0.0) for x in sure), *ramp))

    def __repr__(self) -> str:
        """Return the coefficients and how well they explain the spectrum."""
        return self.text(f"likelihood fit up to {number_text(self.highest)} Hz")


def spectrum_without(values: Floats, dt: float, lines: Sequence[Line] = ()) -> CosineSpectrum:
    """Return a record's cosine coefficients without those near periodic lines."""
    return cosine_spectrum(values, dt, [(line.frequency, LINE_BINS * line.resolution) for line in lines])


def fit_likelihood(values: Floats, dt: float, lines: Sequence[Line] = (), *, level: float = 0.95) -> LikelihoodFit:
    """Return the likeliest sum of an evenly spaced record without gaps.

    Args:
        values: (n,) samples.
        dt: s.
        lines: sinusoids found in the spectrum; their frequencies are left out.
        level: confidence level of the intervals and limits.

    Raises:
        ValueError: fewer than 256 samples, or a constant channel.
    """
    if np.ptp(values) == 0:
        raise ValueError("the channel is constant, so it has no noise to fit; check that the sensor is connected")
    return fit_cosine_spectrum(spectrum_without(values, dt, lines), level=level)


def fit_cosine_spectrum(
    spectrum: CosineSpectrum, *, level: float = 0.95, highest: float = float("inf")
) -> LikelihoodFit:
    """Return the likeliest sum of a record's cosine coefficients.

    Args:
        spectrum: spectrum of the record.
        level: confidence level of the intervals and limits.
        highest: Hz; coefficients above are left out, such as those that a filter has changed.

    Raises:
        ValueError: fewer than 20 bins of the spectrum are left.
    """
    problem = LikelihoodProblem.of(spectrum, [make(1.0) for make in TERMS.values()]).below(highest)
    if problem.power.size < FEWEST_BINS:
        raise ValueError(
            f"{problem.power.size} bins of the spectrum lie below {highest:.3g} Hz; a likelihood fit needs at least {FEWEST_BINS}"
        )
    return fit_problem(problem, level)


def fit_problem(problem: LikelihoodProblem, level: float = 0.95, *, without: Collection[str] = ()) -> LikelihoodFit:
    """Return the likeliest sum Q, N, B, K of the cosine coefficients of one record, or of several together.

    Args:
        problem: likelihood problem of these four terms.
        level: confidence level of the intervals and limits.
        without: terms that are known to be absent; their limits are estimated as well.
    """
    problem, misfit, freedom = explained(problem)
    probability = float(chi_square_tail(misfit, freedom))
    everything = [t for t, letter in enumerate(TERMS) if letter not in without]
    steady, sloping = (problem.solve(everything, ramp=ramp) for ramp in (False, True))
    # Restricted likelihoods with and without a ramp cannot be compared; the plain likelihoods can.
    known = sloping.ramp_sigma > 0  # 0 where a line hides all of the lowest coefficients
    ramped = known and steady.deviance - (sloping.deviance + 2 * np.log(sloping.ramp_sigma)) > RAMP_EVIDENCE
    best = sloping if ramped else steady
    inflation = widening(misfit / freedom, probability)
    coefficients = profiled(problem, best, level, ramped=bool(ramped), inflation=inflation, terms=everything)
    coefficients["R"] = _ramp(sloping, level, inflation, ramped=bool(ramped))
    terms: list[Process] = [TERMS[x](c.value) for x in TERMS if (c := coefficients[x]).value]
    if ramped:
        terms.append(RateRamp(sloping.ramp))
    highest = float(problem.frequency[-1])
    return LikelihoodFit(level, coefficients, Sum(tuple(terms)), misfit / freedom, probability, best.deviance, highest)


def _ramp(sloping: Solution, level: float, inflation: float, *, ramped: bool) -> Coefficient:
    size, sigma = abs(sloping.ramp), sloping.ramp_sigma * inflation**0.5
    z = normal_limit(level)
    if sigma == 0:
        return Coefficient(None, None, float("inf"), at=READ_OUT["R"])
    if not ramped:
        return Coefficient(None, None, float(size + normal_quantile(level) * sigma), at=READ_OUT["R"])
    return Coefficient(float(size), float(max(size - z * sigma, 0.0)), float(size + z * sigma), at=READ_OUT["R"])


def explained(problem: LikelihoodProblem) -> tuple[LikelihoodProblem, float, float]:
    """Return the part of the problem that the sum explains, chi-square and its degrees of freedom.

    A sensor's own filter, or its resonances, bend the upper end of the spectrum, and no sum of these processes can follow. The
    bins there are precise. A cut must reduce the misfit by far more than the part that chance gives to the bins left out.
    """
    top = float(problem.frequency[-1])
    groups = int(np.log(top / problem.frequency[0]) / np.log(GROUP))
    cuts: list[tuple[LikelihoodProblem, float, float]] = []
    for cut in range(max(groups - FEWEST_GROUPS, 1)):
        part = problem.below(top / GROUP**cut * (1 + 1e-12))
        solution = part.solve(range(len(TERMS)))
        misfit, freedom = _misfit(part, solution)
        cuts.append((part, misfit, freedom))
        pays = not cut or cuts[0][1] - misfit > MUCH * (cut + 1)
        if pays and chi_square_tail(_misfit(part, solution, TOLERATED)[0], freedom) > ACCEPTED:
            return cuts[-1]
    gains = [cuts[0][1] - misfit - MUCH * (cut + 1) for cut, (_, misfit, _) in enumerate(cuts)]
    return cuts[int(np.argmax(gains)) if max(gains) > 0 else 0]


def _misfit(problem: LikelihoodProblem, solution: Solution, tolerated: float = 0.0) -> tuple[float, float]:
    """Return chi-square of the mean power in groups of bins, and its degrees of freedom.

    ``tolerated`` is a relative error of the density that does not count as misfit.
    """
    density = problem.design @ solution.squared
    group = (np.log(problem.frequency[-1] / problem.frequency) / np.log(GROUP)).astype(np.int64)
    count = np.bincount(group, problem.count)
    excess = np.bincount(group, problem.count * (problem.power / density - 1))
    chi2 = float(np.sum(excess**2 / (2 * count.clip(1) + (tolerated * count) ** 2)))
    return chi2, float(max(count.size - np.count_nonzero(solution.squared), 1))


def profiled(
    problem: LikelihoodProblem,
    best: Solution,
    level: float,
    *,
    ramped: bool,
    inflation: float,
    terms: Sequence[int] | None = None,
) -> dict[str, Coefficient]:
    """Return Q, N, B and K with their intervals, or their limits; ``terms`` (default all) are those that may be present."""
    free = range(len(TERMS)) if terms is None else terms
    profile = _Profile(problem, best, ramped=bool(ramped), inflation=inflation, terms=free)
    return {letter: replace(profile.coefficient(t, level), at=READ_OUT[letter]) for t, letter in enumerate(TERMS)}


class _Profile:
    """The loss of likelihood as one term leaves its likeliest size and the other terms are fitted again."""

    def __init__(
        self, problem: LikelihoodProblem, best: Solution, *, ramped: bool, inflation: float, terms: Sequence[int]
    ) -> None:
        self._problem, self._best, self._ramped, self._inflation = problem, best, ramped, inflation
        self._terms = terms

    def coefficient(self, term: int, level: float) -> Coefficient:
        """Return the size of a term with its interval, or its limit."""
        value = float(self._best.squared[term])
        if value == 0:
            return Coefficient(None, None, self._end(term, normal_quantile(level) ** 2, upward=True) ** 0.5)
        free = np.flatnonzero(self._best.squared > 0)
        covariance = scaled_inverse(self._best.information[np.ix_(free, free)])
        place = int(np.flatnonzero(free == term)[0])
        freedom = 2 * value**2 / (float(covariance[place, place]) * self._inflation)
        if freedom > SURE:
            return Coefficient(value**0.5, *interval(value, (2 / freedom) ** 0.5 * value, level))
        reach = float(chi_square_quantile(level, 1))
        lower, upper = (self._end(term, reach, upward=upward) for upward in (False, True))
        return Coefficient(value**0.5, lower**0.5, upper**0.5)

    def _loss(self, term: int, size: float) -> float:
        best = self._best
        others = [t for t in self._terms if t != term]
        held = np.eye(best.squared.size)[term] * size
        solution = self._problem.solve(others, ramp=self._ramped, start=best.squared, held=held)
        return (solution.deviance - best.deviance) / self._inflation

    def _end(self, term: int, reach: float, *, upward: bool) -> float:
        """Return the square at which the deviance has risen by ``reach``; 0 if it has risen by less at a square of 0."""
        best = self._best
        value = float(best.squared[term])
        if not upward and self._loss(term, 0.0) < reach:
            return 0.0
        sigma = float(best.information[term, term]) ** -0.5
        inner, outer = value, value
        for _ in range(FARTHEST):  # outward until the end lies between inner and outer
            outer = outer / 2 if not upward else max(2 * outer, value + sigma)
            if self._loss(term, outer) > reach:
                break
            inner = outer
        else:  # the likelihood is flat, so the record does not look like noise
            return outer if upward else 0.0
        inner = max(inner, 1e-3 * outer)
        for _ in range(7):  # to a hundredth of a factor of two
            middle = (inner * outer) ** 0.5
            inner, outer = (middle, outer) if self._loss(term, middle) < reach else (inner, middle)
        return (inner * outer) ** 0.5
