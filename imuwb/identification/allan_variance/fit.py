"""One fit of the whole sum Q, N, B, K, R (and lines) to an Allan curve, with intervals.

The Allan variance is linear in Q², N², B², K² and R². The points of a curve are correlated, strongly at
long averaging times, and their covariance follows from the sum itself; so the squares are estimated
by non-negative generalised least squares, the covariance taken from the fit and the fit repeated.
Reading straight lines off parts of the curve, the usual way, is biased where regions overlap.

A term stays in the sum when it is larger than chance makes it in its absence (one-sided, half of
1 - level). One that does not is no zero: it has an upper limit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np
from scipy import optimize

from imuwb.identification.allan_variance.problem import LETTERS, PROCESSES, Problem, whitener
from imuwb.identification.allan_variance.term_selection import ACCEPTED, begin, select
from imuwb.identification.coefficient import READ_OUT, interval
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import chi_square_tail, normal_limit, normal_quantile
from imuwb.stochastic import Sinusoid, Sum

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.identification.allan_variance.overlapping import AllanDeviation
    from imuwb.identification.spectral.lines import Line

    Floats = NDArray[np.float64]

FEWEST, FEWEST_BEHIND = 3, 5  #: averaging times of a fit, and of one that begins where a filter no longer shows
STRIDE = 4.0  #: in squares, of the search for a limit
FARTHEST = 1e4  #: times the limit without the term's own scatter
GAUSS_MARKOV_PEAK = 1.8926  #: Tc, where the Allan deviation of such a process is largest
SHARE = 0.6  #: of the Allan variance; a term with more rules its region


@dataclass(frozen=True, slots=True)
class Region:
    """Averaging times that one term rules, and the slope a free line has there."""

    letter: str
    start: float  #: s
    end: float  #: s
    slope: float
    lower: float
    upper: float
    nominal: float


@dataclass(frozen=True, slots=True)
class CorrelationTime:
    """Tc of the bias instability, s: where the flat region lies."""

    flat_centre: float  #: as the papers read it (Quinchia, table 5), on the log axis
    lower: float  #: the flat region's begin
    upper: float  #: and end
    peak_matched: float  #: of the Gauss-Markov process whose peak, at 1.893 Tc, is that centre

    @staticmethod
    def of(flat: Region) -> CorrelationTime:
        """Return the reading of a flat region."""
        centre = (flat.start * flat.end) ** 0.5
        return CorrelationTime(centre, flat.start, flat.end, centre / GAUSS_MARKOV_PEAK)


@dataclass(frozen=True, eq=False, slots=True)
class AllanFit:
    """A sum of processes fitted to an Allan curve."""

    level: float
    coefficients: dict[str, Coefficient]  #: Q, N, B, K, R
    lines: tuple[Sinusoid, ...]
    processes: Sum
    regions: tuple[Region, ...]
    correlation_time: CorrelationTime | None  #: of the bias instability
    shortest: float  #: s, the averaging time from which on the sum explains the curve
    misfit: float  #: chi-square over its degrees of freedom, from there on
    probability: float  #: of a misfit as large by chance

    def allan_deviation(self, averaging_time: Floats, dt: float) -> Floats:
        """Return the fitted sum's Allan deviation."""
        return np.sqrt(self.processes.allan_variance(averaging_time, dt))


def fit_allan(curve: AllanDeviation, lines: Sequence[Line] = (), shortest: float = 0.0) -> AllanFit:
    """Fit the sum to a curve.

    Args:
        curve: from ``allan(..., "octave")``; denser ones are thinned to about an octave.
        lines: sinusoids found in the spectrum, held as found.
        shortest: s; averaging times below are left out, as those at which a filter shows.

    Raises:
        ValueError: fewer than three averaging times, or a curve that is 0 (a constant channel).
    """
    chosen = _octaves(curve.factor, curve.averaging_time >= shortest, shortest)
    problem = Problem.of(curve, chosen, lines)
    problem = problem.since(begin(problem))
    squared, covariance, active = select(problem, curve.level)
    residual = problem.variance - problem.design @ squared
    spread = problem.covariance(squared)
    freedom = max(residual.size - len(active), 1)
    chi2, _ = problem.misfit(squared)
    probability = min(float(chi_square_tail(chi2, freedom)), problem.strangeness(squared))
    # A sum that does not explain the curve has wider intervals than its statistics say (Birge).
    inflation = max(chi2 / freedom, 1.0) if probability < ACCEPTED else 1.0
    coefficients = _coefficients(problem, squared, covariance * inflation, active, curve.level, inflation)
    terms = [PROCESSES[x](c.value) for x, c in coefficients.items() if c.value is not None]
    sinusoids = tuple(line.process(curve.dt) for line in lines)
    regions = _regions(problem, squared, spread * inflation, curve.level)
    flat = next((r for r in regions if r.letter == "B"), None)
    if flat is not None:
        b = coefficients["B"]
        coefficients["B"] = Coefficient(b.value, b.lower, b.upper, at=(flat.start * flat.end) ** 0.5)
    # A flat part that ends with the record has no centre: flicker has no correlation time, and a slow
    # Gauss-Markov process shows its own only behind the record's end.
    ends = flat is not None and flat.end < problem.tau[-1]
    tc = CorrelationTime.of(flat) if flat is not None and ends else None
    return AllanFit(
        curve.level, coefficients, sinusoids, Sum((*terms, *sinusoids)), regions,
        tc, float(problem.tau[0]), chi2 / freedom, probability,
    )  # fmt: skip


