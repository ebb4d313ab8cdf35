"""u-blox receivers' own protocol (.ubx): fixes, and the inertial sensors of receivers that have some; NMEA may be in between."""

from collections.abc import Iterator

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes.source import Source
from imuwb.readers.read_options import ReadOptions

format = "ubx"  # noqa: A001 - the contract's name
uses = ("frame",)
ranged = True
SYNC = b"\xb5\x62"
LEAST = (
    0.25  #: share of the first bytes that must be frames or sentences: other logs may hold some of a receiver's, too
)
POSITIONED = (0x01, 0x02, 0x10)  #: classes of messages of which a log with many sentences has at least one


def probe(head: bytes) -> bool:
    """Return whether frames with a correct checksum, and NMEA sentences between them, are a good part of the file's first bytes."""
    if SYNC not in head:
        return False
    import numpy as np  # noqa: PLC0415 - text needs no decoder of frames

    from imuwb.readers.receivers.nmea_sentences import Sentences  # noqa: PLC0415
    from imuwb.readers.receivers.ubx_frames import AROUND, gaps, scan  # noqa: PLC0415

    frames, sentences = scan(np.frombuffer(head, np.uint8), last=True), Sentences()
    if int((frames.length + AROUND).sum()) >= LEAST * len(head):
        return True
    if not np.isin(frames.kind >> 8, POSITIONED).any():
        return False
    for begin, end in gaps(frames):
        sentences.take(head[begin:end], begin, last=True)
    return len(head) - sentences.other >= LEAST * len(head)


def stream(path: Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the streams; the whole file is read first, for its clock.

    Raises:
        UnreadableLogError: the file has no frame that imuwb uses.
    """
    from imuwb.readers.receivers.ubx_streams import streamed  # noqa: PLC0415 - a probe needs no streams

    return streamed(path, options)
