"""Checks by first and last bytes whether a recording is complete: the library that writes it reports no errors of the disk."""

import os
from pathlib import Path

MAGIC = b"RRF2"
END = b"RRF2FOOT"  #: mark near the end of the file; only a number of 32 bits follows it
BLOCK = 1 << 16  #: bytes; a full disk has no room for this number of bytes


def is_whole(path: str | Path) -> bool:
    """Return whether a recording begins with its mark and ends with its footer's mark."""
    with Path(path).open("rb") as file:
        begins = file.read(len(MAGIC)) == MAGIC
        file.seek(0, os.SEEK_END)
        file.seek(max(file.tell() - len(END) - 4, 0))
        return begins and file.read(len(END)) == END


def why_cut(path: str | Path) -> str:
    """Return why a file was not written to its end: try to write more bytes, and return the error of this attempt."""
    try:
        with Path(path).open("ab") as file:
            file.write(bytes(BLOCK))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        return error.strerror or str(error)
    return "only a part was written"
