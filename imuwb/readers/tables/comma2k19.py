"""Folders of the data set comma2k19: a folder for each sensor with the arrays ``t`` and ``value``.

Times are seconds since power-up, rates rad/s, specific forces m/s², forward-right-down; fixes are latitude, longitude (deg), speed
(m/s), Unix ms, height (m), course (deg). Source: commaai/comma2k19, README.md and Example_1.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats
from imuwb.errors import UnreadableLogError
from imuwb.log import Kind, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.flight import trajectory
from imuwb.readers.tables.numpy_files import array_of
from imuwb.units import SECOND

FILES = ("t", "value")
MAGIC = b"\x93NUMPY"
#: sensor -> stream, column
IMU = {
    "accelerometer": ("imu", "specific_force"), "gyro": ("imu", "angular_rate"), "gyro_uncalibrated": ("gyro_uncalibrated", "angular_rate"),
}  # fmt: skip
GNSS, SPEED = "live_gnss_ublox", "CAN/speed"
AXES, FIX = 3, 6  #: columns of a sensor and of a fix
LATEST = 2**62 / SECOND  #: s


def is_sensor(folder: Path) -> bool:
    """Return whether a folder has the two arrays of a sensor."""
    return all(_is_array(folder / name) for name in FILES)


def _is_array(path: Path) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(len(MAGIC)) == MAGIC


def sensors_of(folder: Path) -> dict[str, Path]:
    """Return the sensors in a folder, {name: folder}, such as ``IMU/gyro``; the folder may be one sensor itself."""
    if is_sensor(folder):
        return {folder.name: folder} if folder.name in (*IMU, GNSS) else {}
    for top in (folder / "processed_log", folder):
        found = {
            f"{kind}/{part.name}": part
            for kind in ("IMU", "GNSS", "CAN")
            if (top / kind).is_dir()
            for part in sorted((top / kind).iterdir())
        }
        if any(is_sensor(part) for name, part in found.items() if name.startswith("IMU/")):
            return found
    return (
        {part.name: part for part in sorted(folder.iterdir()) if part.name in IMU and is_sensor(part)}
        if folder.is_dir()
        else {}
    )


def streamed(folder: Path) -> Iterator[Batch | Remark]:
    """Yield the streams of the sensors.

    Raises:
        UnreadableLogError: an array is damaged, or has another shape.
    """
    rest: list[str] = []
    for name, part in sensors_of(folder).items():
        sensor = name.rpartition("/")[2]
        if not is_sensor(part) or not (sensor in (*IMU, GNSS) or name == SPEED):
            rest.append(name)
            continue
        time, value = _timed(part)
        if sensor == GNSS:
            yield from _fixes(time, _shaped(part, value, FIX))
        elif sensor in IMU:
            stream, column = IMU[sensor]
            yield _batch(
                stream, "imu", time, {column: _shaped(part, value, AXES)}, Origin("rad/s, m/s²", "FRD", "boot")
            )
        else:
            yield _batch(
                "speed", "speed", time, {"speed": _shaped(part, value, 1)[:, 0]}, Origin("m/s", "forward", "boot")
            )
    if rest:
        yield unused(rest, "imuwb uses the inertial sensors, the fixes of the u-blox receiver, and the speed")


def _batch(stream: str, kind: Kind, time: NDArray[np.int64], columns: Mapping[str, Floats], origin: Origin) -> Batch:
    return Batch(stream, kind, time, dict(columns), origin)


def _timed(part: Path) -> tuple[NDArray[np.int64], NDArray[Any]]:
    """Return the times (ns) and the values of a sensor, as many as both arrays have."""
    seconds, value = array_of(part / "t"), array_of(part / "value")
    if seconds.ndim != 1 or value.ndim not in (1, 2) or {seconds.dtype.kind, value.dtype.kind} - set("fiu"):
        raise UnreadableLogError(f"{part}: t and value are no arrays of numbers with one row for each time")
    count = min(seconds.size, value.shape[0])
    stamps = np.asarray(seconds[:count], np.float64)
    with np.errstate(invalid="ignore"):
        stamps = np.where(np.abs(stamps) < LATEST, stamps, LATEST)  # such rows are left out, and counted
    return np.rint(stamps * SECOND).astype(np.int64), value[:count]


def _shaped(part: Path, value: NDArray[Any], width: int) -> Floats:
    """Return values as (n, width)."""
    table = value.reshape(len(value), -1)
    if table.shape[1] < width:
        raise UnreadableLogError(f"{part}: its values have {table.shape[1]} columns; {part.name} has {width}")
    return np.asarray(table[:, :width], np.float64)


def _fixes(time: NDArray[np.int64], value: Floats) -> Iterator[Batch | Remark]:
    latitude, longitude, speed, _, height, course = value.T
    columns = {
        "position": trajectory.positions(latitude, longitude, height), "velocity": trajectory.velocities(speed, course),
    }  # fmt: skip
    origin = Origin("deg, m, m/s", "NED", "boot")
    yield from trajectory.located("gnss", "gnss", time, columns, origin, 0)
    yield Remark(
        Note("arrival_time", "gnss: fixes have the time of their arrival, on the clock of the inertial sensors")
    )
