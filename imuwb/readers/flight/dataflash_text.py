"""ArduPilot's logs as text: a line for each record, with scaled fields."""

from collections import defaultdict
from collections.abc import Collection, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats

STATED = ("FMTU", "UNIT", "MULT")  #: records that are text
LARGEST = 2.0**53  #: a larger time (µs) or instance is damage
BATCH = 1 << 16  #: number of rows that become an array at a time


class TextTables:
    """Records by name, column by column."""

    def __init__(self, wanted: Collection[str]) -> None:
        """Set the names of the records to keep."""
        self.records = 0
        self.bad = 0  #: lines of a wanted record that are cut, or have a text in place of a number
        self._wanted = wanted
        self._names: dict[str, tuple[str, ...]] = {}
        self._rows: dict[str, list[list[float]]] = defaultdict(list)
        self._arrays: dict[str, list[Floats]] = defaultdict(list)

    def take(self, lines: Iterable[bytes], *, to_first_bad: bool = False) -> None:
        """Keep the records of some lines; on request, stop at the first bad line."""
        for line in lines:
            name, _, rest = line.partition(b",")
            record = name.strip().decode("ascii", "replace")
            if record == "FMT":
                cells = [cell.strip() for cell in rest.decode("ascii", "replace").split(",")]
                if len(cells) >= 5:  # noqa: PLR2004 - number, size, name, letters, at least one field
                    self._names.setdefault(cells[2], tuple(cells[4:]))
            elif record in self._names and record in self._wanted and record not in STATED:
                self._row(record, rest)
            self.records += bool(record)
            if to_first_bad and self.bad:
                return

    def table(self, name: str) -> dict[str, NDArray[Any]] | None:
        """Return a record's columns, {field: (n,)}; None without such a record."""
        self._pack(name)
        if not self._arrays[name]:
            return None
        rows = np.concatenate(self._arrays[name])
        return {label: rows[:, i] for i, label in enumerate(self._names[name])}

    def _row(self, record: str, rest: bytes) -> None:
        cells = rest.split(b",")
        try:
            row = [float(cell) for cell in cells]
        except ValueError:
            row = []
        if len(row) != len(self._names[record]) or not all(abs(x) < LARGEST for x in row[:2]):  # time and instance
            self.bad += 1
            return
        self._rows[record].append(row)
        if len(self._rows[record]) == BATCH:
            self._pack(record)

    def _pack(self, record: str) -> None:
        if self._rows[record]:
            self._arrays[record].append(np.array(self._rows.pop(record)))
