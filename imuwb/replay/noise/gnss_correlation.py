"""The correlated error of a receiver's positions, from the innovations of a filter.

A receiver's position errors change slowly: those of satellites, atmosphere and multipath last for a minute or longer. A filter
whose error states include a first-order Gauss-Markov error of the position predicts the next fix better. Its sigma and its
correlation time maximise the composite likelihood of the innovations (Varin, Reid and Firth 2011), as the noise in motion does
(``motion_noise``). Intervals come from scores in blocks of a minute (sandwich), and are never narrower than the curvature's.
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
    limit, sigma = normal_limit(level), fit.sigma(theta)
    estimates = [
        Estimate(value, value * math.exp(-limit * s), value * math.exp(limit * s), value * s, unit)
        for value, s, unit in zip(np.exp(theta).tolist(), sigma.tolist(), ("m", "s"), strict=True)
    ]
    gain = float(fit.terms([theta]).sum()) - without
    return GnssCorrelation(estimates[0], estimates[1], gain, int(counted.sum()))


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

    def sigma(self, theta: Floats) -> Floats:
        """Return the sigmas of the two logarithms, (2,)."""
        unit = np.eye(theta.size)
        inverse = np.linalg.inv(curvature_of(self.values, theta, STEP))
        moved = self.terms([theta + side * STEP * u for u in unit for side in (1, -1)])
        scores = (moved[::2] - moved[1::2]) / (2 * STEP)  # (2, c)
        time = self.prepared.corrections.time[self.counted]
        block = ((time - time[0]) / BLOCK).astype(int)
        sums = np.stack([np.bincount(block, own) for own in scores])
        sums -= sums.mean(axis=1, keepdims=True)
        sandwich = inverse @ (sums @ sums.T) @ inverse
        variance = np.maximum(np.diagonal(sandwich), np.diagonal(inverse))
        return np.sqrt(np.minimum(variance, PRIOR**2))
