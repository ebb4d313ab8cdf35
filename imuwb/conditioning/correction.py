"""A log without the deterministic terms of an error model: bias, scale factors, cross-coupling, g-sensitivity.

The correction is causal: each sample is corrected with the last temperature and the last force that were measured up to its
time. Samples before the first measured value are corrected with that first value, because a filter would wait for it.
"""

from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.axes import check_three_axes
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import Conditioning, ImuStream, Log, Nanoseconds, Triad
from imuwb.notes import Note, ids
from imuwb.stochastic import ImuErrorModel, corrected, is_ideal, is_thermal, unscaled
from imuwb.stochastic.deterministic import PLAIN, RAW, THERMAL, states


def corrected_log(log: Log, model: ImuErrorModel) -> tuple[Log, tuple[Note, ...]]:
    """Return a log whose first IMU is corrected once, and a note; a log that ``correct`` has corrected before stays as it is.

    Raises:
        MissingDataError: as in ``correct``.
        UsageError: as in ``correct``.
    """
    if is_ideal(model):
        return log, ()
    before = next((step for step in log.conditioning if ids([step.note]) == ("corrected",)), None)
    if before is None:
        log, note = correct(log, model)
        return log, (note,)
    if (before.name, before.parameters) == _step(model):
        return log, (Note("corrected", before.note),)
    text = f"{before.name}:{before.parameters}"
    return log, (
        Note("corrected-before", f"not corrected by the model, because the samples were already corrected: {text}"),
    )


def correct(log: Log, model: ImuErrorModel, step: tuple[str, str] | None = None) -> tuple[Log, Note]:
    """Return a log without a model's deterministic terms in its first IMU, and a note that names these terms.

    Where the log has no temperature, the constant terms of the model are subtracted instead of its curves. If the model then has
    curves only, the log is returned unchanged.

    Args:
        log: log with an IMU; an error model describes one sensor, so only the first IMU is corrected.
        model: an error model with deterministic terms; its noise does not matter.
        step: name and parameters of the step in ``Log.conditioning``.

    Raises:
        MissingDataError: no IMU; no accelerometer, where gyros have a g-sensitivity.
        UsageError: terms so large that no motion fits the measurement.
    """
    imu = log.imu()
    where = f"{log.provenance.path}: {imu.name}"
    warm = imu.temperature is not None and len(imu.temperature) > 0
    fields = {**PLAIN, **THERMAL} if warm else PLAIN
    terms = {fields[name]: None for name in fields if states(model, name)}
    if not terms:
        return log, Note(
            "uncorrected", f"not corrected: {where} has no temperature, and all terms of the model depend on it"
        )
    if "g-sensitivity" in terms and imu.angular_rate is not None and imu.specific_force is None:
        raise MissingDataError(
            f"{where} has no accelerometer, and the error model {model.name} has a g-sensitivity: the gyros cannot be corrected without the force"
        )
    if {"cross-coupling", "g-sensitivity"} & terms.keys():
        check_three_axes(log.provenance.path, imu, f"a correction by the model's {_listed(tuple(terms))}")
    try:
        changed = replace(imu, angular_rate=_rate(imu, model), specific_force=_force(imu, model))
    except ValueError as error:
        raise UsageError(f"{where}: {error}") from error
    changed, lost = _in_si(changed, model)
    text = f"corrected by the model's {_listed(tuple(terms))}{_at(imu) if is_thermal(model) else ''}"
    note = Note("corrected", text + lost)
    name, parameters = step or _step(model)
    made = Conditioning(name, parameters, causal=True, delay=0.0, note=note)
    imus = (changed, *log.imus[1:])
    return replace(log, imus=imus, conditioning=(*log.conditioning, made)), note


def _in_si(imu: ImuStream, model: ImuErrorModel) -> tuple[ImuStream, str]:
    """Return the IMU without the axes that the model leaves in counts or volts, and what to say of them."""
    if RAW not in model.provenance:
        return imu, ""
    left = unscaled(model)

    def kept(triad: Triad | None, sensor: str) -> Triad | None:
        out = [f"{sensor}_{k}" in left for k in "xyz"]
        return None if triad is None or all(out) else Triad(triad.time, np.where(out, np.nan, triad.value))

    scaled = replace(
        imu, angular_rate=kept(imu.angular_rate, "gyro"), specific_force=kept(imu.specific_force, "accel"),
        origin=replace(imu.origin, units="rad/s, m/s²"),
    )  # fmt: skip
    if not left:
        return scaled, ""
    names = ", ".join(axis.replace("_", " ") for axis in left)
    return scaled, f"; without {names}: the model has no scale factor for these samples in {model.provenance[RAW]}"


def _step(model: ImuErrorModel) -> tuple[str, str]:
    return "error model", model.name


def _listed(terms: tuple[str, ...]) -> str:
    return " and ".join(filter(None, (", ".join(terms[:-1]), terms[-1])))


def _at(imu: ImuStream) -> str:
    """Return the temperature at which a model with curves is applied, as text."""
    if imu.temperature is None or not len(imu.temperature):
        return " with constant values in place of its curves, as the log has no temperature"
    celsius = imu.temperature.value
    return f" at the log's temperature of {celsius.min():.1f} to {celsius.max():.1f} °C"


def _force(imu: ImuStream, model: ImuErrorModel) -> Triad | None:
    accel = imu.specific_force
    if accel is None:
        return None
    value = _known(accel.value)
    force = corrected(model, (np.zeros_like(value), value), _celsius(imu, accel.time))[1]
    return Triad(accel.time, np.where(np.isnan(accel.value), np.nan, force))


def _rate(imu: ImuStream, model: ImuErrorModel) -> Triad | None:
    gyro, accel = imu.angular_rate, imu.specific_force
    if gyro is None:
        return None
    felt = np.zeros_like(gyro.value) if accel is None else _held(accel.time, _known(accel.value), gyro.time)
    rate = corrected(model, (_known(gyro.value), felt), _celsius(imu, gyro.time))[0]
    return Triad(gyro.time, np.where(np.isnan(gyro.value), np.nan, rate))


def _known(values: Floats) -> Floats:
    """Return a triad's values with 0 for an axis that it does not have; no other axis depends on it then."""
    return np.nan_to_num(values)


def _celsius(imu: ImuStream, time: Nanoseconds) -> Floats | None:
    """Return the temperature known at some times, °C; None where the log has no temperature."""
    if imu.temperature is None or not len(imu.temperature):
        return None
    return _held(imu.temperature.time, imu.temperature.value, time)


def _held(known: Nanoseconds, values: Floats, time: Nanoseconds) -> Floats:
    """Return, for each time, the last value measured up to it; before the first value, the first value."""
    return values[np.clip(np.searchsorted(known, time, side="right") - 1, 0, None)]
