"""Arrays in memory, or mapped from a file, as the columns of a table; numbers without names as their rows."""

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
    native = {name: column.astype(column.dtype.newbyteorder("="), copy=False) for name, column in columns.items()}
    schema = pa.schema([pa.field(name, pa.from_numpy_dtype(column.dtype)) for name, column in native.items()])

    def pieces(names: list[str]) -> Pieces:
        for first in range(0, rows, ROWS):
            cells = [pa.array(np.ascontiguousarray(native[name][first : min(first + ROWS, rows)])) for name in names]
            yield pa.RecordBatch.from_arrays(cells, names=names), 8 * len(native) * first

    return Table(schema, rows, pieces)


def doubles(path: Path, width: int) -> Floats:
    """Return the whole rows of a file of little-endian doubles, (n, width); a file that is not packed is mapped into memory."""
    with source.open_unpacked(path) as file:
        if source.is_packed(file):
            numbers = np.frombuffer(b"".join(source.pieces(file, [])), np.uint8)
        else:
            numbers = np.memmap(path, np.uint8, "r")
    rows = numbers.size // (8 * width)
    return numbers[: 8 * width * rows].view("<f8").reshape(rows, width)
