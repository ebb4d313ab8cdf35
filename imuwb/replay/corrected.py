"""A log without what its error model says of its sensors at each temperature: bias, scale factor, cross-coupling."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import UsageError
from imuwb.log import Conditioning, ImuStream, Triad
from imuwb.stochastic import corrected, is_ideal, is_thermal

if TYPE_CHECKING:
    from imuwb.log import Floats, Log, Nanoseconds
    from imuwb.stochastic import ImuErrorModel

STEP = "error model"  #: name of the correction among a log's conditioning
CONDITIONER = "correction"  #: the conditioner that does the same
#: terms -> as they are told
TERMS = {
    ("bias", "thermal_bias"): "bias", ("scale_factor", "thermal_scale_factor"): "scale factor",
    ("scale_factor_nonlinear",): "non-linear scale factor", ("cross_coupling",): "cross-coupling",
    ("g_sensitivity",): "g-sensitivity",
}  # fmt: skip
PLAIN = " at the plain values beside its curves, as the log has no temperature"


def corrected_log(log: Log, model: ImuErrorModel) -> tuple[Log, tuple[str, ...]]:
    """Return a log whose IMU's samples are without a model's deterministic terms, and what was taken off in words.

    The temperature is the log's own, interpolated at the samples and held beyond. A log that was corrected before is
    returned as it is.

    Args:
        log: an IMU; only the first is corrected.
        model: its deterministic terms; what it says of noise does not matter.

    Raises:
        MissingDataError: no IMU.
        UsageError: terms so large that no motion is shown as measured.
    """
    if is_ideal(model):
        return log, ()
    before = next((step for step in log.conditioning if step.name in (STEP, CONDITIONER)), None)
    if before is not None:
        return log, (before.note,) if before.name == STEP else (_left(before),)
    imu = log.imu()
    note = f"corrected by the model's {_told(model)}{_at(imu, model)}"
    try:
        triads = _triads(imu, model)
    except ValueError as error:
        raise UsageError(str(error)) from error
    changed = replace(imu, angular_rate=triads[0], specific_force=triads[1])
    step = Conditioning(STEP, model.name, causal=True, delay=0.0, note=note)
    imus = tuple(changed if one is imu else one for one in log.imus)
    return replace(log, imus=imus, conditioning=(*log.conditioning, step)), (note,)


def _left(step: Conditioning) -> str:
    """Return why a model's deterministic terms are left on."""
    return f"not corrected by the model's deterministic terms: the samples went through {step.name} ({step.parameters})"


def _told(model: ImuErrorModel) -> str:
    """Return a model's deterministic terms in words."""
    there = [
        word
        for names, word in TERMS.items()
        if any(np.any(getattr(axis, name)) for axis in model.axes.values() for name in names)
    ]
    return " and ".join(filter(None, (", ".join(there[:-1]), there[-1])))


def _at(imu: ImuStream, model: ImuErrorModel) -> str:
    """Return at which temperature a correction is made, in words."""
    if not is_thermal(model):
        return ""
    if imu.temperature is None or not len(imu.temperature):
        return PLAIN
    celsius = imu.temperature.value
    return f" at the log's temperature of {celsius.min():.1f} to {celsius.max():.1f} °C"


def _triads(imu: ImuStream, model: ImuErrorModel) -> tuple[Triad | None, Triad | None]:
    """Return gyros and accelerometers without a model's terms, each at its own times."""
    gyro, accel = imu.angular_rate, imu.specific_force

    def motion(own: Triad) -> tuple[Floats, Floats]:
        """Return the motion at one triad's times; what the other shows of it is interpolated."""
        both = _onto(own.time, gyro), _onto(own.time, accel)
        return corrected(model, both, _celsius(imu, own.time))

    if gyro is not None and accel is not None and np.array_equal(gyro.time, accel.time):
        rate, force = motion(gyro)
        return Triad(gyro.time, rate), Triad(accel.time, force)
    return (
        None if gyro is None else Triad(gyro.time, motion(gyro)[0]),
        None if accel is None else Triad(accel.time, motion(accel)[1]),
    )


def _onto(time: Nanoseconds, triad: Triad | None) -> Floats:
    """Return a triad's values at times; none where there is no triad."""
    if triad is None or not len(triad):
        return np.zeros((time.size, 3))
    if triad.time is time or np.array_equal(triad.time, time):
        return triad.value
    own = (triad.time - time[0]).astype(np.float64)
    return np.stack([np.interp(time - time[0], own, triad.value[:, i]) for i in range(3)], axis=1)


def _celsius(imu: ImuStream, time: Nanoseconds) -> Floats | None:
    """Return the temperature at times; None where it is not known."""
    if imu.temperature is None or not len(imu.temperature):
        return None
    own = (imu.temperature.time - time[0]).astype(np.float64)
    return np.interp(time - time[0], own, imu.temperature.value)
