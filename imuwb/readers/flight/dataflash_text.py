"""ArduPilot's logs as text: a line for each record, with scaled fields."""

import contextlib
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator

import numpy as np

from imuwb.readers.flight.dataflash_tables import Factors, Table, stacked

STATED = ("FMTU", "UNIT", "MULT")  #: records that are text
LARGEST = 2.0**53  #: a larger time (µs) or instance is damage
BATCH = 1 << 16  #: number of rows that become an array at a time


class TextTables:
    """Records by name, column by column.

    A record may be described again with other fields: a row has the latest description with its number of cells.
    """

    def __init__(self, wanted: Collection[str]) -> None:
        """Set the names of the records to keep."""
        self.records = 0
        self.bad = 0  #: lines of a wanted record that are cut, or have a text in place of a number
        self.counts: dict[str, int] = defaultdict(int)  #: records by name
        self._wanted = wanted
        self._described: dict[str, list[tuple[str, ...]]] = defaultdict(list)
        self._labels: dict[str, tuple[str, ...]] = {}  #: of the rows that are not yet packed
        self._rows: dict[str, list[list[float]]] = defaultdict(list)
        self._tables: dict[str, list[Table]] = defaultdict(list)
        self._parameters: list[tuple[str, float]] = []

    def take(self, lines: Iterable[bytes], *, to_first_bad: bool = False) -> None:
        """Keep the records of some lines; on request, stop at the first bad line."""
        for line in lines:
            name, _, rest = line.partition(b",")
            record = name.strip().decode("ascii", "replace")
            if record == "FMT":
                cells = [cell.strip() for cell in rest.decode("ascii", "replace").split(",")]
                if len(cells) >= 5 and tuple(cells[4:]) not in self._described[cells[2]][-1:]:  # noqa: PLR2004 - number, size, name, letters, at least one field
                    self._described[cells[2]].append(tuple(cells[4:]))
            elif record == "PARM":
                self._parameter(rest)
            elif record in self._described and record in self._wanted and record not in STATED:
                self._row(record, rest)
            self.records += bool(record)
            if record in self._described or record in self._wanted or record == "FMT":
                self.counts[record] += 1
            if to_first_bad and self.bad:
                return

    @property
    def labels(self) -> dict[str, tuple[str, ...]]:
        """Return the fields of the records of each name."""
        return {name: described[-1] for name, described in self._described.items() if described}

    def labels_of(self, name: str) -> list[tuple[str, ...]]:
        """Return the fields of each layout of the records of a name."""
        self._pack(name)
        return list(dict.fromkeys(tuple(table) for table in self._tables.get(name, ())))

    def table(self, name: str, factors: Factors | None = None) -> Table | None:
        """Return a record's columns, {field: (n,)}; None without such a record; a text log has its fields in SI."""
        del factors
        self._pack(name)
        return stacked(self._tables[name]) if self._tables[name] else None

    def stated(self) -> Iterator[tuple[str, float]]:
        """Yield the autopilot's parameters, name and value, in the order of the file."""
        yield from self._parameters

    def _parameter(self, rest: bytes) -> None:
        labels = self._described["PARM"][-1:] or [("TimeUS", "Name", "Value")]
        stated = dict(
            zip(labels[0], (cell.strip() for cell in rest.decode("ascii", "replace").split(",")), strict=False)
        )
        with contextlib.suppress(ValueError):
            self._parameters.append((stated.get("Name", ""), float(stated.get("Value", ""))))

    def _row(self, record: str, rest: bytes) -> None:
        cells = rest.split(b",")
        labels = next((one for one in reversed(self._described[record]) if len(one) == len(cells)), None)
        try:
            row = [float(cell) for cell in cells]
        except ValueError:
            row = []
        if not row or labels is None or not all(abs(x) < LARGEST for x in row[:2]):  # time and instance
            self.bad += 1
            return
        if self._labels.setdefault(record, labels) != labels:
            self._pack(record)
            self._labels[record] = labels
        self._rows[record].append(row)
        if len(self._rows[record]) == BATCH:
            self._pack(record)

    def _pack(self, record: str) -> None:
        if self._rows.get(record):
            rows = np.array(self._rows.pop(record))
            self._tables[record].append({label: rows[:, i] for i, label in enumerate(self._labels[record])})
