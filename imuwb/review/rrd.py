"""Whether a recording's file is whole, by its first and last bytes: the library that writes it tells no error of the disk."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

MAGIC = b"RRF2"
END = b"RRF2FOOT"  #: of the footer, a number of 32 bits before the file's end
BLOCK = 1 << 16  #: bytes; what a full disk has no room for


def is_whole(path: Path) -> bool:
    """Return whether a recording begins with its mark and ends with that of its footer."""
    with path.open("rb") as file:
        begins = file.read(len(MAGIC)) == MAGIC
        file.seek(0, os.SEEK_END)
        file.seek(max(file.tell() - len(END) - 4, 0))
        return begins and file.read(len(END)) == END


def why_cut(path: Path) -> str:
    """Return why a file could not be written to its end: what keeps the next bytes out has kept the others out."""
    try:
        with path.open("ab") as file:
            file.write(bytes(BLOCK))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        return error.strerror or str(error)
    return "only a part of it was"
