"""Binary logs of NovAtel receivers (OEM4 to OEM7), read by novatel-edie, which is an extra; their ASCII logs are text."""

import zlib
from collections.abc import Iterator

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes.source import Source
from imuwb.readers.read_options import ReadOptions

format = "novatel"  # noqa: A001 - the contract's name
uses = ("units", "frame", "epoch")
ranged = True
LONG, SHORT = b"\xaa\x44\x12", b"\xaa\x44\x13"
SHORT_HEADER, CHECK = 12, 4  #: bytes of the short header, and of the checksum
SEARCHED = 8192  #: bytes; a log may begin within a message, or with an answer of the receiver
ALL_ONES = 0xFFFF_FFFF


def probe(head: bytes) -> bool:
    """Return whether a binary message with a correct checksum is near the beginning."""
    at = -1
    while 0 <= (at := head.find(b"\xaa\x44", at + 1)) < SEARCHED:
        if head[at : at + 3] in (LONG, SHORT) and _holds(head, at):
            return True
    return False


def _holds(head: bytes, at: int) -> bool:
    """Return whether the checksum of a message is correct: the polynomial of zip, begun with 0 and not inverted at the end."""
    part = head[at : at + SHORT_HEADER]
    if len(part) < SHORT_HEADER:
        return False
    size = part[3] + int.from_bytes(part[8:10], "little") if part.startswith(LONG) else SHORT_HEADER + part[3]
    whole = head[at : at + size]
    check = int.from_bytes(head[at + size : at + size + CHECK], "little")
    return len(head) >= at + size + CHECK and zlib.crc32(whole, ALL_ONES) ^ ALL_ONES == check


def stream(path: Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the streams of its messages.

    Raises:
        UnreadableLogError: novatel-edie is not installed, or no message can be used.
        UsageError: the scale of an IMU is unknown.
    """
    from imuwb.readers.receivers.novatel_messages import streamed  # noqa: PLC0415 - a probe needs no novatel-edie

    return streamed(path, options)
