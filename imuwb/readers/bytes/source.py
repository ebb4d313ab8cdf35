"""Opens a file or a remote log, unpacks gzip and Zstandard, reads the first bytes and blocks, and computes the fingerprint."""

import gzip
import hashlib
import zlib
from collections.abc import Generator, Iterable, Iterator
from contextlib import contextmanager, nullcontext
from io import BufferedReader
from pathlib import Path
from typing import BinaryIO, TypeAlias, cast

from isal import isal_zlib

from imuwb.errors import UnreadableLogError
from imuwb.notes import Note
from imuwb.readers.bytes import budget
from imuwb.readers.bytes.address import Place, place_of
from imuwb.readers.bytes.remote import RemoteLog, is_web_page
from imuwb.renames import settle
from imuwb.sidecars import ends_hash

Source: TypeAlias = Path | RemoteLog  #: what a log is read from

HEAD = 1 << 16  #: bytes from which a format is recognised
PIECE = 1 << 16  #: bytes read at a time from a packed file
BLOCK = 8 << 20  #: bytes read at a time from a file of records
_UNPACKING = cast("type[Exception]", isal_zlib.error)  # the library's type hints say that it is a value
GZIP_WINDOW = 31  #: bits: the largest window, after gzip's own header
GZIP_MAGIC = b"\x1f\x8b"
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"


@contextmanager
def accessed(place: str | Place | RemoteLog) -> Generator[Source]:
    """Yield what a log is read from: a file, or a remote log, which is closed afterwards; an open one stays open.

    Raises:
        UnreadableLogError: the remote log cannot be read.
        UsageError: an address that is not read.
    """
    if isinstance(place, RemoteLog):
        yield place
    elif isinstance(found := place_of(place), Path):
        settle(found)
        yield found
    else:
        with RemoteLog(found) as log:
            yield log


@contextmanager
def named(path: Source) -> Generator[None]:
    """Name the address of a remote log in errors, and not its copy."""
    with path.named() if isinstance(path, RemoteLog) else nullcontext():
        yield


def check(path: str | Source) -> None:
    """Raise UnreadableLogError unless ``path`` is a log that is not empty."""
    if isinstance(path, RemoteLog):
        if not path.size:
            raise UnreadableLogError(f"{path}: the object is empty")
        if is_web_page(path.part(0, HEAD)):
            raise UnreadableLogError(
                f"{path}: its host sends a web page and no log; check the address, and whether it needs a login"
            )
        return
    path = Path(path)
    try:
        if path.is_dir():
            raise UnreadableLogError(f"{path}: this is a directory, not a log; name a file in it")
        if not path.exists():
            raise UnreadableLogError(f"{path}: there is no such file")
        if not path.is_file():
            raise UnreadableLogError(
                f"{path}: this is a device or a pipe; a log is read more than once, so write it to a file first"
            )
        if not path.stat().st_size:
            raise UnreadableLogError(f"{path}: the file is empty")
    except OSError as error:
        raise UnreadableLogError(f"{path}: the file cannot be opened: {error.strerror}") from error


class _Unpacked(gzip.GzipFile):
    """A gzip file that closes the packed file too, and knows the position in it."""

    def __init__(self, packed: BinaryIO) -> None:
        super().__init__(fileobj=packed)
        self.packed = packed

    def close(self) -> None:
        super().close()
        self.packed.close()


def opened(path: Source) -> BinaryIO:
    """Open a log for reading; the bytes of a remote log come as they are read.

    Raises:
        UnreadableLogError: the file cannot be opened.
    """
    if isinstance(path, RemoteLog):
        return path.open()
    try:
        return path.open("rb")
    except OSError as error:
        raise UnreadableLogError(f"{path}: the file cannot be opened: {error.strerror}") from error


def open_unpacked(path: Source) -> BinaryIO:
    """Open a log for reading; a log in gzip or Zstandard is unpacked as it is read. Errors as in ``opened``."""
    file = opened(path)
    magic = file.read(4)
    file.seek(0)
    if magic == ZSTD_MAGIC:
        from imuwb.readers.bytes.zstd_file import ZstdFile  # noqa: PLC0415 - few files need the library

        return cast("BinaryIO", ZstdFile(file))
    return cast("BinaryIO", _Unpacked(file)) if magic.startswith(GZIP_MAGIC) else file


def packed_fault(path: Path) -> str:
    """Return why the unpacked content of a gzip file may be wrong; empty if its checksum is correct or the file is only cut.

    A damaged stream still unpacks to something. At first its numbers look like the others; later they do not.
    """
    with path.open("rb") as file:
        piece = file.read(PIECE)
        while piece.startswith(GZIP_MAGIC):  # several packed files in a row are one file
            unpacker = isal_zlib.decompressobj(GZIP_WINDOW)
            while piece and not unpacker.eof:
                try:
                    unpacker.decompress(piece)
                except _UNPACKING as error:
                    return str(error)
                piece = unpacker.unused_data or file.read(PIECE)
    return ""


