"""A log's streams as ROS 2 messages: their definitions, and rows of bytes in the layout of CDR."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.log import GnssStream, ImuStream, Log, Nanoseconds, Reference, Scalars

Fill = Callable[[int, int], NDArray[np.void]]

FRAME_ID = "imu_link"
FRD_TO_FLU = np.array([1.0, -1.0, -1.0])
ABSENT = -1.0  #: first element of a covariance: the message has no such measurement
UNKNOWN = -2  #: status of a fix whose type is unknown
KNOWN_DIAGONAL = 2  #: NavSatFix: the covariance's diagonal is known
_HEADER = "std_msgs/Header header"
_PARTS = {
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist\nfloat64[36] covariance\n",
    "sensor_msgs/NavSatStatus": "int8 status\nuint16 service\n",
}
_MESSAGES = {
    "sensor_msgs/msg/Imu": (
        "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
        "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
        "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"
    ),
    "sensor_msgs/msg/Temperature": "float64 temperature\nfloat64 variance\n",
    "sensor_msgs/msg/NavSatFix": (
        "sensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n"
        "float64[9] position_covariance\nuint8 position_covariance_type\n"
    ),
    "geometry_msgs/msg/TwistWithCovarianceStamped": "geometry_msgs/TwistWithCovariance twist\n",
    "geometry_msgs/msg/TwistStamped": "geometry_msgs/Twist twist\n",
    # No common message has these fields. Units: SI, rad; north-east-down.
    "imuwb_msgs/msg/FixType": "uint8 fix_type\n",
    **dict.fromkeys(
        ("imuwb_msgs/msg/Reference", "imuwb_msgs/msg/FilterEstimate"),
        "float64[3] latitude_longitude_height\nfloat64[3] velocity_north_east_down\nfloat64[3] roll_pitch_heading\n"
        "float64[3] position_sigma\nfloat64[3] velocity_sigma\nfloat64[3] attitude_sigma\n",
    ),
}


def definition(schema: str) -> str:
    """Return the whole definition of a message in the form of ``ros2msg``."""
    ruler = "=" * 80 + "\n"
    texts = [
        f"{_HEADER}\n{_MESSAGES[schema]}",
        *(f"MSG: {name}\n{text}" for name, text in _PARTS.items() if _used(schema, name)),
    ]
    return ruler.join(texts)


def _used(schema: str, part: str) -> bool:
    """Return whether a message has a part, directly or within another part."""
    texts, seen = [_HEADER, _MESSAGES[schema]], set[str]()
    while texts:
        text = texts.pop()
        inner = [name for name in _PARTS if f"{name} " in text and name not in seen]
        seen.update(inner)
        texts += [_PARTS[name] for name in inner]
    return part in seen


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
    fill: Fill  #: (first, end) -> rows with the fields of the message


def topics(log: Log) -> list[Topic]:
    """Return all streams of a log as messages."""
    return [
        *(topic for imu in log.imus for topic in _imu(imu)),
        *(topic for gnss in log.gnss for topic in _gnss(gnss)),
        *map(_speed, log.speeds),
        *map(_reference, log.references),
    ]


def stamped(rows: NDArray[np.void], channel: int, time: Nanoseconds, first: int, opcode: int) -> NDArray[np.void]:
    """Return rows as whole records: with the header of MCAP, the stamp, and the name of the frame."""
    rows["opcode"] = opcode
    rows["size"] = rows.dtype.itemsize - 9
    rows["channel"] = channel
    rows["sequence"] = np.arange(first, first + rows.size)
    rows["log_time"] = rows["publish_time"] = time
    rows["encapsulation"] = (0, 1, 0, 0)  # little-endian CDR
    rows["sec"], rows["nanosec"] = time // 10**9, time % 10**9
    rows["length"], rows["frame"] = _FRAME.size, _FRAME
    return rows


def _imu(imu: ImuStream) -> Iterator[Topic]:
    rate, force = imu.angular_rate, imu.specific_force
    together = rate is None or force is None or np.array_equal(rate.time, force.time)
    for sensor, triad in (("gyro", rate), ("accel", force)):
        if triad is None or (together and sensor == "accel" and rate is not None):
            continue

        def motion(start: int, end: int, *, own: str = sensor) -> NDArray[np.void]:
            rows = np.zeros(end - start, _IMU)
            rows["orientation_covariance"][:, 0] = ABSENT
            for name, part, field in (("gyro", rate, "rate"), ("accel", force, "force")):
                if part is None or (not together and name != own):
                    rows[f"{field}_covariance"][:, 0] = ABSENT
                else:
                    rows[field] = part.value[start:end] * FRD_TO_FLU
            return rows

        # Sensors with different clocks are two topics, which a reader joins.
        yield Topic(imu.name if together else f"{imu.name}/{sensor}", "sensor_msgs/msg/Imu", triad.time, motion)
    if imu.temperature is not None:
        yield _temperature(imu.name, imu.temperature)


def _temperature(imu: str, celsius: Scalars) -> Topic:
    def rows_of(start: int, end: int) -> NDArray[np.void]:
        rows = np.zeros(end - start, _TEMPERATURE)
        rows["temperature"] = celsius.value[start:end]
        return rows

    topic = celsius.name if celsius.name != imu else f"{imu}/temperature"
    return Topic(topic, "sensor_msgs/msg/Temperature", celsius.time, rows_of)


def _gnss(gnss: GnssStream) -> Iterator[Topic]:
    def fix(start: int, end: int) -> NDArray[np.void]:
        rows = np.zeros(end - start, _FIX)
        rows["service"] = 1
        rows["status"] = UNKNOWN
        if gnss.fix_type is not None:  # 0 and 1: no fix; 4 and above: a fix with corrections
            kind = gnss.fix_type[start:end]
            rows["status"] = np.select([kind < 2, kind > 4, kind == 4], [-1, 2, 1], 0)  # noqa: PLR2004 - the fix types of MAVLink
        rows["position"] = gnss.position[start:end] * (180 / np.pi, 180 / np.pi, 1.0)
        if gnss.position_sigma is not None:
            rows["covariance"][:, [4, 0, 8]] = np.nan_to_num(gnss.position_sigma[start:end]) ** 2
            known = np.isfinite(gnss.position_sigma[start:end]).all(axis=1)
            rows["covariance_type"] = np.where(known, KNOWN_DIAGONAL, 0)
        return rows

    yield Topic(gnss.name, "sensor_msgs/msg/NavSatFix", gnss.time, fix)
    velocity, sigma, fix_type = gnss.velocity, gnss.velocity_sigma, gnss.fix_type
    if velocity is not None:

        def moving(start: int, end: int) -> NDArray[np.void]:
            rows = np.zeros(end - start, _VELOCITY)
            rows["linear"] = velocity[start:end, [1, 0, 2]] * (1.0, 1.0, -1.0)
            if sigma is not None:
                rows["covariance"][:, [7, 0, 14]] = np.nan_to_num(sigma[start:end]) ** 2
            return rows

        topic = f"{gnss.name}/gnss_velocity"
        yield Topic(topic, "geometry_msgs/msg/TwistWithCovarianceStamped", gnss.time, moving)
    if fix_type is not None:

        def types(start: int, end: int) -> NDArray[np.void]:
            rows = np.zeros(end - start, _FIX_TYPE)
            rows["fix_type"] = fix_type[start:end]
            return rows

        yield Topic(f"{gnss.name}/fix_type", "imuwb_msgs/msg/FixType", gnss.time, types)


def _speed(speed: Scalars) -> Topic:
    def rows_of(start: int, end: int) -> NDArray[np.void]:
        rows = np.zeros(end - start, _TWIST)
        rows["linear"][:, 0] = speed.value[start:end]
        return rows

    return Topic(speed.name, "geometry_msgs/msg/TwistStamped", speed.time, rows_of)


def _reference(reference: Reference) -> Topic:
    def rows_of(start: int, end: int) -> NDArray[np.void]:
        rows = np.zeros(end - start, _REFERENCE)
        for name in ("position", "velocity", "attitude", "position_sigma", "velocity_sigma", "attitude_sigma"):
            values = getattr(reference, name)
            rows[name] = np.nan if values is None else values[start:end]
        return rows

    schema = "imuwb_msgs/msg/FilterEstimate" if reference.origin.by_filter else "imuwb_msgs/msg/Reference"
    return Topic(reference.name, schema, reference.time, rows_of)
