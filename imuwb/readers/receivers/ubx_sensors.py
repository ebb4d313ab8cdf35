"""The inertial sensors of a u-blox receiver, from ESF-RAW and ESF-MEAS.

Types, scales: u-blox ZED-F9K and ZED-F9R integration manuals, "sensor data types": angular rates 2^-12 deg/s, accelerations
2^-10 m/s² with gravity, temperature 0.01 °C, speed 1 mm/s. A measurement has a time tag of the sensor, not UTC (``sensor_tags``).
"""

from collections.abc import Iterator

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.log import Nanoseconds, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.receivers.sensor_tags import tagged
from imuwb.readers.receivers.ubx_clock import UbxClock
from imuwb.readers.receivers.ubx_log import Values
from imuwb.units import Epoch

GYRO, ACCEL, TEMPERATURE, SPEED = (14, 13, 5), (16, 17, 18), 12, 11  #: types; x, y, z
RATE_STEP, FORCE_STEP, TEMPERATURE_STEP, SPEED_STEP = np.radians(2.0**-12), 2.0**-10, 0.01, 0.001
TRIADS = (("angular_rate", GYRO, RATE_STEP), ("specific_force", ACCEL, FORCE_STEP))
_NAMES = {
    6: "front-left wheel ticks",
    7: "front-right wheel ticks",
    8: "rear-left wheel ticks",
    9: "rear-right wheel ticks",
    10: "single tick",
}


def sensor_streams(
    name: str, rows: Values, clock: UbxClock | None, frame: str | None, bytes_read: int
) -> Iterator[Batch | Remark]:
    """Yield the IMU and the speed of each data provider of one kind of message.

    Args:
        name: of the message.
        rows: ``place``, ``source``, ``tag``, ``type``, ``number`` of all measurements.
        clock: of the log; None if it states no date.
        frame: FRD or FLU, if the user states it.
        bytes_read: of the file.
    """
    # Tags of the wheels' provider may have another clock than those of the receiver's own sensors.
    for source in np.unique(rows["source"]).tolist():
        mine = {key: values[rows["source"] == source] for key, values in rows.items()}
        stream = name if not source else f"{name}.{source}"
        times = tagged(stream, mine["place"], mine["tag"], clock, milliseconds=name == "ESF-MEAS")
        yield from times.remarks
        if times.time is not None:
            yield from _streams(stream, mine, times.time, times.epoch, frame, bytes_read)
    other = {_NAMES.get(kind, f"type {kind}") for kind in np.unique(rows["type"]).tolist()} - {
        f"type {kind}" for kind in (*GYRO, *ACCEL, TEMPERATURE, SPEED)
    }
    if other:
        yield unused(sorted(f"{name} {kind}" for kind in other), "imuwb uses rates, forces, temperature and speed")


def _streams(
    name: str, rows: Values, time: Nanoseconds, epoch: Epoch, frame: str | None, bytes_read: int
) -> Iterator[Batch | Remark]:
    signs = np.array([1.0, -1.0, -1.0]) if frame == "FLU" else np.ones(3)
    origin = Origin("2^-12 deg/s, 2^-10 m/s²", f"{frame} (stated)" if frame else "FRD (assumed)", epoch)
    any_triad = False
    for column, kinds, step in TRIADS:
        at, values, lost = _triad(rows, kinds)
        if lost:
            note = Note("incomplete", f"{column.replace('_', ' ')}s without all of x, y and z of one time tag left out")
            yield Remark(note, name, lost)
        if at.size:
            any_triad = True
            yield Batch(name, "imu", time[at], {column: values * step * signs}, origin, bytes_read)
    warm = np.flatnonzero(rows["type"] == TEMPERATURE)
    if warm.size and any_triad:
        values = {"temperature": rows["number"][warm] * TEMPERATURE_STEP}
        yield Batch(name, "imu", time[warm], values, origin, bytes_read)
    moving = np.flatnonzero(rows["type"] == SPEED)
    if moving.size:
        values = {"speed": rows["number"][moving] * SPEED_STEP}
        yield Batch(f"{name} speed", "speed", time[moving], values, Origin("mm/s", "forward", epoch), bytes_read)


def _triad(rows: Values, kinds: tuple[int, int, int]) -> tuple[Integers, Floats, int]:
    """Return the rows of x of whole triads, their values (n, 3), and how many measurements belong to no whole triad."""
    _, message = np.unique(rows["place"], return_inverse=True)
    key = (message.astype(np.int64) << 32) | rows["tag"].astype(np.int64)
    axes = [np.flatnonzero(rows["type"] == kind) for kind in kinds]
    firsts = [axis[np.unique(key[axis], return_index=True)[1]] for axis in axes]
    common = np.intersect1d(np.intersect1d(key[firsts[0]], key[firsts[1]]), key[firsts[2]])
    found = [axis[np.isin(key[axis], common)] for axis in firsts]
    lost = max(axis.size for axis in axes) - common.size
    values = np.stack([rows["number"][axis] for axis in found], axis=1).astype(np.float64)
    return found[0], values, lost
