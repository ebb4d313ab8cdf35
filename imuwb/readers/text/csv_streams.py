"""The streams that the columns of a text log make up, in SI and FRD."""

from collections.abc import Iterator, Mapping

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.log import Kind
from imuwb.readers.text.column_names import Column
from imuwb.units import Unit

Stream = tuple[Kind, dict[str, Floats], Booleans | None]
Values = Mapping[tuple[str, int], Floats]

_WAYS = ("north", "east", "down")
#: column of a receiver -> beginning of the names of its quantities
_TRIPLES = {"velocity": "velocity_", "position_sigma": "sigma_", "velocity_sigma": "sigma_velocity_"}


def streams_of(values: Mapping[Column, Floats], frame: str) -> Iterator[Stream]:
    """Yield the streams of the columns; slower streams beside an IMU have separate rows.

    Args:
        values: cells of each column, in its unit.
        frame: frame of the IMU, ``FRD`` or ``FLU``.
    """
    si = {(c.quantity, c.axis): _si(v, c.unit) for c, v in values.items() if c.unit is not None}
    signs = np.array([1.0, -1.0, -1.0]) if frame == "FLU" else np.ones(3)
    imu = {
        field: triad * signs
        for quantity, field in (("gyro", "angular_rate"), ("accel", "specific_force"))
        if (triad := _triad(si, quantity)) is not None
    }
    if imu:
        yield "imu", imu, None
        temperature = si.get(("temperature", 0))
        if temperature is not None and np.isfinite(temperature).any():
            yield "imu", {"temperature": temperature}, np.isfinite(temperature)
    if ("latitude", 0) in si and ("longitude", 0) in si:
        yield _position_stream(si, np.isfinite(si["latitude", 0]) if imu else None)
    if ("speed", 0) in si:
        yield "speed", {"speed": si["speed", 0]}, np.isfinite(si["speed", 0]) if imu else None


def _position_stream(si: Values, rows: Booleans | None) -> Stream:
    """Return a receiver's fixes, or a reference if there is an attitude, because receivers have no attitude."""
    latitude, longitude = si["latitude", 0], si["longitude", 0]
    columns = {"position": np.stack([latitude, longitude, si.get(("height", 0), np.zeros_like(latitude))], axis=1)}
    for field, prefix in _TRIPLES.items():
        triple = _north_east_down(si, prefix)
        if triple is not None:
            columns[field] = triple
    attitude = _stacked(si, [("roll", 0), ("pitch", 0), ("heading", 0)])
    if attitude is not None:
        sigma = _stacked(si, [(f"sigma_attitude_{way}", 0) for way in _WAYS])
        columns |= {"attitude": attitude} | ({} if sigma is None else {"attitude_sigma": sigma})
        if not {("velocity_down", 0), ("velocity_up", 0)} & si.keys():
            columns.pop("velocity", None)  # a reference has all three parts of a velocity, or none
        return "reference", {name: x for name, x in columns.items() if np.isfinite(x).any()}, rows
    if ("fix_type", 0) in si:
        columns["fix_type"] = si["fix_type", 0]
    return "gnss", columns, rows


def _north_east_down(si: Values, prefix: str) -> Floats | None:
    """Return three quantities as (n, 3); None if north or east is missing; the part down is nan if it is missing."""
    north, east, down = (si.get((f"{prefix}{way}", 0)) for way in _WAYS)
    if north is None or east is None:
        return None
    if down is None:
        up = si.get((f"{prefix}up", 0))
        down = np.full_like(north, np.nan) if up is None else -up
    return np.stack([north, east, down], axis=1)


def _triad(si: Values, quantity: str) -> Floats | None:
    """Return the axes of a sensor as (n, 3), nan for an axis without a column; None if there is no axis."""
    there = {axis: si[quantity, axis] for axis in range(3) if (quantity, axis) in si}
    if not there:
        return None
    unknown = np.full_like(next(iter(there.values())), np.nan)
    return np.stack([there.get(axis, unknown) for axis in range(3)], axis=1)


def _stacked(si: Values, keys: list[tuple[str, int]]) -> Floats | None:
    """Return three quantities as (n, 3); None if one is missing."""
    return np.stack([si[key] for key in keys], axis=1) if all(key in si for key in keys) else None


def _si(values: Floats, measure: Unit) -> Floats:
    with np.errstate(over="ignore"):
        scaled = values * measure.factor
    return scaled + measure.offset if measure.offset else scaled  # adding 0 would turn -0 into +0
