"""The delay of a receiver and the rate of the IMU's clock, by the likelihood of a filter's innovations."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.navigation.filter_model import FilterModel
from imuwb.replay.noise.motion_noise import BETTER
from imuwb.replay.noise.scaled import scaled
from imuwb.replay.prepared import prepare, run, with_clocks
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_limit

#: The unknowns are: delay of positions, s; delay of velocities minus that of positions, s; rate; log of the noise's factor.
DELAYS = np.arange(-0.5, 0.51, 0.1)  #: s, of the first grid
RATES = np.array([-2e-3, -1e-3, -5e-4, 0.0, 5e-4, 1e-3, 2e-3])  #: changes of the clock rate in the first grid
STEPS = np.array([0.05, 0.1, 3e-4, 0.5])  #: sizes of the first simplex
SMALL = np.array([0.01, 0.01, 2e-5, 0.1])  #: the first steps of the curvature
STAIRS = np.array([2.0, 2.0, 4.0, 0.0])  #: samples; at smaller steps of the curvature the likelihood is a staircase
RISE = 2.0  #: rise of the misfit over which the curvature is computed; the misfit is rough at smaller scales
ENDS = 3  #: fixes at each end that do not count, because a delay moves some of them out of the log
CLOSE = 2e-3  #: of those sizes; the search ends when its simplex is as small
IMPOSSIBLE = 1e9  #: misfit of clocks with which the filter becomes invalid
LOUD = np.log(3.0)  #: log of the factor of white noise at the start of the search: vehicles vibrate


@dataclass(frozen=True, slots=True)
class Clocks:
    """The delay of a receiver and the rate of an IMU's clock, with intervals; None: not estimated."""

    delay: Estimate | None  #: s, by which the stamp of a fix is late
    velocity_delay: Estimate | None  #: s, by which a fix's velocity is older than its position
    rate: Estimate | None  #: true seconds in a second of the IMU's clock
    noise: float  #: factor of the model's white noise with the largest likelihood
    gain: float  #: rise of the log-likelihood over that of the delays and the rate at which the search began

    @property
    def shown(self) -> bool:
        """Whether the log shows the estimates: the log-likelihood rises by more than ``BETTER``."""
        return self.gain > BETTER

    def __str__(self) -> str:
        """Return the estimates in a line."""
        known = {"delay": self.delay, "velocity delay": self.velocity_delay, "clock rate": self.rate}
        return ", ".join(f"{name} {value}" for name, value in known.items() if value is not None)


def estimate_clocks(
    log: Log, model: FilterModel, receiver: str | None, level: float, *, with_delay: bool = True, with_rate: bool
) -> Clocks:
    """Return the delays and the rate for which a filter's innovations are most likely; its white noise is scaled as well.

    The same fixes count for all delays. The intervals follow from the curvature of the likelihood; they are infinite where
    there is no curvature.

    Args:
        log: the log.
        model: a filter; the search begins at its delays and rate.
        receiver: name of the receiver; None: the best one.
        level: of the intervals.
        with_delay: whether the delays of positions and velocities are estimated.
        with_rate: whether the clock's rate is estimated.

    Raises:
        MissingDataError: as ``prepare``; a filter that becomes invalid with all delays.
    """
    prepared = prepare(log, model, receiver)
    row = prepared.corrections.fix
    counted = (int(row[prepared.alignment.event]) + ENDS, int(row.max()) - ENDS)
    free = np.array([with_delay, with_delay, with_rate, True])

    def misfit(x: Floats) -> float:
        tried = _changed(model, x)
        try:
            return -run(tried, with_clocks(prepared, model, tried)).log_likelihood_of(*counted)
        except MissingDataError:  # a covariance that is none: such clocks do not fit
            return IMPOSSIBLE

    def objective(x: Floats) -> float:
        full = np.zeros(4)
        full[free] = x
        # The search uses the delays of positions and of velocities, whose estimates are almost independent.
        full[1] -= full[0]
        return misfit(full)

    delays, rates = DELAYS if with_delay else np.zeros(1), RATES if with_rate else np.zeros(1)
    grid = [(misfit(np.array([d, 0.0, r, LOUD])), float(d), float(r)) for r in rates for d in delays]
    least, coarse, rate = min(grid)
    if least == IMPOSSIBLE:
        run(model, prepared)  # raises the reason
    best = _minimum(objective, np.array([coarse, coarse, rate, LOUD])[free], STEPS[free])
    stairs = STAIRS * prepared.measurement.interval
    stairs[2] /= float(np.ptp(prepared.measurement.time))
    covariance = _covariance(objective, best, np.maximum(SMALL, stairs)[free])
    noises = best[-1] + np.arange(0.0, 2.0, 0.25)  # without a delay, the noise has to explain more
    gain = min(misfit(np.array([0.0, 0.0, 0.0, noise])) for noise in noises) - objective(best)
    if with_delay:
        turn = np.eye(best.size)
        turn[1, 0] = -1.0  # back to the difference of the delays
        covariance, best = turn @ covariance @ turn.T, turn @ best
    return _clocks(model, free, best, covariance, level, gain)


