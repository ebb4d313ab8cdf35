"""MCAP with ROS 2 messages (cdr, zstd) that other tools open; whole chunks are written, not single messages.

The messages of a stream differ only in their numbers, so a chunk is one array of records. ROS bodies are
forward-left-up (REP 145): y and z change sign, as they do when a log is read.
Specification: https://mcap.dev/spec
"""

import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np
import zstandard
from numpy.typing import NDArray

from imuwb.errors import MissingDataError
from imuwb.log import MEAN_SEA_LEVEL, Log
from imuwb.progress import Progress
from imuwb.ros import MCAP_MAGIC as MAGIC
from imuwb.ros import OURS, TRUTH, definition
from imuwb.writers.ros_messages import stamped, topics
from imuwb.writers.whole import whole_file

HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX, STATISTICS, METADATA, METADATA_INDEX, DATA_END = (
    0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x08, 0x0B, 0x0C, 0x0D, 0x0F,
)  # fmt: skip
ROWS = 12_000  #: rows of the fastest stream in a chunk; such a chunk has about 4 MB
LAST = 2**63 - 1  #: ns
STAMPS_END = 2**31 * 10**9  #: ns; seconds of a stamp are an int32


@dataclass(slots=True)
class _Index:
    """The contents of the summary at the end of the file."""

    chunks: list[bytes] = field(default_factory=list[bytes])
    metadata: list[bytes] = field(default_factory=list[bytes])
    counts: dict[int, int] = field(default_factory=dict[int, int])
    first: int = 2**63 - 1
    last: int = 0


def write_mcap(log: Log, path: Path, progress: Progress | None = None) -> None:
    """Write all streams of a log as ROS 2 messages, in chunks in the order of time.

    Raises:
        MissingDataError: times after 2038, which a ROS 2 stamp cannot hold.
    """
    streams = topics(log)
    late = next((topic.name for topic in streams if topic.time.size and topic.time[-1] >= STAMPS_END), None)
    if late is not None:
        raise MissingDataError(f"{path}: {late} has times after 2038, which a ROS 2 stamp cannot hold; write .csv")
    with whole_file(path) as temporary, temporary.open("wb") as file:
        file.write(MAGIC + _record(HEADER, _text("ros2") + _text("imuwb")))
        declared = _declarations([(topic.name, topic.schema) for topic in streams])
        file.write(declared)
        index = _Index()
        _write_metadata(file, log, index)
        fastest = max(streams, key=lambda topic: topic.time.size).time if streams else np.empty(0, np.int64)
        begins = [0] * len(streams)
        for start in range(0, fastest.size, ROWS):
            # A chunk has ``ROWS`` rows of the fastest stream; the rows of the others up to the same time go with them.
            until = int(fastest[start + ROWS]) - 1 if start + ROWS < fastest.size else LAST
            parts: list[NDArray[np.void]] = []
            for place, topic in enumerate(streams):
                begin, end = begins[place], int(np.searchsorted(topic.time, until, side="right"))
                if end > begin:
                    parts.append(stamped(topic, place + 1, slice(begin, end), MESSAGE))
                    begins[place] = end
            if parts:
                _write_chunk(file, parts, index)
            if progress is not None:
                progress(min(start + ROWS, fastest.size), fastest.size)
        file.write(_record(DATA_END, struct.pack("<I", 0)))
        _write_summary(file, declared, index, len(streams))


def _write_metadata(file: BinaryIO, log: Log, index: _Index) -> None:
    """Write which streams have heights above mean sea level, and the parameters of a simulation: no message has fields for them."""
    heights = {
        stream.name: f"heights are {MEAN_SEA_LEVEL}"
        for stream in (*log.gnss, *log.references)
        if stream.origin.above_sea
    }
    for kind, entries in ((OURS, heights), (TRUTH, log.truth)):
        if entries:
            pairs = b"".join(_text(name) + _text(what) for name, what in entries.items())
            record = _record(METADATA, _text(kind) + struct.pack("<I", len(pairs)) + pairs)
            index.metadata.append(_record(METADATA_INDEX, struct.pack("<QQ", file.tell(), len(record)) + _text(kind)))
            file.write(record)


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
        "<QHIIIIQQI", sum(index.counts.values()), channels, channels, 0, len(index.metadata), len(index.chunks), first,
        index.last, len(counts),
    )  # fmt: skip
    file.write(_record(STATISTICS, totals + counts))
    file.write(b"".join([*index.chunks, *index.metadata]))
    file.write(_record(FOOTER, struct.pack("<QQI", start, 0, 0)) + MAGIC)


def _declarations(topics: list[tuple[str, str]]) -> bytes:
    schemas = list(dict.fromkeys(schema for _, schema in topics))
    records = b""
    for number, name in enumerate(schemas, 1):
        text = definition(name).encode()
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
