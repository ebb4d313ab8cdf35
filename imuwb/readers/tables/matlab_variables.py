"""The variables of a MATLAB file as a tree of arrays; objects, such as timetables, are named and not read."""

import warnings
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.readers.batch import Remark, unused
from imuwb.readers.bytes import source
from imuwb.readers.tables.named_arrays import Tree

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
    RuntimeError, AssertionError, ZeroDivisionError, zlib.error,
)  # fmt: skip


def variables(path: Path) -> tuple[Tree, list[Remark]]:
    """Return the arrays of a file by name, structures as trees, and a remark on the objects.

    Raises:
        UnreadableLogError: the file is damaged, or packed.
    """
    head = source.head(path)
    with source.open_unpacked(path) as file:
        if source.is_packed(file):
            raise UnreadableLogError(f"{path}: a packed MATLAB file is not read; unpack it with gzip -d")
    objects: list[str] = []
    try:
        tree = _of_hdf5(path, objects) if head.startswith(HDF5) else _of_version_5(path, objects)
    except FAULTS as error:
        told = (str(error).splitlines() or [type(error).__name__])[0][:120]
        raise UnreadableLogError(
            f"{path}: the MATLAB file cannot be read ({told}); it is cut or damaged: save it again"
        ) from error
    return tree, [unused(objects, OBJECTS)] if objects else []


def _of_version_5(path: Path, objects: list[str]) -> Tree:
    from scipy.io import loadmat  # noqa: PLC0415 - version 7.3 needs h5py alone
    from scipy.io.matlab import MatlabFunction, MatlabOpaque  # noqa: PLC0415

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of names that are twice in the file, and of objects
        loaded: dict[Any, Any] = loadmat(path, simplify_cells=True, verify_compressed_data_integrity=True)

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


def _of_hdf5(path: Path, objects: list[str]) -> Tree:
    try:
        import h5py  # noqa: PLC0415 - version 5 needs scipy alone
    except ImportError as error:
        raise UnreadableLogError(
            f"{path}: a MATLAB file of version 7.3 needs h5py: pip install h5py; or save it in MATLAB with -v7"
        ) from error

    def walked(group: Any, prefix: str, depth: int) -> Iterator[tuple[str, object]]:  # noqa: ANN401 - of a library without types
        for name in group:
            if name.startswith("#"):
                continue  # where references and objects point to
            item, shown = group[name], f"{prefix}{name}"
            if isinstance(item, h5py.Group):
                if depth < DEEPEST:
                    yield name, dict(walked(item, f"{shown}.", depth + 1))
            elif "MATLAB_object_decode" in item.attrs or item.dtype.kind not in "fiub":
                objects.append(shown)
            elif (
                "MATLAB_empty" not in item.attrs
                and item.dtype.names is None
                and item.size * item.dtype.itemsize <= _bytes(path, item)
            ):
                yield name, np.asarray(item[()]).T

    with h5py.File(path, "r") as file:
        return cast("Tree", dict(walked(file, "", 0)))


def _bytes(path: Path, item: Any) -> int:  # noqa: ANN401 - of a library without types
    """Return the most bytes that a data set may take: those of the file, or a thousand times as many if it is packed."""
    return path.stat().st_size * (1000 if item.compression or item.chunks else 1)
