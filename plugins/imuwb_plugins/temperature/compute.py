"""From logs to noise and bias over temperature."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from imuwb import __version__
from imuwb.axes import THREADS, axes_of, rates
from imuwb.errors import MissingDataError, UsageError
from imuwb.estimators.calibration import before_logging, sensor_identity
from imuwb.health import Doubts, model_doubts
from imuwb.identification.temperature import (
    AxisTemperatures,
    Record,
    SetPoint,
    ThermalLag,
    axis_model,
    heterogeneity,
    log_sigma,
    over_temperature,
    set_point_of,
)
from imuwb.log import AXES, Log, source_of
from imuwb.notes import Note
from imuwb.progress import tracked
from imuwb.selection import with_first
from imuwb.stochastic import ImuErrorModel
from imuwb.units import coefficient_units
from imuwb_plugins.temperature.axis_result import axis_result
from imuwb_plugins.temperature.log_checks import check_thermometers, check_together, imu_of, with_sound_thermometers
from imuwb_plugins.temperature.parameters import Parameters
from imuwb_plugins.temperature.records import FEWEST, LogPart, grouped, parts_of
from imuwb_plugins.temperature.result import CONVENTION, LagResult, Result, lag_sentence
from imuwb_plugins.temperature.sensor_temperature import lags_of

DIFFERENT = 1e-3  #: probability by chance, below which N differs between logs
NOTICEABLE = 0.02  #: relative difference of N between logs, from which a note reports it
NAMED = 6  #: temperatures in a note, at most


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return noise and bias of each axis over temperature.

    Raises:
        MissingDataError: a log without temperature, or of a moving sensor; a single temperature.
        UsageError: logs that do not belong together, or options that do not suit the logs.
    """
    logs = [with_first(log, imu_of(log, parameters)) for log in logs]
    logs, before = before_logging(logs, undo=parameters.as_measured)
    notes = [*before, *check_together(logs, parameters), *check_thermometers(logs, parameters)]
    logs, thermometer_notes = with_sound_thermometers(logs, parameters)
    notes += thermometer_notes
    lags = lags_of(logs, parameters)
    known = _lag_results(logs, lags)
    notes += [Note("lag", f"{one.log}: {lag_sentence(one)}") for one in known if one.removed]
    cuts, groups, part_notes, doubts = _groups(logs, lags, parameters)
    notes += [*doubts.all, *part_notes]
    names = [axis for axis in AXES if any(axis in p.axes for group in groups for p in group)]
    axes, axis_notes = _axes(names, groups, parameters)
    notes += axis_notes
    if not axes:
        raise MissingDataError(f"{logs[0].provenance.path}: no axis has noise at two temperatures: {'; '.join(notes)}")
    lowest, highest = (end(p.celsius for over in axes.values() for p in over.points) for end in (min, max))
    reference = min(max(parameters.reference, lowest), highest)
    if reference != parameters.reference:
        text = (
            f"no log is at {parameters.reference:g} °C: the nearest temperature, {reference:.4g} °C, is the reference"
        )
        notes.append(Note("reference", text))
    if len(logs) > 1 and all(over.biases.turn_on is None for over in axes.values()):
        text = (
            "every temperature has one log, so a bias that changes at each turn-on cannot be separated from a bias that "
            "depends on temperature; several logs at one temperature separate them"
        )
        notes.append(Note("turn-on", text))
    if not any(over.biases.hysteresis for over in axes.values()):
        text = "hysteresis is not estimated: no log reaches a temperature both from below and from above"
        notes.append(Note("no-hysteresis", text))
    return Result(
        logs[0].imu().name, "; ".join(source_of(log) for log in logs), parameters.level, parameters.size, reference, CONVENTION,
        cuts, known, rates(axes_of(logs[0].imu())),
        {axis: axis_result(axis, over, reference, parameters.reference, _widest(logs, lags)) for axis, over in axes.items()},
        tuple(dict.fromkeys(notes)), doubts, sensor_identity(logs[0]),
    )  # fmt: skip


