"""ROS 1 bags for tests: written with rosbags, or record by record to be damaged."""

import bz2
import struct
from dataclasses import dataclass, field

import lz4.frame
import pytest

MAGIC = b"#ROSBAG V2.0\n"
PACK = {"none": bytes, "bz2": bz2.compress, "lz4": lz4.frame.compress}
IMU, FIX, TWIST = "sensor_msgs/msg/Imu", "sensor_msgs/msg/NavSatFix", "geometry_msgs/msg/TwistStamped"


@dataclass(frozen=True)
class Topic:
    """A connection and its messages: (recorder's ns, payload)."""

    messages: list = field(default_factory=list)
    topic: str = "/imu"
    schema: str = IMU
    callerid: str | None = None


def typestore():
    """Return the message types of ROS 1 as rosbags has them."""
    typesys = pytest.importorskip("rosbags.typesys", reason="rosbags, which writes bags, is not installed")
    return typesys.get_typestore(typesys.Stores.ROS1_NOETIC)


def write_bag(path, *topics, compression="none", chunk=1 << 20):
    """Write the topics with rosbags, messages of all in the order of time."""
    store = typestore()
    from rosbags.rosbag1 import Writer

    writer = Writer(path)
    writer.chunk_threshold = chunk
    if compression != "none":
        writer.set_compression(Writer.CompressionFormat[compression.upper()])
    with writer:
        rows = []
        for topic in topics:
            to = writer.add_connection(topic.topic, topic.schema, typestore=store, callerid=topic.callerid)
            rows += [(time, to, payload) for time, payload in topic.messages]
        for time, to, payload in sorted(rows, key=lambda row: row[0]):
            writer.write(to, time, payload)
    return path


def fields(**values):
    """Return named fields as a header holds them."""
    parts = (name.encode() + b"=" + value for name, value in values.items())
    return b"".join(struct.pack("<I", len(part)) + part for part in parts)


def record(data, **values):
    """Return a record of these header fields and data."""
    header = fields(**values)
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def connection(number, definition, topic="/imu", schema="sensor_msgs/Imu"):
    """Return the record that declares a connection."""
    inner = fields(topic=topic.encode(), type=schema.encode(), md5sum=b"0" * 32, message_definition=definition.encode())
    return record(inner, op=b"\x07", conn=struct.pack("<I", number), topic=topic.encode())


def message(number, time, payload):
    """Return the record of a message."""
    stamp = struct.pack("<II", *divmod(time, 10**9))
    return record(payload, op=b"\x02", conn=struct.pack("<I", number), time=stamp)


def bag_header(index_at, connections, chunks):
    """Return the bag header, padded to 4096 bytes as recorders do."""
    numbers = {
        "index_pos": struct.pack("<Q", index_at),
        "conn_count": struct.pack("<I", connections),
        "chunk_count": struct.pack("<I", chunks),
    }
    bare = record(b"", op=b"\x03", **numbers)
    return record(b" " * (4096 - len(bare)), op=b"\x03", **numbers)


def chunk_info(at, messages):
    """Return what the index states of a chunk with messages, (number of the connection, recorder's ns) each."""
    times = [struct.pack("<II", *divmod(end(time for _, time in messages), 10**9)) for end in (min, max)]
    counts = {number: sum(n == number for n, _ in messages) for number, _ in messages}
    data = b"".join(struct.pack("<II", *item) for item in counts.items())
    values = {
        "ver": struct.pack("<I", 1),
        "chunk_pos": struct.pack("<Q", at),
        "start_time": times[0],
        "end_time": times[1],
    }
    return record(data, op=b"\x06", **values, count=struct.pack("<I", len(counts)))


def chunk(records, compression="none", size=None, packed=None):
    """Return a chunk of records; ``size`` is what it claims, ``packed`` what it holds instead."""
    packed = PACK[compression](records) if packed is None else packed
    size = struct.pack("<I", len(records) if size is None else size)
    return record(packed, op=b"\x05", compression=compression.encode(), size=size)
