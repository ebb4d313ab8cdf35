"""From a log to Allan deviations and fitted sums."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb import __version__
from imuwb.analysis import LineResult
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification import allan, deviation, find_lines, fit_allan, stillness
from imuwb.identification.record.suitable import unsuitable
from imuwb.log import source_of
from imuwb.progress import tracked
from imuwb.sampling import Sampling, longest_part, sampling
from imuwb.statistics import UNKNOWN
from imuwb.stochastic import AxisModel, GaussMarkov, ImuErrorModel, Sinusoid, Sum
from imuwb.units import coefficient_units
from imuwb_plugins.allan.estimates import estimates
from imuwb_plugins.allan.result import AxisResult, FitQuality, OtherDeviation, Result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.identification import AllanDeviation, AllanFit, Line, ModelChoice, Stillness
    from imuwb.log import Log, Nanoseconds
    from imuwb_plugins.allan.parameters import Parameters

    Floats = NDArray[np.float64]

FAST = (
    "fast mode: at averaging times of 32 samples and more the sums are thinned out and the times rounded; a deviation is off by less than "
    "a quarter of its interval's half width (quantization noise, of which thinning loses most, has wider intervals instead)"
)
FEWEST = 100  #: samples; fewer have no curve worth the name
SETTLED = (
    20.0  #: over a filter's band: averaging times, s, from which on white noise lost to it is less than a part in 250
)
JITTER = 0.2  #: of the sampling interval


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the Allan deviations and fits of the log's (first) IMU."""
    log = logs[0]
    imu = log.imu()
    axes = imu.axes()
    samples = min(time.size for time, _ in axes.values())
    if samples < FEWEST:
        message = f"{log.provenance.path}: {imu.name} has {samples} samples; an Allan deviation needs at least {FEWEST}"
        raise MissingDataError(message)
    constant = [axis for axis, (_, values) in axes.items() if np.ptp(values) == 0]
    if len(constant) == len(axes):
        message = f"{log.provenance.path}: every channel of {imu.name} is constant; there is no noise to analyse"
        raise MissingDataError(message)
    clocks = {sensor: sampling(axes[f"{sensor}_x"][0]) for sensor in ("gyro", "accel") if f"{sensor}_x" in axes}
    seconds = {sensor: log.seconds(axes[f"{sensor}_x"][0]) for sensor in clocks}
    still = stillness({a: (seconds[a.partition("_")[0]], v) for a, (_, v) in axes.items() if a not in constant})
    # The harmonics of a motion are no lines of the sensor.
    wanted = replace(parameters, lines=parameters.lines and not (still is not None and still.moving))

    def analyse(axis: str) -> AxisResult:
        return _axis(axis, *axes[axis], clocks[axis.partition("_")[0]], wanted, log.band)

    with ThreadPoolExecutor(2) as pool:
        results = dict(zip(axes, tracked(pool.map(analyse, axes), len(axes)), strict=True))
    spans = [(log.seconds(time[[0, -1]])) for time, _ in axes.values()]
    return Result(
        imu.name,
        source_of(log),
        parameters.level,
        {sensor: 1 / clock.interval for sensor, clock in clocks.items()},
        float(max(end for _, end in spans) - min(start for start, _ in spans)),
        results,
        None if still is None else still.moving,
        () if still is None else still.disturbances,
        None if still is None else (still.quiet_start, still.quiet_end),
        (
            *_stillness_notes(still),
            *([FAST] if parameters.fast else []),
            *_choice_notes(log),
            *(note for sensor, clock in clocks.items() for note in _clock_notes(sensor, clock)),
            *(f"{axis}: {r.why_no_fit}" for axis, r in results.items() if r.why_no_fit),
        ),
        parameters.model,
    )


def error_model(result: Result) -> ImuErrorModel:
    """Return the fitted sums, with the intervals of what was found and the limits of what was not."""
    axes = {axis: _model(found, result.model) for axis, found in result.axes.items() if found.processes is not None}
    if not axes:
        message = f"{result.imu}: no axis could be fitted, so there is no error model to save"
        raise MissingDataError(message)
    how = (
        "likelihood where a record allows it, else Allan variance"
        if result.model == "headline" and any(r.estimates for r in result.axes.values())
        else "Allan variance"
    )
    rates = ", ".join(f"{sensor} {rate:.6g} Hz" for sensor, rate in result.rate_hz.items())
    analysis = f"imuwb {__version__} allan, by {how}, {100 * result.level:g} % intervals"
    provenance = {"log": result.source, "analysis": analysis, "rate": rates}
    return ImuErrorModel(result.imu, axes, provenance)


def _model(found: AxisResult, whose: str) -> AxisModel:
    processes, coefficients = found.processes or Sum(), found.coefficients
    estimates = found.estimates if whose == "headline" else None
    if estimates is not None and estimates.processes is not None:
        processes, coefficients = estimates.processes, estimates.by[estimates.headline]
    if estimates is not None and estimates.choice is not None and _prefers_gauss_markov(estimates.choice):
        lines = [term for term in processes.terms if isinstance(term, Sinusoid)]
        processes = Sum((*estimates.choice.best.processes.terms, *lines))
        coefficients = {}  # intervals and limits are of another sum
    sure = {letter: c for letter, c in coefficients.items() if c.value is not None and c.lower}
    intervals = {
        f"{i}.{letter}": (c.lower or 0.0, c.upper or 0.0)
        for i, term in enumerate(processes.terms)
        for letter, c in sure.items()
        if hasattr(term, letter)
    }
    limits = {x: c.upper for x, c in coefficients.items() if x not in sure and math.isfinite(c.upper)}
    return AxisModel(processes, intervals, limits)


