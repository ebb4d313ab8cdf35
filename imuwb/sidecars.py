"""What the writer and the reader of a sidecar have in common: how it names its table, and where it waits for its name.

A table and its sidecar are two files, and a process may be killed after it has renamed the first. The sidecar contains the mark of
its table, so a reader never takes it for that of another table. The finished sidecar of such a table is still in the draft of
the sidecar.
"""

import hashlib
import tomllib
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

END = 1 << 20  #: bytes at each end of a file, for its hash
MARK = "table"  #: key of a sidecar: the mark of its table


def draft_of(place: Path) -> Path:
    """Return the name that a file has until it is finished."""
    return place.with_name(f".{place.name}.partial")


def sidecar_beside(table: Path) -> Path:
    """Return the place of the sidecar that is written with a table."""
    return table.with_name(f"{table.name}.toml")


def mark_of(file: Path) -> str:
    """Return the mark of a table."""
    with file.open("rb") as content:
        return ends_hash(content, file.stat().st_size)


def ends_hash(file: BinaryIO, size: int) -> str:
    """Return ``sha256-ends:...`` of a file's size and of its first and last MiB: its identity without the cost of reading it."""
    first = file.read(END)
    file.seek(max(size - END, 0))
    return f"sha256-ends:{hashlib.sha256(b'%d ' % size + first + file.read(END)).hexdigest()}"


def waiting(table: Path) -> Path | None:
    """Return the finished sidecar of a table that still has the name of a draft; None: there is none."""
    draft = draft_of(sidecar_beside(table))
    with suppress(OSError, ValueError, RecursionError):  # what is not finished may be any bytes
        if tomllib.loads(draft.read_text("utf-8")).get(MARK) == mark_of(table):
            return draft
    return None
