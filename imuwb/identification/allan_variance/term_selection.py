"""Which terms a curve shows, and the averaging time from which their sum explains it."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.allan_variance.problem import Problem
from imuwb.identification.sum_fit import ACCEPTED
from imuwb.statistics.distributions import chi_square_tail

MUCH = 15.0  #: reduction of chi-square that justifies leaving out one point, or taking a term back
FEWEST_POINTS = 6  #: least number of points that a fit keeps
BEYOND_DOUBT = 8.0  #: sigmas; a term this large stays without a test


def first_time(problem: Problem) -> int:
    """Return how many of the shortest averaging times to leave out so that the sum explains the rest.

    A sensor's own filter, or its resonances, bend the short end of the curve, and no sum of these processes can follow. The
    points there are precise, so the misfit is large. A cut must reduce the misfit by far more than the part that chance
    gives to the points left out. Nothing is left out when no cut helps.
    """
    misfits: list[float] = []
    for first in range(max(problem.tau.size - FEWEST_POINTS, 1)):
        part = problem.since(first)
        try:
            squared, _, active = select(part, 0.95)
        except ValueError:  # no term is left at these times; a fit with an earlier first time may be possible
            if not first:
                raise
            break
        chi2, _ = part.misfit(squared)
        pays = not first or misfits[0] - chi2 > MUCH * (first + 1)
        if pays and chi_square_tail(chi2, max(part.tau.size - len(active), 1)) > ACCEPTED:
            return first
        misfits.append(chi2)
    gains = [misfits[0] - chi2 - MUCH * (first + 1) for first, chi2 in enumerate(misfits)]
    return int(np.argmax(gains)) if max(gains) > 0 else 0


def select(problem: Problem, level: float) -> tuple[Floats, Floats, list[int]]:
    """Return squares, covariance and indices of the terms that chance does not explain.

    The fit begins with all terms and leaves out the weakest, one by one. A ramp and a random walk look alike over the last
    octaves, so one can displace the other and then be left out itself. Therefore the terms left out are tried again at the
    end. Where the rest does not explain the curve, the term that makes the curve much more likely comes back for good.
    """
    active, kept = list(range(5)), set[int]()
    tried: set[tuple[int, ...]] = set()
    while True:
        active = _without_weak(problem, active, kept, level)
        tried.add(tuple(active))
        squared, covariance = problem.solve(active)
        rest = [t for t in range(5) if t not in active and tuple(sorted((*active, t))) not in tried]
        ratios = {t: _ratio(problem, squared, active, t, level) for t in rest}
        back = max(ratios, key=ratios.__getitem__, default=None)
        if back is None or ratios[back] <= 1:
            back = _missing(problem, squared, active, rest)
            kept |= set() if back is None else {back}
        if back is None:
            return squared, covariance, active
        active = sorted((*active, back))
        tried.add(tuple(active))


def _missing(problem: Problem, squared: Floats, active: list[int], rest: list[int]) -> int | None:
    """Return the term that an unexplained curve needs most; None where no term makes the curve much more likely."""
    chi2, surprise = problem.misfit(squared)
    if not rest or chi_square_tail(chi2, max(problem.tau.size - len(active), 1)) > ACCEPTED:
        return None
    surprises = {t: problem.misfit(problem.solve(sorted((*active, t)))[0])[1] for t in rest}
    best = min(surprises, key=surprises.__getitem__)
    return best if surprise - surprises[best] > MUCH else None


def _without_weak(problem: Problem, active: list[int], kept: set[int], level: float) -> list[int]:
    """Return the terms to be kept, and those that are larger than chance would make them if they were absent."""
    while len(active) > 1:
        squared, covariance = problem.solve(active)
        zero = [t for t in active if squared[t] == 0]
        if len(zero) == len(active):
            raise ValueError("the periodic lines explain the whole curve; nothing is left for the noise processes")
        if zero:
            active = [t for t in active if t not in zero]
            continue
        ratios: dict[int, float] = {}
        for place, t in enumerate(active):
            rest = [u for u in active if u != t]
            if t in kept or squared[t] > BEYOND_DOUBT * np.sqrt(covariance[place, place]):
                continue
            ratios[t] = _ratio(problem, problem.solve(rest)[0], rest, t, level)
        weakest = min(ratios, key=ratios.__getitem__, default=None)
        if weakest is None or ratios[weakest] > 1:
            break
        active = [t for t in active if t != weakest]
    return active


def _ratio(problem: Problem, squared: Floats, active: list[int], term: int, level: float) -> float:
    """Return a term's size over the size that chance exceeds with probability (1 - level)/2 if the term is absent."""
    estimate = problem.added(squared, active, term)
    return estimate.value / (estimate.sigma * estimate.quantile((1 + level) / 2))
