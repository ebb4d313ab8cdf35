"""What receivers of flight controllers tell, as the columns of a GNSS stream."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.readers.batch import Remark

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


HIGHEST = 1e5  #: m
FASTEST = 2e4  #: m/s; more is a damaged record


@dataclass(frozen=True, eq=False, slots=True)
class GpsRows:
    """Fixes as speed over ground and course; nan where something is not told."""

    latitude: Floats  #: (n,) deg
    longitude: Floats  #: (n,) deg
    height: Floats  #: (n,) m
    speed: Floats  #: (n,) m/s over ground
    course: Floats  #: (n,) deg from north
    down: Floats | None  #: (n,) m/s
    fix_type: Floats  #: (n,) as MAVLink counts
    horizontal: Floats  #: (n,) m, one sigma; taken for north and for east
    vertical: Floats  #: (n,) m, one sigma
    of_speed: Floats  #: (n,) m/s, one sigma; taken for all three


def usable_fixes(rows: GpsRows) -> NDArray[np.bool_]:
    """Return which rows have a position."""
    return usable_position(np.stack([np.radians(rows.latitude), np.radians(rows.longitude), rows.height], axis=1))


def usable_position(position: Floats) -> NDArray[np.bool_]:
    """Return which rows, (n, 3) rad and m, are a position: a receiver without a fix tells 0/0."""
    latitude, longitude, height = position.T
    possible = (np.abs(latitude) <= np.pi / 2) & (np.abs(longitude) <= np.pi) & (np.abs(height) < HIGHEST)
    return possible & ((latitude != 0) | (longitude != 0))


def attitude_at(time: NDArray[np.int64], at: NDArray[np.int64], angles: Floats) -> Floats:
    """Return roll, pitch and heading, (n, 3) rad, at other times; linear between, also over the turn from 360 to 0."""
    order = np.argsort(at, kind="stable")
    turned = np.unwrap(angles[order].astype(np.float64), axis=0)
    return np.stack([np.interp(time, at[order], turned[:, k]) for k in range(3)], axis=1)


def left_out(name: str, there: NDArray[np.bool_]) -> list[Remark]:
    """Return what is to be said of the rows without a position: a repair of the stream, if any of it is left."""
    lost, what = int(np.count_nonzero(~there)), "rows without a position (0/0: no fix yet) left out"
    if not lost:
        return []
    return [Remark(what, name, lost) if there.any() else Remark(f"{name}: all {lost} {what}")]


def possible_velocity(velocity: Floats) -> Floats:
    """Return a velocity, (n, 3) m/s, nan where no vehicle of ours moves so."""
    with np.errstate(invalid="ignore"):
        return np.where(np.abs(velocity) < FASTEST, velocity, np.nan)


def gps_columns(rows: GpsRows) -> dict[str, Floats]:
    """Return the columns of a GNSS stream, NED."""
    course = np.radians(rows.course)
    down = np.full(rows.speed.size, np.nan) if rows.down is None else rows.down
    return {
        "position": np.stack([np.radians(rows.latitude), np.radians(rows.longitude), rows.height], axis=1),
        "velocity": possible_velocity(
            np.stack([rows.speed * np.cos(course), rows.speed * np.sin(course), down], axis=1)
        ),
        "position_sigma": np.stack([rows.horizontal, rows.horizontal, rows.vertical], axis=1),
        "velocity_sigma": np.stack([rows.of_speed] * 3, axis=1),
        "fix_type": rows.fix_type,
    }
