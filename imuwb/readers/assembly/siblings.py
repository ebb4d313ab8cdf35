"""Joins streams that belong together: a temperature and its IMU, a gyro and its accelerometer, a velocity and its receiver."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.log import GnssStream, ImuStream, Nanoseconds
from imuwb.notes import Note
from imuwb.sampling import nearest

_SENSOR = re.compile(r"(?<=/)(gyro|accel)(?=/|$)")
MATCHED = 0.9  #: least share of the fixes that must have a row nearby


def sibling(topic: str, names: Sequence[str]) -> str | None:
    """Return the name that a topic belongs to: one that begins the topic, the only name, or one that shares most of the path."""
    above = [name for name in names if topic.startswith(f"{name}/")]
    if above or len(names) == 1:
        return max(above, key=len) if above else names[0]

    def shared(name: str) -> int:
        parts = zip(topic.split("/")[:-1], name.split("/")[:-1], strict=False)
        return sum(1 for a, b in parts if a == b and a)

    return max(names, key=shared) if names and max(map(shared, names)) else None


def with_parts_joined(imus: tuple[ImuStream, ...]) -> tuple[tuple[ImuStream, ...], list[str]]:
    """Return the IMUs; a gyro and an accelerometer whose topics differ only in the sensor's name become one IMU."""
    named = {imu: _SENSOR.sub("*", imu.name) for imu in imus if _SENSOR.search(imu.name)}
    gyros = {name: imu for imu, name in named.items() if imu.angular_rate is not None and imu.specific_force is None}
    accels = {name: imu for imu, name in named.items() if imu.specific_force is not None and imu.angular_rate is None}
    streams, notes = list(imus), list[str]()
    for pattern, gyro in gyros.items():
        accel = accels.get(pattern)
        if accel is None:
            continue
        name = pattern.removesuffix("/*").replace("*", "imu")
        if any(imu.name == name for imu in imus):
            continue
        repairs = (*gyro.origin.repairs, *(r for r in accel.origin.repairs if r not in gyro.origin.repairs))
        temperature, origin = gyro.temperature or accel.temperature, replace(gyro.origin, repairs=repairs)
        streams[streams.index(gyro)] = ImuStream(name, gyro.angular_rate, accel.specific_force, temperature, origin)
        streams.remove(accel)
        text = f"{gyro.name} and {accel.name}: taken as the gyro and the accelerometer of one IMU, {name}"
        notes.append(Note("parts_joined", text))
    return tuple(streams), notes


def with_fix_rows(
    streams: tuple[GnssStream, ...], topic: str, time: Nanoseconds, columns: Mapping[str, Floats]
) -> tuple[tuple[GnssStream, ...], Note]:
    """Return receivers with the velocities or fix types of another stream joined to one of them, and a note about it.

    Each fix takes the row nearest in time, within half an interval of the fixes. If a few fixes have no such row, their value is
    unknown; if many fixes have no such row, all rows are left out.

    Args:
        streams: receivers.
        topic: name of the other stream.
        time: (m,) ns, times of its rows.
        columns: ``velocity`` and ``velocity_sigma`` (m, 3), or ``fix_type`` (m,).
    """
    quantity = "velocity" if "velocity" in columns else "fix type"
    name = sibling(topic, [g.name for g in streams if quantity != "velocity" or g.velocity is None])
    gnss = next((gnss for gnss in streams if gnss.name == name), None)
    if gnss is None or not len(gnss):
        text = f"{topic}: no receiver in the log has this {quantity}; it is left out"
        return streams, Note("fix_rows_left_out", text)
    rows = nearest(gnss.time, time)
    interval = float(np.median(np.diff(gnss.time))) if len(gnss) > 1 else 0.0
    near = np.abs(time[rows] - gnss.time) <= interval / 2
    if near.mean() < MATCHED:
        text = (
            f"{topic}: only {near.sum()} of {len(gnss)} fixes of {gnss.name} have a {quantity} nearby; it is left out"
        )
        return streams, Note("fix_rows_left_out", text)
    values = {
        key: np.where(near.reshape(-1, *[1] * (column.ndim - 1)), column[rows], np.nan)
        for key, column in columns.items()
    }
    if "fix_type" in values:
        whole = replace(gnss, fix_type=np.nan_to_num(values["fix_type"]).astype(np.int64))
    else:
        whole = replace(gnss, **{key: column for key, column in values.items() if np.isfinite(column).any()})
    missing = int(np.count_nonzero(~near))
    rest = f"; {missing} fixes have none nearby" if missing else ""
    note = Note("fix_rows_joined", f"{topic}: taken as the {quantity} of {gnss.name}{rest}")
    return tuple(whole if s is gnss else s for s in streams), note
