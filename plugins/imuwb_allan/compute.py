"""From a log to Allan deviations and fitted sums."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import MissingDataError, UsageError
from imuwb.identification import allan, find_lines, fit_allan, stillness
from imuwb.log import SECOND
from imuwb.readers.summary import gaps, sampling_interval
from imuwb.stochastic import AxisModel, ImuErrorModel
from imuwb.units import coefficient_units
from imuwb_allan.result import AxisResult, CoefficientResult, FitQuality, LineResult, Result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.identification import AllanDeviation, AllanFit, Line, Stillness
    from imuwb.log import ImuStream, Log
    from imuwb_allan.parameters import Parameters

    Floats = NDArray[np.float64]

FEWEST = 100  #: samples; fewer have no curve worth the name
JITTER = 0.2  #: of the sampling interval
EARLIEST_GPS = 3  #: MAVLink's fix type from which a receiver knows where it is


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the Allan deviations and fits of the log's (first) IMU."""
    log = logs[0]
    imu, notes = _imu(log)
    axes = imu.axes()
    samples = min(time.size for time, _ in axes.values())
    if samples < FEWEST:
        message = f"{log.provenance.path}: {imu.name} has {samples} samples; an Allan deviation needs at least {FEWEST}"
        raise MissingDataError(message)
    clocks = {axis: _Clock(time) for axis, (time, _) in axes.items()}
    constant = [axis for axis, (_, values) in axes.items() if np.ptp(values) == 0]
    if len(constant) == len(axes):
        message = f"{log.provenance.path}: every channel of {imu.name} is constant; there is no noise to analyse"
        raise MissingDataError(message)
    notes += [
        note for sensor in ("gyro", "accel") if f"{sensor}_x" in clocks for note in clocks[f"{sensor}_x"].notes(sensor)
    ]

    def analyse(axis: str) -> AxisResult:
        return _axis(axis, axes[axis][1], clocks[axis], parameters)

    with ThreadPoolExecutor(2) as pool:
        results = dict(zip(axes, pool.map(analyse, axes), strict=True))
    first = next(iter(clocks.values()))
    still = stillness({a: v for a, (_, v) in axes.items() if a not in constant}, first.dt)
    notes += _stillness_notes(still)
    return Result(
        imu.name,
        f"{log.provenance.path} {log.provenance.hash}",
        {sensor: 1 / clocks[f"{sensor}_x"].dt for sensor in ("gyro", "accel") if f"{sensor}_x" in clocks},
        samples * first.dt,
        results,
        still.disturbances,
        (still.quiet_start, still.quiet_end),
        tuple(notes) + tuple(f"{axis}: {r.why_no_fit}" for axis, r in results.items() if r.why_no_fit),
    )


def error_model(result: Result) -> ImuErrorModel:
    """Return the fitted sums, with the intervals of what was found and the limits of what was not."""
    axes = {
        axis: AxisModel(
            found.processes,
            {
                letter: (c.lower if c.lower is not None else 0.0, c.upper)
                for letter, c in found.coefficients.items()
                if c.upper is not None
            },
        )
        for axis, found in result.axes.items()
        if found.processes is not None
    }
    return ImuErrorModel(result.imu, axes, {"log": result.source})


def _imu(log: Log) -> tuple[ImuStream, list[str]]:
    if not log.imus:
        streams = ", ".join(stream.name for stream in (*log.gnss, *log.references)) or "nothing that is read"
        message = f"{log.provenance.path}: no IMU in this log (it has {streams}); the Allan analysis needs one"
        raise MissingDataError(message)
    if len(log.imus) == 1:
        return log.imus[0], []
    names = ", ".join(imu.name for imu in log.imus)
    return log.imus[0], [f"{len(log.imus)} IMUs ({names}): {log.imus[0].name} is analysed; --imu takes another"]


