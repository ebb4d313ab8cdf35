"""Helpers that many tests share: tiny files written on the spot. The recordings beside the repository: recordings.py."""

from __future__ import annotations

import itertools
import os
import struct
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import TYPE_CHECKING

import pytest
from mcap.writer import CompressionType, Writer

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

# As on the command line: several processes test at once, and threads of OpenBLAS that wait for each other take their cores.
# numpy is not imported yet; the processes of pytest-xdist inherit it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

pytest_plugins = ["tests.recordings", "tests.servers"]

_HEADER = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
_HEADER_1 = "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
_TIME = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
_IMU = (
    "{header} header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance # row major\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"
)
_PARTS = (
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n",
)
_FIX = (
    "{header} header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n"
    "float64[9] position_covariance\nuint8 COVARIANCE_TYPE_UNKNOWN=0\nuint8 position_covariance_type\n"
)
_STATUS = "MSG: sensor_msgs/NavSatStatus\nint8 STATUS_NO_FIX=-1\nint8 status\nuint16 service\n"
_RULE = "=" * 80 + "\n"
IMU_2 = _RULE.join((_IMU.format(header="std_msgs/Header"), *_PARTS, _HEADER, _TIME))
IMU_1 = _RULE.join((_IMU.format(header="Header"), *_PARTS, _HEADER_1))
FIX_2 = _RULE.join((_FIX.format(header="std_msgs/Header"), _STATUS, _HEADER, _TIME))
TEMPERATURE_2 = _RULE.join(("std_msgs/Header header\nfloat64 temperature\nfloat64 variance\n", _HEADER, _TIME))
THING_2 = _RULE.join(
    (
        "std_msgs/Header header\nstring label\nfloat64[] history\nsensor_msgs/Imu imu\n",
        "MSG: sensor_msgs/Imu\n" + _IMU.format(header="std_msgs/Header"), *_PARTS, _HEADER, _TIME,
    ),
)  # fmt: skip
ROS_1 = None  #: in place of a CDR code


def encode(items: Iterable[tuple[str, object]], code: int | None = 1) -> bytes:
    """Return ``(kind, value)`` pairs on the wire: struct kinds, "str", and "d[]" for a sequence of doubles."""
    order = ">" if code in (0, 6) else "<"
    widest = 1 if code is ROS_1 else 8 if code < 2 else 4
    body = bytearray()

    def put(kind: str, *values: object) -> None:
        for value in values:
            body.extend(bytes(-len(body) % min(struct.calcsize(kind), widest)))
            body.extend(struct.pack(order + kind, value))

    for kind, value in items:
        if kind == "str":
            text = value.encode() + (b"" if code is ROS_1 else b"\0")
            put("I", len(text))
            body.extend(text)
        elif kind.endswith("[]"):
            put("I", len(value))
            put(kind[0], *value)
        else:
            put(kind, *(value if isinstance(value, tuple) else (value,)))
    return bytes(body) if code is ROS_1 else bytes((0, code, 0, 0)) + bytes(body)


def imu_items(stamp: int, rate: tuple, force: tuple, frame: str = "imu", code: int | None = 1) -> list:
    """Return the fields of sensor_msgs/Imu for ``encode``."""
    seconds, nanoseconds = divmod(stamp, 10**9)
    sequence = [("I", 7)] if code is ROS_1 else []
    covariance = ("d", tuple(float(i) for i in range(9)))
    return [
        *sequence, ("i", seconds), ("I", nanoseconds), ("str", frame), ("d", (0.1, 0.2, 0.3, 0.4)), covariance,
        ("d", rate), covariance, ("d", force), covariance,
    ]  # fmt: skip


def imu_message(stamp: int, rate: tuple, force: tuple, frame: str = "imu", code: int | None = 1) -> bytes:
    """Return a sensor_msgs/Imu on the wire."""
    return encode(imu_items(stamp, rate, force, frame, code), code)


@dataclass(frozen=True)
class Topic:
    """A channel and its messages: (log time, payload) or (log time, publish time, payload)."""

    messages: list = field(default_factory=list)
    topic: str = "/imu"
    schema: str = "sensor_msgs/msg/Imu"
    definition: str | bytes = IMU_2
    schema_encoding: str = "ros2msg"
    encoding: str = "cdr"


def write_mcap(path: Path, *topics: Topic, **options: object) -> Path:
    """Write the topics with the ``mcap`` package."""
    options = {"compression": CompressionType.NONE, **options}
    with path.open("wb") as file:
        writer = Writer(file, **options)
        writer.start("", "test")
        for topic in topics:
            text = topic.definition.encode() if isinstance(topic.definition, str) else topic.definition
            schema = writer.register_schema(topic.schema, topic.schema_encoding, text)
            channel = writer.register_channel(topic.topic, topic.encoding, schema)
            for log_time, *publish, payload in topic.messages:
                writer.add_message(channel, log_time, payload, publish[0] if publish else log_time)
        writer.finish()
    return path


@pytest.fixture(scope="session")
def fresh(tmp_path_factory):
    """Return a function that gives a path in a folder of its own, also within one hypothesis test."""
    folder, number = tmp_path_factory.mktemp("fresh"), itertools.count()

    def path(name: str) -> Path:
        place = folder / str(next(number))
        place.mkdir()
        return place / name

    return path


@pytest.fixture(scope="session")
def ros():
    """Return ROS definitions and an encoder of one's own, apart from the reader's and the writer's."""
    return SimpleNamespace(
        imu_2=IMU_2, imu_1=IMU_1, fix_2=FIX_2, temperature_2=TEMPERATURE_2, thing_2=THING_2, ROS_1=ROS_1,
        encode=encode, imu_items=imu_items, imu=imu_message,
    )  # fmt: skip


@pytest.fixture(scope="session")
def mcap(fresh):
    """Return a function that writes an MCAP file of Topics, and the Topic type with it."""

    def write(*topics: Topic, **options: object) -> Path:
        return write_mcap(fresh("log.mcap"), *topics, **options)

    return SimpleNamespace(write=write, Topic=Topic)


@pytest.fixture(scope="session")
def text_log(fresh):
    """Return a function that writes a text log."""

    def write(text: str | bytes, name: str = "log.csv", sidecar: str | None = None) -> Path:
        path = fresh(name)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        if sidecar is not None:
            path.with_name("log.toml").write_text(sidecar, "utf-8")
        return path

    return write
