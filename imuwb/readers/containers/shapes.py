"""Recognises the quantities of a message by the names of its fields, in any encoding.

``sensor_msgs/Imu``, a private protobuf and a JSON object all have ``angular_velocity.x``; if another message contains
one of these, the name has a prefix. A recipe states which fields make which column.
"""

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats, Integers
from imuwb.geodesy import swapped_axes
from imuwb.log import SECOND, Kind
from imuwb.readers.batch import Batch
from imuwb.ros import ABSENT, UNKNOWN

Values = Mapping[str, Floats]

STAMPS = (
    ("header.stamp.sec", "header.stamp.nanosec"),
    ("header.stamp.secs", "header.stamp.nsecs"),
    ("stamp.sec", "stamp.nanosec"),
    ("timestamp.sec", "timestamp.nsec"),
    ("timestamp.sec", "timestamp.nanosec"),
    ("timestamp.seconds", "timestamp.nanos"),
)
NEAR_ONE = 0.05  #: a quaternion whose length differs from one by more is no attitude
LATEST = 9.2e9  #: s; later nanoseconds do not fit into int64


@dataclass(frozen=True, slots=True)
class Recipe:
    """How the messages of one channel become a stream."""

    kind: Kind
    prefix: str  #: path of the measurement in the message; empty for the whole message
    stamp: tuple[str, str] | None  #: paths of seconds and nanoseconds
    paths: tuple[str, ...]  #: paths of all fields that are needed
    columns: Callable[[Values, str, str], dict[str, Floats]]  #: (values, prefix, frame) -> columns


def recognise(paths: Collection[str], schema: str, topic: str) -> tuple[Recipe, ...]:
    """Return the recipes for a topic's messages with these fields: none, one or several."""
    known = set(paths)
    recipes: list[Recipe] = []
    for path in paths:
        for key, kind, required, optional, columns in _SHAPES:
            if not path.endswith(key) or (path != key and not path.endswith(f".{key}")):
                continue
            prefix = path[: -len(key)]
            if not all(prefix + name in known for name in required):
                continue
            if kind in _SCHEMAS and not _SCHEMAS[kind](schema, topic):
                continue
            stamp = _stamp(known, prefix)
            names = (*required, *(name for name in optional if prefix + name.removesuffix("[0]") in known))
            used = (*(stamp or ()), *(prefix + name for name in names))
            recipes.append(Recipe(kind, prefix, stamp, used, columns))
    return tuple(recipes)


def stamps(values: Mapping[str, NDArray[Any]], recipe: Recipe) -> Integers | None:
    """Return the messages' own times (ns), 0 for a time that is not set or impossible; None for messages without a stamp."""
    if recipe.stamp is None:
        return None
    seconds, nanoseconds = (values[path] for path in recipe.stamp)
    possible = (np.abs(seconds) < LATEST) & (nanoseconds >= 0) & (nanoseconds < SECOND)
    whole, rest = (np.where(possible, part, 0).astype(np.int64) for part in (seconds, nanoseconds))
    return whole * SECOND + rest


def _stamp(known: set[str], prefix: str) -> tuple[str, str] | None:
    """Return the stamp nearest to the measurement: in the same message, or in one that contains it."""
    parts = prefix.split(".")
    for depth in range(len(parts), 0, -1):
        around = ".".join(parts[: depth - 1]) + ("." if depth > 1 else "")
        for seconds, nanoseconds in STAMPS:
            if around + seconds in known and around + nanoseconds in known:
                return around + seconds, around + nanoseconds
    return None


def _triad(values: Values, names: list[str], frame: str) -> Floats:
    """Return three columns as one (n, 3) array, FRD; the array is filled by columns, ten times faster than by rows."""
    triad = np.empty((values[names[0]].size, 3))
    for axis, name in enumerate(names):
        if axis and frame == "FLU":
            np.negative(values[name], out=triad[:, axis])
        else:
            triad[:, axis] = values[name]
    return triad


def _imu(values: Values, prefix: str, frame: str) -> dict[str, Floats]:
    columns: dict[str, Floats] = {}
    for column, field in (("angular_rate", "angular_velocity"), ("specific_force", "linear_acceleration")):
        covariance = values.get(f"{prefix}{field}_covariance[0]")
        if covariance is not None and (covariance == ABSENT).all():
            continue  # the message lacks this measurement
        columns[column] = _triad(values, [f"{prefix}{field}.{axis}" for axis in "xyz"], frame)
    return columns


