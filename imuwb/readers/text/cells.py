"""The cells of a text log as columns of numbers, block by block; what is no number is counted."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import pyarrow as pa
from pyarrow import csv

from imuwb.log import SECOND
from imuwb.readers.text import lines
from imuwb.readers.text.trust import is_number

if TYPE_CHECKING:
    from collections import Counter
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from imuwb.readers.text.clock import Clock
    from imuwb.readers.text.column_names import Column
    from imuwb.readers.text.lines import Layout

BLOCK = 4 << 20
LINES = "lines without the usual number of cells left out"
CELLS = "cells that are no number, taken as missing"


def blocks(
    path: Path, layout: Layout, used: tuple[Column, ...], clock: Clock, bad: Counter[str]
) -> Iterator[tuple[pa.RecordBatch, int]]:
    """Yield the used columns in blocks; where a cell is no number, go on by a slower way that finds it."""
    kinds = {c.name: clock.kind if c.quantity == "time" else pa.float64() for c in used}
    names = [f"unused {i}" for i in range(len(layout.first))]
    for column in used:
        names[column.index] = column.name
    rows = 0
    try:
        for block, bytes_read in _parse(path, layout, names, kinds, bad):
            yield block, bytes_read
            rows += block.num_rows
    except (pa.ArrowInvalid, ValueError):
        bad.clear()
        texts = dict.fromkeys(kinds, pa.binary())
        for block, bytes_read in _parse(path, layout, names, texts, bad):
            fresh = block.slice(min(rows, block.num_rows))
            rows -= block.num_rows - fresh.num_rows
            if fresh.num_rows:
                cast_columns = [_numbers(fresh.column(name), kind, bad) for name, kind in kinds.items()]
                yield pa.RecordBatch.from_arrays(cast_columns, names=list(kinds)), bytes_read


def _parse(
    path: Path, layout: Layout, names: list[str], kinds: Mapping[str, pa.DataType], bad: Counter[str]
) -> Iterator[tuple[pa.RecordBatch, int]]:
    def skip(row: object) -> str:
        del row
        bad[LINES] += 1
        return "skip"

    with lines.Rows(path, layout) as rows:
        try:
            if rows.is_empty():
                return
            reader = csv.open_csv(
                pa.PythonFile(rows, "r"),
                csv.ReadOptions(column_names=names, block_size=BLOCK),
                csv.ParseOptions(
                    delimiter="," if layout.delimiter == " " else layout.delimiter, invalid_row_handler=skip
                ),
                csv.ConvertOptions(
                    column_types=dict(kinds), include_columns=list(kinds), strings_can_be_null=True,
                    timestamp_parsers=[csv.ISO8601],
                ),
            )  # fmt: skip
            for block in reader:
                yield block, rows.bytes_read
        finally:
            for trouble in rows.trouble:
                bad[trouble] = max(bad[trouble], 1)


def _numbers(cells: pa.Array[Any], kind: pa.DataType, bad: Counter[str]) -> pa.Array[Any]:
    """Return cells of bytes as numbers or times; those that are none as null."""
    try:
        return cells.cast(pa.string()).cast(kind)
    except pa.ArrowInvalid:
        pass
    texts = [None if cell is None else cell.decode("utf-8", "replace").strip().strip('"') for cell in cells.to_pylist()]
    if pa.types.is_timestamp(kind):
        times = [None if text is None else _instant(text) for text in texts]
        bad[CELLS] += sum(bool(text) and time is None for text, time in zip(texts, times, strict=True))
        return pa.array(times, pa.int64()).cast(kind)
    kept = [text if text and is_number(text) else None for text in texts]
    bad[CELLS] += sum(bool(text) and keep is None for text, keep in zip(texts, kept, strict=True))
    try:
        return pa.array(kept, pa.string()).cast(kind)
    except pa.ArrowInvalid:  # more digits than a decimal has room for
        return pa.array([None if text is None else float(text) for text in kept], pa.float64())


def _instant(text: str) -> int | None:
    """Return an ISO time in ns since 1970, UTC where it does not say; None when it is none."""
    try:
        when = datetime.fromisoformat(text)
        since = (when if when.tzinfo else when.replace(tzinfo=UTC)) - datetime(1970, 1, 1, tzinfo=UTC)
    except (ValueError, OverflowError):
        return None
    nanoseconds = (since.days * 86400 + since.seconds) * SECOND + since.microseconds * 1000
    return nanoseconds if abs(nanoseconds) < 2**63 else None
