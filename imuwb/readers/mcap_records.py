"""The container: MCAP's records, chunks and messages, found without a Python step per message.

A chunk (or, in an unchunked file, a block of the file) is one buffer of bytes; a compiled walk over
its records gives the offsets of all messages, and a structured view with a stride of one byte
gathers any field of all of them at once. Nothing depends on the index, so files without one, or cut
by a crash, are read the same way up to where they end.

Specification: https://mcap.dev/spec
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, BinaryIO

import lz4.frame
import numba
import numpy as np
import zstandard

from imuwb.readers.batch import Remark

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

MAGIC = b"\x89MCAP0\r\n"
SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = 0x03, 0x04, 0x05, 0x06, 0x0F
BLOCK = 8 << 20  #: bytes read at a time
LATEST = np.uint64(2**62)  #: ns; a later time (after 2116) is damage
LARGEST_CHUNK = 1 << 30  #: a chunk that claims to unpack to more is not unpacked

_HEADER = np.dtype([("channel", "<u2"), ("sequence", "<u4"), ("log_time", "<u8"), ("publish_time", "<u8")])


@dataclass(frozen=True, slots=True)
class Schema:
    """How a channel's messages are laid out."""

    name: str
    encoding: str
    data: bytes


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic."""

    topic: str
    message_encoding: str
    schema_id: int


@dataclass(frozen=True, eq=False, slots=True)
class Messages:
    """Messages of all channels that lie in one buffer."""

    buffer: NDArray[np.uint8]
    channel: NDArray[np.uint16]
    log_time: NDArray[np.int64]  #: ns
    publish_time: NDArray[np.int64]  #: ns
    start: NDArray[np.int64]  #: of the payload in the buffer
    length: NDArray[np.int64]  #: of the payload
    bytes_read: int  #: of the file, so far


def gather(buffer: NDArray[np.uint8], offsets: NDArray[np.int64], dtype: np.dtype[np.void]) -> NDArray[np.void]:
    """Return the records of ``dtype`` that begin at ``offsets`` (any alignment), copied."""
    if not offsets.size:
        return np.empty(0, dtype)
    view = np.ndarray((buffer.size - dtype.itemsize + 1,), dtype, buffer, strides=(1,))
    return view[offsets]


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
        with self.path.open("rb") as file:
            size = self.path.stat().st_size
            file.seek(len(MAGIC))
            rest, offset = b"", len(MAGIC)
            while True:
                block = self._block(file, rest, size - offset)
                if block is None:
                    yield from self._cut_end(rest, offset)
                    return
                buffer = np.frombuffer(block, np.uint8)
                opcode, content, length, end = walk(buffer)
                last = np.flatnonzero(opcode == DATA_END)
                if last.size:
                    opcode, content, length = (table[: last[0]] for table in (opcode, content, length))
                yield from self._records(buffer, opcode, content, length, offset)
                if last.size:
                    return
                rest, offset = block[end:], offset + end

    def _block(self, file: BinaryIO, rest: bytes, left: int) -> bytes | None:
        """Return ``rest`` and what follows it, with at least one whole record; None where there is none."""
        want = BLOCK
        if len(rest) >= 9:  # noqa: PLR2004 - opcode and length
            want = max(BLOCK, 9 + int.from_bytes(rest[1:9], "little") - len(rest))
        want = min(want, left)  # a length no file can hold is a damaged record: the walk stops at it
        more = file.read(want)
        return rest + more if more else None

    def _cut_end(self, rest: bytes, offset: int) -> Iterator[Messages]:
        """Use what is whole in a last record that is not."""
        where = f"the file ends at byte {offset + len(rest)} without its end mark"
        if not rest:
            self.remarks.append(Remark(f"{where}: it was cut, or is still being written; all before is used"))
            return
        self.remarks.append(
            Remark(f"{where}, inside a record that begins at byte {offset}: what was whole before it is used")
        )
        if rest[0] == CHUNK and len(rest) > 9 + 40:
            unpacked = _unpack_front(rest[9:])
            if unpacked:
                buffer = np.frombuffer(unpacked, np.uint8)
                opcode, content, length, _ = walk(buffer)
                yield from self._records(buffer, opcode, content, length, offset, inside=True)

    def _records(
        self, buffer: NDArray[np.uint8], opcode: NDArray[np.uint8], content: NDArray[np.int64],
        length: NDArray[np.int64], offset: int, *, inside: bool = False,
    ) -> Iterator[Messages]:  # fmt: skip
        raw = buffer.data
        for i in np.flatnonzero((opcode == SCHEMA) | (opcode == CHANNEL)):
            self._declare(int(opcode[i]), bytes(raw[content[i] : content[i] + length[i]]))
        plain = (opcode == MESSAGE) & (length >= _HEADER.itemsize)
        header = gather(buffer, content[plain], _HEADER)
        possible = np.maximum(header["log_time"], header["publish_time"]) < LATEST
        self.damaged += int(np.count_nonzero(~possible))
        plain[plain] = possible
        if plain.any():
            header = header[possible]
            yield Messages(
                buffer, header["channel"], header["log_time"].astype(np.int64),
                header["publish_time"].astype(np.int64), content[plain] + _HEADER.itemsize,
                length[plain] - _HEADER.itemsize, offset + int(content[plain][-1]),
            )  # fmt: skip
        if inside:
            return
        for i in np.flatnonzero(opcode == CHUNK):
            where = offset + int(content[i])
            try:
                unpacked = _unpack(raw[content[i] : content[i] + length[i]])
            except ValueError as error:
                self.remarks.append(Remark(f"chunk at byte {where} left out: {error}"))
                continue
            records = np.frombuffer(unpacked, np.uint8)
            opcodes, starts, sizes, end = walk(records)
            if end < records.size:
                self.remarks.append(Remark(f"chunk at byte {where}: its last {records.size - end} bytes are no record"))
            yield from self._records(records, opcodes, starts, sizes, where, inside=True)

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


def _string(content: bytes, at: int) -> tuple[str, int]:
    size = struct.unpack_from("<I", content, at)[0]
    if at + 4 + size > len(content):
        message = f"a text of {size} bytes does not fit in its record"
        raise ValueError(message)
    return content[at + 4 : at + 4 + size].decode("utf-8", "replace"), at + 4 + size


def _unpack(chunk: memoryview) -> bytes | memoryview:
    """Return a chunk's records, unpacked and checked; ValueError says why they cannot be used."""
    size, crc, compression, packed = _chunk_fields(chunk)
    if size > LARGEST_CHUNK:
        message = f"it claims to unpack to {size} bytes, more than {LARGEST_CHUNK}"
        raise ValueError(message)
    if compression == "":
        records: bytes | memoryview = packed
    elif compression == "zstd":
        records = _unpack_zstd(packed, size)
    elif compression == "lz4":
        records = _unpack_lz4(packed, size)
    else:
        message = f"compression {compression!r} is not one of zstd, lz4 and none"
        raise ValueError(message)
    if len(records) != size:
        message = f"it unpacks to {len(records)} bytes where {size} are stated"
        raise ValueError(message)
    if crc and zlib.crc32(records) != crc:
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


