"""The correlated error of a receiver's positions, from the innovations of a filter.

A receiver's position errors change slowly: those of satellites, atmosphere and multipath last for a minute or longer. A filter
whose error states include a first-order Gauss-Markov error of the position predicts the next fix better. Its sigma and its
correlation time maximise the composite likelihood of the innovations (Varin, Reid and Firth 2011), as the noise in motion does
(``motion_noise``). The interval of the sigma comes from scores in blocks of a minute (sandwich), and is never narrower than the
curvature's. A drive has few correlation times, so that the likelihood of the time is skew: it falls slowly towards long times, which
look like a constant. Its interval are the times whose profile likelihood, with the best sigma for each, is above the maximum less
half the quantile of chi-square; the quantile is multiplied by the sandwich's variance over the curvature's where that exceeds one
(Pace, Salvan and Sartori 2011, equation 2.5).
"""

import math
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.errors import MissingDataError
from imuwb.navigation.filter_model import FilterModel
from imuwb.replay.noise.motion_noise import BETTER, BLOCK, PRIOR, counted_fixes, curvature_of
from imuwb.replay.prepared import Prepared, run
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_limit

SIGMAS = (0.3, 0.9)  #: of the grid, over the median sigma of the fixes
TIMES = (5.0, 20.0, 80.0)  #: s, of the grid
STEP = 0.01  #: of the logarithms, for derivatives; a sigma near what the fixes state leaves little white noise: larger steps fail
WALK, STEPS = 0.7, 8  #: steps along the profile, in sigmas of the log time, and their largest number
IMPOSSIBLE = -1e6  #: log-likelihood of a fix if the filter becomes invalid


@dataclass(frozen=True, slots=True)
class GnssCorrelation:
    """A first-order Gauss-Markov error of a receiver's positions, with intervals."""

    sigma: Estimate  #: m, horizontal; a height's is twice as large
    time: Estimate  #: s, the correlation time
    gain: float  #: rise of the log-likelihood over that without such an error
    fixes: int  #: that count

    @property
    def shown(self) -> bool:
        """Whether the log shows the error: the log-likelihood rises by more than ``BETTER``."""
        return self.gain > BETTER

    def __str__(self) -> str:
        """Return the estimates in a line."""
        return f"correlated error of positions: sigma {self.sigma}, correlation time {self.time}"


def estimate_gnss_correlation(prepared: Prepared, models: Sequence[FilterModel], level: float) -> GnssCorrelation:
    """Return the Gauss-Markov error of a receiver's positions for which a filter's innovations are most likely.

    Args:
        prepared: the log.
        models: filters; the one whose innovations are the most likely without such an error is used.
        level: of the intervals.

    Raises:
        MissingDataError: too few fixes.
        UsageError: a filter that cannot be written with states.
    """
    counted = counted_fixes(prepared)
    without, fit = max(
        ((float(fit.terms([None]).sum()), fit) for fit in (_Fit(prepared, model, counted) for model in models)),
        key=lambda found: found[0],
    )
    grid = [np.array([math.log(factor * fit.usual), math.log(time)]) for factor in SIGMAS for time in TIMES]
    start = grid[int(np.argmax(fit.values(grid)))]

    def misfit(theta: Floats) -> float:
        return -float(fit.values([theta])[0])

    from scipy import optimize  # noqa: PLC0415 - scipy is slow to import

    best = optimize.minimize(
        misfit, start, method="Nelder-Mead",
        options={"initial_simplex": start + 0.5 * np.array([[0, 0], [1, 0], [0, 1]]), "xatol": 0.01, "fatol": 0.02, "maxfev": 120},
    )  # fmt: skip
    theta = np.asarray(best.x, dtype=np.float64)
    limit, spread = normal_limit(level), fit.spread(theta)
    half = limit * float(spread.sigma[0])
    low, high = fit.times(theta, spread, limit)
    value, time = np.exp(theta).tolist()
    gain = float(fit.terms([theta]).sum()) - without
    return GnssCorrelation(
        Estimate(value, value * math.exp(-half), value * math.exp(half), value * float(spread.sigma[0]), "m"),
        Estimate(time, math.exp(low), math.exp(high), time * float(spread.sigma[1]), "s"), gain, int(counted.sum()),
    )  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True)
class _Spread:
    """How far the estimates of the two logarithms scatter."""

    sigma: Floats  #: (2,)
    inflation: float  #: variance of the time's estimate over that of the curvature, at least 1
    ridge: float  #: change of the best log sigma with the log time
    width: float  #: sigma of the log sigma for a given time


