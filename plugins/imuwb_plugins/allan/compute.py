"""From a log to Allan deviations and the noise of each axis."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from imuwb import __version__
from imuwb.arrays import Floats
from imuwb.axes import Axis, axes_of, for_each, rates
from imuwb.errors import MissingDataError, UsageError
from imuwb.health import record_doubts, stillness_of
from imuwb.identification import NoiseIdentification, deviation, identify, printed_intervals
from imuwb.identification.record.suitable import unsuitable
from imuwb.log import Log, source_of
from imuwb.noise_results import ModelCurves, line_result
from imuwb.notes import Note
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.stochastic import FLICKER_LEVEL, AxisModel, ImuErrorModel, Sinusoid, Sum, of_either_sign
from imuwb.units import coefficient_units
from imuwb_plugins.allan.doubts import doubts_of
from imuwb_plugins.allan.notes import notes_of
from imuwb_plugins.allan.parameters import Parameters
from imuwb_plugins.allan.result import (
    AllanAxis,
    EstimatorComparison,
    FitQuality,
    OtherDeviation,
    ReadOut,
    Result,
)

FEWEST = 100  #: samples; fewer have no useful curve
POINTS = 200  #: averaging times of the model's curves in the figure


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the Allan deviations and fits of the log's (first) IMU.

    Raises:
        MissingDataError: too few samples, or all channels are constant.
        UsageError: no averaging time within the record.
    """
    log = logs[0]
    imu = log.imu()
    axes = axes_of(imu)
    _check(log, axes)
    still = stillness_of(log)
    doubts = record_doubts(log, still)
    # Harmonics of a motion are not lines of the sensor, so a moving IMU is not searched for lines.
    wanted = replace(parameters, lines=parameters.lines and not (still is not None and still.moving))
    results = for_each(axes, lambda axis: _axis(axis, wanted, log.band))
    spans = [log.seconds(axis.time[[0, -1]]) for axis in axes.values()]
    return Result(
        imu.name, source_of(log), parameters.level, rates(axes), float(max(s[1] for s in spans) - min(s[0] for s in spans)),
        results, None if still is None else still.moving, () if still is None else still.disturbances,
        None if still is None else (still.quiet_start, still.quiet_end),
        tuple(notes_of(axes, doubts, results, fast=parameters.fast)), parameters.model, doubts,
    )  # fmt: skip


def _check(log: Log, axes: Mapping[str, Axis]) -> None:
    path, imu = log.provenance.path, log.imu()
    samples = min(axis.time.size for axis in axes.values())
    if samples < FEWEST:
        raise MissingDataError(
            f"{path}: {imu.name} has {samples} samples; an Allan deviation takes at least {FEWEST}: record for longer"
        )
    if all(np.ptp(axis.values) == 0 for axis in axes.values()):
        raise MissingDataError(f"{path}: every channel of {imu.name} is constant, so there is no noise to analyse")


def _axis(axis: Axis, parameters: Parameters, band: float) -> AllanAxis:
    why = unsuitable(axis.values, 1)
    if why is not None:
        none = np.empty(0)
        return AllanAxis(none, none, none, none, none, np.empty(0, np.int64), None, _unknown(axis.name), why_no_fit=why)
    try:
        noise = identify(
            axis.values, axis.clock.interval, time=axis.time, breaks=axis.clock.breaks, level=parameters.level,
            averaging_times=parameters.averaging_times, uncertainty=parameters.uncertainty, fast=parameters.fast,
            lines=parameters.lines, estimators=parameters.estimators, choose=parameters.choose, band=band,
        )  # fmt: skip
    except ValueError as error:
        raise UsageError(f"{axis.name}: {error}") from error
    gapped = any(note.id == "gaps" for note in noise.notes)
    result = replace(
        _fitted(axis.name, noise, printed=parameters.uncertainty == "printed"),
        other=None if gapped else _other(axis, parameters),
    )
    if not parameters.estimators or gapped:
        return result
    return replace(result, estimates=_comparison(axis.name, noise))


def _other(axis: Axis, parameters: Parameters) -> OtherDeviation | None:
    if parameters.deviation == "allan":
        return None
    curve = deviation(
        axis.longest, axis.clock.interval, parameters.deviation, parameters.averaging_times, level=parameters.level
    )
    return OtherDeviation(parameters.deviation, curve.averaging_time, curve.deviation, curve.lower, curve.upper)


