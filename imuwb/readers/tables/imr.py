"""Raw inertial data of NovAtel's Inertial Explorer (.imr): a header with scales, and rows of integers."""

from collections.abc import Iterator

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes.source import Source
from imuwb.readers.read_options import ReadOptions

format = "imr"  # noqa: A001 - the contract's name
uses = ("frame",)
ranged = True
MAGIC = b"$IMURAW\0"


def probe(head: bytes) -> bool:
    """Return whether the file begins with the header's name and a zero; a line of text may begin with the name alone."""
    return head.startswith(MAGIC)


def stream(path: Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the rates and specific forces, block by block.

    Raises:
        UnreadableLogError: the header is cut, or states an impossible rate or scale.
    """
    from imuwb.readers.tables.imr_rows import streamed  # noqa: PLC0415 - a probe needs no rows

    return streamed(path, options)
