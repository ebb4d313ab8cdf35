"""The noise of an IMU in motion, from the innovations of a filter: no outage is simulated.

A bench record shows what a sensor does at rest. In a vehicle, vibration that the sensor rectifies, errors by scale factor and
timing act as more white noise, and biases move faster. Four amplitudes are added to the bench model: white noise and a random
walk, each of gyros and accelerometers. Two more are added to the receiver's sigmas: a floor of positions and of velocities.
All six maximise the composite likelihood of the innovations,

    L = sum over fixes and components of -z²/2 - ln s,    z = innovation / s,

in which each component counts with its own sigma s, so that errors that are correlated between components do not count twice
(composite likelihood: Varin, Reid and Firth 2011). A prior keeps an amplitude without effect where it is. Intervals come from
scores in blocks of a minute (sandwich), because vibration changes with the road, and are never narrower than the curvature's.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.errors import MissingDataError
from imuwb.navigation.filter_model import FilterModel, Vibration
from imuwb.navigation.tables import FIX
from imuwb.navigation.vibration import usual_vibration
from imuwb.replay.noise.added_noise import with_added
from imuwb.replay.prepared import Prepared, run
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_limit
from imuwb.stochastic import AxisModel, ImuErrorModel, RandomWalk, Sum, WhiteNoise

NAME = "motion"  #: of the filter
UNITS = ("rad/s/√Hz", "m/s²/√Hz", "rad/s/√s", "m/s²/√s", "m", "m/s")
#: The search starts high: under the bench's values, the gate refuses the fixes that would show the noise.
START = np.log([1e-3, 1e-2, 2e-5, 3e-4, 0.3, 0.1])
FLOORS = 4  #: index of the first amplitude of the receiver
WIDE = 5.0  #: largest change of a logarithm
PRIOR = 2.0  #: sigma of a logarithm
SETTLED = 20.0  #: s after the start; earlier innovations show the start and not the noise
STEP, CURVE = 0.03, 0.2  #: steps of the logarithms for the gradient and for the curvature
ITERATIONS = 40
BLOCK = 60.0  #: s, of a block of scores
LEAST_TIME = 60.0  #: s of fixes
SCALES = (0.01, 0.03)  #: sigmas of the scale factors that are tried: usual for calibrated and for uncalibrated MEMS
DOUBT = 0.5  #: largest variance of a logarithm that widens the filter's noise
NOISIER = 1.2  #: times the bench's noise; a smaller factor is not worth a sentence
BETTER = 5.0  #: rise of the log-likelihood for which one more cause is kept
SHOWN = (
    2.0  #: an amplitude whose logarithm falls this far below its start, or is this uncertain, is not shown by the log
)


@dataclass(frozen=True, slots=True)
class MotionNoise:
    """The noise that a drive shows beyond the bench's, with intervals. Gyros first, then accelerometers."""

    white: tuple[Estimate, Estimate]  #: N of the added white noise, rad/s/√Hz and m/s²/√Hz
    walk: tuple[Estimate, Estimate]  #: K of the added random walk, rad/s/√s and m/s²/√s
    floor: tuple[Estimate, Estimate]  #: m and m/s, added to the receiver's sigmas of positions and velocities
    bench: dict[str, float]  #: axis -> N of the bench's white noise
    #: axis -> white noise in motion over that of the bench; infinite without any on the bench
    factors: dict[str, Estimate]
    vibration_gain: (
        float  #: rise of the log-likelihood if the white noise grows with vibration; it does where it is kept
    )
    scale_factor: float  #: sigma of the filter's scale factors; 0: no states of scale factors
    scale_factor_gain: float  #: rise of the log-likelihood by states of scale factors
    fixes: int  #: that count
    blocks: int  #: of a minute

    @property
    def grows(self) -> bool:
        """Whether the white noise grows with vibration."""
        return self.vibration_gain > BETTER

    def noisier(self, kind: str) -> Estimate | None:
        """Return the middle factor of the gyros or the accelerometers if its interval shows that they act noisier in motion.

        Args:
            kind: "gyro" or "accel".
        """
        own = sorted((f for axis, f in self.factors.items() if axis.startswith(kind)), key=lambda f: f.value)
        shown = self.white[int(kind == "accel")].lower > 0 and max(f.lower for f in own) >= NOISIER
        return own[len(own) // 2] if shown else None

    def __repr__(self) -> str:
        """Return the white noise and its factors in a line."""
        gyro, accel = (_range(self.factors, kind) for kind in ("gyro", "accel"))
        return f"Noise in motion: gyros {self.white[0]}, {gyro} times the bench's; accelerometers {self.white[1]}, {accel} times"


def _range(factors: dict[str, Estimate], kind: str) -> str:
    values = [f.value for axis, f in factors.items() if axis.startswith(kind)]
    low, high = f"{min(values):.2g}", f"{max(values):.2g}"
    return low if low == high else f"{low} to {high}"


def estimate_motion_noise(prepared: Prepared, model: FilterModel, level: float) -> tuple[FilterModel, MotionNoise]:
    """Return a filter with the noise in motion added, and that noise.

    Args:
        prepared: the log; its fixes should be at least a second apart, because errors of neighbours are not independent.
        model: the filter with the bench's error model.
        level: of the intervals.

    Raises:
        MissingDataError: too few fixes.
        ValueError: a filter that cannot be written with states.
    """
    counted = counted_fixes(prepared)
    fit = _Fit(prepared, model, counted)
    found, vibrating = _better(fit.maximum(START), [replace(fit, vibrating=usual_vibration(prepared.measurement))])
    scales = () if any(model.scale_factor) else SCALES
    found, scaled = _better(found, [replace(found.fit, base=replace(model, scale_factor=(s, s))) for s in scales])
    fit, theta = found.fit, found.theta
    sigma, blocks = fit.sigma(theta)
    limit = normal_limit(level)
    amplitudes = [_estimate(i, theta[i], sigma[i], limit) for i in range(theta.size)]
    bench = {axis: _white(own.processes) for axis, own in model.error_model.axes.items()}
    white, walk, floor = ((amplitudes[i], amplitudes[i + 1]) for i in (0, 2, 4))
    noise = MotionNoise(
        white,
        walk,
        floor,
        bench,
        _factors(bench, white),
        vibrating,
        fit.base.scale_factor[0],
        scaled,
        int(counted.sum()),
        blocks,
    )
    # The filter carries the expectation of each variance, which exceeds the variance at the most likely amplitude.
    widened = theta + np.where(np.arange(theta.size) < FLOORS, np.minimum(sigma**2, DOUBT), 0.0)
    return fit.model(widened), noise


def counted_fixes(prepared: Prepared) -> Booleans:
    """Return which corrections count: fixes after the filter has settled."""
    corrections = prepared.corrections
    counted = (corrections.events.kind == FIX) & (corrections.time > prepared.start_time + SETTLED)
    time = corrections.time[counted]
    if time.size < 2 or np.ptp(time) < LEAST_TIME:  # noqa: PLR2004 - one fix has no duration
        raise MissingDataError(
            f"{prepared.log.provenance.path}: the noise in motion needs {LEAST_TIME:g} s of fixes after the start of the "
            f"filter, and the log has {np.ptp(time) if time.size else 0:.0f} s; use a longer drive"
        )
    return counted


def _estimate(i: int, log: float, sigma: float, limit: float) -> Estimate:
    value = math.exp(log)
    lower, upper = (math.exp(log + side * limit * sigma) for side in (-1, 1))
    # No evidence for the amplitude, or the search ended at the lower end of its range: only the upper end is known.
    unknown = sigma > SHOWN / limit or log < START[i] - WIDE + STEP
    return Estimate(value, 0.0 if unknown else lower, upper, value * sigma, UNITS[i])


def _white(processes: Sum) -> float:
    return math.sqrt(sum(term.N**2 for term in processes.terms if isinstance(term, WhiteNoise)))


def _factors(bench: dict[str, float], white: tuple[Estimate, Estimate]) -> dict[str, Estimate]:
    factors: dict[str, Estimate] = {}
    for axis, own in bench.items():
        added = white[int(axis.startswith("accel"))]
        value, lower, upper = (
            math.hypot(n, own) / own if own else math.inf for n in (added.value, added.lower, added.upper)
        )
        factors[axis] = Estimate(value, lower, upper)
    return factors


def usual_in_motion(model: FilterModel) -> FilterModel:
    """Return a filter with the noise at which the search starts: usual for a MEMS in a car, so that it refuses few fixes."""
    white_g, white_a, walk_g, walk_a, *_ = (float(x) for x in np.exp(START))
    return replace(model, error_model=with_added(model.error_model, (white_g, white_a), (walk_g, walk_a)))


def in_motion(model: FilterModel, noise: MotionNoise) -> ImuErrorModel:
    """Return the error model of a filter with noise in motion, with the intervals of white noise and random walks.

    White noise that grows with vibration has its mean density over the drive.
    """
    whole = with_added(model.error_model, model.vibration.white, (0.0, 0.0))

    def axis(name: str, own: AxisModel) -> AxisModel:
        sensor, intervals = int(name.startswith("accel")), dict[str, tuple[float, float]]()
        for i, term in enumerate(own.processes.terms):
            if isinstance(term, WhiteNoise):
                letter, value, added, bench = "N", term.N, noise.white[sensor], noise.bench[name]
            elif isinstance(term, RandomWalk):
                letter, value, added, bench = "K", term.K, noise.walk[sensor], 0.0
            else:
                continue
            lower, upper = (math.hypot(end, bench) for end in (added.lower, added.upper))
            intervals[f"{i}.{letter}"] = min(lower, value), max(upper, value)
        return replace(own, intervals=intervals)

    return replace(whole, axes={name: axis(name, own) for name, own in whole.axes.items()})


@dataclass(frozen=True, eq=False, slots=True)
class _Fit:
    """The likelihood of a filter as a function of the six logarithms."""

    prepared: Prepared
    base: FilterModel  #: with the bench's error model
    counted: Booleans  #: which corrections count
    vibrating: float = 0.0  #: m/s², vibration at which white noise that grows with it is counted; 0: it does not grow

    def model(self, theta: Floats) -> FilterModel:
        """Return the filter with the amplitudes added."""
        white_g, white_a, walk_g, walk_a, p, v = (float(x) for x in np.exp(theta))
        settings, (floor_p, floor_v) = self.base.settings, self.base.settings.sigma_floor
        white, vibration = (white_g, white_a), Vibration()
        if self.vibrating:
            white, vibration = (0.0, 0.0), Vibration(white, self.vibrating)
        return replace(
            self.base, name=NAME, error_model=with_added(self.base.error_model, white, (walk_g, walk_a)),
            vibration=vibration,
            settings=replace(settings, sigma_floor=(math.hypot(floor_p, p), math.hypot(floor_v, v))),
        )  # fmt: skip

    def terms(self, thetas: Sequence[Floats]) -> Floats:
        """Return the log-likelihood of each correction at several points, (k, c); refused fixes count in full."""

        def one(theta: Floats) -> Floats:
            try:
                return run(self.model(theta), self.prepared).log_likelihoods(self.counted)
            except MissingDataError:  # the covariance is no longer one: such amplitudes do not fit
                return np.full(int(self.counted.sum()), -1e6)

        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            return np.array(list(pool.map(one, thetas)))

    def values(self, thetas: Sequence[Floats]) -> Floats:
        """Return the log-likelihood plus the prior's at several points, (k,)."""
        prior = np.array([((theta - START) ** 2).sum() for theta in thetas]) / (2 * PRIOR**2)
        return self.terms(thetas).sum(axis=1) - prior

    def maximum(self, start: Floats) -> _Found:
        """Return the six logarithms with the largest posterior near a start."""
        n = START.size

        def misfit(theta: Floats) -> tuple[float, Floats]:
            values = self.values([theta, *(theta + STEP * unit for unit in np.eye(n))])
            return -float(values[0]), -(values[1:] - values[0]) / STEP

        bounds = [(x - WIDE, x + WIDE) for x in START]
        from scipy import optimize  # noqa: PLC0415 - scipy is slow to import

        best = optimize.minimize(
            misfit, start, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": ITERATIONS, "ftol": 1e-6}
        )
        theta = np.asarray(best.x, dtype=np.float64)
        return _Found(self, theta, float(self.terms([theta]).sum()))

    def sigma(self, theta: Floats) -> tuple[Floats, int]:
        """Return the sigmas of the logarithms, (6,), from scores in blocks, and the number of blocks."""
        n, unit = theta.size, np.eye(theta.size)
        inverse = np.linalg.inv(curvature_of(self.values, theta))
        moved = self.terms([theta + side * STEP * u for u in unit for side in (1, -1)])
        scores = (moved[::2] - moved[1::2]) / (2 * STEP)  # (6, c)
        time = self.prepared.corrections.time[self.counted]
        block = ((time - time[0]) / BLOCK).astype(int)
        sums = np.stack([np.bincount(block, scores[i]) for i in range(n)])
        sums -= sums.mean(axis=1, keepdims=True)
        sandwich = inverse @ (sums @ sums.T) @ inverse
        variance = np.maximum(np.diagonal(sandwich), np.diagonal(inverse))
        return np.sqrt(np.minimum(variance, PRIOR**2)), int(sums.shape[1])


@dataclass(frozen=True, eq=False, slots=True)
class _Found:
    """The maximum of a fit."""

    fit: _Fit
    theta: Floats  #: (6,)
    log_likelihood: float  #: without the prior


def _better(found: _Found, others: Sequence[_Fit]) -> tuple[_Found, float]:
    """Return the best of some fits and what it gains; the present one, if no other is clearly better."""
    gain, best = 0.0, found
    for fit in others:
        other = fit.maximum(found.theta)
        if other.log_likelihood - found.log_likelihood > gain or best is found:
            gain, best = other.log_likelihood - found.log_likelihood, other
    return (best if gain > BETTER else found), gain


def curvature_of(values: Callable[[Sequence[Floats]], Floats], at: Floats, step: float = CURVE) -> Floats:
    """Return the negative second derivatives of a function at its maximum, by differences, made positive definite."""
    n, unit = at.size, np.eye(at.size) * step
    pairs = [(i, j) for i in range(n) for j in range(i)]
    plus, minus = [at + u for u in unit], [at - u for u in unit]
    both = [at + side * (unit[i] + unit[j]) for i, j in pairs for side in (1, -1)]
    f = values([at, *plus, *minus, *both])
    centre, up, down, mixed = f[0], f[1 : n + 1], f[n + 1 : 2 * n + 1], f[2 * n + 1 :].reshape(-1, 2).sum(axis=1)
    curvature = np.diag(2 * centre - up - down)
    for (i, j), total in zip(pairs, mixed, strict=True):
        curvature[i, j] = curvature[j, i] = -(total - up[i] - down[i] - up[j] - down[j] + 2 * centre) / 2
    value, vector = np.linalg.eigh(curvature / step**2)
    least = 1 / PRIOR**2  # the prior's curvature
    return (vector * np.maximum(value, least)) @ vector.T
