"""The records, chunks and messages of an MCAP file, found without a Python step per message.

A chunk (or, in a file without chunks, a block) is one buffer of bytes. A compiled loop over its records gives the offsets of all
messages; a field of all messages is then gathered at once. The next chunks are unpacked while one is decoded. The index
is not used, so files without one, or cut by a crash, are read in the same way.

Specification: https://mcap.dev/spec
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from imuwb.arrays import Bytes, Integers
from imuwb.notes import Note
from imuwb.readers.bytes.ahead import ahead
from imuwb.readers.bytes.gather import gather
from imuwb.readers.bytes.loops import compiled_loop, worth_compiling
from imuwb.readers.bytes.source import extended
from imuwb.readers.containers.magic import MCAP as MAGIC
from imuwb.readers.containers.mcap_chunk import (
    CHANNEL,
    CHUNK,
    DATA_END,
    FOOTER,
    HEADER,
    MESSAGE,
    METADATA,
    PREFIX,
    SCHEMA,
    TRUTH,
    above_sea_level,
    metadata,
    text,
    unpacked_chunk,
    unpacked_front,
)
from imuwb.readers.containers.messages import Channel, Messages, Schema

LATEST = np.uint64(2**62)  #: ns; a later time (after 2116) is damage
LOG_TIME, PUBLISH_TIME = 6, 14  #: offsets in a message
CHUNK_HEADER = 40  #: bytes of a chunk before its records, at least
AHEAD = 2  #: pieces that are unpacked while another is decoded


def _walk(
    buffer: Bytes,
    start: int,
    opcode: Bytes,
    content: Integers,
    length: Integers,
) -> tuple[int, int]:  # pragma: no cover - compiled
    """Fill the tables (if they have room) with the whole records from ``start``; return their number, and where they end."""
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


def walk(buffer: Bytes, start: int = 0) -> tuple[Bytes, Integers, Integers, int]:
    """Return opcode, start and length of the content of each whole record, and where the records end."""
    fill = compiled_loop(_walk) if worth_compiling(buffer.size) else _walk
    nothing = np.empty(0, np.uint8), np.empty(0, np.int64), np.empty(0, np.int64)
    count, end = fill(buffer, start, *nothing)
    tables = np.empty(count, np.uint8), np.empty(count, np.int64), np.empty(count, np.int64)
    if count:
        fill(buffer, start, *tables)
    return *tables, end


@dataclass(frozen=True, eq=False, slots=True)
class _Piece:
    """A block of the file, or an unpacked chunk, and the offsets of its records."""

    buffer: Bytes
    opcode: Bytes
    content: Integers
    length: Integers
    bytes_read: int  #: position of its end in the file
    notes: tuple[Note, ...] = ()  #: notes on the faults of the piece


class Recording:
    """An MCAP file, read from its beginning to its end; schemas and channels are added on the way."""

    def __init__(self, path: Path) -> None:
        """Set the file; nothing is read yet."""
        self.path = path
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.notes: list[Note] = []  #: notes on the faults of the container
        self.above_sea: set[str] = set()  #: topics with heights above mean sea level, by metadata that imuwb wrote
        self.truth: dict[str, str] = {}  #: parameters of a simulated log, by metadata that imuwb wrote
        self.damaged = 0  #: messages left out because their time is impossible

    def messages(self) -> Iterator[Messages]:
        """Yield the messages of each chunk, or, in a file without chunks, of each block."""
        for piece in ahead(self._pieces(), AHEAD):
            self.notes.extend(piece.notes)
            yield from self._messages(piece)
        if self.damaged:
            text = f"{self.damaged} messages with an impossible recorded time left out"
            self.notes.append(Note("impossible_time", text))

    def _pieces(self) -> Iterator[_Piece]:
        with self.path.open("rb") as file:
            size = self.path.stat().st_size
            file.seek(len(MAGIC))
            rest, offset = b"", len(MAGIC)
            while True:
                whole = PREFIX + int.from_bytes(rest[1:PREFIX], "little") if len(rest) >= PREFIX else 0
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
                    end_of_data = offset + int(content[count - 1] + length[count - 1]) if count else offset
                    fault = _end_fault(file, end_of_data, size)
                    if fault:
                        yield _nothing(size, Note("end_damaged", fault))
                    return
                rest, offset = block[end:], offset + end

    def _messages(self, piece: _Piece) -> Iterator[Messages]:
        opcode, content, length, raw = piece.opcode, piece.content, piece.length, piece.buffer.data
        for i in np.flatnonzero(np.isin(opcode, (SCHEMA, CHANNEL, METADATA))):
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
                name, at = text(content, 2)
                encoding, at = text(content, at)
                size = struct.unpack_from("<I", content, at)[0]
                self.schemas.setdefault(number, Schema(name, encoding, content[at + 4 : at + 4 + size]))
            elif opcode == METADATA:
                record = metadata(content)
                self.above_sea |= above_sea_level(record)
                if record[0] == TRUTH:
                    self.truth |= record[1]
            else:
                number, schema = struct.unpack_from("<HH", content)
                topic, at = text(content, 4)
                encoding, _ = text(content, at)
                self.channels.setdefault(number, Channel(topic, encoding, schema))
        except (struct.error, ValueError) as error:
            note = Note("damaged_record", f"a damaged schema, channel or metadata record left out: {error}")
            self.notes.append(note)


def _end_fault(file: BinaryIO, at: int, size: int) -> str:
    """Return what is wrong after the messages, where the index, the footer and the end mark must be; empty if nothing is wrong."""
    opcode = None
    while opcode != FOOTER:
        file.seek(min(at, size))  # a damaged record may state any length
        prefix = file.read(PREFIX)
        if len(prefix) < PREFIX or prefix.startswith(MAGIC):
            return f"the index at the end of the file is cut or damaged at byte {at}; all messages are before it"
        opcode, at = prefix[0], at + PREFIX + int.from_bytes(prefix[1:], "little")
    file.seek(min(at, size))
    if file.read(len(MAGIC)) != MAGIC:
        return f"the end mark at byte {at} is missing or damaged; all messages are before it"
    more = size - at - len(MAGIC)
    return f"{more} bytes after the end mark are not used" if more else ""


def _nothing(bytes_read: int, note: Note) -> _Piece:
    nothing, nowhere = np.empty(0, np.uint8), np.empty(0, np.int64)
    return _Piece(nothing, nothing, nowhere, nowhere, bytes_read, (note,))


def _chunk(packed: memoryview, offset: int) -> _Piece:
    """Return the content of a chunk; nothing, and a note, if it is damaged."""
    end = offset + len(packed)
    try:
        records = np.frombuffer(unpacked_chunk(packed), np.uint8)
    except ValueError as error:
        return _nothing(end, Note("chunk_left_out", f"chunk at byte {offset} left out: {error}"))
    opcode, content, length, end_of_records = walk(records)
    rest = records.size - end_of_records
    text = f"chunk at byte {offset}: its last {rest} bytes do not form a record"
    return _Piece(records, opcode, content, length, end, (Note("chunk_end", text),) if rest else ())


def _cut_end(rest: bytes, offset: int) -> _Piece:
    """Return the whole part of a last record that is cut."""
    end = offset + len(rest)
    text = f"the file ends at byte {end} without its end mark"
    if not rest:
        text += ": it was cut, or is still being written; all data before this point are used"
        return _nothing(end, Note("no_end_mark", text))
    note = Note("cut", f"{text}, inside a record that begins at byte {offset}; all data before this point are used")
    is_chunk = rest[0] == CHUNK and len(rest) > PREFIX + CHUNK_HEADER
    buffer = np.frombuffer(unpacked_front(rest[PREFIX:]) if is_chunk else b"", np.uint8)
    opcode, content, length, _ = walk(buffer)
    return _Piece(buffer, opcode, content, length, end, (note,))
