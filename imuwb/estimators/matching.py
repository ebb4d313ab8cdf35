"""The random walk, or the Gauss-Markov process, that stands for a sensor's slow errors in an estimator that has only these.

Both are chosen so that the estimator's drift after a horizon without aids is true. That is exact where the sensor has the
process itself; else the match is exact at the horizon for one number of integrations, and the error elsewhere is stated.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

from imuwb.estimators.growth import averaged, predicted_variance, slow_part, true_variance
from imuwb.stochastic import GaussMarkov, RandomWalk, Sum

LONG = (
    60.0  #: horizons: the correlation time that makes a Gauss-Markov process a random walk (sd of position 0.995 of it)
)
_WIDEST = 1e6  #: range in which K is searched, about the value of the window rule, as a factor either way
INTEGRALS = (1, 2, 3)


@dataclass(frozen=True, slots=True)
class Match:
    """A process that stands for others, and its standard deviation after the horizon over the true one."""

    process: RandomWalk | GaussMarkov
    exact: bool  #: whether the sensor has this process itself
    ratios: tuple[float, float, float]  #: predicted over true, for one, two and three integrations


@lru_cache(256)
def as_walk(processes: Sum, white: float | None, horizon: float, times: int) -> Match | None:
    """Return the random walk for all slow processes; None where there is none.

    K makes the standard deviation that a filter of N and K predicts after the horizon the true one. Without white noise
    the bias is taken as the mean over one horizon before, which is the rule of the Allan deviation at the horizon.

    Args:
        processes: those of one axis, SI.
        white: N, through which the filter sees the axis.
        horizon: s without aids.
        times: how many times the error is integrated.
    """
    slow = slow_part(processes)
    if not slow.terms:
        return None
    if all(isinstance(term, RandomWalk) for term in slow.terms):
        return Match(
            RandomWalk(math.hypot(*(term.K for term in slow.terms if isinstance(term, RandomWalk)))),
            True,
            (1.0, 1.0, 1.0),
        )
    start = _by_window(slow, horizon, times)
    if start == 0:
        return None
    if not white:
        ratios = [start / _by_window(slow, horizon, k) for k in INTEGRALS]
        return Match(RandomWalk(start), False, (ratios[0], ratios[1], ratios[2]))
    from scipy.optimize import brentq  # noqa: PLC0415 - scipy is slow to import

    def excess(log_walk: float) -> float:
        walk = math.exp(log_walk)
        return math.log(
            predicted_variance(white, walk, horizon, times) / true_variance(slow, white, walk, horizon, times)
        )

    middle, reach = math.log(start), math.log(_WIDEST)
    walk = math.exp(brentq(excess, middle - reach, middle + reach, xtol=1e-6))
    ratios = [
        math.sqrt(predicted_variance(white, walk, horizon, k) / true_variance(slow, white, walk, horizon, k))
        for k in INTEGRALS
    ]
    return Match(RandomWalk(walk), False, (ratios[0], ratios[1], ratios[2]))


@lru_cache(256)
def as_gauss_markov(processes: Sum, horizon: float, times: int) -> Match | None:
    """Return the Gauss-Markov process for all slow processes; None where there is none.

    It drifts like them over the horizon and over a third of it, the bias being the mean over as long a time before.
    """
    slow = slow_part(processes)
    if not slow.terms:
        return None
    if len(slow.terms) == 1 and isinstance(slow.terms[0], GaussMarkov):
        return Match(slow.terms[0], True, (1.0, 1.0, 1.0))
    true, third = (_drift(slow, t, times) for t in (horizon, horizon / 3))
    if true == 0:
        return None
    from scipy.optimize import brentq  # noqa: PLC0415 - scipy is slow to import

    def excess(log_time: float) -> float:
        unit = Sum((GaussMarkov(1.0, math.exp(log_time)),))
        return math.log(_drift(unit, horizon, times) / _drift(unit, horizon / 3, times)) - math.log(true / third)

    shortest, longest = math.log(horizon / 100), math.log(LONG * horizon)
    if excess(longest) <= 0:
        time = LONG * horizon
    else:
        time = math.exp(brentq(excess, shortest, longest, xtol=1e-6)) if excess(shortest) < 0 else horizon / 100
    sigma = math.sqrt(true / _drift(Sum((GaussMarkov(1.0, time),)), horizon, times))
    process = GaussMarkov(sigma, time)
    ratios = [math.sqrt(_drift(Sum((process,)), horizon, k) / _drift(slow, horizon, k)) for k in INTEGRALS]
    return Match(process, all(isinstance(term, RandomWalk) for term in slow.terms), (ratios[0], ratios[1], ratios[2]))


def _drift(slow: Sum, horizon: float, times: int) -> float:
    return averaged(horizon, times, horizon).variance(slow)


def _by_window(slow: Sum, horizon: float, times: int) -> float:
    """Return K of the walk that has the same variance when the bias is the mean over one horizon before."""
    return math.sqrt(_drift(slow, horizon, times) / _drift(Sum((RandomWalk(1.0),)), horizon, times))
