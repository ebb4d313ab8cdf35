"""What PX4 took off the samples that it logged, and the samples without that.

PX4 since 1.11 (src/lib/sensor_calibration/Accelerometer.hpp, Gyroscope.hpp, Utilities.cpp) logs R ((v - t - o) s) in
``sensor_combined`` and ``vehicle_imu``, and v in ``sensor_accel`` and ``sensor_gyro``: t is the polynomial of temperature, o the
offset, s the scale factor of an accelerometer, R the rotation of the board. Parameters are those of the slot whose ID is the
number of the device. Before 1.11 the drivers took o and s off, so that sensor_accel and sensor_gyro lack them too. t is computed again when the temperature has moved by 1 °C, so it is known here within that step.
"""

import math
import re
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.estimators.calibration.thermal import subtracted
from imuwb.estimators.calibration.turns import celsius_of, rotation_numbered
from imuwb.geodesy import rotation_of_euler
from imuwb.log import ImuStream, Log, Triad

_CORRECTED = re.compile(r"(sensor_combined|vehicle_imu)\b.*")
_BARE = re.compile(r"sensor_(accel|gyro)\b.*")
_SLOTS = 4
_NAMES = {"gyro": ("CAL_GYRO", "TC_G"), "accel": ("CAL_ACC", "TC_A")}
_LEVEL = tuple(
    f"SENS_BOARD_{axis}_OFF" for axis in "XYZ"
)  #: deg: roll, pitch, yaw that are turned after the board's rotation
_UINT32 = 1 << 32


def tells(log: Log, imu: ImuStream) -> bool:
    """Return whether an IMU is one of PX4's whose samples are bare, or corrected by parameters that the log states."""
    stated = any(name.startswith(("CAL_ACC", "CAL_GYRO")) for name in log.settings)
    return bool(_BARE.fullmatch(imu.name) or (_CORRECTED.fullmatch(imu.name) and stated))


def taken_off(log: Log, imu: ImuStream) -> tuple[str, ...]:
    """Return the names of the parameters that changed the samples; none is neutral. Without a device: those of all slots."""
    bare = _BARE.fullmatch(imu.name) is not None
    if bare and not _by_driver(log):
        return ()
    forms = [] if bare else ["SENS_BOARD_ROT", *_LEVEL]
    for sensor, (calibration, thermal) in _NAMES.items():
        place, warm = slot(log, imu, calibration), slot(log, imu, thermal)
        forms += [rf"{calibration}{_any(place)}_[XYZ](OFF|SCALE)"]
        forms += [] if bare else [rf"{calibration}{_any(place)}_ROT"]
        doubtful = warm is not None or device(log, imu, sensor) is None
        if not bare and log.settings.get(f"{thermal}_ENABLE") and doubtful:
            forms.append(rf"{thermal}{_any(warm)}_X.*")
    form = "|".join(forms)
    return tuple(n for n, value in log.settings.items() if re.fullmatch(form, n) and not _neutral(n, value))


def device(log: Log, imu: ImuStream, sensor: str) -> int | None:
    """Return the number of the device of an IMU's ``gyro`` or ``accel``: as its topic states it, or the only one with parameters."""
    stated = log.devices.get(imu.name, {}).get(sensor)
    if stated:
        return stated
    known = [own for i in range(_SLOTS) if (own := log.settings.get(f"{_NAMES[sensor][0]}{i}_ID", 0.0))]
    return int(known[0]) % _UINT32 if len(known) == 1 and math.isfinite(known[0]) else None


def slot(log: Log, imu: ImuStream, prefix: str) -> int | None:
    """Return the number of the parameters ``CAL_ACC``, ``TC_G`` and so on that belong to an IMU's device; None without."""
    sensor = next(name for name, prefixes in _NAMES.items() if prefix in prefixes)
    number = device(log, imu, sensor)
    ids = {i: log.settings.get(f"{prefix}{i}_ID", 0.0) for i in range(_SLOTS)}
    return next((i for i, own in ids.items() if number and math.isfinite(own) and int(own) % _UINT32 == number), None)


def measured(log: Log, imu: ImuStream) -> ImuStream:
    """Return the IMU with the samples of its sensor.

    Raises:
        MissingDataError: the device is not known, of several that have parameters; a rotation that is not known; no
            temperature, where the correction depends on it.
    """
    for sensor, triad in (("gyro", imu.angular_rate), ("accel", imu.specific_force)):
        if triad is not None and device(log, imu, sensor) is None:
            raise MissingDataError(
                f"{log.provenance.path}: {imu.name}: the log does not state from which {sensor} its samples come, or that changed; "
                "the topics sensor_accel and sensor_gyro are as the sensor measured; log them"
            )
    rate = _measured(log, imu, imu.angular_rate, "gyro")
    force = _measured(log, imu, imu.specific_force, "accel")
    return replace(imu, angular_rate=rate, specific_force=force)


def _measured(log: Log, imu: ImuStream, triad: Triad | None, sensor: str) -> Triad | None:
    if triad is None:
        return None
    calibration, thermal = _NAMES[sensor]
    place = slot(log, imu, calibration)
    bare = _BARE.fullmatch(imu.name) is not None
    value = triad.value if bare else triad.value @ _rotation(log, place, calibration)
    if place is not None:
        value = value / _row(log, f"{calibration}{place}", "SCALE", 1.0) + _row(
            log, f"{calibration}{place}", "OFF", 0.0
        )
    warm = slot(log, imu, thermal)
    if not bare and warm is not None and log.settings.get(f"{thermal}_ENABLE"):
        names = [f"{thermal}{warm}_{name}" for name in ("TMIN", "TMAX", "TREF")]
        values = dict(zip(names, (0.0, 100.0, 25.0), strict=True)) | dict(log.settings)
        celsius = celsius_of(log, imu, triad.time, needed=True)
        value = value + subtracted("px4-tc", values, celsius, warm, (sensor,))[int(sensor == "accel")]
    return Triad(triad.time, value)


def _rotation(log: Log, place: int | None, calibration: str) -> Floats:
    """Return the rotation from the sensor's axes to the body's: that of an external sensor, or of the board."""
    own = f"{calibration}{place}_ROT"
    if place is not None and log.settings.get(own, -1.0) >= 0:
        return rotation_numbered(log, own)
    level = np.radians([[log.settings.get(name, 0.0) for name in _LEVEL]])
    return rotation_of_euler(level)[0] @ rotation_numbered(log, "SENS_BOARD_ROT")


def _row(log: Log, prefix: str, name: str, otherwise: float) -> Floats:
    row = np.array([log.settings.get(f"{prefix}_{axis}{name}", otherwise) for axis in "XYZ"])
    return np.where(row == 0, 1.0, row) if name == "SCALE" else row


def _by_driver(log: Log) -> bool:
    """Return whether the drivers of sensors took offset and scale off, as before PX4 1.11, which knows no scale of gyros."""
    return any(re.fullmatch(r"CAL_GYRO\d_XSCALE", name) for name in log.settings)


def _any(place: int | None) -> str:
    return r"\d" if place is None else str(place)


def _neutral(name: str, value: float) -> bool:
    if name.endswith("SCALE"):
        return value in (0.0, 1.0)
    if re.fullmatch(r"CAL_[A-Z]+\d_ROT", name):
        return value <= 0
    return value == 0
