"""From runs of a rate table to the calibration of the gyros."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError, UsageError
from imuwb.estimators.calibration import before_logging
from imuwb.identification import calibration
from imuwb.identification.calibration import RateRun, TableConditions
from imuwb.log import AXES, Log
from imuwb.stochastic import ImuErrorModel, corrected
from imuwb_plugins.calibration.corrected_samples import table_trace
from imuwb_plugins.calibration.error_model import (
    check_gain,
    completed_model,
    full_range_of,
    parameters_of,
    provenance_of,
)
from imuwb_plugins.calibration.notes import table_notes
from imuwb_plugins.calibration.parameters import RateTable
from imuwb_plugins.calibration.result import Step, TableResult, TableRun
from imuwb_plugins.calibration.stretches import SteadyStretch, check_clipping, steps_of, temperature_of, unit_of_counts

RANGES = (250, 300, 500, 1000, 2000, 4000, 8000, 20000)  #: deg/s, usual full ranges
VERTICAL = 0.7  #: share of the specific force along an axis, from which the axis is vertical
SAME_LEVEL = 0.01  #: share of the span of the steps; steps closer together have the same level


@dataclass(frozen=True, eq=False, slots=True)
class TurnedLog:
    """One log of the rate table: its steps, and the run for the fit."""

    stretches: list[SteadyStretch]
    run: RateRun
    force: Floats | None  #: (k, 3) m/s², mean specific force corrected by the given model


def run(logs: Sequence[Log], p: RateTable) -> TableResult:
    """Return the calibration.

    Raises:
        MissingDataError: a log without gyro, without steps, without rotation, or clipped.
        UsageError: rates that do not match the steps.
    """
    base = None if p.into is None else ImuErrorModel.read(p.into)
    logs, before = before_logging(logs, undo=p.as_measured)
    p = replace(p, raw=unit_of_counts(logs, p.raw))
    turned = [_turned(log, p, base) for log in logs]
    runs = [t.run for t in turned]
    given = None if p.range is None else float(np.radians(p.range))
    fastest = np.radians(p.rates[-1]) * (1 - 1e-9)
    full_range = given or full_range_of("gyro", base, np.radians(RANGES).tolist(), fastest)
    known = base is not None and any(any(axis.g_sensitivity) for axis in base.axes.values())
    known = known and all(t.force is not None for t in turned)
    latitude = None if p.latitude is None else float(np.radians(p.latitude))
    conditions = TableConditions(latitude, float(np.radians(p.misplacement)), full_range, known, p.level)
    try:
        fit = calibration.rate_table(runs, conditions)
    except ValueError as error:
        raise MissingDataError(str(error)) from error
    axes = {f"gyro_{k}": c for k, c in zip("xyz", fit.axes, strict=True)}
    check_gain(axes, p.raw)
    celsius, warm_notes = temperature_of([s for t in turned for s in t.stretches])
    name = logs[0].imu().name
    origin = provenance_of(f"rate-table, {', '.join(f'{rate:g}' for rate in p.rates)} deg/s", logs, p.raw)
    model, model_notes = completed_model(name, axes, base, origin, {"gyro": full_range}, celsius)
    notes = (*before, *table_notes(runs, fit, p, full_range, known=known), *warm_notes, *model_notes)
    return TableResult(
        name, p.level, p.raw, full_range, {axis: parameters_of(axis, c, p.raw) for axis, c in axes.items()},
        tuple(_run(t.run, fitted, p.raw) for t, fitted in zip(turned, fit.runs, strict=True)), celsius, notes, model,
        tuple(table_trace(t.stretches, t.run, t.force, model, p.raw) for t in turned),
    )  # fmt: skip


def _turned(log: Log, p: RateTable, base: ImuErrorModel | None) -> TurnedLog:
    stretches, path = steps_of(log, p.shortest, p.raw), log.provenance.path
    check_clipping(stretches, "gyro")
    means = calibration.means([s.gyro for s in stretches if s.gyro is not None])
    if not p.rates:
        raise UsageError(
            f"{path}: its steps are {_levels(means.value, p.raw)}; give the rates of the table: --rates 10,50,100 (deg/s)"
        )
    try:
        staircase = calibration.matched(means.value, np.radians(p.rates).tolist(), path, raw=bool(p.raw))
    except ValueError as error:
        given = ", ".join(f"{rate:g}" for rate in p.rates)
        raise UsageError(f"{error}; found: {_levels(means.value, p.raw)}; given: {given} deg/s") from error
    force = _force(stretches, base)
    value = means.value
    if force is not None and base is not None:
        leaked = np.array([base.axes[a].g_sensitivity if a in base.axes else (0.0, 0.0, 0.0) for a in AXES[:3]])
        value = value - force @ leaked.T
    up = None if force is None else _up(force, staircase.axis)
    free = calibration.Means(value, means.variance, means.freedom, means.red)
    seconds = np.array([s.seconds for s in stretches])
    return TurnedLog(stretches, RateRun(path, staircase.axis, staircase.rate, seconds, free, up), force)


def _force(stretches: Sequence[SteadyStretch], base: ImuErrorModel | None) -> Floats | None:
    """Return the mean specific force in each step, corrected by the model's accelerometers; None without accelerometers."""
    means = [s.accel.mean(axis=0) for s in stretches if s.accel is not None]
    if len(means) < len(stretches):
        return None
    force = np.stack(means)
    return force if base is None else corrected(base, (np.zeros_like(force), force), None)[1]


def _up(force: Floats, axis: int) -> float | None:
    """Return +1 for an axis that points up, -1 for one that points down, None for one that is not vertical."""
    share = float((force[:, axis] / np.linalg.norm(force, axis=1)).mean())
    return float(np.sign(share)) if abs(share) > VERTICAL else None


def _levels(mean: Floats, raw: str) -> str:
    """Return the levels of the axis that turns most, as text."""
    steps = np.sort(mean[:, int(np.argmax(np.ptp(mean, axis=0)))])
    groups = np.split(steps, np.flatnonzero(np.diff(steps) > SAME_LEVEL * np.ptp(steps)) + 1)
    levels = [float(g.mean()) for g in groups]
    shown = [f"{v:.5g}" for v in levels] if raw else [f"{np.degrees(v):.4g}" for v in levels]
    return f"{', '.join(shown)} {raw or 'deg/s'}"


def _run(run: RateRun, fit: calibration.RunFit, raw: str) -> TableRun:
    axis = run.axis
    reference = np.zeros_like(run.rate) if raw else run.rate + fit.offset[axis].value
    error = run.means.value[:, axis] - reference
    steps = tuple(
        Step(
            float(run.rate[i]), float(run.length[i]), _by_axis(run.means.value[i]), _by_axis(fit.residual[i]),
            _by_axis(fit.sigma[i]), float(error[i]), float(error[i] - fit.residual[i, axis]),
        )
        for i in range(run.rate.size)
    )  # fmt: skip
    offset = {f"gyro_{k}": e.scaled(1.0, raw or "rad/s") for k, e in zip("xyz", fit.offset, strict=True)}
    return TableRun(run.name, f"gyro_{'xyz'[axis]}", offset, steps)


def _by_axis(values: Floats) -> dict[str, float]:
    return {f"gyro_{k}": float(v) for k, v in zip("xyz", values, strict=True)}
