"""u-blox receivers' own protocol (.ubx): fixes, and the inertial sensors of receivers that have some; NMEA may be in between."""

from collections.abc import Iterator

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes.source import Source
from imuwb.readers.read_options import ReadOptions

format = "ubx"  # noqa: A001 - the contract's name
uses = ("frame",)
ranged = True
SYNC = b"\xb5\x62"
LEAST = 0.25  #: share of the first bytes that must be frames: other logs may hold some of a receiver's frames, too


def probe(head: bytes) -> bool:
    """Return whether frames with a correct checksum are a good part of the file's first bytes."""
    if SYNC not in head:
        return False
    import numpy as np  # noqa: PLC0415 - text needs no decoder of frames

    from imuwb.readers.receivers.ubx_frames import scan  # noqa: PLC0415

    frames = scan(np.frombuffer(head, np.uint8), last=True)
    return int((frames.length + 8).sum()) >= LEAST * len(head)


def stream(path: Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the streams; the whole file is read first, for its clock.

    Raises:
        UnreadableLogError: the file has no frame that imuwb uses.
    """
    from imuwb.readers.receivers.ubx_streams import streamed  # noqa: PLC0415 - a probe needs no streams

    return streamed(path, options)
