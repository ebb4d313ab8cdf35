"""PX4's logs (.ulg): IMUs, their raw samples if they were logged, receivers, and the navigation solution."""

import struct
from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.read_options import ReadOptions

format = "ulog"  # noqa: A001 - the contract's name
uses: tuple[str, ...] = ()
HEADER, PREFIX = 16, 3  #: bytes of the file's header, and of a message's size and type
INFORMATION = ord("I")
MAGIC = b"ULog\x01\x12\x35"


def probe(head: bytes) -> bool:
    """Return whether the file begins with ULog's magic."""
    return head.startswith(MAGIC)


def stated(path: Path) -> dict[str, str]:
    """Return the information messages at the beginning of a file, {name: text}; numbers are left out."""
    head, at, known = source.head(path), HEADER, dict[str, str]()
    while at + PREFIX < len(head):
        size, kind = struct.unpack_from("<HB", head, at)
        content = head[at + PREFIX : at + PREFIX + size]
        at += PREFIX + size
        if kind == INFORMATION and content:
            declared, _, name = content[1 : 1 + content[0]].decode("utf-8", "replace").partition(" ")
            if declared.startswith("char["):
                known[name] = content[1 + content[0] :].decode("utf-8", "replace")
    return known


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the streams; the file is mapped into memory.

    Raises:
        UnreadableLogError: the file has no whole message of data.
    """
    from imuwb.readers.flight.ulog_streams import streamed  # noqa: PLC0415 - a probe needs no decoder

    return streamed(path)
