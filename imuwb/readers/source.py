"""Opens a file and looks at its first bytes; unpacks gzip on the way."""

from __future__ import annotations

import gzip
import hashlib
import zlib
from typing import TYPE_CHECKING, BinaryIO, cast

from imuwb.errors import UnreadableLogError

if TYPE_CHECKING:
    from pathlib import Path

HEAD = 1 << 16
GZIP_MAGIC = b"\x1f\x8b"


def check(path: Path) -> None:
    """Raise UnreadableLogError unless ``path`` is a file with something in it."""
    try:
        if path.is_dir():
            message = f"{path}: a directory, not a log; name a file in it"
            raise UnreadableLogError(message)
        if not path.exists():
            message = f"{path}: no such file"
            raise UnreadableLogError(message)
        if path.is_file() and path.stat().st_size == 0:
            message = f"{path}: the file is empty"
            raise UnreadableLogError(message)
    except OSError as error:
        message = f"{path}: cannot be opened: {error.strerror}"
        raise UnreadableLogError(message) from error


def open_unpacked(path: Path) -> BinaryIO:
    """Open a file for reading; a gzip file as what it holds."""
    try:
        file = path.open("rb")
    except OSError as error:
        message = f"{path}: cannot be opened: {error.strerror}"
        raise UnreadableLogError(message) from error
    magic = file.read(2)
    file.seek(0)
    return cast("BinaryIO", gzip.GzipFile(fileobj=file)) if magic == GZIP_MAGIC else file


def head(path: Path) -> bytes:
    """Return the first 64 KiB, unpacked; what there is of a gzip file that is cut."""
    with open_unpacked(path) as file:
        pieces: list[bytes] = []
        try:
            while sum(map(len, pieces)) < HEAD and (piece := file.read(HEAD // 16)):
                pieces.append(piece)
        except (OSError, EOFError, zlib.error):
            pass  # the reader meets the same fault, and says where
        return b"".join(pieces)[:HEAD]


def fingerprint(path: Path) -> str:
    """Return ``sha256:...`` of the file's bytes, as they are on the disk."""
    with path.open("rb") as file:
        return f"sha256:{hashlib.file_digest(file, 'sha256').hexdigest()}"
