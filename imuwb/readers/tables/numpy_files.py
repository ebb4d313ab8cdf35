"""Arrays of NumPy's files by name, mapped into memory where they are not packed, and never as a pickle."""

import struct
import tokenize
import warnings
import zipfile
import zlib
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import budget
from imuwb.readers.tables.named_arrays import Tree
from imuwb.readers.tables.packed import refuse_packed

#: what NumPy and zipfile raise at damaged bytes
FAULTS = (
    SyntaxWarning, DeprecationWarning,
    ValueError, TypeError, KeyError, IndexError, OverflowError, OSError, EOFError, MemoryError, SyntaxError, NotImplementedError, RuntimeError,
    RecursionError, tokenize.TokenError, zlib.error, zipfile.BadZipFile, struct.error,
)  # fmt: skip
HEADER = 65_536  #: bytes; a longer header is damage
_READERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def arrays(path: Path) -> Tree:
    """Return the arrays of a file: those of an archive by their names, a single one as ``array``.

    Raises:
        UnreadableLogError: an array is damaged, or holds Python objects.
    """
    refuse_packed(path)
    try:
        if zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as archive:
                budget.check(sum(info.file_size for info in archive.infolist()), "its unpacked arrays")
                return {info.filename.removesuffix(".npy"): _read(archive, info) for info in archive.infolist()}
        return {"array": array_of(path)}
    except FAULTS as error:
        raise _refused(path, error) from error


def array_of(path: Path) -> NDArray[Any]:
    """Return the array of a file, mapped into memory.

    Raises:
        UnreadableLogError: as in ``arrays``.
    """
    refuse_packed(path)
    try:
        with path.open("rb") as file:
            _check(file, path.stat().st_size)
        array: NDArray[Any] = np.load(path, mmap_mode="r", allow_pickle=False)
    except FAULTS as error:
        raise _refused(path, error) from error
    return array


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> NDArray[Any]:
    with archive.open(info) as file:
        _check(file, info.file_size)
    with archive.open(info) as file:
        return npy.read_array(file, allow_pickle=False, max_header_size=HEADER)


def _check(file: IO[bytes], size: int) -> None:
    """Raise ValueError if the header states Python objects, or more numbers than the file has bytes for."""
    version = npy.read_magic(file)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # odd literals are damage
        shape, _, kind = _READERS[min(version, (2, 0))](file, max_header_size=HEADER)
    if kind.hasobject:
        raise ValueError("the array holds Python objects, which only a pickle can store; save numbers")
    count = 1
    for length in shape:
        count *= length
    if not kind.itemsize or count * kind.itemsize > size:
        raise ValueError(f"its header states {count} numbers, more than the file has")


def _refused(path: Path, error: BaseException) -> UnreadableLogError:
    told = (str(error).splitlines() or [type(error).__name__])[0][:160]
    return UnreadableLogError(f"{path}: the array cannot be read: {told}")
