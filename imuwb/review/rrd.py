"""Whether a recording's file is complete, by its first and last bytes: the library that writes it reports no error of the disk."""

from __future__ import annotations

import os
from pathlib import Path

MAGIC = b"RRF2"
END = b"RRF2FOOT"  #: begins the footer; a number of 32 bits follows it, then the file ends
BLOCK = 1 << 16  #: bytes; a full disk has no room for so many


def is_whole(path: str | Path) -> bool:
    """Return whether a recording begins with its mark and ends with its footer's mark."""
    with Path(path).open("rb") as file:
        begins = file.read(len(MAGIC)) == MAGIC
        file.seek(0, os.SEEK_END)
        file.seek(max(file.tell() - len(END) - 4, 0))
        return begins and file.read(len(END)) == END


def why_cut(path: str | Path) -> str:
    """Return why a file was not written to its end: the cause also prevents the next bytes from being written."""
    try:
        with Path(path).open("ab") as file:
            file.write(bytes(BLOCK))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        return error.strerror or str(error)
    return "only a part was written"
