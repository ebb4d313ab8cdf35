"""The cells of a text log as columns of numbers, block by block; cells that are not numbers are counted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import csv

from imuwb.arrays import Booleans, Floats
from imuwb.notes import Note
from imuwb.readers.bytes.memory_limit import check_room
from imuwb.readers.text import lines
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.trust import is_number
from imuwb.units import unix_nanoseconds

BLOCK = 4 << 20
ROOM = 16 * BLOCK  #: bytes that the parser takes at least; without them it ends the process
LINES = Note("cell_count", "lines without the usual number of cells left out")
CHECKSUM = Note("checksum", "lines with a wrong checksum left out")
CELLS = Note("not_a_number", "cells that are not numbers are taken as missing")


def blocks(
    path: Path,
    layout: Layout,
    kinds: Mapping[int, pa.DataType],
    faults: Counter[str],
    span: lines.Span | None = None,
) -> Iterator[tuple[pa.RecordBatch, int]]:
    """Yield the columns of ``kinds``, {index: type}, in blocks, each with the bytes read; ``of`` returns a column of a block.

    With a ``span`` only its rows are read. The parser stops at a cell that is not a number. From there on cells are read as text: this is slower, but
    finds and counts such cells.
    """
    named = {_key(index): kind for index, kind in kinds.items()}
    names = [_key(i) for i in range(len(layout.first))]
    rows = 0
    try:
        for block, bytes_read in _parsed(partial(lines.Rows, path, layout, span), layout, names, named, faults):
            yield block, bytes_read
            rows += block.num_rows
    except (pa.ArrowInvalid, ValueError):
        faults.clear()
        yield from _read_as_text(partial(lines.Rows, path, layout, span), layout, names, named, faults, rows)


def _key(index: int) -> str:
    """Return the name of a column for the parser; the names in a file may be equal."""
    return str(index)


def of(block: pa.RecordBatch, index: int) -> pa.Array[Any]:
    """Return the cells of a column of a block."""
    return block.column(_key(index))


def _read_as_text(
    opened: Callable[[], lines.Rows],
    layout: Layout,
    names: list[str],
    kinds: Mapping[str, pa.DataType],
    faults: Counter[str],
    skip: int,
) -> Iterator[tuple[pa.RecordBatch, int]]:
    """Yield the columns after the first ``skip`` rows, each cell read as text first."""
    as_text = dict.fromkeys(kinds, pa.binary())
    for block, bytes_read in _parsed(opened, layout, names, as_text, faults):
        rest = block.slice(min(skip, block.num_rows))
        skip -= block.num_rows - rest.num_rows
        if rest.num_rows:
            columns = [converted(rest.column(name), kind, faults) for name, kind in kinds.items()]
            yield pa.RecordBatch.from_arrays(columns, names=list(kinds)), bytes_read


def _parsed(
    opened: Callable[[], lines.Rows],
    layout: Layout,
    names: list[str],
    kinds: Mapping[str, pa.DataType],
    faults: Counter[str],
) -> Iterator[tuple[pa.RecordBatch, int]]:
    def skip(row: object) -> str:
        faults[LINES] += 1
        return "skip"

    with opened() as rows:
        try:
            if rows.is_empty():
                return
            check_room(ROOM)
            reader = csv.open_csv(
                pa.PythonFile(rows, "r"),
                csv.ReadOptions(column_names=names, block_size=BLOCK),
                csv.ParseOptions(delimiter=layout.parsed_delimiter, invalid_row_handler=skip),
                csv.ConvertOptions(
                    column_types=dict(kinds), include_columns=list(kinds), strings_can_be_null=True,
                    timestamp_parsers=[csv.ISO8601],
                ),
            )  # fmt: skip
            # The parser reads ahead by many blocks, so the position in the file exceeds what the blocks so far hold.
            for count, block in enumerate(reader, 1):
                yield block, min(rows.bytes_read, count * BLOCK)
        finally:
            for fault in rows.faults:
                faults[fault] = max(faults[fault], 1)
            if rows.unsound:
                faults[CHECKSUM] = rows.unsound


def converted(cells: pa.Array[Any], kind: pa.DataType, faults: Counter[str]) -> pa.Array[Any]:
    """Return cells of bytes as numbers or times; null for cells that are neither."""
    if pa.types.is_binary(kind):
        return cells
    try:
        return cells.cast(pa.string()).cast(kind)
    except pa.ArrowInvalid:
        pass
    found, instants = texts(cells), pa.types.is_timestamp(kind)
    numbers = [(_instant(text) if instants else text if is_number(text) else None) if text else None for text in found]
    faults[CELLS] += sum(bool(text) and number is None for text, number in zip(found, numbers, strict=True))
    if instants:
        return pa.array(numbers, pa.int64()).cast(kind)
    try:
        return pa.array(numbers, pa.string()).cast(kind)
    except pa.ArrowInvalid:  # the cell has more digits than a decimal can hold
        return pa.array([None if text is None else float(text) for text in numbers], pa.float64())


def _instant(text: str) -> int | None:
    """Return an ISO date in ns since 1970 UTC; None for another text."""
    try:
        nanoseconds = unix_nanoseconds(datetime.fromisoformat(text))
    except (ValueError, OverflowError):
        return None
    return nanoseconds if abs(nanoseconds) < 2**63 else None


# Arrays are made from pyarrow's buffers: its own conversions import pandas, which takes a second.


def known(cells: pa.Array[Any]) -> Booleans:
    """Return which cells are not null."""
    bits = cells.buffers()[0]
    if bits is None:
        return np.ones(len(cells), dtype=bool)
    flags = np.unpackbits(np.frombuffer(bits, np.uint8), bitorder="little")
    return flags[cells.offset : cells.offset + len(cells)].astype(bool)


def memory(cells: pa.Array[Any], kind: str, count: int = 1) -> NDArray[Any]:
    """Return the memory of cells as numbers of a numpy kind, (n, count); undefined for null."""
    table = np.frombuffer(cells.buffers()[1], kind).reshape(-1, count)
    return table[cells.offset : cells.offset + len(cells)]


def texts(cells: pa.Array[Any]) -> list[str]:
    """Return cells of bytes as texts without blanks and quotes around them; an empty text for null."""
    return ["" if cell is None else cell.decode("utf-8", "replace").strip().strip('"') for cell in cells.to_pylist()]


def floats(cells: pa.Array[Any]) -> Floats:
    """Return cells of double precision; nan for null."""
    numbers = memory(cells, "<f8")[:, 0]
    return np.where(known(cells), numbers, np.nan) if cells.null_count else numbers