def _unpack_zstd(packed: memoryview, size: int) -> bytes:
    try:
        # A frame states its size; the library would allocate whatever it states.
        if zstandard.frame_content_size(bytes(packed[:18])) not in (-1, size):
            message = "its zstd frame and its header state different sizes"
            raise ValueError(message)
        return zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
    except zstandard.ZstdError as error:
        message = f"zstd cannot unpack it ({error})"
        raise ValueError(message) from error


def _unpack_lz4(packed: memoryview, size: int) -> bytes:
    try:
        return lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size + 1)
    except (RuntimeError, EOFError) as error:
        message = f"lz4 cannot unpack it ({error})"
        raise ValueError(message) from error


def _unpack_front(chunk: bytes) -> bytes:
    """Return as much of a cut chunk as unpacks; its checksum cannot be checked."""
    try:
        size, _, compression, packed = _chunk_fields(memoryview(chunk))
        if size > LARGEST_CHUNK:
            return b""
        if compression == "zstd":
            pieces, unpacker = bytearray(), zstandard.ZstdDecompressor().decompressobj()
            for at in range(0, len(packed), 1 << 16):
                pieces += unpacker.decompress(packed[at : at + (1 << 16)])
                if len(pieces) > size:
                    return b""
            return bytes(pieces)
        if compression == "lz4":
            return lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size)
        return bytes(packed)
    except (ValueError, zstandard.ZstdError, RuntimeError, EOFError):
        return b""
