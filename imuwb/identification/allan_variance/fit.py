"""One fit of the whole sum Q, N, B, K, R (and periodic lines) to an Allan curve, with intervals.

The Allan variance is linear in Q², N², B², K² and R². The points of a curve are correlated, strongly at long averaging
times, and the sum itself gives their covariance. So the squares are estimated by non-negative generalised least squares:
the covariance is taken from the fit, and the fit is repeated. The usual way reads straight lines off parts of the curve; that
is biased where the parts overlap.

A term stays in the sum if it is larger than chance would make it if the term were absent. The test is one-sided, with the
probability (1 - level)/2 of a false alarm.
A term that does not stay is not zero: it has an upper limit.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from scipy import optimize

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.identification.allan_variance.flat import measured_flat_part
from imuwb.identification.allan_variance.overlapping import AllanDeviation
from imuwb.identification.allan_variance.problem import LETTERS, PROCESSES, Problem
from imuwb.identification.allan_variance.regions import regions
from imuwb.identification.allan_variance.term_selection import first_time, select
from imuwb.identification.coefficient import READ_OUT, interval
from imuwb.identification.region import Region
from imuwb.identification.spectral.lines import Line
from imuwb.identification.sum_fit import SumFit, widening
from imuwb.statistics import Coefficient, Estimate
from imuwb.statistics.distributions import chi_square_tail, normal_quantile
from imuwb.stochastic import Sinusoid, Sum
from imuwb.texts import number_text

FEWEST = 3  #: least number of averaging times of a fit
FEWEST_FILTERED = 5  #: least number for a fit that leaves out the averaging times which a filter changes
STRIDE = 4.0  #: factor between two squares in the search for a limit
FARTHEST = 1e4  #: largest ratio of a limit to the limit that neglects the term's own scatter
GAUSS_MARKOV_PEAK = 1.8926  #: the Allan deviation of a Gauss-Markov process is largest at 1.8926 Tc
OCTAVE = 1.8  #: ratio of averaging times that counts as an octave


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class AllanFit(SumFit):
    """A sum of processes, with the periodic lines, fitted to an Allan curve."""

    lines: tuple[Sinusoid, ...]
    regions: tuple[Region, ...]
    #: s, correlation time of the bias instability as the papers read it: middle of the flat part (Quinchia, table 5), which is its
    #: interval; without an upper end where the flat part lasts to the end of the curve; None: the sum has no B
    correlation_time: Estimate | None
    shortest: float  #: s; the sum explains the curve from this averaging time up

    @property
    def gauss_markov_time(self) -> float | None:
        """Return Tc (s) of the Gauss-Markov process whose peak, at 1.893 Tc, is the middle of the flat part."""
        return None if self.correlation_time is None else self.correlation_time.value / GAUSS_MARKOV_PEAK

    def allan_deviation(self, averaging_time: Floats, dt: float) -> Floats:
        """Return the fitted sum's Allan deviation."""
        return np.sqrt(self.processes.allan_variance(averaging_time, dt))

    def __repr__(self) -> str:
        """Return the coefficients and how well they explain the curve."""
        return self.text(f"Allan fit from {number_text(self.shortest)} s")


def fit_allan(curve: AllanDeviation, lines: Sequence[Line] = (), shortest: float = 0.0) -> AllanFit:
    """Return the sum of processes that fits a curve best.

    Args:
        curve: from ``allan(..., "octave")``; a denser curve is thinned to about one point an octave.
        lines: sinusoids found in the spectrum; their frequencies and amplitudes are held.
        shortest: s; shorter averaging times are left out, such as those that a filter has changed.

    Raises:
        ValueError: fewer than three averaging times, or a curve that is 0 (a constant channel).
    """
    chosen = _octaves(curve.factor, curve.averaging_time >= shortest, shortest)
    problem = Problem.of(curve, chosen, lines)
    problem = problem.since(first_time(problem))
    squared, covariance, active = select(problem, curve.level)
    freedom = max(problem.variance.size - len(active), 1)
    chi2, _ = problem.misfit(squared)
    probability = min(float(chi_square_tail(chi2, freedom)), problem.strangeness(squared))
    inflation = widening(chi2 / freedom, probability)
    coefficients = _coefficients(problem, squared, covariance * inflation, active, curve.level, inflation)
    terms = [PROCESSES[x](c.value) for x, c in coefficients.items() if c.value is not None]
    sinusoids = tuple(line.process(curve.dt) for line in lines)
    dominated = regions(problem, squared, problem.covariance(squared) * inflation, curve.level)
    flat = next((region for region in dominated if region.letter == "B"), None)
    if flat is not None:
        coefficients["B"] = replace(coefficients["B"], at=flat.centre)
    return AllanFit(
        curve.level, coefficients, Sum((*terms, *sinusoids)), chi2 / freedom, probability, sinusoids, dominated,
        _correlation_time(curve, Sum(tuple(terms)), coefficients["B"].value), float(problem.tau[0]),
    )  # fmt: skip


