"""PX4's logs (.ulg): IMUs, their raw samples if they were logged, receivers, and the navigation solution."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions

format = "ulog"  # noqa: A001 - the contract's name
uses: tuple[str, ...] = ()
MAGIC = b"ULog\x01\x12\x35"


def probe(head: bytes) -> bool:
    """Return whether the file begins with ULog's magic."""
    return head.startswith(MAGIC)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the streams; the file is mapped into memory.

    Raises:
        UnreadableLogError: the file has no whole message of data.
    """
    from imuwb.readers.flight.ulog_streams import streamed  # noqa: PLC0415 - a probe needs no decoder

    return streamed(path)