class _Clock:
    """The even clock that a triad's stamps come near to, and where it breaks."""

    def __init__(self, time: NDArray[np.int64]) -> None:
        self.dt = sampling_interval(time)
        self.gaps = gaps(time)
        steps = np.diff(time)
        self.breaks = [int(i) + 1 for i in np.flatnonzero(steps > 1.5 * np.median(steps))]
        usual = steps[steps <= 1.5 * np.median(steps)] / SECOND
        self.jitter = float(usual.std() / self.dt)
        self.span = float(time[-1] - time[0]) / SECOND

    def notes(self, sensor: str) -> list[str]:
        """Return what the reader of a curve must know of its clock."""
        found: list[str] = []
        if self.breaks:
            lost = sum(length for _, length in self.gaps) - len(self.gaps) * self.dt
            found.append(
                f"{sensor}: {len(self.breaks)} gaps, {lost:.3g} s in all: no difference spans one, so averaging times "
                f"end at half the longest part without"
            )
        if self.jitter > JITTER:
            found.append(
                f"{sensor}: stamps scatter by {100 * self.jitter:.0f} % of the sampling interval; samples are taken as "
                f"even at {1 / self.dt:.4g} Hz, so averaging times near one interval are not to be trusted"
            )
        return found


def _axis(axis: str, values: Floats, clock: _Clock, parameters: Parameters) -> AxisResult:
    if np.ptp(values) == 0:
        return _nothing(axis, "the channel is constant: stuck, or not connected")
    try:
        curve = allan(
            values, clock.dt, parameters.averaging_times, level=parameters.level,
            uncertainty=parameters.uncertainty, breaks=clock.breaks,
        )  # fmt: skip
    except ValueError as error:
        message = f"{axis}: {error}"
        raise UsageError(message) from error
    octaves = curve
    if parameters.averaging_times != "octave":
        octaves = allan(values, clock.dt, "octave", level=parameters.level, breaks=clock.breaks)
    lines = find_lines(values, clock.dt) if parameters.lines and not clock.breaks else ()
    try:
        return _fitted(axis, curve, fit_allan(octaves, lines), lines)
    except ValueError as error:
        return _unfitted(axis, curve, str(error))


def _fitted(axis: str, curve: AllanDeviation, fit: AllanFit, lines: Sequence[Line]) -> AxisResult:
    rate_unit = coefficient_units(axis, "rate")[0].name
    return AxisResult(
        curve.averaging_time, curve.deviation, curve.lower, curve.upper, curve.degrees_of_freedom, curve.noise_type,
        fit.allan_deviation(curve.averaging_time, curve.dt),
        {
            letter: CoefficientResult(c.value, c.lower, c.upper, coefficient_units(axis, letter)[0].name, c.at)
            for letter, c in fit.coefficients.items()
        },
        fit.regions,
        None if fit.correlation_time is None else {
            "flat_centre": fit.correlation_time[0], "peak_matched": fit.correlation_time[1],
        },
        tuple(LineResult(x.frequency, x.amplitude, x.lower, x.upper, rate_unit) for x in lines),
        FitQuality(fit.shortest, fit.misfit, fit.probability), fit.processes, None,
    )  # fmt: skip


def _unfitted(axis: str, curve: AllanDeviation, why: str) -> AxisResult:
    empty = _nothing(axis, f"no fit: {why}")
    return AxisResult(
        curve.averaging_time, curve.deviation, curve.lower, curve.upper, curve.degrees_of_freedom, curve.noise_type,
        None, empty.coefficients, (), None, (), None, None, empty.why_no_fit,
    )  # fmt: skip


def _nothing(axis: str, why: str) -> AxisResult:
    none = np.empty(0)
    unknown = {
        letter: CoefficientResult(None, None, None, coefficient_units(axis, letter)[0].name, None) for letter in "QNBKR"
    }
    return AxisResult(none, none, none, none, none, np.empty(0, np.int64), None, unknown, (), None, (), None, None, why)


def _stillness_notes(still: Stillness) -> list[str]:
    quiet = f"--start {still.quiet_start:.0f} --end {still.quiet_end:.0f}"
    if still.moving:
        return [f"this is no static record: it moves in most of its parts; the longest quiet one: {quiet}"]
    if not still.disturbances:
        return []
    worst = max(still.disturbances, key=lambda d: d.largest)
    return [
        (
            f"{len(still.disturbances)} shocks or movements, the largest at {worst.start:.0f} s "
            f"({worst.largest:.0f} times the usual scatter, {', '.join(worst.axes)}); the longest part without: {quiet}"
        )
    ]
