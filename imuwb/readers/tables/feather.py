"""Feather and other files of Apache Arrow: named columns, each with its unit in its name or in its metadata."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.sidecar import names_of

format = "feather"  # noqa: A001 - the contract's name
uses = ("time_source", "columns", "units", "frame", "epoch")
beside = names_of
MAGIC = b"ARROW1"
STREAM = b"\xff\xff\xff\xff"  #: begins each message of a stream; the length of its head follows
LONGEST = 1 << 20  #: bytes of the first head, which describes the columns


def probe(head: bytes) -> bool:
    """Return whether the file begins with Arrow's magic, or with the first message of a stream."""
    length = int.from_bytes(head[4:8], "little")
    return head.startswith(MAGIC) or (head.startswith(STREAM) and 0 < length < LONGEST and length % 8 == 0)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the streams of its columns, some thousand rows at a time.

    Raises:
        UnreadableLogError: the file is cut or damaged, or has no row of numbers.
        UsageError: the columns, units or rate of the file are unknown.
    """
    from imuwb.readers.tables.arrow_tables import feather_pieces, streamed  # noqa: PLC0415 - a probe needs no pyarrow
    from imuwb.readers.tables.packed import refuse_packed  # noqa: PLC0415

    refuse_packed(path)
    return streamed(path, options, feather_pieces)
