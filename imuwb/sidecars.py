"""What the writer and the reader of a sidecar have in common: its place, and the mark of its table.

A table and its sidecar are two files, and one may be replaced without the other. The sidecar contains the mark of its table, so a reader
never takes it for that of another table.
"""

import hashlib
from pathlib import Path
from typing import BinaryIO

END = 1 << 20  #: bytes at each end of a file, for its hash
MARK = "table"  #: key of a sidecar: the mark of its table


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
