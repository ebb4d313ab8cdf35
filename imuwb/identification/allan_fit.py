"""One fit of the whole sum Q, N, B, K, R (and lines) to an Allan curve, with intervals.

The Allan variance is linear in Q², N², B², K² and R². The points of a curve are correlated, strongly at
long averaging times, and their covariance follows from the sum itself; so the squares are estimated
by non-negative generalised least squares, the covariance taken from the fit and the fit repeated.
Reading straight lines off parts of the curve, the usual way, biases N by a tenth and K by a factor of
two where regions overlap.

A term stays in the sum when it is larger than chance makes it in its absence (one-sided, half of
1 - level). One that does not is no zero: it has an upper limit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg, optimize, stats

from imuwb.identification.allan_statistics import Moments, moments
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, RateRamp, Sinusoid, Sum, WhiteNoise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.identification.allan import AllanDeviation
    from imuwb.identification.lines import Line

    Floats = NDArray[np.float64]

LETTERS = ("Q", "N", "B", "K", "R")
_PROCESS = {"Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk, "R": RateRamp}
#: averaging time at which IEEE reads a coefficient off its own line (B: off the flat part)
READ_OUT = {"Q": 3**0.5, "N": 1.0, "B": None, "K": 3.0, "R": 2**0.5}
ROUNDS = 6
ACCEPTED = 1e-3  #: probability of a misfit as large; below it the sum does not explain the curve
LEAST_EIGENVALUE = 1e-9  #: of a correlation matrix
BEYOND_DOUBT = 8.0  #: sigmas; a term this large is not tried without
SHARE = 0.6  #: of the Allan variance; a term with more rules its region


@dataclass(frozen=True, slots=True)
class Coefficient:
    """One coefficient in SI. ``value`` None: not identified, ``upper`` its limit."""

    value: float | None
    lower: float | None
    upper: float
    at: float | None  #: s, where it is read off; None for B without a flat region


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


@dataclass(frozen=True, eq=False, slots=True)
class AllanFit:
    """A sum of processes fitted to an Allan curve."""

    level: float
    coefficients: dict[str, Coefficient]  #: Q, N, B, K, R
    lines: tuple[Sinusoid, ...]
    processes: Sum
    regions: tuple[Region, ...]
    correlation_time: tuple[float, float] | None  #: s: centre of the flat region as the papers read it; peak-matched
    shortest: float  #: s, the averaging time from which on the sum explains the curve
    misfit: float  #: chi-square over its degrees of freedom, from there on
    probability: float  #: of a misfit as large by chance

    def allan_deviation(self, averaging_time: Floats, dt: float) -> Floats:
        """Return the fitted sum's Allan deviation."""
        return np.sqrt(self.processes.allan_variance(averaging_time, dt))


def fit_allan(curve: AllanDeviation, lines: Sequence[Line] = ()) -> AllanFit:
    """Fit the sum to a curve.

    Args:
        curve: from ``allan(..., "octave")``; denser ones are thinned to about an octave.
        lines: sinusoids found in the spectrum, held as found.

    Raises:
        ValueError: fewer than three averaging times, or a curve that is 0 (a constant channel).
    """
    chosen = _octaves(curve.factor)
    problem = _Problem.of(curve, chosen, lines)
    first, active = _begin(problem)
    problem = problem.since(first)
    squared, covariance, active = _select(problem, curve.level)
    residual = problem.variance - problem.design @ squared
    spread = problem.covariance(squared)
    freedom = max(residual.size - len(active), 1)
    chi2 = float(np.sum(problem.whiten(squared, residual) ** 2))
    probability = float(stats.chi2.sf(chi2, freedom))
    # A sum that does not explain the curve has wider intervals than its statistics say (Birge).
    inflation = max(chi2 / freedom, 1.0) if probability < ACCEPTED else 1.0
    coefficients = _coefficients(problem, squared, covariance * inflation, active, curve.level, inflation)
    terms = [_PROCESS[x](c.value) for x, c in coefficients.items() if c.value is not None]
    sinusoids = tuple(Sinusoid(line.amplitude, line.frequency) for line in lines)
    regions = _regions(problem, squared, spread * inflation, curve.level)
    flat = next((r for r in regions if r.letter == "B"), None)
    centre = None if flat is None else (flat.start + flat.end) / 2
    if centre is not None:
        b = coefficients["B"]
        coefficients["B"] = Coefficient(b.value, b.lower, b.upper, centre)
    return AllanFit(
        curve.level, coefficients, sinusoids, Sum((*terms, *sinusoids)), regions,
        None if centre is None else (centre, centre / 1.8926), float(problem.tau[0]), chi2 / freedom, probability,
    )  # fmt: skip


