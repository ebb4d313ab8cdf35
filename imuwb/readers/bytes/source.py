"""Opens a file and looks at its first bytes; unpacks gzip on the way."""

from __future__ import annotations

import gzip
import hashlib
import zlib
from typing import TYPE_CHECKING, BinaryIO, cast

from isal import isal_zlib

from imuwb.errors import UnreadableLogError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from io import BufferedReader
    from pathlib import Path

HEAD = 1 << 16
PIECE = 1 << 16
BLOCK = 8 << 20  #: bytes read at a time, of a file of records
_UNPACKING = cast("type[Exception]", isal_zlib.error)  # the library's types call it a value
GZIP_WINDOW = 31  #: bits: the largest, behind gzip's own header
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
        if not path.is_file():
            message = f"{path}: a device or a pipe, not a file; a log is read more than once"
            raise UnreadableLogError(message)
        if path.stat().st_size == 0:
            message = f"{path}: the file is empty"
            raise UnreadableLogError(message)
    except OSError as error:
        message = f"{path}: cannot be opened: {error.strerror}"
        raise UnreadableLogError(message) from error


class _Unpacked(gzip.GzipFile):
    """A gzip file that closes the file below it, and knows how far in that it is."""

    def __init__(self, packed: BinaryIO) -> None:
        super().__init__(fileobj=packed)
        self.packed = packed

    def close(self) -> None:
        super().close()
        self.packed.close()


def open_unpacked(path: Path) -> BinaryIO:
    """Open a file for reading; a gzip file as what it holds."""
    try:
        file = path.open("rb")
    except OSError as error:
        message = f"{path}: cannot be opened: {error.strerror}"
        raise UnreadableLogError(message) from error
    magic = file.read(2)
    file.seek(0)
    return cast("BinaryIO", _Unpacked(file)) if magic == GZIP_MAGIC else file


def packed_fault(path: Path) -> str:
    """Return why what a gzip file unpacks to may be wrong; nothing where its checksum holds, or the file is only cut.

    A damaged stream goes on unpacking to something: what it holds is text or numbers like the rest, until they are none.
    """
    with path.open("rb") as file:
        piece = file.read(PIECE)
        while piece.startswith(GZIP_MAGIC):  # one packed file behind the other is one file
            unpacker = isal_zlib.decompressobj(GZIP_WINDOW)
            while piece and not unpacker.eof:
                try:
                    unpacker.decompress(piece)
                except _UNPACKING as error:
                    return str(error)
                piece = unpacker.unused_data or file.read(PIECE)
    return ""


def is_packed(file: BinaryIO) -> bool:
    """Return whether the file is unpacked as it is read."""
    return isinstance(file, _Unpacked)


def position(file: BinaryIO) -> int:
    """Return how many of the file's bytes on the disk are read."""
    return file.packed.tell() if isinstance(file, _Unpacked) else file.tell()


def pieces(file: BinaryIO, trouble: list[str]) -> Iterator[bytes]:
    """Yield what a file holds in small pieces; a gzip file that is cut, as far as it unpacks.

    What is wrong with it is added to ``trouble``.
    """
    try:
        while piece := cast("BufferedReader", file).read1(PIECE):
            yield piece
    except gzip.BadGzipFile as error:
        if "Not a gzipped file" in str(error):
            trouble.append("there are bytes behind the end of the packed file: all before is used")
        else:
            trouble.append(
                f"the packed file is damaged ({error}): what unpacks is used, and some of it is not what was written"
            )
    except (OSError, EOFError, zlib.error) as error:
        trouble.append(f"the packed file is cut or damaged ({error}): what unpacks is used")


def blocks(file: BinaryIO, trouble: list[str]) -> Iterator[tuple[bytes, bool]]:
    """Yield what a file holds, unpacked, in blocks, and whether one is the last, which may be empty."""
    block = bytearray()
    for piece in pieces(file, trouble):
        block += piece
        if len(block) >= BLOCK:
            yield bytes(block), False
            block.clear()
    yield bytes(block), True


def extended(file: BinaryIO, rest: bytes, whole: int, left: int) -> bytes | None:
    """Return ``rest`` and the next block of a file, which holds at least one whole record; None at its end.

    Args:
        file: stands behind ``rest``.
        rest: the beginning of a record that was not whole.
        whole: size of that record, as far as it is known. One that no file can hold is damage: the walk stops at it.
        left: bytes from the beginning of ``rest`` to the end of the file.
    """
    more = file.read(min(max(BLOCK, whole - len(rest)), left))
    return rest + more if more else None


def head(path: Path) -> bytes:
    """Return the first 64 KiB, unpacked; what there is of a gzip file that is cut."""
    found = b""
    with open_unpacked(path) as file:
        for piece in pieces(file, []):  # the reader meets the same trouble, and says so
            found += piece
            if len(found) >= HEAD:
                break
    return found[:HEAD]


def fingerprint(path: Path) -> str:
    """Return ``sha256:...`` of the file's bytes, as they are on the disk."""
    with path.open("rb") as file:
        return f"sha256:{hashlib.file_digest(file, 'sha256').hexdigest()}"