def _correlation_time(curve: AllanDeviation, processes: Sum, flat: float | None) -> Estimate | None:
    """Return the middle of the flat part; None for a sum without bias instability.

    Flicker has no correlation time: where the flat part lasts to the end of the curve, the middle is a lower bound.
    """
    if flat is None:
        return None
    smooth = np.sqrt(processes.allan_variance(curve.averaging_time, curve.dt))
    part = measured_flat_part(curve.averaging_time, curve.deviation, smooth, curve.n * curve.dt)
    return part.correlation_time


def _octaves(factor: Integers, usable: Booleans, shortest: float) -> Integers:
    """Return the indices of usable factors about an octave apart, among them the first."""
    chosen: list[int] = []
    for i in np.flatnonzero(usable):
        if not chosen or factor[i] >= OCTAVE * factor[chosen[-1]]:
            chosen.append(int(i))
    fewest = FEWEST_FILTERED if shortest else FEWEST
    if len(chosen) < fewest:
        where = f" above {shortest:.3g} s, where a filter no longer shows" if shortest else ""
        raise ValueError(
            f"{len(chosen)} averaging times an octave apart{where}; a fit needs at least {fewest}: record for longer"
        )
    return np.array(chosen)


def _coefficients(
    problem: Problem, squared: Floats, covariance: Floats, active: list[int], level: float, inflation: float
) -> dict[str, Coefficient]:
    """Return all five coefficients: intervals of the active terms, limits of the others."""
    coefficients: dict[str, Coefficient] = {}
    for t, letter in enumerate(LETTERS):
        if t in active:
            value, variance = squared[t], covariance[active.index(t), active.index(t)]
            ends = interval(float(value), float(variance**0.5), level)
            coefficients[letter] = Coefficient(float(value**0.5), *ends, at=READ_OUT[letter])
            continue
        limit = _upper_limit(problem, squared, active, t, level, inflation)
        coefficients[letter] = Coefficient(None, None, limit, at=READ_OUT[letter])
    return coefficients


def _upper_limit(
    problem: Problem, squared: Floats, active: list[int], term: int, level: float, inflation: float
) -> float:
    """Return a term's upper limit: if this is its size, an estimate as low as this record's has probability 1 - level.

    If the size of the term changes, the fitted other terms, the weights and the scatter change too.
    """
    z = normal_quantile(level) * inflation**0.5

    def reach(size: float) -> float:
        held = np.eye(5)[term] * size
        others, _ = problem.solve(active, held, rounds=2)
        estimate = problem.added(others + held, active, term)
        # An estimate below 0 comes from chance, or from a curve that bends away. It must not make the limit too small.
        return max(estimate.value, 0.0) + z * estimate.sigma

    here = problem.added(squared, active, term)
    plain = max(here.value, 0.0) + z * here.sigma
    low = max(here.value, 0.0) + here.sigma * 1e-3
    while reach(high := STRIDE * low) > high:
        low = high
        if low > FARTHEST * plain:  # so few degrees of freedom, or so bad a fit, that every size is possible
            return float(plain**0.5)
    ends = float(np.log(low)), float(np.log(high))
    if reach(low) <= low:  # no root lies between low and high
        return float(high**0.5)

    def beyond(log_size: float) -> float:
        return float(np.log(reach(float(np.exp(log_size))))) - log_size

    at = optimize.brentq(beyond, *ends, xtol=1e-3)
    return float(np.exp(cast("float", at) / 2))