def _octaves(factor: NDArray[np.int64], usable: NDArray[np.bool_], shortest: float) -> NDArray[np.int64]:
    """Return the indices of usable factors about an octave apart, the first and the longest among them."""
    chosen: list[int] = []
    for i in np.flatnonzero(usable):
        if not chosen or factor[i] >= 1.8 * factor[chosen[-1]]:
            chosen.append(int(i))
    fewest = FEWEST_BEHIND if shortest else FEWEST
    if len(chosen) < fewest:
        behind = f" from {shortest:.3g} s on, where a filter no longer shows" if shortest else ""
        message = f"a fit needs at least {fewest} averaging times an octave apart{behind}; there are {len(chosen)}"
        raise ValueError(message)
    return np.array(chosen)


def _coefficients(
    problem: Problem, squared: Floats, covariance: Floats, active: list[int], level: float, inflation: float
) -> dict[str, Coefficient]:
    """Return all five coefficients: intervals of those found, limits of the others."""
    found: dict[str, Coefficient] = {}
    for t, letter in enumerate(LETTERS):
        if t in active:
            value, variance = squared[t], covariance[active.index(t), active.index(t)]
            ends = interval(float(value), float(variance**0.5), level)
            found[letter] = Coefficient(float(value**0.5), *ends, at=READ_OUT[letter])
            continue
        limit = _upper_limit(problem, squared, active, t, level, inflation)
        found[letter] = Coefficient(None, None, limit, at=READ_OUT[letter])
    return found


def _upper_limit(
    problem: Problem, squared: Floats, active: list[int], term: int, level: float, inflation: float
) -> float:
    """Return the largest size a term may have and still, with probability 1 - level, be estimated as low as it is.

    With the size, everything changes: the other terms that fit beside it, the weights, and the scatter.
    """

    def reach(size: float) -> float:
        held = np.eye(5)[term] * size
        others, _ = problem.solve(active, held, rounds=2)
        estimate = problem.added(others + held, active, term)
        # An estimate below 0 is chance, or a curve that bends away: it must not make the limit absurdly small.
        return max(estimate.value, 0.0) + normal_quantile(level) * estimate.sigma * inflation**0.5

    here = problem.added(squared, active, term)
    plain = max(here.value, 0.0) + normal_quantile(level) * here.sigma * inflation**0.5
    low = max(here.value, 0.0) + here.sigma * 1e-3
    while reach(high := STRIDE * low) > high:
        low = high
        if low > FARTHEST * plain:  # so few degrees of freedom, or so bad a fit, that every size is possible
            return float(plain**0.5)
    ends = float(np.log(low)), float(np.log(high))
    if reach(low) <= low:  # the estimate alone reaches no farther
        return float(high**0.5)

    def beyond(log_size: float) -> float:
        return float(np.log(reach(float(np.exp(log_size))))) - log_size

    at = optimize.brentq(beyond, *ends, xtol=1e-3)
    return float(np.exp(cast("float", at) / 2))


def _regions(problem: Problem, squared: Floats, spread: Floats, level: float) -> tuple[Region, ...]:
    """Return where each term makes most (60 %) of the Allan variance, and the slope of a free line there, lines taken off."""
    parts = problem.design * squared
    share = parts / (parts.sum(axis=1) + problem.by_lines)[:, None]
    z = normal_limit(level)
    found: list[Region] = []
    for t, (letter, nominal) in enumerate(zip(LETTERS, (-1.0, -0.5, 0.0, 0.5, 1.0), strict=True)):
        inside = np.flatnonzero(share[:, t] > SHARE)
        inside = inside[problem.variance[inside] > 0]
        if inside.size < 2:  # noqa: PLR2004 - a slope needs two points
            continue
        inside = np.arange(inside[0], inside[-1] + 1)
        y = problem.variance[inside]
        if (y <= 0).any():
            continue
        cov = spread[np.ix_(inside, inside)] / np.outer(y, y)
        design = np.stack([np.ones(inside.size), np.log(problem.tau[inside])], axis=1)
        whiten = whitener(cov)
        inverse = np.linalg.inv((whiten @ design).T @ (whiten @ design))
        slope = float((inverse @ (whiten @ design).T @ (whiten @ np.log(y)))[1]) / 2
        half = float(z * np.sqrt(inverse[1, 1])) / 2
        tau = problem.tau[inside]
        found.append(Region(letter, float(tau[0]), float(tau[-1]), slope, slope - half, slope + half, nominal))
    return tuple(found)
