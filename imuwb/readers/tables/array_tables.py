"""Arrays in memory, or mapped from a file, as the columns of a table; numbers without names as their rows."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from imuwb.arrays import Floats
from imuwb.readers.bytes import source
from imuwb.readers.tables.arrow_tables import ROWS, Pieces, Table


def array_table(columns: Mapping[str, NDArray[Any]]) -> Table:
    """Return the table of some columns, {name: (n,)}; a missing number is nan."""
    rows = min(column.size for column in columns.values())
    kinds = {name: _kind(column.dtype) for name, column in columns.items()}
    schema = pa.schema([pa.field(name, pa.from_numpy_dtype(kind)) for name, kind in kinds.items()])

    def pieces(names: list[str]) -> Pieces:
        for first in range(0, rows, ROWS):
            last = min(first + ROWS, rows)
            cells = [_cells(np.ascontiguousarray(columns[name][first:last], kinds[name])) for name in names]
            yield pa.RecordBatch.from_arrays(cells, names=names), 8 * len(columns) * first

    return Table(schema, rows, pieces)


def _kind(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """Return the type of a column's cells: in the machine's byte order, and none that arrow stores otherwise, or not at all."""
    if dtype.kind == "b":
        return np.dtype(np.uint8)
    if dtype.kind == "f" and dtype.itemsize not in (4, 8):
        return np.dtype(np.float64)
    return dtype.newbyteorder("=")


def _cells(column: NDArray[Any]) -> pa.Array[Any]:
    """Return the memory of a column as cells; ``pa.array`` would import pandas, which takes a second."""
    return pa.Array.from_buffers(pa.from_numpy_dtype(column.dtype), column.size, [None, pa.py_buffer(column)])


def doubles(path: Path, width: int) -> Floats:
    """Return the whole rows of a file of little-endian doubles, (n, width); a file that is not packed is mapped into memory."""
    with source.open_unpacked(path) as file:
        if source.is_packed(file):
            numbers = np.frombuffer(source.whole(file, []), np.uint8)
        else:
            numbers = np.memmap(path, np.uint8, "r")
    rows = numbers.size // (8 * width)
    return numbers[: 8 * width * rows].view("<f8").reshape(rows, width)