def _octaves(factor: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the indices of factors about an octave apart, the first and the longest among them."""
    chosen = [0]
    for i in range(1, factor.size):
        if factor[i] >= 1.8 * factor[chosen[-1]]:
            chosen.append(i)
    if len(chosen) < 3:  # noqa: PLR2004 - five coefficients from fewer points are none
        message = f"a fit needs at least 3 averaging times an octave apart; there are {len(chosen)}"
        raise ValueError(message)
    return np.array(chosen)


@dataclass(frozen=True, eq=False, slots=True)
class _Problem:
    """Allan variances to be explained: design @ (Q², N², B², K², R²) + lines."""

    dt: float
    tau: Floats  #: (k,)
    variance: Floats  #: (k,) less what the lines make
    design: Floats  #: (k, 5)
    of_lines: Floats  #: (k, k) covariance from the lines' own uncertainty
    moments: Moments

    @staticmethod
    def of(curve: AllanDeviation, chosen: NDArray[np.int64], lines: Sequence[Line]) -> _Problem:
        factor, tau = curve.factor[chosen], curve.averaging_time[chosen]
        n = int(curve.terms[0]) + 2 * int(curve.factor[0]) - 1
        factor_fits = factor <= n // 2
        chosen, factor, tau = chosen[factor_fits], factor[factor_fits], tau[factor_fits]
        variance = curve.deviation[chosen] ** 2
        if not variance.all():
            message = "the Allan variance is 0: the channel is constant"
            raise ValueError(message)
        units = [_PROCESS[letter](1.0) for letter in LETTERS]
        design = np.stack([unit.allan_variance(tau, curve.dt) for unit in units], axis=1)
        of_lines = np.zeros((tau.size, tau.size))
        for line in lines:
            shape = Sinusoid(1.0, line.frequency).allan_variance(tau, curve.dt)
            variance = variance - line.amplitude**2 * shape
            of_lines += np.outer(shape, shape) * line.power_sigma**2
        return _Problem(curve.dt, tau, variance, design, of_lines, moments(tuple(int(m) for m in factor), n))

    def since(self, first: int) -> _Problem:
        """Return the problem without its ``first`` shortest averaging times."""
        rest = slice(first, None)
        m = self.moments
        kept = Moments(m.factor[rest], m.squares[rest, rest], m.linear[rest, rest])
        return _Problem(
            self.dt, self.tau[rest], self.variance[rest], self.design[rest], self.of_lines[rest, rest], kept
        )

    def covariance(self, squared: Floats) -> Floats:
        """Return the covariance of the variances if these coefficients are true."""
        return self.moments.covariance(squared[:4], float(np.sqrt(squared[4])), self.dt) + self.of_lines

    def whiten(self, squared: Floats, columns: Floats) -> Floats:
        """Return columns in which the errors, if these coefficients are true, are independent and of size 1."""
        return _whitener(self.covariance(squared)) @ columns

    def solve(self, active: Sequence[int], held: Floats | None = None) -> tuple[Floats, Floats]:
        """Return the squares, none negative, of the active terms (0 elsewhere), and the covariance of those.

        ``held``: (5,) squares of other terms that are in the sum, but not free.
        """
        squared = np.zeros(5)
        held = np.zeros(5) if held is None else held
        variance = self.variance - self.design @ held
        weight = 1 / self.variance.clip(np.abs(self.variance).max() * 1e-12)
        scaled = self.design[:, active] * weight[:, None]
        squared[list(active)] = optimize.nnls(scaled, variance * weight)[0]
        columns = self.design[:, active]
        information = np.eye(len(active))
        for _ in range(ROUNDS):
            white = self.whiten(squared + held, columns)
            size = np.linalg.norm(white, axis=0)
            fitted = optimize.nnls(white / size, self.whiten(squared + held, variance))[0] / size
            before = squared[list(active)]
            squared[list(active)] = fitted
            information = white.T @ white
            if np.allclose(before, fitted, rtol=1e-5, atol=0):
                break
        return squared, np.asarray(linalg.pinvh(information))

    def added(self, squared: Floats, active: Sequence[int], extra: int) -> _Estimate:
        """Return the free estimate of one more term's square, and how it scatters if ``squared`` is true."""
        columns = self.design[:, [*active, extra]]
        covariance = self.covariance(squared)
        whitener = _whitener(covariance)
        white = whitener @ columns
        size = np.linalg.norm(white, axis=0)
        inverse = np.asarray(linalg.pinvh((white / size).T @ (white / size)))
        weights = (inverse @ (white / size).T @ whitener)[-1] / size[-1]
        # Each Allan variance is about a scaled chi-square, whose third cumulant is 8 E³ / edf² = 2 var² / E.
        expected = self.design @ squared
        scatter = np.diag(covariance)
        sigma = float(np.sqrt(inverse[-1, -1]) / size[-1])
        third = np.divide(2 * weights**3 * scatter**2, expected, out=np.zeros_like(expected), where=expected > 0)
        skewness = float(third.sum()) / sigma**3
        return _Estimate(float(weights @ self.variance), sigma, skewness)


@dataclass(frozen=True, slots=True)
class _Estimate:
    value: float
    sigma: float
    skewness: float

    def quantile(self, probability: float) -> float:
        """Return how far above the truth the estimate is found with this probability, in sigmas (Pearson III)."""
        skewness = float(np.clip(self.skewness, 0.0, 4.0))
        return float(stats.pearson3.ppf(probability, skewness))


def _whitener(covariance: Floats) -> Floats:
    """Return W with W covariance W' = 1.

    Far from the truth, points may hang together so closely that rounding shows: the least eigenvalue is held.
    """
    size = np.sqrt(np.diag(covariance))
    size = np.where(size > 0, size, size.max() or 1.0)  # a ramp alone does not scatter
    values, vectors = linalg.eigh(covariance / np.outer(size, size))
    return (vectors / np.sqrt(np.maximum(values, LEAST_EIGENVALUE))).T / size


def _begin(problem: _Problem) -> tuple[int, list[int]]:
    """Return how many of the shortest averaging times to leave out so that the sum explains the rest.

    A sensor's own filter, or its resonances, bend the short end of the curve; no sum of these
    processes follows. Nothing is left out when no cut helps.
    """
    k = problem.tau.size
    best, best_misfit = 0, np.inf
    for first in range(max(k - 6, 1)):
        part = problem.since(first)
        squared, _, active = _select(part, 0.95)
        residual = part.variance - part.design @ squared
        freedom = max(part.tau.size - len(active), 1)
        chi2 = float(np.sum(part.whiten(squared, residual) ** 2))
        if stats.chi2.sf(chi2, freedom) > ACCEPTED:
            return first, active
        if chi2 / freedom < best_misfit / 2:  # a cut must pay for what it leaves out
            best, best_misfit = first, chi2 / freedom
    return best, []


def _select(problem: _Problem, level: float) -> tuple[Floats, Floats, list[int]]:
    """Fit all terms, then leave out, one by one, those that chance explains."""
    active = list(range(5))
    while True:
        squared, covariance = problem.solve(active)
        zero = [t for t in active if squared[t] == 0]
        if zero:
            active = [t for t in active if t not in zero]
            continue
        if len(active) == 1:
            return squared, covariance, active
        ratios: dict[int, float] = {}  # of each term, to what chance makes of it in its absence
        for place, t in enumerate(active):
            rest = [u for u in active if u != t]
            ratios[t] = float(squared[t] / np.sqrt(covariance[place, place]))
            if ratios[t] > BEYOND_DOUBT:
                continue
            without, _ = problem.solve(rest)
            estimate = problem.added(without, rest, t)
            ratios[t] = estimate.value / (estimate.sigma * estimate.quantile((1 + level) / 2))
        weakest = min(ratios, key=lambda t: ratios[t])
        if ratios[weakest] > 1:
            return squared, covariance, active
        active.remove(weakest)


def _coefficients(
    problem: _Problem, squared: Floats, covariance: Floats, active: list[int], level: float, inflation: float
) -> dict[str, Coefficient]:
    """Return all five coefficients: intervals of those found, limits of the others."""
    found: dict[str, Coefficient] = {}
    tail = (1 - level) / 2
    for t, letter in enumerate(LETTERS):
        if t in active:
            value, variance = squared[t], covariance[active.index(t), active.index(t)]
            # A positive quadratic estimate is about a scaled chi-square: skewed when few degrees are left.
            freedom = 2 * value**2 / variance
            lower, upper = (value * freedom / stats.chi2.ppf(q, freedom) for q in (1 - tail, tail))
            found[letter] = Coefficient(float(value**0.5), float(lower**0.5), float(upper**0.5), READ_OUT[letter])
            continue
        limit = _upper_limit(problem, squared, active, t, level, inflation)
        found[letter] = Coefficient(None, None, limit, READ_OUT[letter])
    return found


def _upper_limit(
    problem: _Problem, squared: Floats, active: list[int], term: int, level: float, inflation: float
) -> float:
    """Return the largest size a term may have and still, with probability 1 - level, be estimated as low as it is.

    With the size, everything changes: the other terms that fit beside it, the weights, and the scatter.
    """

    def reach(size: float) -> float:
        held = np.eye(5)[term] * size
        others, _ = problem.solve(active, held)
        estimate = problem.added(others + held, active, term)
        return estimate.value + stats.norm.ppf(level) * estimate.sigma * inflation**0.5

    here = problem.added(squared, active, term)
    low = max(here.value, 0.0) + here.sigma * 1e-3
    while reach(high := 1.5 * low) > high:
        low = high
    for _ in range(12):
        middle = (low * high) ** 0.5
        low, high = (middle, high) if reach(middle) > middle else (low, middle)
    return float(high**0.5)


def _regions(problem: _Problem, squared: Floats, spread: Floats, level: float) -> tuple[Region, ...]:
    """Return where each term makes more than half of the Allan variance, with a freely fitted slope."""
    parts = problem.design * squared
    share = parts / parts.sum(axis=1, keepdims=True)
    z = stats.norm.ppf((1 + level) / 2)
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
        whiten = _whitener(cov)
        inverse = np.linalg.inv((whiten @ design).T @ (whiten @ design))
        slope = float((inverse @ (whiten @ design).T @ (whiten @ np.log(y)))[1]) / 2
        half = float(z * np.sqrt(inverse[1, 1])) / 2
        tau = problem.tau[inside]
        found.append(Region(letter, float(tau[0]), float(tau[-1]), slope, slope - half, slope + half, nominal))
    return tuple(found)
