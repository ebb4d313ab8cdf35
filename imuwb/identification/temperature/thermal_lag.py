"""The lag of a thermometer against the sensor's own temperature, and the hysteresis of the biases, from a record itself.

All axes of a sensor have one temperature T. The bias of each axis is a polynomial of T, plus half of its hysteresis where T rises and
minus half where T falls, plus noise. The lag is the one with which the polynomials explain all axes best: where the
temperature turns, or changes at another rate, a lag that is left in splits the bias into a loop. Its standard error comes from
the derivative of the biases by the lag, by least squares beside the other unknowns, the slow noise of each axis among them, and from
the thermometer's noise, which all axes share.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.temperature.cosine_window import CosineWindow, smoothed
from imuwb.identification.temperature.drift_fit import DriftFit, Weights, fit_drift
from imuwb.identification.temperature.lag_information import lag_information
from imuwb.identification.temperature.stretches import legs_of
from imuwb.identification.temperature.thermometer_curve import ThermometerCurve
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_limit

ORDER = 5  #: of the polynomials of temperature
LEAST_SPAN = 3.0  #: °C; over a smaller range a lag does not show
FEWEST = 100  #: blocks
GRID = 16  #: lags of each sign in the first search
LONGEST = 0.1  #: share of the record, largest lag
ROUGH = 0.5  #: share of the largest lag for which the window of the first search is made
WIDER = 4.0  #: times the lag of the first search, largest lag of the second
REFINEMENTS = 24  #: steps of the golden section
EVIDENCE = 10.8  #: reduction of the deviance from which a lag is removed; chance gives it in 0.1 % of records
STEP = 0.02  #: share of the lag, or of a block for a small one, by which the derivative is taken


@dataclass(frozen=True, eq=False, slots=True)
class ThermalLag:
    """The lag of a thermometer, and what the record shows beside it."""

    lag: Estimate  #: s; positive: the thermometer lags the sensor
    evident: bool  #: whether the record shows that it is not 0; if not, no lag is removed
    hysteresis: dict[str, Estimate]  #: bias with rising minus bias with falling temperature, SI; empty: it never turns
    turns: tuple[float, ...]  #: s, where the sensor's temperature turns
    window: CosineWindow  #: that smooths the temperature
    time: Floats  #: (n,) s
    celsius: Floats  #: (n,) temperature of the sensor
    later: Floats  #: (n,) what it were with a lag that is one standard error longer; the same where no lag is removed
    direction: Floats  #: (n,) 1 where it rises and -1 where it falls, smoothed; empty: it never turns
    axes: dict[str, Floats]  #: (n,) means of each axis, SI
    drift: dict[str, Floats]  #: (n,) drift of each axis with temperature, without a constant, SI

    def __repr__(self) -> str:
        """Return the lag with its interval."""
        return f"lag {self.lag}{'' if self.evident else ', not evident'}"


def thermal_lag(
    curve: ThermometerCurve, axes: Mapping[str, Floats], *, given: float | None = None, level: float = 0.95
) -> ThermalLag | None:
    """Return the lag of a thermometer; None where the record is too short, or its temperature too steady, to show any.

    Args:
        curve: readings of the thermometer.
        axes: (n,) means of each axis over the curve's blocks, SI.
        given: s, a lag that is known; None: it is estimated.
        level: confidence level of the intervals.
    """
    if curve.time.size < FEWEST or np.ptp(curve.celsius) < LEAST_SPAN or not axes:
        return None
    z = normal_limit(level)
    if given is None:
        rough = _Problem(curve, axes, curve.window(ROUGH * _longest(curve))).search(_longest(curve))
        problem = _Problem(curve, axes, curve.window(rough))
        best = problem.search(min(max(WIDER * abs(rough), WIDER * curve.interval), _longest(curve)))
        sigma = problem.sigma(best)
        evident = problem.deviance(0.0) - problem.deviance(best) > EVIDENCE and abs(best) > z * sigma
    else:
        problem, best, sigma, evident = _Problem(curve, axes, curve.window(given)), given, 0.0, given != 0
    used = best if evident else 0.0
    state, fits = problem.state(used), problem.fits(used)
    hysteresis = _hysteresis(problem, used, sigma, z) if state.turns else {}
    return ThermalLag(
        Estimate(best, best - z * sigma, best + z * sigma, sigma, "s"), evident, hysteresis,
        tuple(float(curve.time[k]) for k in state.turns), problem.window, curve.time, state.celsius,
        curve.of_sensor(used + sigma, problem.window.width) if evident else state.celsius,
        state.direction, dict(axes),
        {name: state.columns @ fit.factors for name, fit in fits.items()},
    )  # fmt: skip


def _longest(curve: ThermometerCurve) -> float:
    """Return the largest lag that is searched, s."""
    return LONGEST * curve.interval * curve.time.size


def _hysteresis(problem: "_Problem", lag: float, sigma: float, z: float) -> dict[str, Estimate]:
    """Return the hysteresis of each axis; an error of the lag changes it too."""
    fits, others = problem.fits(lag), problem.fits(lag + (sigma if np.isfinite(sigma) else 0.0))
    found: dict[str, Estimate] = {}
    for name, fit in fits.items():
        value, own = 2 * float(fit.factors[ORDER]), 4 * float(fit.covariance[ORDER, ORDER])
        half = z * (own + (2 * float(others[name].factors[ORDER]) - value) ** 2) ** 0.5
        found[name] = Estimate(value, value - half, value + half, half / z)
    return found


@dataclass(frozen=True, eq=False, slots=True)
class _State:
    """The drift's columns at one lag."""

    celsius: Floats  #: (n,) of the sensor
    share: Floats  #: (n,) the temperature from -1 to 1
    columns: Floats  #: (n, p) polynomials of the temperature; where it turns, also its direction and an error of the turn's time
    direction: Floats  #: (n,) 1 where it rises and -1 where it falls, smoothed; empty: it never turns
    turns: list[int]  #: blocks


