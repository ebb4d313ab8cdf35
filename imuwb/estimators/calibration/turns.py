"""Rotations that autopilots name by a number, and the temperature of an IMU at its samples."""

from collections.abc import Mapping

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.geodesy import rotation_of_euler
from imuwb.log import ImuStream, Log, Nanoseconds

#: number -> roll, pitch, yaw (deg), which ArduPilot and PX4 share. Source: MAV_SENSOR_ORIENTATION
_TURNS: Mapping[int, tuple[int, int, int]] = {
    **{i: (0, 0, 45 * i) for i in range(8)}, **{8 + i: (180, 0, 45 * i) for i in range(8)}, 12: (0, 180, 0),
    **{16 + i: (90, 0, 45 * i) for i in range(4)}, **{20 + i: (270, 0, 45 * i) for i in range(4)}, 24: (0, 90, 0), 25: (0, 270, 0),
    26: (0, 180, 90), 27: (0, 180, 270), 28: (90, 90, 0), 29: (180, 90, 0), 30: (270, 90, 0), 31: (90, 180, 0), 32: (270, 180, 0),
    33: (90, 270, 0), 34: (180, 270, 0), 35: (270, 270, 0), 36: (90, 180, 90), 37: (90, 0, 270),
}  # fmt: skip


def rotation_numbered(log: Log, name: str) -> Floats:
    """Return the rotation (3, 3) from the sensor's axes to the body's that a parameter of a log names; no parameter: none.

    Raises:
        MissingDataError: a number of which no angles are known.
    """
    turn = log.settings.get(name, 0.0)
    if turn not in _TURNS:
        raise MissingDataError(f"{log.provenance.path}: {name} {turn:g} is a rotation of which no angles are known")
    return rotation_of_euler(np.radians(np.array([_TURNS[int(turn)]], float)))[0]


def celsius_of(log: Log, imu: ImuStream, time: Nanoseconds, *, needed: bool) -> Floats:
    """Return the temperature (n,) °C of an IMU at times; 25 °C where it is not stated and not needed.

    Raises:
        MissingDataError: it is needed and not stated.
    """
    if imu.temperature is None or not len(imu.temperature):
        if needed:
            raise MissingDataError(
                f"{log.provenance.path}: {imu.name} has no temperature, on which its correction depended"
            )
        return np.full(time.size, 25.0)
    return np.interp(time.astype(float), imu.temperature.time.astype(float), imu.temperature.value)