def _orientation(values: Values, prefix: str, frame: str) -> dict[str, Floats]:
    """Return the quaternions, nan where the message states none, and their sigmas."""
    quaternion = np.stack([values[f"{prefix}orientation.{part}"] for part in "wxyz"], axis=1)
    quaternion[(~(np.abs(quaternion) < 1 + NEAR_ONE)).any(axis=1)] = (
        np.nan
    )  # damaged numbers may be too large to be squared
    length = np.linalg.norm(quaternion, axis=1, keepdims=True)
    covariance = values.get(f"{prefix}orientation_covariance")
    whole = covariance is not None and covariance.shape[1:] == (9,)
    stated = np.abs(length - 1) < NEAR_ONE
    if covariance is not None and whole:
        stated &= covariance[:, :1] != ABSENT
    quaternion /= np.where(stated, length, np.nan)
    # An IMU whose axes are stated as FRD is taken to state its attitude relative to NED as well.
    columns = {"quaternion": swapped_axes(quaternion) if frame == "FLU" else quaternion}
    return columns | (_sigmas("sigma", covariance, 3) if whole else {})


def stated_orientation(batch: Batch) -> Iterator[Batch]:
    """Yield the rows of a batch that have an orientation, if any has; an orientation that is always the identity is not set."""
    quaternion = batch.columns["quaternion"]
    known = np.isfinite(quaternion).all(axis=1)
    unset = swapped_axes(np.array([1.0, 0, 0, 0])), np.array([1.0, 0, 0, 0])
    if not known.any() or any((np.abs(quaternion[known]) == np.abs(row)).all() for row in unset):
        return
    columns = {name: values[known] for name, values in batch.columns.items()}
    yield replace(batch, time=batch.time[known], columns=columns)


def _gnss(values: Values, prefix: str, frame: str) -> dict[str, Floats]:
    latitude = values[f"{prefix}latitude"]
    height = values.get(f"{prefix}altitude", np.zeros_like(latitude))
    columns = {"position": np.stack([np.radians(latitude), np.radians(values[f"{prefix}longitude"]), height], axis=1)}
    columns |= _sigmas("position_sigma", values.get(f"{prefix}position_covariance"), 3)
    track, speed, climb = (values.get(f"{prefix}{name}") for name in _COURSE)
    if track is not None and speed is not None:  # gps_common/GPSFix; the track is in degrees from north
        course = np.radians(track)
        down = np.full_like(speed, np.nan) if climb is None else -climb
        columns["velocity"] = np.stack([speed * np.cos(course), speed * np.sin(course), down], axis=1)
    status = values.get(f"{prefix}status.status")
    # -1 none, 0 fix, 1 with satellite, 2 with ground augmentation
    if status is not None and (status != UNKNOWN).any():
        columns["fix_type"] = np.select([status < 0, status > 0], [1.0, 4.0], 3.0)
    return columns


def _pose(values: Values, prefix: str, frame: str) -> dict[str, Floats]:
    position, quaternion = (
        np.stack([values[prefix + name] for name in names], axis=1) for names in (_POSE[:3], _POSE[3:])
    )
    length = np.linalg.norm(quaternion, axis=1, keepdims=True)
    columns = {"position": position, "quaternion": quaternion / np.where(length > 0, length, np.nan)}
    covariance = values.get(f"{prefix}covariance")
    if covariance is not None and covariance.ndim > 1 and covariance.shape[1] == 36:  # noqa: PLR2004 - 6 x 6
        square = covariance[:, [0, 7, 14]]
        columns["position_sigma"] = np.sqrt(np.where(square > 0, square, np.nan))
    return columns


def _velocity(values: Values, prefix: str, frame: str) -> dict[str, Floats]:
    east, north, up = (values[f"{prefix}twist.linear.{axis}"] for axis in "xyz")
    sigmas = _sigmas("velocity_sigma", values.get(f"{prefix}covariance"), 6)
    return {"velocity": np.stack([north, east, -up], axis=1), **sigmas}


