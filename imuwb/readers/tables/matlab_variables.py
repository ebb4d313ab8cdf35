"""The variables of a MATLAB file as a tree of arrays; objects, such as timetables, are named and not read."""

import warnings
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.readers.batch import Remark, unused
from imuwb.readers.bytes import source
from imuwb.readers.bytes.memory_limit import limited
from imuwb.readers.tables.hdf5_apart import check_apart
from imuwb.readers.tables.hdf5_arrays import tree_of
from imuwb.readers.tables.matlab_check import check_structure
from imuwb.readers.tables.named_arrays import Tree
from imuwb.readers.tables.packed import refuse_packed

HDF5 = b"MATLAB 7.3"
OBJECTS = (
    "objects, such as tables and timetables, which only MATLAB reads; save structures: S = table2struct(timetable2table(TT), "
    '"ToScalar", true)'
)
MOST = 64  #: structures of an array of them
DEEPEST = 16  #: structures within each other
#: what the libraries raise at damaged bytes
FAULTS = (
    ValueError, TypeError, KeyError, IndexError, OverflowError, OSError, EOFError, MemoryError, AttributeError, NotImplementedError,
    RuntimeError, AssertionError, ZeroDivisionError, UnboundLocalError, zlib.error,
)  # fmt: skip


def variables(path: Path) -> tuple[Tree, list[Remark]]:
    """Return the arrays of a file by name, structures as trees, and a remark on the objects.

    Raises:
        UnreadableLogError: the file is damaged, or packed.
    """
    head = source.head(path)
    refuse_packed(path)
    objects: list[str] = []
    if head.startswith(HDF5):
        check_apart(path, matlab=True)
    try:
        tree = tree_of(path, objects, matlab=True) if head.startswith(HDF5) else _of_version_5(path, objects)
    except FAULTS as error:
        told = (str(error).splitlines() or [type(error).__name__])[0][:120]
        raise UnreadableLogError(
            f"{path}: the MATLAB file cannot be read ({told}); it is cut or damaged: save it again"
        ) from error
    return tree, [unused(objects, OBJECTS)] if objects else []


def _of_version_5(path: Path, objects: list[str]) -> Tree:
    check_structure(path.read_bytes())
    from scipy.io import loadmat  # noqa: PLC0415 - version 7.3 needs h5py alone
    from scipy.io.matlab import MatlabFunction, MatlabOpaque, MatReadError  # noqa: PLC0415

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of names that are twice in the file, and of objects
        try:
            with limited():
                loaded: dict[Any, Any] = loadmat(path, simplify_cells=True, verify_compressed_data_integrity=True)
        except MatReadError as error:  # its base is Exception itself
            raise ValueError(str(error)) from error

    def plain(name: str, value: object, depth: int = 0) -> object:
        if isinstance(value, (MatlabOpaque, MatlabFunction)):
            objects.append(name)
            return None
        if isinstance(value, Mapping) and depth < DEEPEST:
            fields = cast("Mapping[str, object]", value)
            return {key: plain(f"{name}.{key}", field, depth + 1) for key, field in fields.items()}
        if isinstance(value, Sequence) and not isinstance(value, (str, bytes)) and depth < DEEPEST:
            return {f"{i + 1}": plain(f"{name}.{i + 1}", item, depth + 1) for i, item in enumerate(value[:MOST])}
        if isinstance(value, np.ndarray) and value.dtype.kind == "O" and value.size <= MOST and depth < DEEPEST:
            return {
                f"{i + 1}": plain(f"{name}.{i + 1}", item, depth + 1) for i, item in enumerate(value.ravel().tolist())
            }
        return value

    named = {str(key or "object"): value for key, value in loaded.items() if not str(key).startswith("__")}
    return cast("Tree", {key: plain(key, value) for key, value in named.items()})
