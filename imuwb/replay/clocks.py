"""How two clocks differ: a receiver's delay, and the rate of the IMU's clock, by the likelihood of a filter's innovations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import optimize

from imuwb.replay.replay import prepare, run
from imuwb.replay.scaled import scaled
from imuwb.replay.statistics import Interval
from imuwb.statistics.distributions import normal_limit

if TYPE_CHECKING:
    from collections.abc import Callable

    from imuwb.log import Floats, Log
    from imuwb.navigation.filter_model import FilterModel

DELAYS = np.arange(-0.5, 0.51, 0.1)  #: s, of the first grid
RATES = np.array([-2e-3, -1e-3, -5e-4, 0.0, 5e-4, 1e-3, 2e-3])  #: likewise
STEPS = np.array([0.05, 0.1, 3e-4, 0.5])  #: of both delays, s, rate, and log of the noise: the first simplex
SMALL = np.array([0.01, 0.01, 2e-5, 0.1])  #: likewise, where the curvature begins to be looked for
RISE = 2.0  #: of the misfit, over which it is taken: what is jagged below does not count
ENDS = 3  #: fixes at each end that do not count: a delay takes some in or out
LOUD = np.log(3.0)  #: log of the factor of white noise at the start: vehicles shake


@dataclass(frozen=True, slots=True)
class Clocks:
    """A receiver's delay and an IMU's clock, with intervals."""

    delay: (
        Interval | None
    )  #: s by which a fix's stamp is later than where its position shows the IMU; None: it was given
    velocity_delay: Interval | None  #: s by which its velocity is older than that; likewise
    rate: Interval | None  #: true seconds in one of the IMU's; likewise
    noise: float  #: factor of the model's white noise under which the log is most likely


def estimate_clocks(
    log: Log, model: FilterModel, receiver: str | None, level: float, *, with_delay: bool = True, with_rate: bool
) -> Clocks:
    """Return delays and rate where the innovations of a filter are most likely, its white noise scaled along with them.

    The same fixes count whatever the delay. Intervals are of the curvature there; infinite, where there is none.

    Args:
        log: the log.
        model: a filter; its own delays and rate are where the search begins.
        receiver: name of the receiver; None: the one that tells most.
        level: of the intervals.
        with_delay: whether the delays of positions and velocities are sought.
        with_rate: whether the clock's rate is sought.

    Raises:
        MissingDataError: as ``prepare``.
    """
    before = model.installation
    untouched = prepare(log, model, receiver)
    row = untouched.found.fix
    counted = (int(row[untouched.start.event]) + ENDS, int(row.max()) - ENDS)

    def misfit(delay: float, later: float, rate: float, noise: float) -> float:
        factor = float(np.exp(noise))
        tried = replace(
            model, error_model=scaled(model.error_model, (factor, factor)),
            installation=replace(
                before, gnss_delay=before.gnss_delay + delay, velocity_delay=before.velocity_delay + later or 1e-9,
                clock_rate=before.clock_rate + rate,
            ),
        )  # fmt: skip
        return -run(tried, prepare(log, tried, receiver)).log_likelihood_of(*counted)

    delays = DELAYS if with_delay else np.zeros(1)
    rates = RATES if with_rate else np.zeros(1)
    grid = [(misfit(float(d), 0.0, float(r), LOUD), float(d), float(r)) for r in rates for d in delays]
    _, coarse, rate = min(grid)
    free = np.array([with_delay, with_delay, with_rate, True])

    def objective(x: Floats) -> float:
        full = np.zeros(4)
        full[free] = x
        full[1] -= full[0]  # sought: when positions are, and when velocities are; they hardly depend on each other
        return misfit(*(float(v) for v in full))

    start = np.array([coarse, coarse, rate, LOUD])[free]
    best = optimize.minimize(
        objective, start, method="Nelder-Mead",
        options={
            "initial_simplex": np.vstack([start, start + np.diag(STEPS[free])]), "xatol": 1e-5, "fatol": 0.05, "maxfev": 300,
        },
    )  # fmt: skip
    # A velocity counts at a sample: over less than a few of them its likelihood is a stair.
    length = float(np.ptp(untouched.moves.time))
    least = np.array([2.0, 2.0, 4.0 / length, 0.0]) * untouched.moves.interval
    covariance = _covariance(objective, best.x, np.maximum(SMALL, least)[free])
    if with_delay:
        turn = np.eye(best.x.size)
        turn[1, 0] = -1.0  # back to how much older velocities are
        covariance, best.x = turn @ covariance @ turn.T, turn @ best.x
    spread = np.diagonal(covariance)
    half = normal_limit(level) * np.sqrt(np.where(spread > 0, spread, np.inf))
    value, width = np.zeros(4), np.zeros(4)
    value[free], width[free] = best.x, half
    first = before.gnss_delay, before.velocity_delay, before.clock_rate
    delay, later, slope = (
        Interval(f + float(v), f + float(v - w), f + float(v + w))
        for f, v, w in zip(first, value[:3], width[:3], strict=True)
    )
    return Clocks(
        delay if with_delay else None,
        later if with_delay else None,
        slope if with_rate else None,
        float(np.exp(value[3])),
    )


def _covariance(objective: Callable[[Floats], float], at: Floats, step: Floats) -> Floats:
    """Return the inverse of a function's curvature, by differences."""
    n = at.size
    centre = objective(at)
    step = step.copy()
    for i in range(n):
        unit = np.eye(n)[i]
        for _ in range(8):
            if objective(at + step[i] * unit) + objective(at - step[i] * unit) - 2 * centre >= 2 * RISE:
                break
            step[i] *= 1.6
    hessian = np.zeros((n, n))
    for i in range(n):
        for j in range(i + 1):
            a, b = np.zeros(n), np.zeros(n)
            a[i], b[j] = step[i], step[j]
            if i == j:
                hessian[i, i] = (objective(at + a) - 2 * centre + objective(at - a)) / step[i] ** 2
            else:
                mixed = objective(at + a + b) - objective(at + a - b) - objective(at - a + b) + objective(at - a - b)
                hessian[i, j] = hessian[j, i] = mixed / (4 * step[i] * step[j])
    return np.asarray(np.linalg.pinv(hessian), dtype=np.float64)
