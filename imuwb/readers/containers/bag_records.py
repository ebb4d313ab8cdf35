"""The records, chunks and messages of a ROS 1 bag, found without a Python step per message.

A record has a header of named fields, and data. The index at the end is not used, so bags that are cut, or have no index, are
read in the same way.

Specification: http://wiki.ros.org/Bags/Format/2.0
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from imuwb.arrays import Bytes, Integers
from imuwb.compiled import compiled
from imuwb.notes import Note
from imuwb.readers.bytes import source
from imuwb.readers.bytes.gather import gather
from imuwb.readers.bytes.source import extended
from imuwb.readers.bytes.unpack import unpack, unpack_front
from imuwb.readers.containers.messages import BAG_MAGIC as MAGIC
from imuwb.readers.containers.messages import Channel, Messages, Piece, RecordFile, Schema
from imuwb.units import SECOND

MESSAGE, CHUNK, CONNECTION = 0x02, 0x05, 0x07
_OP, _CONNECTION, _TIME = b"op=", b"conn=", b"time="


@dataclass(frozen=True, eq=False, slots=True)
class Records:
    """The records of a buffer: (n,) offsets and numbers."""

    opcode: Bytes
    header: Integers  #: offset of the fields
    connection: Integers  #: offset of the connection's number; -1 for a record without it
    time: Integers  #: offset of the time; -1 for a record without it
    data: Integers  #: offset
    length: Integers  #: length of the data
    end: int  #: offset after the last whole record


@compiled()
def _u32(buffer: Bytes, at: int) -> int:  # pragma: no cover - compiled
    return int(buffer[at]) | int(buffer[at + 1]) << 8 | int(buffer[at + 2]) << 16 | int(buffer[at + 3]) << 24


@compiled()
def _is(buffer: Bytes, at: int, name: Bytes) -> bool:  # pragma: no cover - compiled
    for k in range(name.size):  # noqa: SIM110 - no generators in compiled code
        if buffer[at + k] != name[k]:
            return False
    return True


@compiled()
def _walk(buffer: Bytes, names: tuple[Bytes, ...], tables: Integers) -> tuple[int, int]:  # pragma: no cover - compiled
    """Fill the table (if it has room) with the whole records; return their number, and where they end."""
    count, at, size = 0, 0, buffer.size
    while at + 8 <= size:
        header = _u32(buffer, at)
        if at + 8 + header > size:
            break
        length = _u32(buffer, at + 4 + header)
        if at + 8 + header + length > size:
            break
        if tables.size:
            tables[0, count], tables[1, count] = 0, at + 4
            tables[2, count] = tables[3, count] = -1
            tables[4, count], tables[5, count] = at + 8 + header, length
            field, end = at + 4, at + 4 + header
            while field + 4 < end:
                width = _u32(buffer, field)
                if field + 4 + width > end:
                    break
                for k in range(3):
                    if width == names[k].size + (1, 4, 8)[k] and _is(buffer, field + 4, names[k]):
                        value = field + 4 + names[k].size
                        tables[0 if k == 0 else k + 1, count] = buffer[value] if k == 0 else value
                field += 4 + width
        count += 1
        at += 8 + header + length
    return count, at


def walk(buffer: Bytes) -> Records:
    """Return the whole records of a buffer."""
    names = tuple(np.frombuffer(name, np.uint8) for name in (_OP, _CONNECTION, _TIME))
    count, end = _walk(buffer, names, np.empty((0, 0), np.int64))
    tables = np.empty((6, count), np.int64)
    if count:
        _walk(buffer, names, tables)
    opcode, header, connection, time, data, length = tables
    return Records(opcode.astype(np.uint8), header, connection, time, data, length, end)


class Bag(RecordFile[Records]):
    """A ROS 1 bag. It does not state whether heights are above mean sea level."""

    def _walk(self, buffer: Bytes) -> Records:
        return walk(buffer)

    def _pieces(self) -> Iterator[Piece[Records]]:
        with source.opened(self.log) as file:
            size = source.size(self.log)
            file.seek(len(MAGIC))
            rest, offset = b"", len(MAGIC)
            while (block := extended(file, rest, _whole(rest), size - offset)) is not None:
                buffer = np.frombuffer(block, np.uint8)
                records = walk(buffer)
                yield Piece(buffer, records, offset + len(block))
                for i in np.flatnonzero(records.opcode == CHUNK):
                    start = int(records.data[i])
                    head = bytes(buffer[records.header[i] : start - 4])
                    packed = buffer.data[start : start + int(records.length[i])]
                    unpacked = partial(unpack, packed, *packing_of(head))
                    yield self._chunk(unpacked, offset + start, offset + start + len(packed))
                rest, offset = block[records.end :], offset + records.end
            if rest:
                yield self._cut_end(rest, offset)

    def _cut_end(self, rest: bytes, offset: int) -> Piece[Records]:
        """Return the whole part of a last record that is cut."""
        end = offset + len(rest)
        text = f"the file ends at byte {end} inside a record that begins at byte {offset}"
        header = int.from_bytes(rest[:4], "little")
        unpacked = b""
        if len(rest) > 8 + header and fields_of(rest[4 : 4 + header]).get("op") == bytes([CHUNK]):
            compression, size = packing_of(rest[4 : 4 + header])
            unpacked = unpack_front(memoryview(rest)[8 + header :], compression, size)
        return self._piece(unpacked, end, Note("cut", f"{text}; all data before this point are used"))

    def _messages(self, piece: Piece[Records]) -> Iterator[Messages]:
        records, buffer = piece.records, piece.buffer
        for i in np.flatnonzero(records.opcode == CONNECTION):
            self._declare(piece, int(i))
        plain = np.flatnonzero((records.opcode == MESSAGE) & (records.connection >= 0) & (records.time >= 0))
        if plain.size:
            number = gather(buffer, records.connection[plain], "<u4").astype(np.int64)
            stamp = gather(buffer, records.time[plain], "<u4", 2).astype(np.int64)
            time = stamp[:, 0] * SECOND + stamp[:, 1]
            start = records.data[plain]
            yield Messages(buffer, number, time, time, start, records.length[plain], piece.bytes_read)

    def _declare(self, piece: Piece[Records], i: int) -> None:
        records, raw = piece.records, piece.buffer.data
        start, length = int(records.data[i]), int(records.length[i])
        outer = fields_of(bytes(raw[int(records.header[i]) : start - 4]))
        inner = fields_of(bytes(raw[start : start + length]))
        number = outer.get("conn", b"")
        if len(number) != 4 or "type" not in inner:  # noqa: PLR2004 - u32
            self.notes.append(Note("damaged_record", "a damaged connection record left out"))
            return
        connection = int.from_bytes(number, "little")
        topic = inner.get("topic", outer.get("topic", b"")).decode("utf-8", "replace")
        self.channels.setdefault(connection, Channel(topic, "ros1", connection))
        name = inner["type"].decode("utf-8", "replace")
        self.schemas.setdefault(connection, Schema(name, "ros1msg", inner.get("message_definition", b"")))


def _whole(rest: bytes) -> int:
    """Return the size of the record that begins here, as far as it is known."""
    if len(rest) < 4:  # noqa: PLR2004 - u32
        return 0
    header = int.from_bytes(rest[:4], "little")
    if len(rest) < 8 + header:
        return 8 + header
    return 8 + header + int.from_bytes(rest[4 + header : 8 + header], "little")


def fields_of(header: bytes) -> dict[str, bytes]:
    """Return the whole fields of a header, by name."""
    fields: dict[str, bytes] = {}
    at = 0
    while at + 4 <= len(header):
        width = struct.unpack_from("<I", header, at)[0]
        name, mark, value = header[at + 4 : at + 4 + width].partition(b"=")
        if not mark or at + 4 + width > len(header):
            break
        fields[name.decode("utf-8", "replace")] = value
        at += 4 + width
    return fields


def packing_of(header: bytes) -> tuple[str, int]:
    """Return a chunk's compression and unpacked size, as its header states them."""
    fields = fields_of(header)
    compression = fields.get("compression", b"none").decode("utf-8", "replace")
    return compression, int.from_bytes(fields.get("size", b""), "little")
