"""A log's streams as ROS 2 messages: rows of bytes in the layout of CDR."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.geodesy import swapped_axes
from imuwb.log import GnssStream, ImuStream, Log, Nanoseconds, Orientation, Reference, Scalars
from imuwb.ros import ABSENT, UNKNOWN

Fill = Callable[[NDArray[np.void], slice], None]

FRAME_ID = "imu_link"
FRD_TO_FLU = np.array([1.0, -1.0, -1.0])
KNOWN_DIAGONAL = 2  #: NavSatFix: the covariance's diagonal is known
_FRAME = np.frombuffer(FRAME_ID.encode() + b"\0", np.uint8)
#: a message record: the header of MCAP, then the CDR message; padding after the string aligns the doubles
_RECORD: list[tuple[Any, ...]] = [
    ("opcode", "u1"), ("size", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log_time", "<u8"),
    ("publish_time", "<u8"), ("encapsulation", "u1", (4,)), ("sec", "<i4"), ("nanosec", "<u4"), ("length", "<u4"),
    ("frame", "u1", (_FRAME.size,)),
]  # fmt: skip
_TO_DOUBLES: list[tuple[Any, ...]] = [("padding", "u1", (-(12 + _FRAME.size) % 8,))]
_IMU = np.dtype([
    *_RECORD, *_TO_DOUBLES, ("orientation", "<f8", (4,)), ("orientation_covariance", "<f8", (9,)), ("rate", "<f8", (3,)),
    ("rate_covariance", "<f8", (9,)), ("force", "<f8", (3,)), ("force_covariance", "<f8", (9,)),
])  # fmt: skip
_TEMPERATURE = np.dtype([*_RECORD, *_TO_DOUBLES, ("temperature", "<f8"), ("variance", "<f8")])
_FIX = np.dtype([  # status follows the string; service is aligned to two bytes, doubles to eight
    *_RECORD, ("status", "i1"), ("between", "u1", (1 - (12 + _FRAME.size) % 2,)), ("service", "<u2"),
    ("padding", "u1", (-(12 + _FRAME.size + 1 + (1 - (12 + _FRAME.size) % 2) + 2) % 8,)), ("position", "<f8", (3,)),
    ("covariance", "<f8", (9,)), ("covariance_type", "u1"),
])  # fmt: skip
_VELOCITY = np.dtype([
    *_RECORD, *_TO_DOUBLES, ("linear", "<f8", (3,)), ("angular", "<f8", (3,)), ("covariance", "<f8", (36,)),
])  # fmt: skip
_TWIST = np.dtype([*_RECORD, *_TO_DOUBLES, ("linear", "<f8", (3,)), ("angular", "<f8", (3,))])
_FIX_TYPE = np.dtype([*_RECORD, ("fix_type", "u1")])
_REFERENCE = np.dtype([
    *_RECORD, *_TO_DOUBLES, *((name, "<f8", (3,)) for name in (
        "position", "velocity", "attitude", "position_sigma", "velocity_sigma", "attitude_sigma",
    )),
])  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True)
class Topic:
    """One stream of messages."""

    name: str
    schema: str
    time: Nanoseconds
    dtype: np.dtype[np.void]
    fill: Fill  #: (rows, part): sets the fields of the message from a part of the stream


def topics(log: Log) -> list[Topic]:
    """Return all streams of a log as messages."""
    return [
        *(topic for imu in log.imus for topic in _imu(imu, log.orientations)),
        *(topic for gnss in log.gnss for topic in _gnss(gnss)),
        *map(_speed, log.speeds),
        *map(_reference, log.references),
    ]


def stamped(topic: Topic, channel: int, part: slice, opcode: int) -> NDArray[np.void]:
    """Return a part of a topic as whole records: with the header of MCAP, the stamp, and the name of the frame."""
    time = topic.time[part]
    rows = np.zeros(time.size, topic.dtype)
    topic.fill(rows, part)
    rows["opcode"] = opcode
    rows["size"] = rows.dtype.itemsize - 9
    rows["channel"] = channel
    rows["sequence"] = np.arange(part.start, part.stop)
    rows["log_time"] = rows["publish_time"] = time
    rows["encapsulation"] = (0, 1, 0, 0)  # little-endian CDR
    rows["sec"], rows["nanosec"] = time // 10**9, time % 10**9
    rows["length"], rows["frame"] = _FRAME.size, _FRAME
    return rows


def _imu(imu: ImuStream, orientations: tuple[Orientation, ...]) -> Iterator[Topic]:
    rate, force = imu.angular_rate, imu.specific_force
    together = rate is None or force is None or np.array_equal(rate.time, force.time)
    for sensor, triad in (("gyro", rate), ("accel", force)):
        if triad is None or (together and sensor == "accel" and rate is not None):
            continue

        # Sensors with different clocks are two topics, which a reader joins.
        name = imu.name if together else f"{imu.name}/{sensor}"

        def motion(
            rows: NDArray[np.void],
            part: slice,
            *,
            own: str = sensor,
            topic: str = name,
            time: Nanoseconds = triad.time,
        ) -> None:
            rows["orientation_covariance"][:, 0] = ABSENT
            for orientation in orientations:
                if orientation.name == topic:
                    _orient(rows, time[part], orientation)
            for name, values, field in (("gyro", rate, "rate"), ("accel", force, "force")):
                if values is None or (not together and name != own):
                    rows[f"{field}_covariance"][:, 0] = ABSENT
                else:
                    rows[field] = values.value[part] * FRD_TO_FLU

        yield Topic(name, "sensor_msgs/msg/Imu", triad.time, _IMU, motion)
    if imu.temperature is not None:
        yield _temperature(imu.name, imu.temperature)


def _orient(rows: NDArray[np.void], time: Nanoseconds, orientation: Orientation) -> None:
    """Set the orientation of the messages at whose times there is one."""
    at = np.minimum(np.searchsorted(orientation.time, time), len(orientation) - 1)
    same = np.flatnonzero(orientation.time[at] == time)
    at = at[same]
    rows["orientation"][same] = swapped_axes(orientation.quaternion[at])[:, [1, 2, 3, 0]]
    covariance = np.zeros((same.size, 9))  # 0: not known
    if orientation.sigma is not None:
        covariance[:, [4, 0, 8]] = np.nan_to_num(orientation.sigma[at]) ** 2
    rows["orientation_covariance"][same] = covariance


def _temperature(imu: str, celsius: Scalars) -> Topic:
    def rows_of(rows: NDArray[np.void], part: slice) -> None:
        rows["temperature"] = celsius.value[part]

    topic = celsius.name if celsius.name != imu else f"{imu}/temperature"
    return Topic(topic, "sensor_msgs/msg/Temperature", celsius.time, _TEMPERATURE, rows_of)


def _gnss(gnss: GnssStream) -> Iterator[Topic]:
    def fix(rows: NDArray[np.void], part: slice) -> None:
        rows["service"] = 1
        rows["status"] = UNKNOWN
        if gnss.fix_type is not None:  # 0 and 1: no fix; 4 and above: a fix with corrections
            kind = gnss.fix_type[part]
            rows["status"] = np.select([kind < 2, kind > 4, kind == 4], [-1, 2, 1], 0)  # noqa: PLR2004 - the fix types of MAVLink
        rows["position"] = gnss.position[part] * (180 / np.pi, 180 / np.pi, 1.0)
        if gnss.position_sigma is not None:
            rows["covariance"][:, [4, 0, 8]] = np.nan_to_num(gnss.position_sigma[part]) ** 2
            known = np.isfinite(gnss.position_sigma[part]).all(axis=1)
            rows["covariance_type"] = np.where(known, KNOWN_DIAGONAL, 0)

    yield Topic(gnss.name, "sensor_msgs/msg/NavSatFix", gnss.time, _FIX, fix)
    velocity, sigma, fix_type = gnss.velocity, gnss.velocity_sigma, gnss.fix_type
    if velocity is not None:

        def moving(rows: NDArray[np.void], part: slice) -> None:
            rows["linear"] = velocity[part, [1, 0, 2]] * (1.0, 1.0, -1.0)
            if sigma is not None:
                rows["covariance"][:, [7, 0, 14]] = np.nan_to_num(sigma[part]) ** 2

        topic = f"{gnss.name}/gnss_velocity"
        yield Topic(topic, "geometry_msgs/msg/TwistWithCovarianceStamped", gnss.time, _VELOCITY, moving)
    if fix_type is not None:

        def types(rows: NDArray[np.void], part: slice) -> None:
            rows["fix_type"] = fix_type[part]

        yield Topic(f"{gnss.name}/fix_type", "imuwb_msgs/msg/FixType", gnss.time, _FIX_TYPE, types)


def _speed(speed: Scalars) -> Topic:
    def rows_of(rows: NDArray[np.void], part: slice) -> None:
        rows["linear"][:, 0] = speed.value[part]

    return Topic(speed.name, "geometry_msgs/msg/TwistStamped", speed.time, _TWIST, rows_of)


def _reference(reference: Reference) -> Topic:
    def rows_of(rows: NDArray[np.void], part: slice) -> None:
        for name in ("position", "velocity", "attitude", "position_sigma", "velocity_sigma", "attitude_sigma"):
            values = getattr(reference, name)
            rows[name] = np.nan if values is None else values[part]

    schema = "imuwb_msgs/msg/FilterEstimate" if reference.origin.by_filter else "imuwb_msgs/msg/Reference"
    return Topic(reference.name, schema, reference.time, _REFERENCE, rows_of)
