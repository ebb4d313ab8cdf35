"""Text logs: separated numbers, with units in the header, on the command line, or in a sidecar."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.errors import UnreadableLogError
from imuwb.log import MEAN_SEA_LEVEL, Kind, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes.source import damaged
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.cells import CELLS, LINES, blocks, floats
from imuwb.readers.text.clock import Clock, clock_of
from imuwb.readers.text.column_names import Column, above_sea, columns
from imuwb.readers.text.csv_columns import check_gravity, used_columns
from imuwb.readers.text.csv_streams import streams_of
from imuwb.readers.text.encoding import encoding_of, head_text
from imuwb.readers.text.layout import Layout, layout_of
from imuwb.readers.text.sidecar import with_sidecar
from imuwb.units import SECOND

Piece = tuple[Integers, dict[Column, Floats], int]

format = "csv"  # noqa: A001 - the contract's name
uses = ("rate", "columns", "units", "frame", "epoch")
UNTIMED = Note("no_time", "rows without a usable time left out")
INCOMPLETE = Note("incomplete", "rows without a number in every used column")
PRINTABLE = 0.99  #: least share of printable bytes in text
JUMP = 3600 * SECOND  #: ns; in a damaged packed file, a longer step forward shows where the damage begins
MOST_UNUSABLE = 0.5  #: share of rows; if more rows are unusable, the file is not a log with these columns


def probe(head: bytes) -> bool:
    """Return whether the file begins with text that has digits, in UTF-8 or UTF-16."""
    head = head_text(head, encoding_of(head))
    if b"\0" in head or not any(digit in head for digit in b"0123456789"):
        return False
    printable = sum(byte >= ord(" ") or byte in b"\t\r\n\f" for byte in head)
    return printable >= PRINTABLE * len(head)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the rows of a text log in pieces.

    Raises:
        UsageError: the columns, units or rate of the file are unknown.
        UnreadableLogError: the file has no row of numbers, or the numbers contradict their stated unit.
    """
    options, remarks = with_sidecar(path, options)
    layout = layout_of(path)
    used = used_columns(path, layout, options)
    clock = clock_of(path, layout, used, options)
    yield from (*remarks, *map(Remark, (*_layout_notes(layout, used), *clock.notes)))
    yield from _Rows(path, layout, used, clock, options).batches()


def _layout_notes(layout: Layout, used: tuple[Column, ...]) -> Iterator[Note]:
    if layout.cut_first:
        yield Note("first_line_cut", "first line left out: it has fewer cells than the others")
    for column in used:
        named = columns((column.name,), {})
        if named and named[0].unit is not None and column.unit is not None and named[0].unit != column.unit:
            text = f"column {column.name!r} read in {column.unit.name}, as stated, not in {named[0].unit.name}"
            yield Note("unit_overridden", text)
    known = {column.quantity for column in used}
    vertical = known & {"velocity_down", "velocity_up"}
    if {"roll", "pitch", "heading", "velocity_north", "velocity_east"} <= known and not vertical:
        text = "the velocities are left out: a reference has a velocity north, east and down, and there is none down"
        yield Note("velocity_left_out", text)


class _Rows:
    """The rows of a text log, and the faults found so far."""

    def __init__(
        self, path: Path, layout: Layout, used: tuple[Column, ...], clock: Clock, options: ReadOptions
    ) -> None:
        self._path, self._layout, self._used, self._clock, self._options = path, layout, used, clock, options
        self._faults = Counter[str]()
        self._rows = self._unusable = 0  # rows with a time, and the rows among them that have no sample of the IMU

    def batches(self) -> Iterator[Batch | Remark]:
        """Yield the streams of each piece of the file, then its faults."""
        any_stream = checked = False
        for time, values, bytes_read in self._pieces():
            self._rows += time.size
            missing = [~np.isfinite(cells) for column, cells in values.items() if column.quantity in ("gyro", "accel")]
            self._unusable += int(np.count_nonzero(np.any(missing, axis=0))) if missing else 0
            for kind, fields, rows in streams_of(values, self._options.frame or "FRD"):
                if not checked and "specific_force" in fields:
                    checked = check_gravity(self._path, fields["specific_force"], self._used)
                any_stream = True
                kept = fields if rows is None else {name: array[rows] for name, array in fields.items()}
                timed = time if rows is None else time[rows]
                exact = self._clock.column is None  # the times come from the rate
                yield Batch(kind, kind, timed, kept, self._origin(kind), bytes_read, exact)
        if not any_stream and self._rows:
            names = ", ".join(column.name for column in self._used) or "none that is known"
            text = (
                f"no stream in this file (known columns: {names}); an IMU needs x, y and z of a sensor, and a fix latitude "
                "and longitude; name the columns with --columns"
            )
            yield Remark(Note("no_stream", text))
        self._check_usable()
        yield from self._repairs()

    def _pieces(self) -> Iterator[Piece]:
        """Yield the rows that have a time; the rows of a damaged file only up to a jump in time."""
        first_row, before = 0, None
        for block, bytes_read in blocks(self._path, self._layout, self._used, self._clock.kind, self._faults):
            time, timed = self._clock.time(block, first_row)
            first_row += block.num_rows
            self._faults[UNTIMED] += int(np.count_nonzero(~timed))
            good = _rising(time, before) if self._layout.fault else time.size
            values = {c: floats(block.column(c.name))[timed][:good] for c in self._used if c.quantity != "time"}
            yield time[:good], values, bytes_read
            if good < time.size:
                text = "the damage shows at a jump in time; all later rows are left out"
                self._faults[damaged(self._layout.fault, text)] = 1
                return
            before = int(time[-1]) if time.size else before

    def _origin(self, kind: Kind) -> Origin:
        quantities = ("gyro", "accel") if kind == "imu" else ("latitude", "height")
        used = (c.unit.name for c in self._used if c.unit is not None and c.quantity in quantities)
        units = ", ".join(dict.fromkeys(used))
        if kind != "imu":
            above = f" ({MEAN_SEA_LEVEL})" if any(map(above_sea, self._used)) else ""
            return Origin(units + above, "NED", self._clock.epoch)
        stated = self._options.frame
        return Origin(units, f"{stated} (stated)" if stated else "FRD (assumed)", self._clock.epoch)

    def _check_usable(self) -> None:
        faults = self._faults
        rows = self._rows + faults[UNTIMED] + faults[LINES]
        if self._rows and self._unusable + faults[LINES] <= MOST_UNUSABLE * rows:
            return
        faults[INCOMPLETE] += self._unusable
        counts = ", ".join(f"{count} {fault}" for fault, count in faults.items() if count) or "no row"
        raise UnreadableLogError(
            f"{self._path}: too few rows can be used ({counts}); check that this is a log of numbers, and its columns"
        )

    def _repairs(self) -> Iterator[Remark]:
        name = "imu" if any(column.quantity in ("gyro", "accel") for column in self._used) else "gnss"
        if self._layout.fault and not any(getattr(fault, "id", "") == "packed_damaged" for fault in self._faults):
            note = damaged(self._layout.fault, "no row shows where, so any row may be wrong")
            yield Remark(note, name, self._rows, "value")
        for fault, count in self._faults.items():
            if count:
                yield Remark(fault, name, count, "value" if fault == CELLS else "lost")


def _rising(time: Integers, before: int | None) -> int:
    """Return how many times follow the one before and each other without a step back or a jump."""
    steps = np.diff(time, prepend=time[:1] - 1 if before is None else before)
    odd = np.flatnonzero((steps <= 0) | (steps > JUMP))
    return int(odd[0]) if odd.size else time.size
