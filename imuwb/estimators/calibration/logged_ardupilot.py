"""What ArduPilot took off the samples that it logged, and the samples without that.

ArduPilot (libraries/AP_InertialSensor/AP_InertialSensor_Backend.cpp) logs R (((v - t) - o) s): v is the sensor's value, t the
polynomial of temperature, o the offset, s the scale factor of an accelerometer, and R the rotation of the board.
"""

import re
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.estimators.calibration.thermal import subtracted
from imuwb.estimators.calibration.turns import celsius_of, rotation_numbered
from imuwb.log import ImuStream, Log, Triad

_STREAM = re.compile(r"(?:IMU|ACC)([123]?)(?:\.(\d))?(?:\+GYR.*)?")


def tells(log: Log, imu: ImuStream) -> bool:
    """Return whether an IMU is one of ArduPilot's, and the log states its parameters."""
    return instance(imu.name) is not None and any(name.startswith("INS_") for name in log.settings)


def instance(name: str) -> int | None:
    """Return the number of an IMU of ArduPilot, from 0; None for another stream."""
    match = _STREAM.fullmatch(name)
    if match is None:
        return None
    return int(match[2]) if match[2] else max(int(match[1] or 1) - 1, 0)


def taken_off(log: Log, imu: ImuStream) -> tuple[str, ...]:
    """Return the names of the parameters that changed the samples; none is neutral."""
    place = instance(imu.name) or 0
    number, thermal = "" if place == 0 else str(place + 1), f"INS_TCAL{place + 1}_"
    form = rf"INS_(ACC{number}(OFFS|SCAL)|GYR{number}OFFS)_[XYZ]|AHRS_ORIENTATION"
    form += rf"|{thermal}(ACC|GYR).*" if log.settings.get(f"{thermal}ENABLE") == 1.0 else ""
    stated = log.settings.items()
    return tuple(n for n, value in stated if re.fullmatch(form, n) and value != (1.0 if "SCAL" in n else 0.0))


def measured(log: Log, imu: ImuStream) -> ImuStream:
    """Return the IMU with the samples of its sensor.

    Raises:
        MissingDataError: a rotation that is not known; no temperature, where the correction depends on it.
    """
    place = instance(imu.name) or 0
    rotation = rotation_numbered(log, "AHRS_ORIENTATION")
    rate = _measured(log, imu, imu.angular_rate, rotation, place, accel=False)
    force = _measured(log, imu, imu.specific_force, rotation, place, accel=True)
    return replace(imu, angular_rate=rate, specific_force=force)


def _measured(
    log: Log, imu: ImuStream, triad: Triad | None, rotation: Floats, place: int, *, accel: bool
) -> Triad | None:
    if triad is None:
        return None
    settings, number, prefix = log.settings, "" if place == 0 else str(place + 1), f"INS_TCAL{place + 1}"
    warm = settings.get(f"{prefix}_ENABLE", 0.0) == 1.0
    neutral = {f"{prefix}_TMIN": 0.0, f"{prefix}_TMAX": 70.0}
    neutral |= {f"INS_{kind}{place + 1}_CALTEMP": -300.0 for kind in ("ACC", "GYR")}
    values = neutral | {n: v for n, v in settings.items() if warm or not n.startswith("INS_TCAL")}
    off = subtracted("ardupilot-tcal", values, celsius_of(log, imu, triad.time, needed=warm), place)[int(accel)]
    scale = [settings.get(f"INS_ACC{number}SCAL_{axis}", 1.0) for axis in "XYZ"] if accel else [1.0] * 3
    return Triad(triad.time, triad.value @ rotation / np.where(np.array(scale) == 0, 1.0, scale) + off)
