"""From runs of a rate table to parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import MissingDataError, UsageError
from imuwb.identification import calibration
from imuwb.identification.calibration import Conditions, RateRun
from imuwb.log import AXES, source_of
from imuwb.stochastic import ImuErrorModel, corrected
from imuwb_plugins.calibration import model as models
from imuwb_plugins.calibration.result import Run, Step, TableResult
from imuwb_plugins.calibration.stretches import Stretch, check_clipping, steps, temperature_of
from imuwb_plugins.calibration.table_notes import table_notes
from imuwb_plugins.calibration.traces import table_trace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.log import Floats, Log
    from imuwb_plugins.calibration.parameters import RateTable

RANGES = (250, 300, 500, 1000, 2000, 4000, 8000, 20000)  #: deg/s, usual ones
UPRIGHT = 0.7  #: share of the force along an axis that stands upright


@dataclass(frozen=True, eq=False, slots=True)
class Found:
    """One run: its stretches, and what it tells."""

    stretches: list[Stretch]
    run: RateRun
    force: Floats | None  #: (k, 3) m/s², true as far as the given model says


def run(logs: Sequence[Log], p: RateTable) -> TableResult:
    """Return what runs of a rate table tell.

    Raises:
        MissingDataError: a log without gyro, without steps, that never turns, or is clipped.
        UsageError: rates that are not those of the steps.
    """
    base = models.read_base(p.into)
    found = [_found(log, p, base) for log in logs]
    degrees = p.magnitudes()
    highest = np.radians(degrees[-1])
    full_range = _full_range(p, base, float(highest))
    known = base is not None and any(any(axis.g_sensitivity) for axis in base.axes.values())
    known = known and all(f.force is not None for f in found)
    latitude = None if p.latitude is None else float(np.radians(p.latitude))
    conditions = Conditions(latitude, float(np.radians(p.misplacement)), full_range, known, p.level)
    try:
        fit = calibration.rate_table([f.run for f in found], conditions)
    except ValueError as error:
        raise MissingDataError(str(error)) from error
    axes = {f"gyro_{k}": c for k, c in zip("xyz", fit.axes, strict=True)}
    models.check_gain(axes, p.raw)
    celsius, warm = temperature_of([s for f in found for s in f.stretches])
    name = logs[0].imu().name
    provenance = {
        "calibration": f"rate-table, {', '.join(f'{d:g}' for d in degrees)} deg/s"
        + (f", {p.raw} to SI" if p.raw else ""),
        "calibration_logs": "; ".join(source_of(log) for log in logs),
    }
    model, moved = models.made(name, axes, base, provenance, {"gyro": full_range}, celsius)
    notes = [*table_notes([f.run for f in found], fit, p, full_range, known=known), *warm, *moved]
    return TableResult(
        name, p.level, p.raw, full_range, {axis: models.parameters(axis, c, p.raw) for axis, c in axes.items()},
        tuple(_run(f, r, p.raw) for f, r in zip(found, fit.runs, strict=True)), celsius, tuple(notes), model,
        tuple(table_trace(f.stretches, f.run, f.force, model, p.raw) for f in found),
    )  # fmt: skip


def _found(log: Log, p: RateTable, base: ImuErrorModel | None) -> Found:
    stretches = steps(log, p.shortest, p.raw)
    check_clipping(stretches, "gyro")
    means = calibration.means([s.gyro for s in stretches if s.gyro is not None])
    if not p.rates:
        message = f"{log.provenance.path}: its steps are {_levels(means.value, p.raw)}; say the table's rates: --rates 10,50,100 (deg/s)"
        raise UsageError(message)
    try:
        stair = calibration.matched(
            means.value, np.radians(p.magnitudes()).tolist(), log.provenance.path, raw=bool(p.raw)
        )
    except ValueError as error:
        given = ", ".join(f"{rate:g}" for rate in p.magnitudes())
        message = f"{error}; found: {_levels(means.value, p.raw)}; given: {given} deg/s"
        raise UsageError(message) from error
    seconds = np.array([s.seconds for s in stretches])
    force = _force(stretches, base)
    value = means.value
    if force is not None and base is not None:
        leaked = np.array([base.axes[a].g_sensitivity if a in base.axes else (0.0, 0.0, 0.0) for a in AXES[:3]])
        value = value - force @ leaked.T
    up = None if force is None else _up(force, stair.axis)
    better = calibration.Means(value, means.variance, means.freedom, means.red)
    return Found(stretches, RateRun(log.provenance.path, stair.axis, stair.rate, seconds, better, up), force)


def _force(stretches: Sequence[Stretch], base: ImuErrorModel | None) -> Floats | None:
    """Return the mean force in each step, less what the model knows of the accelerometers."""
    means = [s.accel.mean(axis=0) for s in stretches if s.accel is not None]
    if len(means) < len(stretches):
        return None
    force = np.stack(means)
    return force if base is None else corrected(base, (np.zeros_like(force), force), None)[1]


def _up(force: Floats, axis: int) -> float | None:
    share = float((force[:, axis] / np.linalg.norm(force, axis=1)).mean())
    return float(np.sign(share)) if abs(share) > UPRIGHT else None


def _levels(mean: Floats, raw: str) -> str:
    """Return the levels of the axis that turns most, as text."""
    steps_found = np.sort(mean[:, int(np.argmax(np.ptp(mean, axis=0)))])
    groups = np.split(steps_found, np.flatnonzero(np.diff(steps_found) > 0.01 * np.ptp(steps_found)) + 1)
    levels = [float(g.mean()) for g in groups]
    shown = [f"{v:.5g}" for v in levels] if raw else [f"{np.degrees(v):.4g}" for v in levels]
    return f"{', '.join(shown)} {raw or 'deg/s'}"


def _full_range(p: RateTable, base: ImuErrorModel | None, highest: float) -> float:
    if p.range is not None:
        return float(np.radians(p.range))
    ranges = [axis.range for name, axis in base.axes.items() if name.startswith("gyro") and axis.range] if base else []
    usual = [float(np.radians(r)) for r in RANGES if np.radians(r) >= highest * (1 - 1e-9)]
    return max(ranges) if ranges else usual[0]


def _run(found: Found, fit: calibration.RunFit, raw: str) -> Run:
    rows = tuple(
        Step(
            float(found.run.rate[i]), float(found.run.length[i]), _by_axis(found.run.means.value[i]),
            _by_axis(fit.residual[i]), _by_axis(fit.sigma[i]),
        )
        for i in range(len(found.run.rate))
    )  # fmt: skip
    offset = {f"gyro_{k}": models.parameter(e, raw or "rad/s") for k, e in zip("xyz", fit.offset, strict=True)}
    return Run(found.run.name, f"gyro_{'xyz'[found.run.axis]}", offset, rows)


def _by_axis(values: Floats) -> dict[str, float]:
    return {f"gyro_{k}": float(v) for k, v in zip("xyz", values, strict=True)}
