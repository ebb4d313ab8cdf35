"""Streams that belong together: a temperature to its IMU, a gyro to its accelerometer, a velocity to its receiver."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import GnssStream, ImuStream

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from imuwb.log import Floats, Nanoseconds

_SENSOR = re.compile(r"(?<=/)(gyro|accel)(?=/|$)")
MATCHED = 0.9  #: share of the fixes that must have a velocity of their own


def sibling(topic: str, names: Sequence[str]) -> str | None:
    """Return the name that a topic belongs to: one it begins with, the only one, or the one that shares most of its path."""
    above = [name for name in names if topic.startswith(f"{name}/")]
    if above or len(names) == 1:
        return max(above, key=len) if above else names[0]

    def shared(name: str) -> int:
        parts = zip(topic.split("/")[:-1], name.split("/")[:-1], strict=False)
        return sum(1 for a, b in parts if a == b and a)

    return max(names, key=shared) if names and max(map(shared, names)) else None


def with_parts_joined(imus: tuple[ImuStream, ...]) -> tuple[tuple[ImuStream, ...], list[str]]:
    """Return IMUs with those made one of which a topic holds the gyro, another, called alike, the accelerometer."""
    parts = {
        (_SENSOR.sub("*", imu.name), sensor): imu
        for imu in imus
        for sensor, there, other in (
            ("gyro", imu.angular_rate, imu.specific_force),
            ("accel", imu.specific_force, imu.angular_rate),
        )
        if there is not None and other is None and _SENSOR.search(imu.name)
    }
    found, notes = list(imus), list[str]()
    for (name, sensor), gyro in parts.items():
        accel = parts.get((name, "accel"))
        if sensor != "gyro" or accel is None:
            continue
        whole = name.removesuffix("/*").replace("*", "imu")
        if any(imu.name == whole for imu in imus):
            continue
        warmth = gyro.temperature or accel.temperature
        repairs = (*gyro.origin.repairs, *(r for r in accel.origin.repairs if r not in gyro.origin.repairs))
        found[found.index(gyro)] = ImuStream(
            whole, gyro.angular_rate, accel.specific_force, warmth, replace(gyro.origin, repairs=repairs)
        )
        found.remove(accel)
        notes.append(f"{gyro.name} and {accel.name}: taken as the gyro and the accelerometer of one IMU, {whole}")
    return tuple(found), notes


def beside_fixes(
    streams: tuple[GnssStream, ...], topic: str, time: Nanoseconds, columns: Mapping[str, Floats]
) -> tuple[tuple[GnssStream, ...], str]:
    """Return the receivers with what a stream of its own tells of fixes joined to the one it is of, and a note about it.

    Each fix takes the row nearest in time, within half an interval of the fixes. Where a few fixes have none, it is unknown of
    those; where many have none, it is left out.

    Args:
        streams: receivers.
        topic: name of the stream.
        time: (m,) ns.
        columns: ``velocity`` and ``velocity_sigma`` (m, 3), or ``fix_type`` (m,).
    """
    what = "velocity" if "velocity" in columns else "fix type"
    name = sibling(topic, [g.name for g in streams if what != "velocity" or g.velocity is None])
    gnss = next((gnss for gnss in streams if gnss.name == name), None)
    if gnss is None or not len(gnss):
        return streams, f"{topic}: {what} of no receiver in the log, left out"
    after = np.searchsorted(time, gnss.time).clip(0, time.size - 1)
    before = (after - 1).clip(0)
    nearest = np.where(np.abs(time[after] - gnss.time) < np.abs(gnss.time - time[before]), after, before)
    interval = float(np.median(np.diff(gnss.time))) if len(gnss) > 1 else 0.0
    near = np.abs(time[nearest] - gnss.time) <= interval / 2
    if near.mean() < MATCHED:
        return streams, f"{topic}: only {near.sum()} of {len(gnss)} fixes of {gnss.name} have a {what} near; left out"
    values = {
        key: np.where(near.reshape(-1, *[1] * (column.ndim - 1)), column[nearest], np.nan)
        for key, column in columns.items()
    }
    if "fix_type" in values:
        joined = replace(gnss, fix_type=np.nan_to_num(values["fix_type"]).astype(np.int64))
    else:
        known = {key: column for key, column in values.items() if np.isfinite(column).any()}
        joined = replace(gnss, **known)
    missing = int(np.count_nonzero(~near))
    note = f"; {missing} fixes have none near" if missing else ""
    return tuple(joined if s is gnss else s for s in streams), f"{topic}: taken as the {what} of {gnss.name}{note}"