def _changed(model: FilterModel, x: Floats) -> FilterModel:
    """Return a filter with other delays, rate and white noise."""
    delay, later, rate, noise = (float(v) for v in x)
    factor, own = float(np.exp(noise)), model.installation
    installation = replace(
        own, gnss_delay=own.gnss_delay + delay, clock_rate=own.clock_rate + rate,
        velocity_delay=own.velocity_delay + later or 1e-9,  # never 0, so that all runs have the same events
    )  # fmt: skip
    return replace(model, error_model=scaled(model.error_model, (factor, factor)), installation=installation)


def _minimum(objective: Callable[[Floats], float], start: Floats, steps: Floats) -> Floats:
    n = start.size
    options = {"initial_simplex": np.vstack([np.zeros(n), np.eye(n)]), "xatol": CLOSE, "fatol": 0.05, "maxfev": 300}
    from scipy import optimize  # noqa: PLC0415 - scipy is slow to import

    def moved(x: Floats) -> float:
        return objective(start + steps * x)

    best = optimize.minimize(moved, np.zeros(n), method="Nelder-Mead", options=options)
    return start + steps * np.asarray(best.x, dtype=np.float64)


def _clocks(model: FilterModel, free: Booleans, best: Floats, covariance: Floats, level: float, gain: float) -> Clocks:
    """Return the estimates with their intervals."""
    variance = np.diagonal(covariance)
    value, sigma = np.zeros(4), np.zeros(4)
    value[free], sigma[free] = best, np.sqrt(np.where(variance > 0, variance, np.inf))
    own, limit = model.installation, normal_limit(level)

    def estimate(k: int, start: float, unit: str) -> Estimate | None:
        center, half = start + float(value[k]), limit * float(sigma[k])
        return Estimate(center, center - half, center + half, float(sigma[k]), unit) if free[k] else None

    return Clocks(
        estimate(0, own.gnss_delay, "s"), estimate(1, own.velocity_delay, "s"), estimate(2, own.clock_rate, ""),
        float(np.exp(value[3])), gain,
    )  # fmt: skip


def _covariance(objective: Callable[[Floats], float], at: Floats, step: Floats) -> Floats:
    """Return the inverse of a function's curvature, by differences."""
    n, centre = at.size, objective(at)
    step = step.copy()
    unit = np.eye(n)
    for i in range(n):
        for _ in range(8):
            if objective(at + step[i] * unit[i]) + objective(at - step[i] * unit[i]) - 2 * centre >= 2 * RISE:
                break
            step[i] *= 1.6
    hessian = np.zeros((n, n))
    for i in range(n):
        a = step[i] * unit[i]
        hessian[i, i] = (objective(at + a) - 2 * centre + objective(at - a)) / step[i] ** 2
        for j in range(i):
            b = step[j] * unit[j]
            mixed = objective(at + a + b) - objective(at + a - b) - objective(at - a + b) + objective(at - a - b)
            hessian[i, j] = hessian[j, i] = mixed / (4 * step[i] * step[j])
    return np.asarray(np.linalg.pinv(hessian), dtype=np.float64)