def damaged(fault: str, text: str) -> Note:
    """Return a note on a packed file whose content may be wrong."""
    return Note("packed_damaged", f"the packed file is damaged ({fault}): {text}")


def is_packed(file: BinaryIO) -> bool:
    """Return whether the file is unpacked as it is read."""
    return hasattr(file, "packed")


def position(file: BinaryIO) -> int:
    """Return how many bytes of the file on disk are read."""
    return cast("_Unpacked", file).packed.tell() if is_packed(file) else file.tell()


def pieces(file: BinaryIO, faults: list[str]) -> Iterator[bytes]:
    """Yield a file in small pieces; a packed file that is cut is unpacked as far as possible.

    Notes on what is wrong with the file are added to ``faults``.
    """
    try:
        while piece := cast("BufferedReader", file).read1(PIECE):
            yield piece
    except gzip.BadGzipFile as error:
        if "Not a gzipped file" in str(error):
            faults.append(Note("packed_more", "bytes after the end of the packed file are not used"))
        else:
            faults.append(damaged(str(error), "the part that can be unpacked is used, but some of it may be wrong"))
    except (OSError, EOFError, zlib.error) as error:
        text = f"the packed file is cut or damaged ({error}): the part that can be unpacked is used"
        faults.append(Note("packed_cut", text))


def whole(file: BinaryIO, faults: list[str]) -> bytes:
    """Return the whole unpacked content of a file; faults as in ``pieces``.

    Raises:
        OverBudgetError: it takes more memory than the log may.
    """
    content = bytearray()
    for piece in pieces(file, faults):
        content += piece
        budget.check(len(content), "its unpacked content")
    return bytes(content)


def lines(pieces: Iterable[bytes]) -> Iterator[tuple[bytes, bool]]:
    """Yield a text in blocks that end with a line's end, each with whether it is the last, which may lack the end or be empty.

    A line that is longer than its piece is put together once, not again with each further piece.

    Raises:
        UnreadableLogError: a line is longer than any of a log.
    """
    parts, size = list[bytes](), 0
    for piece in pieces:
        cut = piece.rfind(b"\n") + 1
        if cut:
            yield b"".join((*parts, piece[:cut])), False
            parts, size = [], 0
        parts.append(piece[cut:])
        size += len(piece) - cut
        budget.check_line(size)
    yield b"".join(parts), True


def blocks(file: BinaryIO, faults: list[str]) -> Iterator[tuple[bytes, bool]]:
    """Yield an unpacked file in blocks, each with whether it is the last block; the last block may be empty."""
    block = bytearray()
    for piece in pieces(file, faults):
        block += piece
        if len(block) >= BLOCK:
            yield bytes(block), False
            block.clear()
    yield bytes(block), True


def extended(file: BinaryIO, rest: bytes, whole: int, left: int) -> bytes | None:
    """Return ``rest`` and the next bytes of a file, which together have at least one whole record; None at the file's end.

    Args:
        file: its position is after ``rest``.
        rest: the beginning of an incomplete record.
        whole: size of that record, as far as it is known. A size beyond the file's end is damage: reading ends there.
        left: bytes from the beginning of ``rest`` to the end of the file.
    """
    more = file.read(min(max(BLOCK, whole - len(rest)), left))
    return rest + more if more else None


def head(path: Source) -> bytes:
    """Return the first 64 KiB, unpacked; a gzip file that is cut may give less."""
    first = b""
    with open_unpacked(path) as file:
        for piece in pieces(file, []):  # the reader meets the same faults, and notes them
            first += piece
            if len(first) >= HEAD:
                break
    return first[:HEAD]


def size(path: Source) -> int:
    """Return the bytes of a log, or of all files in a folder."""
    return path.size if isinstance(path, RemoteLog) else sum(file.stat().st_size for file in _files(path))


def fingerprint(path: Source) -> str:
    """Return ``sha256:...`` of a log's stored bytes; of a folder, of the names and the hashes of its files.

    Of a remote log it is that of the bytes that were read; it is empty if only parts of them were.
    """
    if isinstance(path, RemoteLog):
        return path.fingerprint()
    if not path.is_dir():
        return f"sha256:{_digest(path)}"
    lines = "".join(f"{_digest(file)} {file.relative_to(path).as_posix()}\n" for file in _files(path))
    return f"sha256:{hashlib.sha256(lines.encode('utf-8', 'surrogateescape')).hexdigest()}"


def ends_fingerprint(path: Source) -> str:
    """Return ``sha256-ends:...`` of a log's size and of its first and last MiB: its identity without the cost of reading it."""
    if isinstance(path, Path) and path.is_dir():
        return fingerprint(path)
    with opened(path) as file:
        return ends_hash(file, size(path))


def _files(path: Path) -> list[Path]:
    """Return a file, or the files in a folder in the order of their names."""
    return sorted(file for file in path.rglob("*") if file.is_file()) if path.is_dir() else [path]


def _digest(file: Path) -> str:
    with file.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()