def _fitted(axis: str, noise: NoiseIdentification, *, printed: bool) -> AllanAxis:
    curve, fit = noise.curve, noise.allan
    arrays = (
        curve.averaging_time, curve.deviation, curve.lower, curve.upper, curve.degrees_of_freedom, curve.noise_type
    )  # fmt: skip
    if fit is None:
        why = next(note for note in noise.notes if note.id == "no-fit")
        return AllanAxis(*arrays, None, _unknown(axis), why_no_fit=str(why))
    own = printed_intervals(fit, curve.n * curve.dt) if printed else fit.coefficients
    coefficients = _with_units(axis, own)
    lines = tuple(line_result(axis, line) for line in noise.lines)
    return AllanAxis(
        *arrays, fit.allan_deviation(curve.averaging_time, curve.dt), coefficients, fit.regions, fit.correlation_time,
        fit.gauss_markov_time, lines, FitQuality(fit.shortest, fit.misfit, fit.probability), noise.allan_processes,
        _read_outs(coefficients, curve.averaging_time), model_curves=_model_curves(fit.processes, fit.shortest, curve.averaging_time[-1], noise.dt),
    )  # fmt: skip


def _read_outs(coefficients: Mapping[str, Coefficient], averaging_time: Floats) -> tuple[ReadOut, ...]:
    return tuple(
        ReadOut(letter, c.at, factor * c.value)
        for letter, factor in (("N", 1.0), ("K", 1.0), ("B", FLICKER_LEVEL))
        if (c := coefficients[letter]).value is not None
        and c.at is not None
        and averaging_time[0] <= c.at <= averaging_time[-1]
    )


def _model_curves(processes: Sum, begin: float, end: float, dt: float) -> ModelCurves:
    tau = np.geomspace(begin, max(end, 1.01 * begin), POINTS)
    parts = [
        term for term in processes.terms if not isinstance(term, Sinusoid)
    ]  # the arches of lines would hide the others
    whole, *terms = (np.sqrt(part.allan_variance(tau, dt)) for part in (processes, *parts))
    return ModelCurves(tau, whole, tuple(terms))


def _comparison(axis: str, noise: NoiseIdentification) -> EstimatorComparison:
    by = {name: _with_units(axis, coefficients) for name, coefficients in noise.estimators.items()}
    notes = tuple(note for note in noise.notes if note.id != "no-fit")
    return EstimatorComparison(
        noise.headline, by, noise.processes, not noise.prefers_gauss_markov,
        None if noise.likelihood is None else noise.likelihood.highest, noise.agree, noise.differences,
        noise.stationarity, noise.choice, noise.mean, notes,
    )  # fmt: skip


def _with_units(axis: str, coefficients: Mapping[str, Coefficient]) -> dict[str, Coefficient]:
    return {letter: c.in_unit(coefficient_units(axis, letter)[0].name) for letter, c in coefficients.items()}


def _unknown(axis: str) -> dict[str, Coefficient]:
    return _with_units(axis, dict.fromkeys("QNBKR", UNKNOWN))


def error_model(result: Result) -> ImuErrorModel:
    """Return the identified sums, with the intervals of their terms, the limits of the terms that are absent, and all doubts.

    Raises:
        MissingDataError: no axis has a fit.
    """
    headline = result.model == "headline"
    axes = {axis: _model(r, headline=headline) for axis, r in result.axes.items() if r.processes is not None}
    if not axes:
        raise MissingDataError(f"{result.imu}: no axis could be fitted, so there is no error model to save")
    how = (
        "likelihood where a record allows it, else Allan variance"
        if headline and any(r.estimates for r in result.axes.values())
        else "Allan variance"
    )
    rates = ", ".join(f"{sensor} {rate:.6g} Hz" for sensor, rate in result.rate_hz.items())
    analysis = f"imuwb {__version__} allan, by {how}, {100 * result.level:g} % intervals"
    model = ImuErrorModel(result.imu, axes, {"log": result.source, "analysis": analysis, "rate": rates})
    return replace(model, doubts=doubts_of(result, model).all)


def objections(result: Result) -> tuple[Note, ...]:
    """Return why no error model should be made of this record; errors as of ``error_model``."""
    return doubts_of(result, error_model(result)).grave


def _model(axis: AllanAxis, *, headline: bool) -> AxisModel:
    estimates, processes, coefficients = axis.estimates, axis.processes or Sum(), axis.coefficients
    if headline and estimates is not None:
        processes = estimates.processes
        coefficients = estimates.by[estimates.headline] if estimates.intervals_apply else {}
    sure = {letter: c for letter, c in coefficients.items() if c.value is not None and c.lower}
    intervals = {
        f"{i}.{letter}": of_either_sign(getattr(term, letter), c.lower or 0.0, c.upper)
        for i, term in enumerate(processes.terms)
        for letter, c in sure.items()
        if hasattr(term, letter)
    }
    limits = {x: c.upper for x, c in coefficients.items() if x not in sure and 0 < c.upper < math.inf}
    return AxisModel(processes, intervals, limits)
