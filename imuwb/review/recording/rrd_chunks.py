"""Reads chunks of a recording: tables of Apache Arrow in messages. The viewer's own library ends the process at some damaged recordings.

A file begins with 12 bytes; each message has its kind and its length (8 bytes each, little-endian), and a message of protobuf. Source:
rerun, the crate re_log_encoding and log_msg.proto, 0.41. Tested with recordings of 0.41 alone; imuwb takes rerun 0.38 to 0.44.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import pyarrow as pa

from imuwb.readers.bytes import budget

START, HEAD = 12, 16  #: bytes
END, TABLE = 0, 2  #: kinds of messages
COMPRESSION, SIZE, PAYLOAD = 2, 3, 5  #: fields of a table's message
PACKED = 2  #: a compression: LZ4 without a frame
RATIO = 256  #: bytes at most that a byte of LZ4 unpacks to
ENTITY = b"rerun:entity_path"
FAULTS = (pa.ArrowException, OSError, MemoryError, OverflowError, ValueError, IndexError, TypeError)


def chunks(path: Path, prefixes: tuple[str, ...]) -> Iterator[tuple[str, pa.RecordBatch]]:
    """Yield the tables of entities whose paths begin with one of some prefixes, each with its path.

    Raises:
        OverBudgetError: a table takes more memory than the recording may. Of a damaged recording, one of ``FAULTS``.
    """
    with path.open("rb") as file:
        left = path.stat().st_size - file.seek(START)
        while left > HEAD:
            kind, length = (int.from_bytes(file.read(8), "little") for _ in range(2))
            left -= HEAD + length
            if kind == END:
                return
            if left < 0:
                raise ValueError("a message goes beyond the end of the file")
            if kind != TABLE:
                file.seek(length, 1)
                continue
            table = pa.ipc.open_stream(_payload(file, length))
            entity = (table.schema.metadata or {}).get(ENTITY, b"").decode()
            if entity.startswith(prefixes):
                for batch in table:
                    batch.validate(full=True)
                    yield entity, batch


def _payload(file: BinaryIO, length: int) -> pa.Buffer | bytes:
    """Return the unpacked table of a message."""
    fields = dict(_fields(file.read(length)))
    payload, size = fields.get(PAYLOAD), fields.get(SIZE, 0)
    if not isinstance(payload, bytes) or not isinstance(size, int):
        raise ValueError("a message has no table")  # noqa: TRY004 - what the file has, not what a caller gives
    if fields.get(COMPRESSION) != PACKED:
        return payload
    if size > RATIO * len(payload):
        raise ValueError(f"{len(payload)} bytes cannot unpack to the {size} that are stated")
    budget.check(size, "a table in it")
    return pa.Codec("lz4_raw").decompress(payload, size)


def _fields(message: bytes) -> Iterator[tuple[int, int | bytes]]:
    """Yield number and value of each field of a message of protobuf: a whole number, or bytes."""
    at = 0
    while at < len(message):
        tag, at = _whole(message, at)
        wire = tag & 7
        if wire == 0:
            value, at = _whole(message, at)
            yield tag >> 3, value
            continue
        if wire not in (1, 2, 5):
            raise ValueError(f"a field of protobuf of the unknown form {wire}")
        size, at = _whole(message, at) if wire == 2 else ({1: 8, 5: 4}[wire], at)  # noqa: PLR2004 - bytes with their length
        yield tag >> 3, message[at : at + size]
        at += size


def _whole(message: bytes, at: int) -> tuple[int, int]:
    """Return a whole number of protobuf, and where it ends."""
    value = shift = 0
    while True:
        byte = message[at]
        value, at, shift = value | (byte & 127) << shift, at + 1, shift + 7
        if byte < 128:  # noqa: PLR2004 - the highest bit
            return value, at
        if shift > 63:  # noqa: PLR2004 - bits
            raise ValueError("a whole number of protobuf without end")
