"""Reads texts and metadata in the records of MCAP, and unpacks chunks."""

import struct

from isal import isal_zlib

from imuwb.log import MEAN_SEA_LEVEL
from imuwb.readers.bytes.unpack import unpack, unpack_front

OURS = "imuwb"  #: name of the metadata that imuwb writes
TRUTH = "imuwb simulation"  #: name of the metadata with the parameters of a simulated log
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, METADATA, DATA_END = 0x02, 0x03, 0x04, 0x05, 0x06, 0x0C, 0x0F
PREFIX = 9  #: bytes of a record before its content: opcode u8, length u64
HEADER = 22  #: bytes of a message before its payload: channel u16, sequence u32, log time u64, publish time u64


def text(content: bytes, at: int) -> tuple[str, int]:
    """Return a text that is stored after its length, and the offset of its end.

    Raises:
        ValueError: the text is longer than its record.
    """
    size = struct.unpack_from("<I", content, at)[0]
    if at + 4 + size > len(content):
        raise ValueError(f"a text of {size} bytes is longer than its record")
    return content[at + 4 : at + 4 + size].decode("utf-8", "replace"), at + 4 + size


def metadata(content: bytes) -> tuple[str, dict[str, str]]:
    """Return a metadata record's name and entries.

    Raises:
        ValueError, struct.error: the record is damaged.
    """
    name, at = text(content, 0)
    end = at + 4 + struct.unpack_from("<I", content, at)[0]
    at, entries = at + 4, dict[str, str]()
    while at < min(end, len(content)):
        key, at = text(content, at)
        entries[key], at = text(content, at)
    return name, entries


def above_sea_level(record: tuple[str, dict[str, str]]) -> set[str]:
    """Return the topics whose heights are above mean sea level, according to metadata that imuwb wrote."""
    name, entries = record
    return {topic for topic, text in entries.items() if MEAN_SEA_LEVEL in text} if name == OURS else set()


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
