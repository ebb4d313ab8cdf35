"""Columns of Parquet and Arrow files as the columns of a table, some thousand rows at a time.

A column's unit is in its name, or in its metadata under ``unit`` or ``units``. Parts of a structure are columns of their own, named
``structure.part``; so are the three numbers of a list of three. A time has the type of a time, or the name and unit of one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import compute, parquet

from imuwb.errors import UnreadableLogError
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.bytes.memory_limit import limited
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.cells import converted
from imuwb.readers.text.column_names import with_units
from imuwb.readers.text.layout import SAMPLE, Layout
from imuwb.readers.text.several import of_layouts, other_rows
from imuwb.readers.text.sidecar import with_sidecar
from imuwb.readers.text.tables import by_column
from imuwb.readers.text.text_table import table

ROWS = 32_768  #: in a piece
AXES = 3  #: numbers of a list that are x, y and z
DEEPEST = 8  #: structures within each other
FAULTS = (pa.ArrowException, OSError, MemoryError, OverflowError, ValueError)
Pieces = Iterator[tuple[pa.RecordBatch, int]]  #: each with the bytes read


@dataclass(frozen=True, slots=True)
class Table:
    """A file of columns."""

    schema: pa.Schema
    rows: int
    pieces: Callable[[list[str]], Pieces]  #: of the columns with some names


def parquet_pieces(path: Path) -> Table:
    """Return the table of a Parquet file."""
    file = parquet.ParquetFile(path, pre_buffer=False)
    rows, size = file.metadata.num_rows, path.stat().st_size

    def pieces(names: list[str]) -> Pieces:
        done = 0
        for piece in file.iter_batches(ROWS, columns=names, use_threads=False):
            done += piece.num_rows
            yield piece, size * done // max(rows, 1)

    return Table(file.schema_arrow, rows, pieces)


def feather_pieces(path: Path) -> Table:
    """Return the table of an Arrow file; of a cut one, which lacks its index, that of the pieces before the cut."""
    size = path.stat().st_size
    source = pa.memory_map(str(path))
    try:
        file = pa.ipc.open_file(source)
        schema, batches = file.schema, (file.get_batch(i) for i in range(file.num_record_batches))
    except FAULTS:
        source.seek(0)
        source.seek(8 if source.read(6) == b"ARROW1" else 0)
        pieces_of = pa.ipc.open_stream(source)  # after the magic number, a file is like a stream
        schema, batches = pieces_of.schema, iter(pieces_of)

    def pieces(names: list[str]) -> Pieces:
        for batch in batches:
            batch.validate(full=True)
            chosen = batch.select(names)
            for first in range(0, batch.num_rows, ROWS):
                yield chosen.slice(first, ROWS), min(source.tell(), size)

    return Table(schema, 0, pieces)


def streamed(
    path: Path, options: ReadOptions, opened: Callable[[Path], Table], *, named: bool = True
) -> Iterator[Batch | Remark]:
    """Yield the streams of a file of columns.

    Args:
        path: the file.
        options: what the file does not state itself.
        opened: opens the file; it is called twice.
        named: whether the columns have names; without names the known shapes of rows are tried.

    Raises:
        UnreadableLogError: the file is cut or damaged, or has no row of numbers.
        UsageError: the columns, units or rate of the file are unknown.
    """
    try:
        with _limited():
            found = opened(path)
            names = list(found.schema.names)
            # Names may be equal; columns are asked for by name, so of equal ones none is read.
            count = Counter(names)
            tops = [name for name in names if count[name] == 1]
            first, _ = next(found.pieces(tops), (None, 0))
            leaves = [] if first is None else _leaves(found.schema, first, tops)
    except FAULTS as error:
        raise UnreadableLogError(
            f"{path}: the table cannot be read ({_shortly(error)}); it is cut or damaged: copy it again"
        ) from error
    if not leaves:
        raise UnreadableLogError(f"{path}: the table has no row, or no column of numbers, times or texts")
    layout = _layout(leaves, named=named)

    def blocks(_: Path, own: Layout, kinds: Mapping[int, pa.DataType], faults: Counter[str]) -> Pieces:
        wanted = list(dict.fromkeys(leaves[index].top for index in kinds))
        tag = None if own.tag is None else leaves[own.tag.column]
        if tag is not None and tag.top not in wanted:
            wanted.append(tag.top)
        if not wanted:  # the rows are counted, even where no column of theirs is used
            wanted = [leaves[0].top]
        try:
            for piece, bytes_read in _pieces(path, opened, wanted):
                with _limited():
                    columns = _columns(piece, wanted, own, tag)
                    arrays = [_as(columns[leaves[index].name], kind, faults) for index, kind in kinds.items()]
                yield pa.RecordBatch.from_arrays(arrays, names=[str(index) for index in kinds]), bytes_read
        except FAULTS as error:
            faults[Note("table_cut", f"end of the table that cannot be read ({_shortly(error)})")] = 1

    if rest := [name for name in dict.fromkeys(names) if name not in {leaf.top for leaf in leaves}]:
        yield unused(rest, "columns of bytes, maps, or lists of other lengths than three, or of equal names")
    parted = tuple(by_column(layout)) if named and not options.columns else ()
    if not parted:
        yield from table(path, layout, options, blocks)
        return
    options, remarks = with_sidecar(path, options)
    yield from remarks
    yield from of_layouts(path, parted, options, blocks)
    yield from other_rows(_tag_counts(path, opened, parted[0], leaves), parted)


@contextmanager
def _limited() -> Generator[None]:
    """Let the library take no more memory than the log may. Its own allocator reserves a gigabyte, so that of the system is used."""
    before = pa.default_memory_pool()
    pa.set_memory_pool(pa.system_memory_pool())
    try:
        with limited():
            yield
    finally:
        pa.set_memory_pool(before)


def _pieces(path: Path, opened: Callable[[Path], Table], names: list[str]) -> Pieces:
    """Yield the pieces of some columns, each prepared within the limit."""
    with _limited():
        pieces = opened(path).pieces(names)
    while True:
        with _limited():
            piece = next(pieces, None)
        if piece is None:
            return
        yield piece


def _columns(piece: pa.RecordBatch, tops: list[str], own: Layout, tag: _Leaf | None) -> dict[str, pa.Array[Any]]:
    """Return the columns of single values of a piece, with the rows of a table's tag if it has one."""
    columns = {name: cells for top in tops for name, cells in _flat(top, piece.column(top))}
    if tag is None or own.tag is None:
        return columns
    of_tag = compute.equal(columns[tag.name].cast(pa.string()), own.tag.text)
    return {name: cells.filter(of_tag) for name, cells in columns.items()}


