"""MCAP with ROS 2 messages (cdr, zstd) that other tools open; written a chunk at a time, not a message.

Messages of one stream are alike but for their numbers, so a chunk is one array of records. ROS bodies
are forward-left-up (REP 145): y and z change sign on the way out as they do on the way in.
Specification: https://mcap.dev/spec
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
import zstandard

from imuwb.errors import MissingDataError
from imuwb.log import SECOND
from imuwb.writers.beside import beside

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from imuwb.log import ImuStream, Log

    Progress = Callable[[int, int], None]

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX, STATISTICS, DATA_END = (
    0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x08, 0x0B, 0x0F,
)  # fmt: skip
ROWS = 12_000  #: of the fastest stream in a chunk, about 4 MB
FRAME_ID = "imu_link"
ABSENT = -1.0  #: first element of a covariance: there is no such estimate

_HEADER = "std_msgs/Header header"
_STAMP = (
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n",
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n",
)
_VECTOR = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
_RULER = "=" * 80 + "\n"
_IMU_FIELDS = (
    f"{_HEADER}\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"
)
_QUATERNION = "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
SCHEMAS = {
    "sensor_msgs/msg/Imu": _RULER.join((_IMU_FIELDS, _QUATERNION, _VECTOR, *_STAMP)),
    "sensor_msgs/msg/Temperature": _RULER.join((f"{_HEADER}\nfloat64 temperature\nfloat64 variance\n", *_STAMP)),
}

_FRAME = np.frombuffer(FRAME_ID.encode() + b"\0", np.uint8)
#: a message record: MCAP's own header, then the CDR message; the string is padded to where doubles begin
_RECORD = [
    ("opcode", "u1"), ("size", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log_time", "<u8"),
    ("publish_time", "<u8"), ("encapsulation", "u1", (4,)), ("sec", "<i4"), ("nanosec", "<u4"), ("length", "<u4"),
    ("frame", "u1", (_FRAME.size,)), ("padding", "u1", (-(12 + _FRAME.size) % 8,)),
]  # fmt: skip
_IMU = np.dtype([
    *_RECORD, ("orientation", "<f8", (4,)), ("orientation_covariance", "<f8", (9,)), ("rate", "<f8", (3,)),
    ("rate_covariance", "<f8", (9,)), ("force", "<f8", (3,)), ("force_covariance", "<f8", (9,)),
])  # fmt: skip
_TEMPERATURE = np.dtype([*_RECORD, ("temperature", "<f8"), ("variance", "<f8")])
FRD_TO_FLU = np.array([1.0, -1.0, -1.0])


@dataclass(slots=True)
class _Index:
    """What the summary at the end of the file says."""

    chunks: list[bytes] = field(default_factory=list[bytes])
    counts: dict[int, int] = field(default_factory=dict[int, int])
    first: int = 2**63 - 1
    last: int = 0


def write_mcap(log: Log, path: Path, progress: Progress | None = None) -> None:
    """Write the log's IMUs and their temperatures as sensor_msgs/Imu and sensor_msgs/Temperature.

    Raises:
        MissingDataError: an IMU without gyro or accelerometer, or with a clock for each; the message has one of both.
    """
    streams = [stream for imu in log.imus for stream in _streams(imu)]
    with beside(path) as temporary, temporary.open("wb") as file:
        file.write(MAGIC + _record(HEADER, _text("ros2") + _text("imuwb")))
        declared = _declarations([(topic, schema) for topic, schema, _, _ in streams])
        file.write(declared)
        index = _Index()
        longest = max((time.size for _, _, time, _ in streams), default=0)
        begins = [0] * len(streams)
        for start in range(0, longest, ROWS):
            until = None  # the chunk ends where the fastest stream's does; the others bring what lies before
            parts: list[NDArray[np.void]] = []
            for channel, (_, _, time, fill) in enumerate(streams):
                if until is None:
                    end = min(start + ROWS, time.size)
                    until = int(time[end - 1]) if end < time.size else 2**63 - 1
                else:
                    end = int(np.searchsorted(time, until, side="right"))
                if end > begins[channel]:
                    parts.append(_messages(channel + 1, time, begins[channel], end, fill))
                    begins[channel] = end
            if parts:
                _write_chunk(file, parts, index)
            if progress is not None:
                progress(min(start + ROWS, longest), longest)
        file.write(_record(DATA_END, struct.pack("<I", 0)))
        _write_summary(file, declared, index, len(streams))


def _streams(imu: ImuStream) -> list[tuple[str, str, NDArray[np.int64], Callable[[int, int], NDArray[np.void]]]]:
    """Return (topic, schema, time, rows to records), the fastest first."""
    rate, force = imu.angular_rate, imu.specific_force
    if rate is None or force is None or not np.array_equal(rate.time, force.time):
        message = f"{imu.name}: sensor_msgs/Imu has gyro and accelerometer at one time; this IMU has not"
        raise MissingDataError(message)

    def motion(start: int, end: int) -> NDArray[np.void]:
        rows = np.zeros(end - start, _IMU)
        rows["rate"] = rate.value[start:end] * FRD_TO_FLU
        rows["force"] = force.value[start:end] * FRD_TO_FLU
        rows["orientation_covariance"][:, 0] = ABSENT
        return rows

    streams = [(imu.name, "sensor_msgs/msg/Imu", rate.time, motion)]
    warmth = imu.temperature
    if warmth is not None:

        def temperature(start: int, end: int) -> NDArray[np.void]:
            rows = np.zeros(end - start, _TEMPERATURE)
            rows["temperature"] = warmth.value[start:end]
            return rows

        topic = warmth.name if warmth.name != imu.name else f"{imu.name}/temperature"
        streams.append((topic, "sensor_msgs/msg/Temperature", warmth.time, temperature))
    return streams


def _messages(
    channel: int, time: NDArray[np.int64], start: int, end: int, fill: Callable[[int, int], NDArray[np.void]]
) -> NDArray[np.void]:
    rows = fill(start, end)
    stamp = time[start:end]
    rows["opcode"] = MESSAGE
    rows["size"] = rows.dtype.itemsize - 9
    rows["channel"] = channel
    rows["sequence"] = np.arange(start, end)
    rows["log_time"] = rows["publish_time"] = stamp
    rows["encapsulation"] = (0, 1, 0, 0)  # little-endian CDR
    rows["sec"], rows["nanosec"] = stamp // SECOND, stamp % SECOND
    rows["length"], rows["frame"] = _FRAME.size, _FRAME
    return rows


def _write_chunk(file: BinaryIO, parts: list[NDArray[np.void]], index: _Index) -> None:
    records = b"".join(part.tobytes() for part in parts)
    packed = zstandard.ZstdCompressor(level=3).compress(records)
    times = np.concatenate([part["log_time"] for part in parts])
    first, last = int(times.min()), int(times.max())
    place = file.tell()
    head = struct.pack("<QQQI", first, last, len(records), zlib.crc32(records)) + _text("zstd")
    file.write(_record(CHUNK, head + struct.pack("<Q", len(packed)) + packed))
    length, offsets, at = file.tell() - place, {}, 0
    for part in parts:
        channel = int(part["channel"][0])
        entries = np.empty((part.size, 2), "<u8")
        entries[:, 0] = part["log_time"]
        entries[:, 1] = at + np.arange(part.size) * part.dtype.itemsize
        at += part.nbytes
        offsets[channel] = file.tell()
        file.write(_record(MESSAGE_INDEX, struct.pack("<HI", channel, entries.nbytes) + entries.tobytes()))
        index.counts[channel] = index.counts.get(channel, 0) + part.size
    body = struct.pack("<QQQQI", first, last, place, length, 10 * len(offsets))
    body += b"".join(struct.pack("<HQ", channel, offset) for channel, offset in offsets.items())
    body += (
        struct.pack("<Q", file.tell() - place - length) + _text("zstd") + struct.pack("<QQ", len(packed), len(records))
    )
    index.chunks.append(_record(CHUNK_INDEX, body))
    index.first, index.last = min(index.first, first), max(index.last, last)


def _write_summary(file: BinaryIO, declared: bytes, index: _Index, channels: int) -> None:
    start = file.tell()
    file.write(declared)
    counts = b"".join(struct.pack("<HQ", channel, count) for channel, count in index.counts.items())
    first = index.first if index.chunks else 0
    totals = struct.pack(
        "<QHIIIIQQI",
        sum(index.counts.values()),
        channels,
        channels,
        0,
        0,
        len(index.chunks),
        first,
        index.last,
        len(counts),
    )
    file.write(_record(STATISTICS, totals + counts))
    file.write(b"".join(index.chunks))
    file.write(_record(FOOTER, struct.pack("<QQI", start, 0, 0)) + MAGIC)


def _declarations(topics: list[tuple[str, str]]) -> bytes:
    schemas = list(dict.fromkeys(schema for _, schema in topics))
    records = b""
    for number, name in enumerate(schemas, 1):
        text = SCHEMAS[name].encode()
        body = struct.pack("<H", number) + _text(name) + _text("ros2msg") + struct.pack("<I", len(text)) + text
        records += _record(SCHEMA, body)
    for number, (topic, schema) in enumerate(topics, 1):
        body = (
            struct.pack("<HH", number, schemas.index(schema) + 1) + _text(topic) + _text("cdr") + struct.pack("<I", 0)
        )
        records += _record(CHANNEL, body)
    return records


def _record(opcode: int, content: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(content)) + content


def _text(text: str) -> bytes:
    data = text.encode()
    return struct.pack("<I", len(data)) + data
