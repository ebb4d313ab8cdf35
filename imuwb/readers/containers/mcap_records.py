"""The records, chunks and messages of an MCAP file, found without a Python step per message.

A chunk (or, in a file without chunks, a block) is one buffer of bytes. A compiled loop over its records gives the offsets of all
messages; a field of all messages is then gathered at once. The next chunks are unpacked while one is decoded. The index
is not used, so files without one, or cut by a crash, are read in the same way.

Specification: https://mcap.dev/spec
"""

import struct
from collections.abc import Iterator
from functools import partial
from typing import BinaryIO, NamedTuple

import numpy as np
from isal import isal_zlib

from imuwb.arrays import Bytes, Integers
from imuwb.notes import Note
from imuwb.readers.bytes import source
from imuwb.readers.bytes.gather import gather
from imuwb.readers.bytes.loops import compiled_late, compiled_loop, worth_compiling
from imuwb.readers.bytes.source import Source, extended
from imuwb.readers.bytes.unpack import unpack, unpack_front
from imuwb.readers.containers.mcap_extras import (
    READ,
    above_sea_level,
    attachment,
    attachment_text,
    extras_notes,
    metadata,
    metadata_text,
    text,
)
from imuwb.readers.containers.messages import Channel, Messages, Piece, RecordFile, Schema
from imuwb.ros import MCAP_MAGIC as MAGIC
from imuwb.ros import TRUTH

FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, ATTACHMENT, METADATA, DATA_END = 0x02, 0x03, 0x04, 0x05, 0x06, 0x09, 0x0C, 0x0F
PREFIX = 9  #: bytes of a record before its content: opcode u8, length u64
HEADER = 22  #: bytes of a message before its payload: channel u16, sequence u32, log time u64, publish time u64
LATEST = np.uint64(2**62)  #: ns; a later time (after 2116) is damage
LOG_TIME, PUBLISH_TIME = 6, 14  #: offsets in a message
MOST_NOTES = 100  #: on damaged records
ATTACHMENT_HEAD = 1 << 16  #: bytes of an attachment that are looked at
_SHORTEST = np.full(256, -1, np.int64)  #: bytes of the content of each kind of record
_SHORTEST[[SCHEMA, CHANNEL, CHUNK, ATTACHMENT, METADATA, DATA_END]] = 0
_SHORTEST[MESSAGE] = HEADER
DECLARED = {
    SCHEMA: 14,
    CHANNEL: 12,
    METADATA: 8,
    ATTACHMENT: 32,
}  #: bytes of a record that declares something, at least
#: of each opcode, whether its records declare something and the least bytes of these: numpy looks this up fast
_DECLARING, _LEAST = (
    np.isin(np.arange(256), list(DECLARED)),
    np.array([DECLARED.get(opcode, 0) for opcode in range(256)]),
)
CHUNK_HEADER = 40  #: bytes of a chunk before its records, at least


@compiled_late
def _walk(
    buffer: Bytes,
    start: int,
    least: Integers,
    opcode: Bytes,
    content: Integers,
    length: Integers,
) -> tuple[int, int]:  # pragma: no cover - compiled
    """Fill the tables (if they have room) with the whole records from ``start``; return their number, and where they end.

    ``least``: (256,) bytes of the content of each kind, at least; a shorter one is in no table, so that a table is as small as its
    records. -1: no record of this kind is of use.
    """
    count, at, size = 0, start, buffer.size
    while at + 9 <= size:
        n = np.uint64(0)
        for k in range(8):
            n |= np.uint64(buffer[at + 1 + k]) << np.uint64(8 * k)
        if n > np.uint64(size - at - 9):
            break
        shortest = least[buffer[at]]
        if shortest >= 0 and n >= np.uint64(shortest):
            if opcode.size:
                opcode[count] = buffer[at]
                content[count] = at + 9
                length[count] = n
            count += 1
        at += 9 + int(n)
    return count, at


class Records(NamedTuple):
    """The whole records of a buffer, (n,) each."""

    opcode: Bytes
    content: Integers  #: offset
    length: Integers  #: length of the content
    end: int  #: offset after the last whole record


def walk(buffer: Bytes, start: int = 0) -> Records:
    """Return the whole records of a buffer from an offset on: those of the kinds that are read."""
    fill = compiled_loop(_walk) if worth_compiling(buffer.size) else _walk
    nothing = np.empty(0, np.uint8), np.empty(0, np.int64), np.empty(0, np.int64)
    count, end = fill(buffer, start, _SHORTEST, *nothing)
    tables = np.empty(count, np.uint8), np.empty(count, np.int64), np.empty(count, np.int64)
    if count:
        fill(buffer, start, _SHORTEST, *tables)
    return Records(*tables, end)


def unpacked_chunk(chunk: memoryview) -> bytes | memoryview:
    """Return the unpacked records of a chunk; their checksum is tested.

    Args:
        chunk: the content of the chunk's record.

    Raises:
        ValueError: the records cannot be used; the message states why.
    """
    size, crc, compression, packed = _chunk_fields(chunk)
    records = unpack(packed, compression, size)
    if crc and isal_zlib.crc32(records) != crc:
        raise ValueError("its checksum is wrong")
    return records