def _prefers_gauss_markov(choice: ModelChoice) -> bool:
    return choice.clear and any(isinstance(term, GaussMarkov) for term in choice.best.processes.terms)


def _choice_notes(log: Log) -> list[str]:
    if len(log.imus) == 1:
        return []
    names = ", ".join(imu.name for imu in log.imus)
    return [f"{len(log.imus)} IMUs ({names}): {log.imu().name} is analysed; --imu takes another"]


def _clock_notes(sensor: str, clock: Sampling) -> list[str]:
    """Return what the reader of a curve must know of its clock."""
    found: list[str] = []
    if clock.breaks:
        found.append(
            f"{sensor}: {len(clock.breaks)} gaps, {clock.missing:.3g} s in all: where they leave too few differences, averaging "
            f"times are bridged by block means; likelihood, wavelet variances and lines are of the longest part without, "
            f"if that is half of the record"
        )
    if clock.jitter > JITTER:
        found.append(
            f"{sensor}: stamps scatter by {100 * clock.jitter:.0f} % of the sampling interval; samples are taken as "
            f"even at {1 / clock.interval:.4g} Hz, so averaging times near one interval are not to be trusted"
        )
    return found


def _axis(
    axis: str, time: Nanoseconds, values: Floats, clock: Sampling, parameters: Parameters, band: float
) -> AxisResult:
    why = unsuitable(values, 1)
    if why is not None:
        return _nothing(axis, why)
    values = np.ascontiguousarray(values)
    try:
        curve = allan(
            values, clock.interval, parameters.averaging_times, level=parameters.level,
            uncertainty=parameters.uncertainty, breaks=clock.breaks, time=time, fast=parameters.fast,
        )  # fmt: skip
    except ValueError as error:
        message = f"{axis}: {error}"
        raise UsageError(message) from error
    octaves = curve
    if parameters.averaging_times != "octave" or parameters.fast:
        octaves = allan(values, clock.interval, "octave", level=parameters.level, breaks=clock.breaks, time=time)
    whole = _longest(values, clock)
    lines: tuple[Line, ...] = ()
    if parameters.lines and whole is not None:
        lines = tuple(x for x in find_lines(whole, clock.interval, parameters.level) if x.frequency <= band)
    try:
        found = _fitted(axis, curve, fit_allan(octaves, lines, SETTLED / band), lines)
    except ValueError as error:
        found = _unfitted(axis, curve, str(error))
    if whole is None:
        return found
    other = _other(whole, clock.interval, parameters)
    beside = (
        estimates(axis, whole, clock.interval, lines, found.coefficients, parameters, band)
        if parameters.estimators
        else None
    )
    return replace(found, other=other, estimates=beside)


def _longest(values: Floats, clock: Sampling) -> Floats | None:
    """Return the longest part without gaps; None where it is less than half of the record."""
    part = values[longest_part(clock.breaks, values.size)]
    return part if 2 * part.size >= values.size else None


def _other(values: Floats, dt: float, parameters: Parameters) -> OtherDeviation | None:
    if parameters.deviation == "allan":
        return None
    curve = deviation(values, dt, parameters.deviation, parameters.averaging_times, level=parameters.level)
    return OtherDeviation(parameters.deviation, curve.averaging_time, curve.deviation, curve.lower, curve.upper)


def _fitted(axis: str, curve: AllanDeviation, fit: AllanFit, lines: Sequence[Line]) -> AxisResult:
    rate_unit = coefficient_units(axis, "rate")[0].name
    return AxisResult(
        curve.averaging_time, curve.deviation, curve.lower, curve.upper, curve.degrees_of_freedom, curve.noise_type,
        fit.allan_deviation(curve.averaging_time, curve.dt),
        {
            letter: c.in_unit(coefficient_units(axis, letter)[0].name)
            for letter, c in fit.coefficients.items()
        },
        fit.regions,
        fit.correlation_time,
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
    unknown = {letter: UNKNOWN.in_unit(coefficient_units(axis, letter)[0].name) for letter in "QNBKR"}
    return AxisResult(none, none, none, none, none, np.empty(0, np.int64), None, unknown, (), None, (), None, None, why)


def _stillness_notes(still: Stillness | None) -> list[str]:
    if still is None:
        return [
            "too short, or too slow, to tell whether the IMU is still: if it moves, what follows is no noise of the sensor"
        ]
    # Seconds from the log's start, inwards to whole ones: what --start and --end take.
    quiet = f"--start {math.ceil(still.quiet_start)} --end {math.floor(still.quiet_end)}"
    if still.moving:
        text = (
            f"this is no static record: it moves in most of its parts, and what follows is no noise of the sensor; "
            f"its longest quiet part: {quiet}"
        )
        return [text]
    if not still.disturbances:
        return []
    worst = max(still.disturbances, key=lambda d: d.largest)
    text = (
        f"{len(still.disturbances)} shocks or movements, the largest at {worst.start:.0f} s "
        f"({worst.largest:.0f} times the usual scatter, {', '.join(worst.axes)}); the longest part without: {quiet}"
    )
    return [text]
