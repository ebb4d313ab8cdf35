"""MAVLink telemetry logs (.tlog): IMUs, receivers and the navigation solution of all systems."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions

format = "tlog"  # noqa: A001 - the contract's name
uses = ("time_source",)
SHORTEST = 16  #: bytes: a time stamp and the shortest frame


def probe(head: bytes) -> bool:
    """Return whether the file begins with a possible time and a frame whose checksum is correct."""
    if len(head) < SHORTEST or b"\0" not in head:
        return False
    from imuwb.readers.flight.telemetry import has_frame  # noqa: PLC0415 - text needs no decoder of frames

    return has_frame(head)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the streams of each system; the whole file is read first, for its clocks.

    Raises:
        UnreadableLogError: the file has no frame whose checksum is correct.
    """
    from imuwb.readers.flight.tlog_streams import streamed  # noqa: PLC0415 - a probe needs no streams

    return streamed(path, options)