def _lag_results(logs: Sequence[Log], lags: Sequence[ThermalLag | None]) -> tuple[LagResult, ...]:
    return tuple(
        LagResult(
            log.provenance.path, thermal.lag, thermal.evident,
            {axis: h.scaled(1.0, coefficient_units(axis, "rate")[0].name) for axis, h in thermal.hysteresis.items()},
        )
        for log, thermal in zip(logs, lags, strict=True)
        if thermal is not None
    )  # fmt: skip


def _widest(logs: Sequence[Log], lags: Sequence[ThermalLag | None]) -> tuple[str, ThermalLag] | None:
    """Return path and temperature of the log whose temperature has the widest range."""
    known = [(log.provenance.path, lag) for log, lag in zip(logs, lags, strict=True) if lag is not None]
    return max(known, key=lambda one: float(np.ptp(one[1].celsius)), default=None)


def _groups(
    logs: Sequence[Log], lags: Sequence[ThermalLag | None], parameters: Parameters
) -> tuple[tuple[str, ...], list[list[LogPart]], list[Note], Doubts]:
    """Return how each log was divided, the parts at each temperature with enough samples, notes, and what is in doubt."""
    parts: list[LogPart] = []
    cuts: list[str] = []
    notes: list[Note] = []
    doubts = Doubts()
    for i, (log, thermal) in enumerate(zip(logs, lags, strict=True)):
        given = parameters.celsius[i] if parameters.celsius else None
        cut, log_parts, log_doubts = parts_of(i, log, given, parameters, thermal)
        parts += log_parts
        cuts.append(cut)
        doubts += log_doubts
    groups = grouped(parts, lambda part: part.stretch.nominal)
    usable = [group for group in groups if any(part.has_enough() for part in group)]
    if len(usable) < 2 and parameters.cut == "auto" and "plateaus" in cuts:  # noqa: PLR2004 - one temperature only
        # The plateau at the end of a warm-up is one temperature, and the way to it has others.
        return _groups(logs, lags, replace(parameters, cut="bins"))
    short = [group[0].stretch.nominal for group in groups if group not in usable]
    if short:
        where = ", ".join(f"{t:.4g}" for t in short[:NAMED]) + (" ..." if len(short) > NAMED else "")
        text = f"left out, with fewer than {FEWEST} samples: {len(short)} of {len(groups)} temperatures ({where} °C)"
        notes.append(Note("short", text))
    _require_two(logs, usable, bool(groups))
    return tuple(cuts), usable, notes, doubts


def _require_two(logs: Sequence[Log], groups: Sequence[list[LogPart]], any_stretch: bool) -> None:  # noqa: FBT001 - of one temperature
    if len(groups) > 1:
        return
    where = logs[0].provenance.path + (f" and {len(logs) - 1} more" if len(logs) > 1 else "")
    if not groups:
        why = f"no temperature has {FEWEST} samples" if any_stretch else "no stretch has one temperature"
        raise MissingDataError(f"{where}: {why}; use wider bins with --bins, or longer logs")
    celsius = groups[0][0].stretch.celsius
    raise MissingDataError(
        f"{where}: one temperature only ({celsius:.1f} °C), which shows no dependence on temperature; give logs of other "
        "temperatures, or --celsius if the thermometer is stuck; for the noise alone, use imuwb noise"
    )


def _axes(
    names: Sequence[str], groups: Sequence[list[LogPart]], parameters: Parameters
) -> tuple[dict[str, AxisTemperatures], list[Note]]:
    """Return each axis with at least two set-points over temperature, and notes."""
    jobs = [(axis, group) for axis in names for group in groups]

    def identified(job: tuple[str, list[LogPart]]) -> tuple[SetPoint | None, str]:
        return _set_point(*job, parameters)

    with ThreadPoolExecutor(THREADS) as pool:
        points = list(tracked(pool.map(identified, jobs), len(jobs)))
    axes: dict[str, AxisTemperatures] = {}
    notes: list[Note] = []
    for axis in names:
        own = [(group, point, text) for (name, group), (point, text) in zip(jobs, points, strict=True) if name == axis]
        notes += _axis_notes(axis, [(group[0].stretch.nominal, text) for group, _, text in own if text])
        known = [point for _, point, _ in own if point is not None]
        if len(known) > 1:
            axes[axis] = _over(known, parameters)
    return axes, notes


