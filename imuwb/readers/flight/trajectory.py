"""Positions, velocities and attitudes of flight controllers and their receivers, as the columns of streams."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Booleans, Floats
from imuwb.log import BY_FILTER, Kind, Nanoseconds, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark

HIGHEST = 1e5  #: m; a height beyond is damage
FASTEST = 2e4  #: m/s; a velocity beyond is damage
FULL_TURNS = 1000.0  #: rad; an angle beyond is damage
ESTIMATED = f"NED, {BY_FILTER}"  #: frame of a navigation solution


def positions(latitude: NDArray[Any], longitude: NDArray[Any], height: NDArray[Any]) -> Floats:
    """Return positions, (n, 3) rad and m, from degrees and metres."""
    return np.stack([np.radians(latitude), np.radians(longitude), height], axis=1).astype(np.float64)


def triples(columns: Mapping[str, NDArray[Any]], names: tuple[str, ...] | str) -> Floats:
    """Return three columns as one, (n, 3)."""
    with np.errstate(invalid="ignore"):  # damaged numbers may be signalling nans, for which numpy warns
        return np.stack([columns[name].astype(np.float64) for name in names], axis=1)


def velocities(speed: Floats, course: Floats, down: Floats | float = np.nan) -> Floats:
    """Return velocities, (n, 3) m/s, NED, from the speed over ground, the course (deg) and the velocity down.

    A value is nan if it is unknown, or beyond what any vehicle reaches.
    """
    with np.errstate(invalid="ignore", over="ignore"):  # damaged numbers may be infinite
        angle = np.radians(course)
        velocity = np.stack([speed * np.cos(angle), speed * np.sin(angle), np.broadcast_to(down, speed.shape)], axis=1)
        return np.where(np.abs(velocity) < FASTEST, velocity, np.nan)


def sigmas(horizontal: Floats, vertical: Floats) -> Floats:
    """Return sigmas, (n, 3) NED, of positions or velocities; the horizontal sigma is used for north and for east."""
    return np.stack([horizontal, horizontal, vertical], axis=1)


def fix_types(numbers: NDArray[Any]) -> Floats:
    """Return fix types by MAVLink's numbers; 0 (no receiver) and 1 (no fix) are 1."""
    return np.maximum(numbers.astype(np.float64), 1.0)


def usable(position: Floats) -> Booleans:
    """Return which rows, (n, 3) rad and m, are positions; a receiver without a fix states latitude 0 and longitude 0."""
    latitude, longitude, height = position.T
    possible = (np.abs(latitude) <= np.pi / 2) & (np.abs(longitude) <= np.pi) & (np.abs(height) < HIGHEST)
    return possible & ((latitude != 0) | (longitude != 0))


def located(
    name: str, kind: Kind, time: Nanoseconds, columns: Mapping[str, Floats], origin: Origin, bytes_read: int
) -> Iterator[Batch | Remark]:
    """Yield the rows that have a position, and the number of rows that have none."""
    rows = usable(columns["position"])
    lost, text = int(np.count_nonzero(~rows)), "rows without a position (0/0: no fix yet) left out"
    if lost and not rows.any():
        yield Remark(Note("no_position", f"{name}: all {lost} {text}"))
        return
    if lost:
        yield Remark(Note("no_position", text), name, lost)
    yield Batch(
        name, kind, time[rows], {key: column[rows] for key, column in columns.items()}, origin, bytes_read, exact=True
    )


def interpolated(time: Nanoseconds, at: Nanoseconds, values: Floats) -> Floats:
    """Return values at other times, (n, k), by linear interpolation of values, (m, k), at rising times ``at``."""
    return np.stack([np.interp(time, at, column) for column in values.T], axis=1)


def attitudes(time: Nanoseconds, at: Nanoseconds, angles: Floats) -> dict[str, Floats]:
    """Return the column ``attitude``, roll, pitch and heading at other times, (n, 3) rad; nothing if all angles are damaged.

    The interpolation is linear, also across the step from 360 to 0 degrees.

    Args:
        time: (n,) ns.
        at: (m,) ns, in any order.
        angles: (m, 3) rad.
    """
    known = (np.abs(angles) < FULL_TURNS).all(axis=1)
    if not known.any():
        return {}
    at, angles = at[known], angles[known]
    order = np.argsort(at, kind="stable")
    return {"attitude": interpolated(time, at[order], np.unwrap(angles[order], axis=0))}
