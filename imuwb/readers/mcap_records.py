"""The container: MCAP's records, chunks and messages, found without a Python step per message.

A chunk (or, in an unchunked file, a block of the file) is one buffer of bytes; a compiled walk over
its records gives the offsets of all messages, from which any field of all of them is gathered at once. The next chunks are
unpacked while one is decoded. Nothing depends on the index, so files without one, or cut
by a crash, are read the same way up to where they end.

Specification: https://mcap.dev/spec
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numba
import numpy as np
from isal import isal_zlib

from imuwb.readers.ahead import ahead
from imuwb.readers.batch import Remark
from imuwb.readers.gather import gather
from imuwb.readers.messages import Channel, Messages, Schema
from imuwb.readers.source import extended
from imuwb.readers.unpack import unpack, unpack_front

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

MAGIC = b"\x89MCAP0\r\n"
SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = 0x03, 0x04, 0x05, 0x06, 0x0F
LATEST = np.uint64(2**62)  #: ns; a later time (after 2116) is damage

#: Of a message, before its payload: channel u16, sequence u32, log time u64, publish time u64.
HEADER, LOG_TIME, PUBLISH_TIME = 22, 6, 14
AHEAD = 2  #: pieces that are unpacked while others are decoded


@numba.njit(cache=True, nogil=True)
def _walk(
    buffer: NDArray[np.uint8],
    start: int,
    opcode: NDArray[np.uint8],
    content: NDArray[np.int64],
    length: NDArray[np.int64],
) -> tuple[int, int]:  # pragma: no cover - compiled
    """Fill the tables (when they have room) with the whole records from ``start``; return number, end."""
    count, at, size = 0, start, buffer.size
    while at + 9 <= size:
        n = np.uint64(0)
        for k in range(8):
            n |= np.uint64(buffer[at + 1 + k]) << np.uint64(8 * k)
        if n > np.uint64(size - at - 9):
            break
        if opcode.size:
            opcode[count] = buffer[at]
            content[count] = at + 9
            length[count] = n
        count += 1
        at += 9 + int(n)
    return count, at


def walk(
    buffer: NDArray[np.uint8], start: int = 0
) -> tuple[NDArray[np.uint8], NDArray[np.int64], NDArray[np.int64], int]:
    """Return opcode, start and length of the content of every whole record, and where they end."""
    nothing = np.empty(0, np.uint8), np.empty(0, np.int64), np.empty(0, np.int64)
    count, end = _walk(buffer, start, *nothing)
    tables = np.empty(count, np.uint8), np.empty(count, np.int64), np.empty(count, np.int64)
    if count:
        _walk(buffer, start, *tables)
    return *tables, end


@dataclass(frozen=True, eq=False, slots=True)
class _Piece:
    """A block of the file, or an unpacked chunk, and where its records lie."""

    buffer: NDArray[np.uint8]
    opcode: NDArray[np.uint8]
    content: NDArray[np.int64]
    length: NDArray[np.int64]
    bytes_read: int  #: of the file, up to its end
    remarks: tuple[Remark, ...] = ()  #: what was wrong with it


class Recording:
    """An MCAP file, read from its beginning to its end; schemas and channels fill up on the way."""

    def __init__(self, path: Path) -> None:
        """Remember the file; nothing is read yet."""
        self.path = path
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.remarks: list[Remark] = []  #: what was wrong with the container
        self.damaged = 0  #: messages left out because their time cannot be

    def messages(self) -> Iterator[Messages]:
        """Yield the messages of each chunk, or of each block of an unchunked file."""
        for piece in ahead(self._pieces(), AHEAD):
            self.remarks.extend(piece.remarks)
            yield from self._messages(piece)
        if self.damaged:
            self.remarks.append(Remark(f"{self.damaged} messages whose recorded time cannot be left out"))

    def _pieces(self) -> Iterator[_Piece]:
        with self.path.open("rb") as file:
            size = self.path.stat().st_size
            file.seek(len(MAGIC))
            rest, offset = b"", len(MAGIC)
            while True:
                whole = 9 + int.from_bytes(rest[1:9], "little") if len(rest) >= 9 else 0  # noqa: PLR2004 - opcode, length
                block = extended(file, rest, whole, size - offset)
                if block is None:
                    yield _cut_end(rest, offset)
                    return
                buffer = np.frombuffer(block, np.uint8)
                opcode, content, length, end = walk(buffer)
                last = np.flatnonzero(opcode == DATA_END)
                count = int(last[0]) if last.size else opcode.size
                opcode, content, length = opcode[:count], content[:count], length[:count]
                yield _Piece(buffer, opcode, content, length, offset + len(block))
                for i in np.flatnonzero(opcode == CHUNK):
                    yield _chunk(buffer.data[content[i] : content[i] + length[i]], offset + int(content[i]))
                if last.size:
                    return
                rest, offset = block[end:], offset + end

    def _messages(self, piece: _Piece) -> Iterator[Messages]:
        opcode, content, length, raw = piece.opcode, piece.content, piece.length, piece.buffer.data
        for i in np.flatnonzero((opcode == SCHEMA) | (opcode == CHANNEL)):
            self._declare(int(opcode[i]), bytes(raw[content[i] : content[i] + length[i]]))
        plain = (opcode == MESSAGE) & (length >= HEADER)
        at, sizes = content[plain], length[plain]
        log_time = gather(piece.buffer, at + LOG_TIME, "<u8")
        publish_time = gather(piece.buffer, at + PUBLISH_TIME, "<u8")
        possible = np.maximum(log_time, publish_time) < LATEST
        if not possible.all():
            self.damaged += int(np.count_nonzero(~possible))
            at, sizes, log_time, publish_time = (table[possible] for table in (at, sizes, log_time, publish_time))
        if at.size:
            yield Messages(
                piece.buffer, gather(piece.buffer, at, "<u2"), log_time.view(np.int64), publish_time.view(np.int64),
                at + HEADER, sizes - HEADER, piece.bytes_read,
            )  # fmt: skip

    def _declare(self, opcode: int, content: bytes) -> None:
        try:
            if opcode == SCHEMA:
                number = struct.unpack_from("<H", content)[0]
                name, at = _string(content, 2)
                encoding, at = _string(content, at)
                size = struct.unpack_from("<I", content, at)[0]
                self.schemas.setdefault(number, Schema(name, encoding, content[at + 4 : at + 4 + size]))
            else:
                number, schema = struct.unpack_from("<HH", content)
                topic, at = _string(content, 4)
                encoding, _ = _string(content, at)
                self.channels.setdefault(number, Channel(topic, encoding, schema))
        except (struct.error, ValueError) as error:
            self.remarks.append(Remark(f"a damaged schema or channel record left out: {error}"))


def _nothing(bytes_read: int, why: str) -> _Piece:
    none, nowhere = np.empty(0, np.uint8), np.empty(0, np.int64)
    return _Piece(none, none, nowhere, nowhere, bytes_read, (Remark(why),))


def _chunk(packed: memoryview, offset: int) -> _Piece:
    """Return what a chunk unpacks to; nothing of it, and a remark, where it is damaged."""
    try:
        records = unpacked_chunk(packed)
    except ValueError as error:
        return _nothing(offset + len(packed), f"chunk at byte {offset} left out: {error}")
    opcode, content, length, end = walk(records)
    remarks: list[Remark] = []
    if end < records.size:
        remarks.append(Remark(f"chunk at byte {offset}: its last {records.size - end} bytes are no record"))
    return _Piece(records, opcode, content, length, offset + len(packed), tuple(remarks))


def _cut_end(rest: bytes, offset: int) -> _Piece:
    """Return what is whole in a last record that is not."""
    where = f"the file ends at byte {offset + len(rest)} without its end mark"
    if not rest:
        return _nothing(offset + len(rest), f"{where}: it was cut, or is still being written; all before is used")
    remark = Remark(f"{where}, inside a record that begins at byte {offset}: what was whole before it is used")
    unpacked = _unpack_front(rest[9:]) if rest[0] == CHUNK and len(rest) > 9 + 40 else b""
    buffer = np.frombuffer(unpacked, np.uint8)
    opcode, content, length, _ = walk(buffer)
    return _Piece(buffer, opcode, content, length, offset + len(rest), (remark,))


def _string(content: bytes, at: int) -> tuple[str, int]:
    size = struct.unpack_from("<I", content, at)[0]
    if at + 4 + size > len(content):
        message = f"a text of {size} bytes does not fit in its record"
        raise ValueError(message)
    return content[at + 4 : at + 4 + size].decode("utf-8", "replace"), at + 4 + size


def unpacked_chunk(chunk: memoryview) -> NDArray[np.uint8]:
    """Return a chunk's records; ValueError says why they cannot be used."""
    return np.frombuffer(_unpack(chunk), np.uint8)


def _unpack(chunk: memoryview) -> bytes | memoryview:
    """Return a chunk's records, unpacked and checked; ValueError says why they cannot be used."""
    size, crc, compression, packed = _chunk_fields(chunk)
    records = unpack(packed, compression, size)
    if crc and isal_zlib.crc32(records) != crc:
        message = "its checksum does not match"
        raise ValueError(message)
    return records


def _chunk_fields(chunk: memoryview) -> tuple[int, int, str, memoryview]:
    try:
        _, _, size, crc = struct.unpack_from("<QQQI", chunk)
        compression, at = _string(bytes(chunk[:64]), 28)
        packed = struct.unpack_from("<Q", chunk, at)[0]
    except struct.error as error:
        message = f"its header is damaged ({error})"
        raise ValueError(message) from error
    return size, crc, compression, chunk[at + 8 : at + 8 + packed]


def _unpack_front(chunk: bytes) -> bytes:
    """Return as much of a cut chunk as unpacks; its checksum cannot be checked."""
    try:
        size, _, compression, packed = _chunk_fields(memoryview(chunk))
    except ValueError:
        return b""
    return unpack_front(packed, compression, size)
