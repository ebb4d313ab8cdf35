"""How two clocks differ: a receiver's delay, and the rate of the IMU's clock, by the likelihood of a filter's innovations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import optimize

from imuwb.identification.distributions import normal_limit
from imuwb.replay.replay import prepare, run
from imuwb.replay.scaled import scaled
from imuwb.replay.statistics import Interval

if TYPE_CHECKING:
    from collections.abc import Callable

    from imuwb.log import Floats, Log
    from imuwb.navigation.filter_model import FilterModel

COARSE = np.arange(-0.5, 0.51, 0.1)  #: s
STEPS = np.array([0.05, 0.1, 2e-4, 0.5])  #: of both delays, s, rate, and log of the noise: the first simplex
SMALL = np.array([0.01, 0.01, 2e-5, 0.1])  #: likewise, of the curvature
LOUD = np.log(3.0)  #: log of the factor of white noise at the start: vehicles shake


@dataclass(frozen=True, slots=True)
class Clocks:
    """A receiver's delay and an IMU's clock, with intervals."""

    delay: Interval  #: s by which a fix's stamp is later than where its position shows the IMU
    velocity_delay: Interval  #: s by which its velocity is older than that
    rate: Interval | None  #: true seconds in one of the IMU's; None: it was not asked for
    noise: float  #: factor of the model's white noise under which the log is most likely


def estimate_clocks(log: Log, model: FilterModel, receiver: str | None, level: float, *, with_rate: bool) -> Clocks:
    """Return delay and rate where the innovations of a filter are most likely, its white noise scaled along with them.

    Intervals are of the curvature there.

    Args:
        log: the log.
        model: a filter; its own delay and rate are where the search begins.
        receiver: name of the receiver; None: the first.
        level: of the intervals.
        with_rate: whether the clock's rate is sought, too.

    Raises:
        MissingDataError: as ``prepare``.
    """
    before = model.installation

    def misfit(delay: float, later: float, rate: float, noise: float) -> float:
        factor = float(np.exp(noise))
        tried = replace(
            model, error_model=scaled(model.error_model, (factor, factor)),
            installation=replace(before, gnss_delay=before.gnss_delay + delay, velocity_delay=before.velocity_delay + later, clock_rate=before.clock_rate + rate),
        )  # fmt: skip
        return -run(tried, prepare(log, tried, receiver)).log_likelihood

    coarse = float(COARSE[int(np.argmin([misfit(float(d), 1e-6, 0.0, LOUD) for d in COARSE]))])
    free = np.array([True, True, with_rate, True])

    def objective(x: Floats) -> float:
        full = np.zeros(4)
        full[free] = x
        return misfit(*(float(v) for v in full))

    start = np.array([coarse, 1e-6, 0.0, LOUD])[free]
    simplex = np.vstack([start, start + np.diag(STEPS[free])])
    best = optimize.minimize(
        objective, start, method="Nelder-Mead",
        options={"initial_simplex": simplex, "xatol": 1e-5, "fatol": 0.05, "maxfev": 300},
    )  # fmt: skip
    spread = _covariance(objective, best.x, SMALL[free])
    half = normal_limit(level) * np.sqrt(np.maximum(np.diagonal(spread), 0.0))
    delay = before.gnss_delay + float(best.x[0])
    rate = None
    if with_rate:
        value = before.clock_rate + float(best.x[2])
        rate = Interval(value, value - float(half[2]), value + float(half[2]))
    later = before.velocity_delay + float(best.x[1])
    return Clocks(
        Interval(delay, delay - float(half[0]), delay + float(half[0])),
        Interval(later, later - float(half[1]), later + float(half[1])), rate, float(np.exp(best.x[-1])),
    )  # fmt: skip


def _covariance(objective: Callable[[Floats], float], at: Floats, step: Floats) -> Floats:
    """Return the inverse of a function's curvature, by differences."""
    n = at.size
    centre = objective(at)
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