def _set_point(axis: str, group: Sequence[LogPart], parameters: Parameters) -> tuple[SetPoint | None, str]:
    taken = [(part, r) for part in group if (r := part.record(axis)) is not None]
    if not taken:
        return None, ""
    part = taken[0][0]
    dt, band = part.axes[axis].clock.interval, part.log.band
    records = [record for _, record in taken]
    try:
        point = set_point_of(records, dt, level=parameters.level, band=band)
    except ValueError as error:
        return None, str(error)
    apart = _difference_of_logs(records, dt, band, parameters.level)
    if apart is None:
        return point, ""
    paths = ", ".join(p.log.provenance.path for p, _ in taken)
    return point, f"N differs by {100 * apart:.0f} % between logs ({paths}); check that they are of one sensor"


def _difference_of_logs(records: Sequence[Record], dt: float, band: float, level: float) -> float | None:
    """Return the relative difference of N between logs at one temperature; None if chance explains it."""
    if len({record.log for record in records}) < 2:  # noqa: PLR2004 - a difference needs two logs
        return None
    each = [set_point_of([record], dt, level=level, band=band).coefficients["N"] for record in records]
    known = [(c.value, s) for c in each if c.value is not None and (s := log_sigma(c, level))]
    if len(known) < 2:  # noqa: PLR2004 - a difference needs two values
        return None
    sizes, sigmas = (np.array(column) for column in zip(*known, strict=True))
    apart, test = float(sizes.max() / sizes.min() - 1), heterogeneity(np.log(sizes), sigmas)
    return None if test is None or (test.p_value or 0.0) > DIFFERENT or apart < NOTICEABLE else apart


def _axis_notes(axis: str, remarks: Sequence[tuple[float, str]]) -> list[Note]:
    """Return the remarks on an axis, each once, with its temperatures."""
    by_text: dict[str, list[float]] = {}
    for celsius, text in remarks:
        by_text.setdefault(text, []).append(celsius)
    return [
        Note("set-point", f"{axis}, {f'{len(t)} temperatures from {min(t):.4g} to {max(t):.4g}' if len(t) > 1 else f'at {t[0]:.4g}'} °C: {text}")
        for text, t in by_text.items()
    ]  # fmt: skip


def _over(points: Sequence[SetPoint], parameters: Parameters) -> AxisTemperatures:
    kind = None if parameters.function == "auto" else parameters.function
    try:
        return over_temperature(points, level=parameters.level, size=parameters.size, kind=kind)
    except ValueError as error:
        raise UsageError(f"--function {parameters.function}: {error}") from error


def error_model(result: Result) -> ImuErrorModel:
    """Return the error model: processes and biases of all axes as functions of temperature."""
    axes = {
        name: axis_model(axis.over, result.reference, gravity=name.startswith("accel"))
        for name, axis in result.axes.items()
    }
    rates = ", ".join(f"{sensor} {rate:.6g} Hz" for sensor, rate in result.rate_hz.items())
    provenance = {
        "log": result.source,
        "analysis": f"imuwb {__version__} temperature, by likelihood, {100 * result.level:g} % intervals at {result.reference:g} °C",
        "rate": rates,
        "bias": (
            f"accelerometers: change from {result.reference:g} °C; gyros: the mean of a still record, which includes the earth's "
            "rate"
        ),
    }
    model = ImuErrorModel(result.imu, axes, provenance | result.identity)
    return replace(model, doubts=(result.doubts + model_doubts(model)).all)


def objections(result: Result) -> tuple[Note, ...]:
    """Return why no error model should be made of these records."""
    return (result.doubts + model_doubts(error_model(result))).grave
