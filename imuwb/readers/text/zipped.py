"""Zip files of text logs, such as the exports of phone apps: unpacked to a folder that is removed after reading."""

import lzma
import zipfile
import zlib
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import IO

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import budget
from imuwb.readers.text.sensor_files import MOST_FILES, SUFFIXES

MAGIC = b"PK\x03\x04"
LARGEST = 4 << 30  #: bytes of all unpacked files
#: what the unpacking of damaged bytes raises
FAULTS = (
    zipfile.BadZipFile, NotImplementedError, EOFError, OSError, ValueError, IndexError, RuntimeError, zlib.error, lzma.LZMAError,
)  # fmt: skip
_NAMES = (b".csv", b".txt", b".tsv")


def is_zip_of_text(head: bytes) -> bool:
    """Return whether a file begins like a zip file with a text file in its first 64 KiB."""
    return head.startswith(MAGIC) and any(name in head.lower() for name in _NAMES)


@contextmanager
def unpacked(path: Path) -> Generator[Path]:
    """Yield a folder with the text files of a zip file; it is removed afterwards.

    No file is written outside the folder, whatever its name in the zip file is.

    Raises:
        UnreadableLogError: the zip file is damaged, has a password, or is too large.
    """
    try:
        with zipfile.ZipFile(path) as archive, TemporaryDirectory(prefix="imuwb-") as folder:
            budget.check(sum(member.file_size for member in _texts(path, archive)), "its unpacked content")
            left = min(LARGEST, budget.current().most)
            for member in _texts(path, archive):
                if member.flag_bits & 1:
                    raise UnreadableLogError(f"{path}: {member.filename} has a password; unpack the zip file first")
                place = _place(Path(folder), member.filename)
                place.parent.mkdir(parents=True, exist_ok=True)
                with archive.open(member) as packed, place.open("wb") as file:
                    left -= _copied(path, packed, file, left)
            yield Path(folder)
    except FAULTS as error:
        raise UnreadableLogError(
            f"{path}: the zip file is damaged or packed in an unusual way ({error}); unpack it, and name the folder"
        ) from error


def _texts(path: Path, archive: zipfile.ZipFile) -> list[zipfile.ZipInfo]:
    """Return the text files of a zip file, apart from those that macOS adds."""
    files = [m for m in archive.infolist() if not m.is_dir() and m.filename.lower().endswith(SUFFIXES)]
    files = [m for m in files if not PurePosixPath(m.filename).parts[0].startswith("__MACOSX")]
    if not files:
        raise UnreadableLogError(f"{path}: the zip file has no text log; unpack it, and name a file in it")
    if len(files) > MOST_FILES:
        raise UnreadableLogError(
            f"{path}: the zip file has {len(files)} text files; unpack it, and name those of one log"
        )
    return files


def _place(folder: Path, name: str) -> Path:
    """Return where a file is written: in the folder, and under the folder of its name at most."""
    parts = [
        part
        for part in PurePosixPath(name.replace("\\", "/")).parts
        if part not in ("/", "..", ".") and ":" not in part
    ]
    return folder.joinpath(*parts[-2:])


def _copied(path: Path, packed: IO[bytes], file: IO[bytes], most: int) -> int:
    """Copy an unpacked file, and return its bytes."""
    size = 0
    while piece := packed.read(1 << 20):
        size += len(piece)
        if size > most:
            raise UnreadableLogError(
                f"{path}: unpacked, it has more than its own list of files states; unpack it, and name the folder"
            )
        file.write(piece)
    return size
