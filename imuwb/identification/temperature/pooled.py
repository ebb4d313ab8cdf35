"""Q, B and K from all temperatures together, assuming that each has one value; N differs with temperature.

A single record determines a square badly, and a square cannot be negative: a mean of such estimates is biased. So the likelihoods
are maximised together, by Fisher scoring, with N eliminated.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.coefficient import READ_OUT, interval
from imuwb.identification.likelihood.fit import TERMS, fit_problem
from imuwb.identification.likelihood.problem import nonnegative
from imuwb.identification.temperature.set_point import LETTERS, SetPoint
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import normal_quantile

ROUNDS, CLOSE = 60, 1e-3  #: largest number of rounds of the scoring, and the change of the deviance at which it ends
RANK = 1e-12  #: share of the largest eigenvalue of an information matrix; smaller ones count as 0
LEAST_STEP = 1e-3  #: share of a step, below which the scoring ends
DOUBLINGS, HALVINGS = 30, 6  #: largest numbers of doublings and halvings of a square in the search for a limit


@dataclass(frozen=True, eq=False, slots=True)
class Pooled:
    """The likeliest squares."""

    squares: Floats  #: (k, t) squares at k temperatures of t terms
    deviance: float
    information: Floats  #: (t, t) information of the common squares, with those that differ with temperature eliminated


def pooled(points: Sequence[SetPoint], level: float = 0.95, own: Collection[str] = ()) -> dict[str, Coefficient]:
    """Return the coefficients common to all temperatures, with intervals or limits.

    Args:
        points: one for each temperature.
        level: confidence level of the intervals and limits.
        own: letters, besides N, that differ with temperature.
    """
    absent = {letter for point in points for letter in point.absent}
    common = [t for t, letter in enumerate(TERMS) if letter not in {"N", *own, *absent}]
    mine = [t for t, letter in enumerate(TERMS) if letter in {"N", *own} and letter not in absent]
    start = np.array([p.squared for p in points])
    start[:, common] = np.median(start[:, common], axis=0)
    best = _climbed(points, start, common, mine)
    letters = list(TERMS)
    return {letters[t]: _coefficient(points, best, t, common, mine, level) for t in common}


def settled(points: Sequence[SetPoint], level: float = 0.95) -> tuple[tuple[SetPoint, ...], dict[str, Coefficient]]:
    """Return set-points of one axis, and the common coefficients; without quantization if all set-points together do not show it.

    Quantization and random walk share the upper end of the spectrum: a free quantization term that is absent doubles the error of
    N. The limits of quantization remain those of the fit with the free term.
    """
    together = pooled(points, level)
    if together["Q"].value is not None:
        return tuple(points), together
    without = tuple(_without_quantization(p, level) for p in points)
    return without, pooled(without, level) | {"Q": together["Q"]}


def _without_quantization(point: SetPoint, level: float) -> SetPoint:
    if point.coefficients["Q"].value is None:
        return replace(point, absent=("Q",))
    fit = fit_problem(point.problem, level, without="Q")
    coefficients = {letter: fit.coefficients[letter] for letter in LETTERS}
    absent = replace(point.coefficients["Q"], value=None, lower=None)
    return replace(point, coefficients=coefficients | {"Q": absent}, fit=fit, absent=("Q",))


def _coefficient(
    points: Sequence[SetPoint], best: Pooled, term: int, common: list[int], mine: list[int], level: float
) -> Coefficient:
    square, at = float(best.squares[0, term]), READ_OUT[list(TERMS)[term]]
    if square > 0:
        active = [t for t in common if best.squares[0, t] > 0]
        place = active.index(term)
        variance = _inverse(best.information[np.ix_(active, active)])[place, place]
        ends = interval(square, float(variance) ** 0.5, level)
        if ends[0] > 0:
            return Coefficient(square**0.5, *ends, at=at)
    return Coefficient(None, None, _limit(points, best, term, common, mine, level) ** 0.5, at=at)


def _limit(
    points: Sequence[SetPoint], best: Pooled, term: int, common: list[int], mine: list[int], level: float
) -> float:
    """Return the square at which the joint likelihood reaches the limit's level, with the other terms likeliest."""
    reach = normal_quantile(level) ** 2
    others = [t for t in common if t != term]

    def loss(square: float) -> float:
        start = best.squares.copy()
        start[:, term] = square
        return _climbed(points, start, others, mine).deviance - best.deviance

    low = float(best.squares[0, term])
    high = low + normal_quantile(level) / float(best.information[term, term]) ** 0.5
    for _ in range(DOUBLINGS):
        if loss(high) > reach:
            break
        low, high = high, 2 * high
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if loss(middle) < reach else (low, middle)
    return high


def _climbed(points: Sequence[SetPoint], squares: Floats, common: list[int], mine: list[int]) -> Pooled:
    """Return the likeliest squares: one value of ``common``, one for each temperature of ``mine``; the others are fixed."""
    deviance = _deviance(points, squares)
    information = np.zeros((squares.shape[1], squares.shape[1]))
    for _ in range(ROUNDS):
        wanted, information = _target(points, squares, common, mine)
        step, now = 1.0, np.inf
        while step > LEAST_STEP:
            following = squares + step * (wanted - squares)
            now = _deviance(points, following)
            if now <= deviance + 1e-9 * abs(deviance):
                break
            step /= 2
        if not now <= deviance:
            break
        done, squares, deviance = deviance - now <= CLOSE, squares + step * (wanted - squares), now
        if done:
            break
    return Pooled(squares, deviance, information)


def _target(points: Sequence[SetPoint], squares: Floats, common: list[int], mine: list[int]) -> tuple[Floats, Floats]:
    """Return the next squares of the scoring, none negative, and the information of the common ones."""
    count = squares.shape[1]
    total, target = np.zeros((count, count)), np.zeros(count)
    parts: list[tuple[Floats, Floats, Floats]] = []
    for point, square in zip(points, squares, strict=True):
        slope, information = (part / point.inflation for part in point.problem.slope(square, ramp=point.ramped))
        inner = _inverse(information[np.ix_(mine, mine)])
        across = information[np.ix_(common, mine)] @ inner
        total[np.ix_(common, common)] += (
            information[np.ix_(common, common)] - across @ information[np.ix_(mine, common)]
        )
        target[common] += slope[common] - across @ slope[mine]
        parts.append((slope, information, inner))
    wanted = squares.copy()
    if common:
        here = squares[0, common]
        inside = total[np.ix_(common, common)]
        wanted[:, common] = nonnegative(inside, inside @ here + target[common], RANK)
    for row, (slope, information, inner) in enumerate(parts):
        change = wanted[row, common] - squares[row, common]
        moved = squares[row, mine] + inner @ (slope[mine] - information[np.ix_(mine, common)] @ change)
        wanted[row, mine] = np.maximum(moved, squares[row, mine] / 10)
    return wanted, total


def _inverse(matrix: Floats) -> Floats:
    size = np.sqrt(matrix.diagonal()).clip(1e-150)
    return np.linalg.pinv(matrix / np.outer(size, size), rcond=RANK, hermitian=True) / np.outer(size, size)


def _deviance(points: Sequence[SetPoint], squares: Floats) -> float:
    return sum(
        p.problem.deviance(square, ramp=p.ramped) / p.inflation for p, square in zip(points, squares, strict=True)
    )