class _Problem:
    """The deviance of all axes as a function of the lag, seen through one window."""

    def __init__(self, curve: ThermometerCurve, axes: Mapping[str, Floats], window: float) -> None:
        self._curve, self.window = curve, CosineWindow.of(curve.time.size, curve.interval, window)
        self._axes = {
            name: self.window.cosines(smoothed(values, curve.interval, window)) for name, values in axes.items()
        }
        self._weights = Weights.of(self.window.length, curve.interval, self.window.factor.size)
        #: variance that a thermometer's noise of 1 °C² gives an axis, its own white noise being 1
        self._felt = {
            name: float(np.polyfit(curve.celsius, values, 1)[0]) ** 2 / float(np.mean(np.diff(values, 2) ** 2) / 6)
            for name, values in axes.items()
        }
        self._known: dict[float, float] = {}

    def state(self, lag: float) -> _State:
        warm = self._curve.of_sensor(lag, self.window.width)
        low, high = float(warm.min()), float(warm.max())
        share = (2 * warm - low - high) / (high - low)
        columns = np.asarray(np.polynomial.chebyshev.chebvander(share, ORDER)[:, 1:], dtype=np.float64)
        legs = legs_of(warm)
        turns = [begin for begin, _ in legs[1:]]
        direction = np.empty(warm.size if turns else 0)
        if turns:
            for begin, end in legs:
                direction[begin : end + 1] = 1.0 if warm[end] > warm[begin] else -1.0
            direction = smoothed(direction, self._curve.interval, self.window.width)
            columns = np.column_stack([columns, direction, *self._late(warm, turns)])
        return _State(warm, share, columns, direction, turns)

    def _late(self, warm: Floats, turns: list[int]) -> list[Floats]:
        """Return columns of a direction that changes somewhat sooner or later than at the turn: at the tops, at the bottoms."""
        tops, bottoms = np.zeros(warm.size), np.zeros(warm.size)
        middle = float(warm.mean())
        for turn in turns:
            (tops if warm[turn] > middle else bottoms)[turn] = 1.0
        return [smoothed(x, self._curve.interval, self.window.width) for x in (tops, bottoms) if x.any()]

    def fits(self, lag: float) -> dict[str, DriftFit]:
        columns, noise = self.window.cosines(self.state(lag).columns), self._noise(lag)
        return {
            name: fit_drift(values, columns, self._weights, self._felt[name] * noise)
            for name, values in self._axes.items()
        }

    def _noise(self, lag: float, frequency: Floats | None = None) -> Floats:
        """Return the variances of the cosine coefficients of the sensor's temperature by the thermometer's noise, °C²."""
        factor = 1 + ((self.window.frequency if frequency is None else frequency) * lag) ** 2
        return self._curve.noise**2 / self._curve.interval * (factor if lag > 0 else 1 / factor)

    def deviance(self, lag: float) -> float:
        if lag not in self._known:
            self._known[lag] = sum(fit.deviance for fit in self.fits(lag).values())
        return self._known[lag]

    def search(self, longest: float) -> float:
        """Return the likeliest lag of those up to ``longest`` s: on a grid, then by golden section."""
        sizes = np.geomspace(self._curve.interval / 2, longest, GRID)
        grid = [*(-sizes[::-1]).tolist(), 0.0, *sizes.tolist()]
        place = min(range(len(grid)), key=lambda k: self.deviance(grid[k]))
        low, high = grid[max(place - 1, 0)], grid[min(place + 1, len(grid) - 1)]
        ratio = (5**0.5 - 1) / 2
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        for _ in range(REFINEMENTS):
            if self.deviance(a) < self.deviance(b):
                high, b = b, a
                a = high - ratio * (high - low)
            else:
                low, a = a, b
                b = low + ratio * (high - low)
        return min((a, b, grid[place]), key=self.deviance)

    def sigma(self, lag: float) -> float:
        """Return the standard error of the lag: all other unknowns are estimated beside it."""
        state, fits = self.state(lag), self.fits(lag)
        step = STEP * max(abs(lag), self._curve.interval)
        before, after = (self._curve.of_sensor(lag + d, self.window.width) for d in (-step, step))
        change = (after - before) / (2 * step)
        to_share = 2 / float(np.ptp(state.celsius))
        x, noise = self.window.cosines(state.columns), self._noise(lag)
        information, own = 0.0, 0.0
        felt = np.zeros(self.window.length)  # effect of the temperature of each mean on the slope of the deviance
        for name, fit in fits.items():
            series = np.polynomial.chebyshev.chebder(np.concatenate([[0.0], fit.factors[:ORDER]]))
            slope = to_share * np.polynomial.chebyshev.chebval(state.share, series)
            along = self.window.cosines(slope * change)
            one = lag_information(fit, self._axes[name], x, along, self._felt[name] * noise)
            information += one.information
            own += one.own
            felt += slope[self.window.inside] * self.window.readings(one.score)
        if information <= 0:
            return float("inf")
        shared = self.window.variance(felt, lambda frequency: self._noise(lag, frequency))
        return (own + shared) ** 0.5 / information
