"""The inverse of a sensor's deterministic terms, sample by sample."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Table
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import AXES, Conditioning, Triad
from imuwb.stochastic import AxisModel, ImuErrorModel, corrected, is_ideal, is_thermal
from imuwb.units import STANDARD_GRAVITY, coefficient_units

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from imuwb.analysis import Review
    from imuwb.log import Floats, ImuStream, Log, Nanoseconds, Scalars

TERMS = {
    "bias": "bias", "thermal_bias": "bias by temperature", "scale_factor": "scale factor",
    "thermal_scale_factor": "scale factor by temperature", "scale_factor_nonlinear": "non-linear scale factor",
    "cross_coupling": "cross-coupling", "g_sensitivity": "g-sensitivity",
}  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True)
class Found:
    """What was taken off."""

    model: str
    axes: Mapping[str, AxisModel]
    celsius: tuple[float, float] | None  #: lowest and highest, of a model that depends on it


def condition(log: Log, path: Path) -> tuple[Log, Found]:
    """Return the log less the deterministic terms of the model in a file.

    Raises:
        UsageError: no model there, one without such terms, or terms that cannot be taken off.
        MissingDataError: the model needs a temperature, or forces, that the log has not.
    """
    model = ImuErrorModel.read(path)
    if is_ideal(model):
        message = f"correction: {path}: the model has no bias, scale factor, cross-coupling or g-sensitivity to take off; imuwb calibration finds them"
        raise UsageError(message)
    if any(step.name == "correction" and step.parameters == f"model={path}" for step in log.conditioning):
        message = f"correction: {path}: its terms are taken off already; give it once"
        raise UsageError(message)
    log.imu()
    imus = tuple(_imu(log, imu, model, path) for imu in log.imus)
    said = [text for name, text in TERMS.items() if any(_any(getattr(axis, name)) for axis in model.axes.values())]
    span = _span(log) if is_thermal(model) else None
    note = f"{', '.join(said)} of {model.name} are taken off"
    if span is not None:
        note += f", at the log's temperature of {span[0]:.1f} to {span[1]:.1f} °C"
    made = Conditioning("correction", f"model={path}", causal=True, delay=0.0, note=note)
    changed = replace(log, imus=imus, conditioning=(*log.conditioning, made))
    return changed, Found(model.name, model.axes, span)


def draw(found: Found, review: Review) -> None:
    """Show the terms of each axis."""
    rows = tuple((axis, *_row(axis, found.axes[axis])) for axis in AXES if axis in found.axes)
    headings = ("axis", "bias", "scale factor", "non-linear", "cross-coupling [mrad]", "g-sensitivity [deg/s/g]")
    caption = (
        ""
        if found.celsius is None
        else f"… depends on temperature: {found.celsius[0]:.1f} to {found.celsius[1]:.1f} °C here."
    )
    review.table(Table(f"Taken off, as {found.model} says", headings, rows, caption, wide=True))


def _imu(log: Log, imu: ImuStream, model: ImuErrorModel, path: Path) -> ImuStream:
    where = f"correction: {log.provenance.path}: {imu.name}"
    if is_thermal(model) and (imu.temperature is None or not len(imu.temperature)):
        message = f"{where} has no temperature, and {path} has terms that depend on it"
        raise MissingDataError(message)
    gyro, accel = imu.angular_rate, imu.specific_force
    leaks = any(any(axis.g_sensitivity) for axis in model.axes.values())
    if leaks and gyro is not None and accel is None:
        message = f"{where} has no accelerometer, and {path} has a g-sensitivity of the gyros, for which the force must be known"
        raise MissingDataError(message)
    try:
        force = None if accel is None else _force(model, accel, _celsius(model, imu.temperature, accel.time))
        rate = None if gyro is None else _rate(model, gyro, accel, _celsius(model, imu.temperature, gyro.time))
    except ValueError as error:
        message = f"{where}: {error}"
        raise UsageError(message) from error
    return replace(imu, angular_rate=rate, specific_force=force)


def _force(model: ImuErrorModel, accel: Triad, celsius: Floats | None) -> Triad:
    return Triad(accel.time, corrected(model, (np.zeros_like(accel.value), accel.value), celsius)[1])


def _rate(model: ImuErrorModel, gyro: Triad, accel: Triad | None, celsius: Floats | None) -> Triad:
    felt = np.zeros_like(gyro.value) if accel is None else _latest(accel.time, accel.value, gyro.time)
    return Triad(gyro.time, corrected(model, (gyro.value, felt), celsius)[0])


def _celsius(model: ImuErrorModel, temperature: Scalars | None, time: Nanoseconds) -> Floats | None:
    if temperature is None or not is_thermal(model):
        return None
    return _latest(temperature.time, temperature.value, time)


def _latest(known: Nanoseconds, values: Floats, time: Nanoseconds) -> Floats:
    """Return the last values known at times, so that no sample knows a later one; before the first, the first."""
    return values[np.clip(np.searchsorted(known, time, side="right") - 1, 0, None)]


def _span(log: Log) -> tuple[float, float] | None:
    values = [imu.temperature.value for imu in log.imus if imu.temperature is not None]
    return (float(min(v.min() for v in values)), float(max(v.max() for v in values))) if values else None


def _any(term: object) -> bool:
    return any(term) if isinstance(term, tuple) else bool(term)


def _row(axis: str, model: AxisModel) -> tuple[str, ...]:
    unit = coefficient_units(axis, "rate")[1]
    bias = "…" if model.thermal_bias else f"{unit.from_si(model.bias):.6g} {unit.name}"
    scale = "…" if model.thermal_scale_factor else f"{100 * model.scale_factor:.5g} %"
    leak = (
        ", ".join(f"{np.degrees(g) * STANDARD_GRAVITY:.4g}" for g in model.g_sensitivity)
        if any(model.g_sensitivity)
        else "—"
    )
    cross = ", ".join(f"{1e3 * c:.4g}" for c in model.cross_coupling) if any(model.cross_coupling) else "—"
    bent = f"{100 * model.scale_factor_nonlinear:.4g} %" if model.scale_factor_nonlinear else "—"
    return bias, scale, bent, cross, leak
