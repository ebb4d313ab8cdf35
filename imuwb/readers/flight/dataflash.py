"""ArduPilot's logs, binary (.bin) and as text (.log): IMUs, receivers, high-rate batches, and the navigation solution."""

import re
from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.read_options import ReadOptions

format = "dataflash"  # noqa: A001 - the contract's name
uses: tuple[str, ...] = ()
_FMT_OF_FMT = b"\xa3\x95" + bytes([128, 128, 89])  # the record that describes records describes itself
_TEXT = re.compile(rb"^FMT, ?128, ?89, ?FMT,", re.MULTILINE)


def probe(head: bytes) -> bool:
    """Return whether the file has the record that describes records, binary or as text."""
    return is_binary(head) or _TEXT.search(head) is not None


def is_binary(head: bytes) -> bool:
    """Return whether the file is a binary log."""
    return b"\0" in head and _FMT_OF_FMT in head


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the streams; the whole file is read first, for its formats and its clock.

    Raises:
        UnreadableLogError: the file has no whole record.
    """
    from imuwb.readers.bytes import source  # noqa: PLC0415 - a probe needs no decoder
    from imuwb.readers.flight.dataflash_streams import streamed  # noqa: PLC0415

    return streamed(path, binary=is_binary(source.head(path)))


def part(path: Path, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Return the streams of a part of a binary log, found by bisection of the file.

    Raises:
        CannotSeekError: the file cannot be searched by time; logs as text never are.
    """
    from imuwb.readers.bytes import source  # noqa: PLC0415 - as above
    from imuwb.readers.flight import dataflash_part  # noqa: PLC0415

    if not is_binary(source.head(path)):
        raise CannotSeekError
    return dataflash_part.part(path, limits)
