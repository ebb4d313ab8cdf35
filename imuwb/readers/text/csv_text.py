"""Text logs: separated numbers, with units in the header, on the command line, or in a sidecar."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from imuwb.readers.batch import Batch, Remark
    from imuwb.readers.read_options import ReadOptions

format = "csv"  # noqa: A001 - the contract's name
uses = ("rate", "columns", "units", "frame", "epoch")
PRINTABLE = 0.99  #: least share of printable bytes in text


def probe(head: bytes) -> bool:
    """Return whether the file begins with text that has digits."""
    if b"\0" in head or not any(digit in head for digit in b"0123456789"):
        return False
    printable = sum(byte >= ord(" ") or byte in b"\t\r\n\f" for byte in head)
    return printable >= PRINTABLE * len(head)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the rows of a text log in pieces.

    Raises:
        UsageError: the columns, units or rate of the file are unknown.
        UnreadableLogError: the file has no row of numbers, or the numbers contradict their stated unit.
    """
    from imuwb.readers.text.csv_rows import streamed  # noqa: PLC0415 - logs of other formats need no parser of text

    return streamed(path, options)