@dataclass(frozen=True, eq=False, slots=True)
class _Fit:
    """The likelihood of a filter as a function of the logarithms of sigma and correlation time."""

    prepared: Prepared
    base: FilterModel
    counted: Booleans  #: which corrections count

    @property
    def usual(self) -> float:
        """Return the median horizontal sigma of the fixes, m."""
        variance = self.prepared.corrections.events.variance[self.counted, :2]
        return float(np.sqrt(np.median(variance[variance > 0])))

    def terms(self, thetas: Sequence[Floats | None]) -> Floats:
        """Return the log-likelihood of each correction at several points, (k, c); None: without a correlated error."""

        def one(theta: Floats | None) -> Floats:
            correlation = (0.0, 0.0) if theta is None else (math.exp(theta[0]), math.exp(theta[1]))
            settings = replace(self.base.settings, gnss_correlation=correlation)
            try:
                solution = run(replace(self.base, settings=settings), self.prepared)
                return solution.log_likelihoods(self.counted)
            except MissingDataError:  # the covariance is no longer one: such an error does not fit
                return np.full(int(self.counted.sum()), IMPOSSIBLE)

        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            return np.array(list(pool.map(one, thetas)))

    def values(self, thetas: Sequence[Floats]) -> Floats:
        """Return the log-likelihood plus a wide prior's at several points, (k,); the prior bounds what the log does not show."""
        centre = np.array([math.log(self.usual), math.log(TIMES[1])])
        prior = np.array([((theta - centre) ** 2).sum() for theta in thetas]) / (2 * PRIOR**2)
        return self.terms(thetas).sum(axis=1) - prior

    def spread(self, theta: Floats) -> _Spread:
        """Return the sigmas of the two logarithms, and the shape of the likelihood near its maximum."""
        unit = np.eye(theta.size)
        curvature = curvature_of(self.values, theta, STEP)
        inverse = np.linalg.inv(curvature)
        moved = self.terms([theta + side * STEP * u for u in unit for side in (1, -1)])
        scores = (moved[::2] - moved[1::2]) / (2 * STEP)  # (2, c)
        time = self.prepared.corrections.time[self.counted]
        block = ((time - time[0]) / BLOCK).astype(int)
        sums = np.stack([np.bincount(block, own) for own in scores])
        sums -= sums.mean(axis=1, keepdims=True)
        sandwich = inverse @ (sums @ sums.T) @ inverse
        variance = np.maximum(np.diagonal(sandwich), np.diagonal(inverse))
        return _Spread(
            np.sqrt(np.minimum(variance, PRIOR**2)), float(variance[1] / inverse[1, 1]),
            -float(curvature[0, 1] / curvature[0, 0]), float(curvature[0, 0]) ** -0.5,
        )  # fmt: skip

    def times(self, theta: Floats, spread: _Spread, limit: float) -> tuple[float, float]:
        """Return the ends of the interval of the log time by its profile likelihood; ``limit`` is that of a standard normal variable.

        The profile is followed to both sides in steps; the root of the deviance is nearly linear, so ends are interpolated in it.
        """
        highest = float(self.values([theta])[0])
        ends = list[float]()
        for side in (-1, 1):
            step, place, at, root = side * WALK * float(spread.sigma[1]), theta[0], theta[1], 0.0
            wanted = limit * math.sqrt(spread.inflation)
            for _ in range(STEPS):
                place, best = self._best_sigma(place + spread.ridge * step, at + step, spread.width)
                before, root, at = root, math.sqrt(max(2 * (highest - best), 0.0)), at + step
                if root >= wanted:
                    at -= step * (root - wanted) / (root - before)
                    break
            ends.append(float(at))
        return ends[0], ends[1]

    def _best_sigma(self, near: float, time: float, width: float) -> tuple[float, float]:
        """Return the best log sigma for a log time, and the likelihood there, by a parabola; it is sought near a first guess."""
        low, middle, high = self.values([np.array([near + k * width, time]) for k in (-1, 0, 1)])
        bend = 2 * middle - low - high
        shift = float(np.clip((high - low) / (2 * bend), -2, 2)) if bend > 0 else 2 * float(np.sign(high - low))
        value = middle + shift * (high - low) / 2 - shift**2 * bend / 2
        return near + shift * width, float(max(value, low, middle, high))
