"""Joins streams that belong together: a temperature and its IMU, a gyro and its accelerometer, a velocity and its receiver."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.log import GnssStream, ImuStream, Nanoseconds
from imuwb.notes import Note
from imuwb.readers.assembly.without_fix import fix_types
from imuwb.sampling import nearest
from imuwb.selection import joined_name, without_sensor

MOST = 4  #: proposals that a note lists
MATCHED = 0.9  #: least share of the fixes that must have a row nearby


def sibling(topic: str, names: Sequence[str]) -> str | None:
    """Return the name that a topic belongs to: its own or one that begins it, the only name, or one that shares most of the path."""
    if topic in names:
        return topic
    above = [name for name in names if topic.startswith(f"{name}/")]
    if above or len(names) == 1:
        return max(above, key=len) if above else names[0]

    def shared(name: str) -> int:
        parts = zip(topic.split("/")[:-1], name.split("/")[:-1], strict=False)
        return sum(1 for a, b in parts if a == b and a)

    return max(names, key=shared) if names and max(map(shared, names)) else None


def with_parts_joined(imus: tuple[ImuStream, ...]) -> tuple[tuple[ImuStream, ...], list[str]]:
    """Return the IMUs, of which halves are joined, and notes.

    A gyro and an accelerometer become one IMU if their names differ only in the sensor's word, and no other halves have these names.
    Halves that are left are proposed as ``--imu A+B`` with their names.
    """
    streams, notes = list(imus), list[str]()
    gyros = [imu for imu in imus if imu.angular_rate is not None and imu.specific_force is None]
    accels = [imu for imu in imus if imu.specific_force is not None and imu.angular_rate is None]
    for pattern in dict.fromkeys(without_sensor(imu.name) for imu in gyros):
        own, others = ([imu for imu in halves if without_sensor(imu.name) == pattern] for halves in (gyros, accels))
        name = joined_name(own[0].name)
        if (
            len(own) != 1
            or len(others) != 1
            or any(imu.name == name for imu in imus)
            or not _overlap(own[0], others[0])
        ):
            continue
        streams[streams.index(own[0])] = _joined(name, own[0], others[0])
        streams.remove(others[0])
        text = f"{own[0].name} and {others[0].name}: taken as the gyro and the accelerometer of one IMU, {name}"
        notes.append(Note("parts_joined", text))
    return tuple(streams), [*notes, *_proposals(streams)]


def _overlap(one: ImuStream, other: ImuStream) -> bool:
    """Return whether two halves were recorded at the same time."""
    spans = [t.time[[0, -1]] for imu in (one, other) for t in (imu.angular_rate, imu.specific_force) if t is not None]
    return bool(spans[0][0] <= spans[1][1] and spans[1][0] <= spans[0][1])


def _joined(name: str, gyro: ImuStream, accel: ImuStream) -> ImuStream:
    repairs = (*gyro.origin.repairs, *(r for r in accel.origin.repairs if r not in gyro.origin.repairs))
    origin = replace(gyro.origin, repairs=repairs)
    return ImuStream(name, gyro.angular_rate, accel.specific_force, gyro.temperature or accel.temperature, origin)


def _proposals(streams: Sequence[ImuStream]) -> Iterator[Note]:
    """Yield how each gyro that has no accelerometer can be used with one that has no gyro."""
    gyros = [imu for imu in streams if imu.angular_rate is not None and imu.specific_force is None]
    accels = [imu for imu in streams if imu.specific_force is not None and imu.angular_rate is None]
    pairs = [f"--imu {g.name}+{a.name}" for g in gyros for a in accels if _overlap(g, a)]
    if pairs:
        text = f"{len(gyros)} gyros and {len(accels)} accelerometers alone; to use two as one IMU: {' or '.join(pairs[:MOST])}"
        yield Note("parts_apart", text + (f" ({len(pairs)} pairs in all)" if len(pairs) > MOST else ""))


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
        whole = replace(gnss, fix_type=fix_types(values["fix_type"]))
    else:
        whole = replace(gnss, **{key: column for key, column in values.items() if np.isfinite(column).any()})
    missing = int(np.count_nonzero(~near))
    rest = f"; {missing} fixes have none nearby" if missing else ""
    note = Note("fix_rows_joined", f"{topic}: taken as the {quantity} of {gnss.name}{rest}")
    return tuple(whole if s is gnss else s for s in streams), note
