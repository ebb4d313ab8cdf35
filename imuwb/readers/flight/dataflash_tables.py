"""The records of ArduPilot's binary logs as tables: by name, column by column."""

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Bytes, Integers
from imuwb.readers.bytes.gather import columns
from imuwb.readers.flight.dataflash_records import FMT, FMT_SIZE, RecordFormat, described, walk

Table = dict[str, NDArray[Any]]
#: (layout, field) -> factor; a layout is a place in ``Tables.layouts``
Factors = Mapping[tuple[int, str], float]

MOST_CHANGES = 64  #: times that formats may change; a file with more is damaged, and the last formats hold to its end
LAYOUT = "@"  #: column of FMTU records: the layout whose units each states


@dataclass(frozen=True, eq=False, slots=True)
class _Piece:
    """Records of one layout that follow each other, apart from those of other layouts."""

    layout: int
    at: Integers  #: (n,) places in the file; (1,) the first place, where no other layout has the name
    columns: Table


@dataclass(slots=True)
class Tables:
    """Records by name, column by column; the file is taken block by block.

    A number may be described again with other fields: each description holds from its place on, and the first one also before.
    """

    formats: dict[int, RecordFormat]  #: by number, in force
    wanted: Collection[str]
    records: int = 0
    skipped: int = 0  #: bytes that belong to no record
    layouts: list[RecordFormat] = field(default_factory=list[RecordFormat])  #: all formats, in the order of the file
    counts: dict[str, int] = field(default_factory=lambda: defaultdict(int))  #: records by name
    _in_force: dict[int, int] = field(default_factory=dict[int, int])  #: number -> place in ``layouts``
    _described: dict[int, bytes] = field(default_factory=dict[int, bytes])  #: number -> its last description
    _changes: int = 0  #: times that formats changed
    _taken: int = 0  #: bytes of the file before the block
    _pieces: dict[str, list[_Piece]] = field(default_factory=lambda: defaultdict(list))

    def __post_init__(self) -> None:
        """List the formats."""
        self._in_force = {number: i for i, number in enumerate(self.formats)}
        self.layouts = list(self.formats.values())

    def take(self, buffer: Bytes, *, last: bool) -> int:
        """Keep the records of a block; return where the next block begins."""
        begin, again = 0, True
        while again:
            end, again = self._take(buffer[begin:], begin, last=last)
            begin += end
        self.skipped += buffer.size - begin if last else 0
        self._taken += begin
        return begin

    def _take(self, buffer: Bytes, offset: int, *, last: bool) -> tuple[int, bool]:
        """Keep the records up to the first whose format is another than at the beginning.

        Returns:
            where they end, and whether there is such a record.
        """
        sizes = np.zeros(256, np.int64)
        for number, one in self.formats.items():
            sizes[number] = one.size
        numbers, starts, end = walk(buffer, last=last, sizes=sizes)
        first, stop, changed = self._changed(buffer, numbers, starts, sizes)
        if changed:
            numbers, starts, end = numbers[:stop], starts[:stop], int(starts[stop - 1] + sizes[numbers[stop - 1]])
        self.records += numbers.size
        self.skipped += end - int(sizes[numbers].sum())
        self._keep(buffer, numbers[:first], starts[:first], offset)
        for number, new in changed.items():
            self.formats[number], self._in_force[number] = new, len(self.layouts)
            self.layouts.append(new)
        self._keep(buffer, numbers[first:], starts[first:], offset)
        self._changes += bool(changed)
        return end, bool(changed)

    def _changed(
        self, buffer: Bytes, numbers: Bytes, starts: Integers, sizes: Integers
    ) -> tuple[int, int, dict[int, RecordFormat]]:
        """Return how many records come before the first changed format, how many are found with right sizes, and the changes.

        After a change the records are found with sizes that may be wrong, up to the first of a changed number at the latest.
        """
        first = stop = numbers.size
        changed: dict[int, RecordFormat] = {}
        for row in np.flatnonzero(numbers == FMT).tolist() if self._changes < MOST_CHANGES else ():
            if row >= stop:
                break
            body = buffer[starts[row] + 3 : starts[row] + FMT_SIZE].tobytes()
            number = body[0]
            if self._described.get(number) == body:
                continue  # a log may repeat its formats many times
            self._described[number] = body
            new = described(body)
            if number == FMT or new is None or new == changed.get(number, self.formats.get(number, new)):
                continue
            if not changed:
                first = row + 1
                apart = np.flatnonzero(np.diff(starts[row:]) != sizes[numbers[row:-1]])
                stop = row + 1 + int(apart[0]) if apart.size else stop
            changed[number] = new
            again = np.flatnonzero(numbers[row + 1 : stop] == number)
            stop = row + 1 + int(again[0]) if again.size else stop
        return first, stop, changed

    def _keep(self, buffer: Bytes, numbers: Bytes, starts: Integers, offset: int) -> None:
        names = [one.name for one in self.layouts]
        for number, found in enumerate(np.bincount(numbers, minlength=256).tolist()):
            one = self.formats.get(number)
            if not found or one is None:
                continue
            self.counts[one.name] += found
            if one.name not in self.wanted:
                continue
            rows = starts[numbers == number]
            raw = columns(one.fields, buffer, rows)
            raw |= {f.name: raw[f.name] * f.factor for f in one.fields if f.factor != 1}
            if one.name == "FMTU" and raw.get("FmtType", np.empty((0, 0))).ndim == 1:
                raw[LAYOUT] = np.array([self._in_force.get(int(i), -1) for i in raw["FmtType"]])
            at = self._taken + offset + (rows if names.count(one.name) > 1 else rows[:1])
            self._pieces[one.name].append(_Piece(self._in_force[number], at, raw))

    @property
    def labels(self) -> dict[str, tuple[str, ...]]:
        """Return the fields of the records of each name."""
        return {one.name: tuple(f.name for f in one.fields) for one in self.layouts}

    def stated(self) -> Iterator[tuple[str, float]]:
        """Yield the autopilot's parameters, name and value, in the order of the file."""
        table = self.table("PARM") or {}
        names, values = table.get("Name", np.empty((0, 0))), table.get("Value", np.empty(0))
        if names.dtype == np.uint8 and names.ndim == 2 and values.ndim == 1:  # noqa: PLR2004 - letters of each name
            for name, value in zip(names, values.tolist(), strict=True):
                yield name.tobytes().rstrip(b"\0").decode("ascii", "replace"), float(value)

    def labels_of(self, name: str) -> list[tuple[str, ...]]:
        """Return the fields of each layout of the records of a name."""
        used = sorted({piece.layout for piece in self._pieces.get(name, ())})
        return list(dict.fromkeys(tuple(f.name for f in self.layouts[i].fields) for i in used))

    def table(self, name: str, factors: Factors | None = None) -> Table | None:
        """Return a record's columns in the order of the file, {field: (n,) or (n, count)}; None without such a record.

        A field that only some layouts have is nan in the others' rows.

        Args:
            name: name of the records.
            factors: fields that are multiplied.
        """
        pieces = self._pieces.get(name)
        if not pieces:
            return None
        if factors:
            pieces = [_Piece(p.layout, p.at, _scaled(p, factors)) for p in pieces]
        table = stacked([piece.columns for piece in pieces])
        if len({piece.layout for piece in pieces}) == 1:
            return table
        sizes = [len(next(iter(piece.columns.values()))) for piece in pieces]
        # A piece from before the other layout was known has its first place only; no row of another layout is among its rows.
        at = [p.at if p.at.size == n else p.at + np.arange(n) for p, n in zip(pieces, sizes, strict=True)]
        order = np.argsort(np.concatenate(at), kind="stable")
        return {key: column[order] for key, column in table.items()}


def _scaled(piece: _Piece, factors: Factors) -> Table:
    return {
        key: column.astype(np.float64) * factors[piece.layout, key] if (piece.layout, key) in factors else column
        for key, column in piece.columns.items()
    }


def stacked(tables: Sequence[Table]) -> Table:
    """Return tables one below the other; a field that some lack, or have in another shape, is nan there, or empty if it is text."""
    first = tables[0]
    shapes = {key: column.shape[1:] for table in reversed(tables) for key, column in table.items()}
    if all(table.keys() == first.keys() for table in tables) and all(
        column.shape[1:] == shapes[key] for table in tables for key, column in table.items()
    ):
        return {key: np.concatenate([table[key] for table in tables]) for key in first}
    whole: Table = {}
    for key, shape in shapes.items():
        text = any(table[key].dtype == np.uint8 and shape for table in tables if key in table)
        parts: list[NDArray[Any]] = []
        for table in tables:
            rows = len(next(iter(table.values())))
            fits = key in table and table[key].shape[1:] == shape
            missing = np.zeros((rows, *shape), np.uint8) if text else np.full((rows, *shape), np.nan)
            parts.append(table[key] if fits else missing)
        whole[key] = np.concatenate(parts)
    return whole