def _chunk_fields(chunk: memoryview) -> tuple[int, int, str, memoryview]:
    try:
        _, _, size, crc = struct.unpack_from("<QQQI", chunk)
        compression, at = text(bytes(chunk[:64]), 28)
        packed = struct.unpack_from("<Q", chunk, at)[0]
    except struct.error as error:
        raise ValueError(f"its header is damaged ({error})") from error
    return size, crc, compression, chunk[at + 8 : at + 8 + packed]


def unpacked_front(chunk: bytes) -> bytes:
    """Return the part of a cut chunk that can be unpacked; its checksum cannot be tested."""
    try:
        size, _, compression, packed = _chunk_fields(memoryview(chunk))
    except ValueError:
        return b""
    return unpack_front(packed, compression, size)


class Recording(RecordFile[Records]):
    """An MCAP file; metadata that imuwb wrote state which heights are above mean sea level."""

    damaged = 0  #: messages left out because their time is impossible

    def __init__(self, log: Source) -> None:
        """Set the file, or the remote log; nothing is read yet."""
        super().__init__(log)
        self.extras: list[str] = []  #: attachments and metadata that are not used

    def messages(self) -> Iterator[Messages]:
        """Yield the messages of each chunk, or, in a file without chunks, of each block."""
        yield from super().messages()
        self.notes += extras_notes(self.extras)
        if self.damaged:
            text = f"{self.damaged} messages with an impossible recorded time left out"
            self.notes.append(Note("impossible_time", text))

    def _walk(self, buffer: Bytes) -> Records:
        return walk(buffer)

    def _pieces(self) -> Iterator[Piece[Records]]:
        with source.opened(self.log) as file:
            size = source.size(self.log)
            file.seek(len(MAGIC))
            rest, offset = b"", len(MAGIC)
            while True:
                whole = PREFIX + int.from_bytes(rest[1:PREFIX], "little") if len(rest) >= PREFIX else 0
                block = extended(file, rest, whole, size - offset)
                if block is None:
                    yield self._cut_end(rest, offset)
                    return
                buffer = np.frombuffer(block, np.uint8)
                opcode, content, length, end = walk(buffer)
                last = np.flatnonzero(opcode == DATA_END)
                count = int(last[0]) if last.size else opcode.size
                opcode, content, length = opcode[:count], content[:count], length[:count]
                yield Piece(buffer, Records(opcode, content, length, end), offset + len(block))
                for i in np.flatnonzero(opcode == CHUNK):
                    start = offset + int(content[i])
                    packed = buffer.data[content[i] : content[i] + length[i]]
                    yield self._chunk(partial(unpacked_chunk, packed), start, start + len(packed))
                if last.size:
                    end_of_data = offset + int(content[count - 1] + length[count - 1]) if count else offset
                    if fault := _end_fault(file, end_of_data, size):
                        yield self._piece(b"", size, Note("end_damaged", fault))
                    return
                rest, offset = block[end:], offset + end

    def _cut_end(self, rest: bytes, offset: int) -> Piece[Records]:
        """Return the whole part of a last record that is cut."""
        end = offset + len(rest)
        text = f"the file ends at byte {end} without its end mark"
        if not rest:
            text += ": it was cut, or is still being written; all data before this point are used"
            return self._piece(b"", end, Note("no_end_mark", text))
        note = Note("cut", f"{text}, inside a record that begins at byte {offset}; all data before this point are used")
        is_chunk = rest[0] == CHUNK and len(rest) > PREFIX + CHUNK_HEADER
        return self._piece(unpacked_front(rest[PREFIX:]) if is_chunk else b"", end, note)

    def _messages(self, piece: Piece[Records]) -> Iterator[Messages]:
        opcode, content, length, _ = piece.records
        raw = piece.buffer.data
        declaring = np.flatnonzero(_DECLARING[opcode])
        whole = length[declaring] >= _LEAST[opcode[declaring]]
        if short := int(np.count_nonzero(~whole)):
            self.notes.append(Note("damaged_record", f"{short} damaged schema, channel or metadata records left out"))
        for i in declaring[whole]:
            # Of an attachment, which may be large, only its beginning is needed.
            size = min(length[i], ATTACHMENT_HEAD) if opcode[i] == ATTACHMENT else length[i]
            self._declare(int(opcode[i]), bytes(raw[content[i] : content[i] + size]))
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
                elif record[0] not in READ:
                    self.extras.append(metadata_text(record))
            elif opcode == ATTACHMENT:
                self.extras.append(attachment_text(*attachment(content)))
            else:
                number, schema = struct.unpack_from("<HH", content)
                topic, at = text(content, 4)
                encoding, _ = text(content, at)
                self.channels.setdefault(number, Channel(topic, encoding, schema))
        except (struct.error, ValueError) as error:
            note = Note("damaged_record", f"a damaged schema, channel or metadata record left out: {error}")
            if len(self.notes) < MOST_NOTES:
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