def _tag_counts(path: Path, opened: Callable[[Path], Table], table_of: Layout, leaves: list[_Leaf]) -> Counter[str]:
    """Return how many rows of a whole file have each text in the column that parts its tables."""
    counts = Counter[str]()
    if table_of.tag is not None:
        tag = leaves[table_of.tag.column]
        with suppress(*FAULTS):  # of a cut file, the tables themselves say so
            for piece, _ in _pieces(path, opened, [tag.top]):
                counts.update(_texts(dict(_flat(tag.top, piece.column(tag.top)))[tag.name]))
    return counts


def _shortly(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:120]


@dataclass(frozen=True, slots=True)
class _Leaf:
    """A column of single values."""

    top: str  #: name of the file's column that it is, or is a part of
    name: str
    shown: str  #: name with its unit
    cells: tuple[str, ...]  #: of the first rows


def _leaves(schema: pa.Schema, first: pa.RecordBatch, tops: list[str]) -> list[_Leaf]:
    leaves: list[_Leaf] = []
    for top in tops:
        measure = _unit_of(schema.field(top))
        for name, cells in _flat(top, first.column(top)):
            shown = _shown(name, measure or _unit_of_type(cells.type))
            leaves.append(_Leaf(top, name, shown, tuple(_texts(cells.slice(0, SAMPLE)))))
    return leaves


