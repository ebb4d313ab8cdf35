"""The arrays of an HDF5 file as a tree; those that MATLAB wrote are turned, because MATLAB stores columns first."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import budget
from imuwb.readers.bytes.memory_limit import limited
from imuwb.texts import printable

if TYPE_CHECKING:  # the tables need pyarrow, which is slow to import
    from imuwb.readers.tables.named_arrays import Tree

DEEPEST = 16  #: groups within each other
MOST = 4096  #: groups and arrays that are looked at
PACKED = 1000  #: largest ratio of the numbers of a packed array to its bytes in the file
UNITS = ("unit", "units", "Unit", "Units")  #: attributes that state the unit of an array


def tree_of(path: Path, objects: list[str], *, matlab: bool = False) -> Tree:
    """Return the arrays of numbers in a file by name, groups as trees; names of other contents are added to ``objects``.

    Raises:
        UnreadableLogError: h5py is not installed. Other errors are those of h5py at damaged bytes.
    """
    try:
        import h5py  # noqa: PLC0415 - MATLAB's version 5 needs scipy alone
    except ImportError as error:
        raise UnreadableLogError(
            f"{path}: an HDF5 file, such as those of MATLAB 7.3, needs h5py: pip install h5py; or save it in MATLAB with -v7"
        ) from error
    size, held = path.stat().st_size, 0
    looked = iter(range(MOST))  # a group may hold itself

    def walked(group: Any, prefix: str, depth: int) -> Iterator[tuple[str, object]]:  # noqa: ANN401 - of a library without types
        nonlocal held
        for name in group:
            if matlab and name.startswith("#"):
                continue  # where references and objects point to
            if next(looked, None) is None:
                raise ValueError(f"it has more than {MOST} groups and arrays")
            shown, elsewhere = f"{prefix}{name}", isinstance(group.get(name, getlink=True), h5py.ExternalLink)
            item: Any = None if elsewhere else group.get(name)  # no other file is opened
            if isinstance(item, h5py.Group):
                if depth < DEEPEST:
                    yield printable(name), dict(walked(item, f"{shown}.", depth + 1))
            elif not isinstance(item, h5py.Dataset) or not _is_read(item, size):
                objects.append(shown)
            elif "MATLAB_empty" not in item.attrs:
                held += item.size * item.dtype.itemsize
                budget.check(held, "its unpacked arrays")
                array = np.asarray(item[()])
                yield printable(_named(name, item)), array.T if matlab else array

    with limited(), h5py.File(path, "r") as file:
        return dict(walked(file, "", 0))


def _is_read(item: Any, size: int) -> bool:  # noqa: ANN401 - of a library without types
    """Return whether a data set holds numbers, in this file, and not more than the file can have."""
    if item.is_virtual or item.external:
        return False
    most = size * (PACKED if item.compression or item.chunks else 1)
    numbers = item.dtype.kind in "fiub" or (item.dtype.names is not None and item.ndim == 1)
    return numbers and "MATLAB_object_decode" not in item.attrs and item.size * item.dtype.itemsize <= most


def _named(name: str, item: Any) -> str:  # noqa: ANN401 - of a library without types
    """Return the name of a data set with the unit that its attributes state."""
    stated = next((item.attrs[key] for key in UNITS if key in item.attrs), None)
    if isinstance(stated, bytes):
        stated = stated.decode("utf-8", "replace")
    return f"{name} [{stated}]" if isinstance(stated, str) and stated and "[" not in name else name