def _sigmas(name: str, covariance: Floats | None, size: int) -> dict[str, Floats]:
    """Return the sigmas of a message's covariances, east-north-up, (n, size x size); nothing for another shape."""
    if covariance is None or covariance.shape[1:] != (size * size,):
        return {}
    square = covariance[:, np.array([1, 0, 2]) * (size + 1)]  # of north, east and down
    return {
        name: np.sqrt(np.where(square > 0, square, np.nan))
    }  # unknown (0) or absent (-1) variances are not positive


def _single(column: str, field: str) -> Callable[[Values, str, str], dict[str, Floats]]:
    """Return the recipe of one number that is the same in all frames."""
    return lambda values, prefix, frame: {column: values[prefix + field]}


def _reference(values: Values, prefix: str, frame: str) -> dict[str, Floats]:
    columns = {
        name: values[prefix + field]
        for name, field in zip(("position", "velocity", "attitude"), REFERENCE, strict=True)
    }
    sigmas = {name: values[prefix + name] for name in REFERENCE_SIGMAS if prefix + name in values}
    known = {name: column for name, column in sigmas.items() if np.isfinite(column).any()}
    return {name: column for name, column in columns.items() if np.isfinite(column).all()} | known


_POSE = (
    *(f"pose.position.{axis}" for axis in "xyz"), *(f"pose.orientation.{part}" for part in "wxyz"),
)  # fmt: skip
_COURSE = ("track", "speed", "climb")
_LINEAR = ("twist.linear.x", "twist.linear.y", "twist.linear.z")
REFERENCE = ("latitude_longitude_height", "velocity_north_east_down", "roll_pitch_heading")
REFERENCE_SIGMAS = ("position_sigma", "velocity_sigma", "attitude_sigma")
_TRIADS = tuple(f"{field}.{axis}" for field in ("angular_velocity", "linear_acceleration") for axis in "xyz")
_COVARIANCES = ("angular_velocity_covariance[0]", "linear_acceleration_covariance[0]")
_ORIENTATION = ("angular_velocity.x", *(f"orientation.{part}" for part in "xyzw"))
_RECEIVER = re.compile(r"(?:^|[/_.])(?:gps|gnss|fix|navsat|ublox)")


def _is_receiver(topic: str) -> bool:
    return _RECEIVER.search(topic.lower()) is not None and "speed" not in topic.lower()


def _is_twist(schema: str) -> bool:
    return schema.endswith(("TwistStamped", "TwistWithCovarianceStamped"))


#: kind -> test of schema and topic, for kinds that the fields do not decide: many messages have a temperature or a linear.x, and
#: a twist may be a receiver's velocity or a vehicle's speed
_SCHEMAS: dict[Kind, Callable[[str, str], bool]] = {
    "temperature": lambda schema, _: schema.endswith("Temperature"),
    "pose": lambda schema, _: schema.endswith(("Odometry", "PoseStamped", "PoseWithCovarianceStamped")),
    "fix": lambda schema, _: schema.endswith("FixType"),
    "velocity": lambda schema, topic: _is_twist(schema) and _is_receiver(topic),
    "speed": lambda schema, topic: schema.endswith("Odometry") or (_is_twist(schema) and not _is_receiver(topic)),
}
#: (key, kind, required fields, optional fields, recipe)
_SHAPES: tuple[tuple[str, Kind, tuple[str, ...], tuple[str, ...], Callable[..., dict[str, Floats]]], ...] = (
    ("angular_velocity.x", "imu", _TRIADS, _COVARIANCES, _imu),
    ("angular_velocity.x", "orientation", _ORIENTATION, ("orientation_covariance",), _orientation),
    ("latitude", "gnss", ("latitude", "longitude"), ("altitude", "position_covariance", "status.status", *_COURSE), _gnss),
    ("temperature", "temperature", ("temperature",), (), _single("temperature", "temperature")),
    ("twist.linear.x", "velocity", _LINEAR, ("covariance",), _velocity),
    ("twist.linear.x", "speed", _LINEAR, (), _single("speed", "twist.linear.x")),
    ("fix_type", "fix", ("fix_type",), (), _single("fix_type", "fix_type")),
    ("pose.position.x", "pose", _POSE, ("covariance",), _pose),
    ("latitude_longitude_height", "reference", REFERENCE, REFERENCE_SIGMAS, _reference),
)  # fmt: skip
