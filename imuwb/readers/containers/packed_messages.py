"""Messages that are packed one by one, as rosbag2 does with its compression of messages.

Source: ros2/rosbag2, rosbag2_compression (message mode): the payload is a frame of Zstandard.
"""

from dataclasses import replace

import numpy as np

from imuwb.arrays import Integers
from imuwb.readers.bytes import budget
from imuwb.readers.bytes.source import ZSTD_MAGIC
from imuwb.readers.bytes.unpack import unpack
from imuwb.readers.containers.messages import Messages

LARGEST = 64 << 20  #: bytes; a message that unpacks to more, such as an image, is not unpacked


def are_packed(messages: Messages, rows: Integers) -> bool:
    """Return whether the first of some messages is packed; a message in CDR begins otherwise."""
    first = int(messages.start[rows[0]]) if rows.size else 0
    return bool(rows.size) and messages.buffer[first : first + 4].tobytes() == ZSTD_MAGIC


def unpacked_messages(messages: Messages, rows: Integers) -> Messages:
    """Return some messages with their content; one that cannot be unpacked is empty."""
    starts, lengths = messages.start[rows], messages.length[rows]
    contents: list[bytes] = []
    held = 0
    for start, size in zip(starts, lengths, strict=True):
        contents.append(_unpacked(messages.buffer.data[start : start + size]))
        held += len(contents[-1])
        budget.check(held, "what its packed messages contain")
    length = np.array([len(content) for content in contents], np.int64)
    return replace(
        messages,
        buffer=np.frombuffer(b"".join(contents), np.uint8),
        channel=messages.channel[rows],
        log_time=messages.log_time[rows],
        publish_time=messages.publish_time[rows],
        start=np.cumsum(length) - length,
        length=length,
    )


def _unpacked(packed: memoryview) -> bytes:
    import zstandard  # noqa: PLC0415 - few recordings are packed so

    try:
        size = zstandard.frame_content_size(bytes(packed[:18]))
        return bytes(unpack(packed, "zstd", size)) if 0 <= size <= LARGEST else b""
    except (ValueError, zstandard.ZstdError):
        return b""