def _flat(name: str, cells: pa.Array[Any], depth: int = 0) -> Iterator[tuple[str, pa.Array[Any]]]:
    """Yield the columns of single values that a column is made of; none for bytes, maps and long lists."""
    kind = cells.type
    if pa.types.is_dictionary(kind):
        yield from _flat(name, cells.cast(kind.value_type), depth)
    elif pa.types.is_struct(kind) and depth < DEEPEST:
        for field, part in zip(kind, cells.flatten(), strict=True):
            yield from _flat(f"{name}.{field.name}", part, depth + 1)
    elif pa.types.is_fixed_size_list(kind) and kind.list_size == AXES and _is_single(kind.value_type):
        for i, axis in enumerate("xyz"):
            yield f"{name}.{axis}", compute.list_element(cells, i)
    elif _is_single(kind):
        yield name, cells


def _is_single(kind: pa.DataType) -> bool:
    is_a = pa.types
    return (
        is_a.is_integer(kind) or is_a.is_floating(kind) or is_a.is_decimal(kind) or is_a.is_boolean(kind) or is_a.is_temporal(kind)
        or is_a.is_string(kind) or is_a.is_large_string(kind)
    )  # fmt: skip


def _unit_of(field: pa.Field[Any]) -> str:
    """Return the unit in the metadata of a column; empty without one."""
    stated = {key.lower(): value for key, value in (field.metadata or {}).items()}
    return next((stated[key].decode("utf-8", "replace").strip() for key in (b"unit", b"units") if key in stated), "")


def _unit_of_type(kind: pa.DataType) -> str:
    return str(kind.unit) if pa.types.is_duration(kind) else ""


def _shown(name: str, measure: str) -> str:
    """Return a column's name with its unit, unless the name states one itself."""
    stated = next(with_units(name))[1]
    return f"{name} [{measure}]" if measure and stated is None else name


def _texts(cells: pa.Array[Any]) -> list[str]:
    """Return cells as text; a number with a fraction has an exponent, because it is no exact decimal."""
    kind = cells.type
    if pa.types.is_timestamp(kind) and kind.tz is not None:
        cells = cells.cast(pa.timestamp(kind.unit, "UTC"))
    elif pa.types.is_duration(kind):
        cells = cells.cast(pa.int64())
    elif pa.types.is_floating(kind) or pa.types.is_decimal(kind):
        return ["" if x is None else f"{x:.17e}" for x in cells.cast(pa.float64(), safe=False).to_pylist()]
    return ["" if text is None else text for text in cells.cast(pa.string()).to_pylist()]


def _layout(leaves: list[_Leaf], *, named: bool) -> Layout:
    sample = tuple(zip(*(leaf.cells for leaf in leaves), strict=True))
    first = max(sample, key=lambda row: sum(bool(cell) and cell != "nan" for cell in row))
    return Layout(",", 0, tuple(leaf.shown for leaf in leaves) if named else (), first, sample=sample)


def _as(cells: pa.Array[Any], kind: pa.DataType, faults: Counter[str]) -> pa.Array[Any]:
    """Return cells as numbers or times of a type; null for those that are neither."""
    mine = cells.type
    if pa.types.is_string(mine) or pa.types.is_large_string(mine):
        return converted(cells.cast(pa.binary()), kind, faults)
    if pa.types.is_binary(kind):
        return pa.array(_texts(cells), pa.string()).cast(kind)
    if pa.types.is_timestamp(kind):
        return cells.cast(kind, safe=False)
    if pa.types.is_duration(mine) or pa.types.is_boolean(mine) or pa.types.is_uint64(mine):
        cells = cells.cast(pa.int64(), safe=False)
    elif not pa.types.is_integer(mine):
        cells = cells.cast(pa.float64(), safe=False)
    return cells.cast(kind, safe=False)
