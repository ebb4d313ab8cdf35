"""The streams that the columns of a text log make up, in SI and FRD."""

from collections.abc import Iterable, Iterator, Mapping
from typing import cast

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.log import Kind
from imuwb.readers.text.column_names import Column, above_sea
from imuwb.units import Unit

Stream = tuple[Kind, dict[str, Floats], Booleans | None]
Values = Mapping[tuple[str, int], Floats]

_ACCURACIES = ("sigma_horizontal", "sigma_vertical", "sigma_speed")
_WAYS = ("north", "east", "down")
#: column of a receiver -> beginning of the names of its quantities
_TRIPLES = {"velocity": "velocity_", "position_sigma": "sigma_", "velocity_sigma": "sigma_velocity_"}


def streams_of(values: Mapping[Column, Floats], frame: str) -> Iterator[Stream]:
    """Yield the streams of the columns; slower streams beside an IMU have separate rows.

    Args:
        values: cells of each column, in its unit.
        frame: frame of the IMU, ``FRD`` or ``FLU``.
    """
    si = {(c.quantity, c.axis): _si(v, c) for c, v in values.items() if c.unit is not None}
    signs = np.array([1.0, -1.0, -1.0]) if frame == "FLU" else None
    imu = {
        field: triad if signs is None else triad * signs
        for quantity, field in (("gyro", "angular_rate"), ("accel", "specific_force"))
        if (triad := _triad(si, quantity)) is not None
    }
    if imu:
        yield "imu", imu, None
    # A file of a temperature alone is that of an IMU in another file.
    temperature = si.get(("temperature", 0)) if imu or not {("latitude", 0), ("speed", 0)} & si.keys() else None
    if temperature is not None and np.isfinite(temperature).any():
        yield "imu", {"temperature": temperature}, np.isfinite(temperature)
    if ("latitude", 0) in si and ("longitude", 0) in si:
        yield _position_stream(si, np.isfinite(si["latitude", 0]) if imu else None)
    if ("speed", 0) in si:
        yield "speed", {"speed": si["speed", 0]}, np.isfinite(si["speed", 0]) if imu else None


def _position_stream(si: Values, rows: Booleans | None) -> Stream:
    """Return a receiver's fixes, or a reference if there is an attitude, because receivers have no attitude."""
    latitude, longitude = si["latitude", 0], si["longitude", 0]
    columns = {"position": np.stack([latitude, longitude, _height(si, latitude)], axis=1), **_sigmas(si)}
    along = _velocity_along_course(si)
    if along is not None:
        columns["velocity"] = along
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
        return "reference", {n: x for n, x in columns.items() if n == "position" or np.isfinite(x).any()}, rows
    if ("fix_type", 0) in si:
        columns["fix_type"] = si["fix_type", 0]
    return "gnss", columns, rows


def _fix_type(values: Floats, column: Column) -> Floats:
    """Return fix types by MAVLink's numbers: 0 and 1 are no fix; in a column called ``fix``, without "type", 1 may stand for a fix of any type."""
    fixes = np.where(values == 1, np.nan, values) if column.name.lower().endswith("fix") else values
    return np.where(fixes == 0, 1.0, fixes)


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


def _si(values: Floats, column: Column) -> Floats:
    if column.quantity == "fix_type":
        return _fix_type(values, column)
    measure = cast("Unit", column.unit)
    with np.errstate(invalid="ignore", over="ignore"):  # a damaged number may be a signalling nan, or beyond all floats
        scale = column.sign * measure.factor
        scaled = values * scale if scale != 1.0 else values
    return scaled + measure.offset if measure.offset else scaled  # adding 0 would turn -0 into +0


def heights_above_sea(used: Iterable[Column]) -> bool:
    """Return whether a log has heights above mean sea level alone."""
    heights = {c.quantity: c for c in used if c.quantity in ("height", "height_msl", "undulation")}
    return (
        above_sea(heights["height"]) if "height" in heights else "height_msl" in heights and "undulation" not in heights
    )


def _height(si: Values, like: Floats) -> Floats:
    """Return heights above the ellipsoid, those above mean sea level if only these are known, and else 0."""
    if ("height", 0) in si:
        return si["height", 0]
    if ("height_msl", 0) in si:
        return si["height_msl", 0] + si.get(("undulation", 0), 0.0)
    return np.where(np.isfinite(like), 0.0, np.nan)


def _velocity_along_course(si: Values) -> Floats | None:
    """Return velocities, (n, 3), of speeds over ground and courses; None without them."""
    speed, course = si.get(("ground_speed", 0)), si.get(("course", 0))
    if speed is None or course is None:
        return None
    down = si.get(("velocity_down", 0), np.full_like(speed, np.nan))
    course = np.where(np.isfinite(course), course, np.nan)
    return np.stack([speed * np.cos(course), speed * np.sin(course), down], axis=1)


def _sigmas(si: Values) -> dict[str, Floats]:
    """Return the sigmas, (n, 3), of horizontal and vertical accuracies, and of the accuracy of a speed; a negative one is none."""
    known = {name: np.where(si[name, 0] > 0, si[name, 0], np.nan) for name in _ACCURACIES if (name, 0) in si}
    found = dict[str, Floats]()
    if "sigma_horizontal" in known:
        horizontal = known["sigma_horizontal"]
        vertical = known.get("sigma_vertical", np.full_like(horizontal, np.nan))
        found["position_sigma"] = np.stack([horizontal, horizontal, vertical], axis=1)
    if "sigma_speed" in known:
        found["velocity_sigma"] = np.stack([known["sigma_speed"]] * 3, axis=1)
    return found
