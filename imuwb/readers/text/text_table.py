"""One table of a text log: its columns, its clock, and the streams of its rows."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

import numpy as np
from pyarrow import DataType, RecordBatch, float64

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.errors import UnreadableLogError
from imuwb.log import MEAN_SEA_LEVEL, Kind, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.bytes.source import damaged
from imuwb.readers.quantities import units_by_quantity, units_text
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.cells import CELLS, LINES, blocks, floats, of
from imuwb.readers.text.clock import Clock, clock_of
from imuwb.readers.text.column_names import Column, columns
from imuwb.readers.text.csv_columns import used_columns
from imuwb.readers.text.csv_part import Search
from imuwb.readers.text.csv_streams import heights_above_sea, streams_of
from imuwb.readers.text.gravity import check_gravity
from imuwb.readers.text.increments import RATES, Increments
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.left_out import left_over, no_stream, unused_columns
from imuwb.readers.text.positions import check_position
from imuwb.readers.text.sensor_files import BETTER, WORSE, sensor_name, stem
from imuwb.readers.text.sensors import Sensor, is_sparse, sensors_of, stream_name
from imuwb.readers.text.shapes.application import Shaped, shape_of_log
from imuwb.readers.text.sidecar import with_sidecar
from imuwb.readers.text.tables import name_of
from imuwb.units import SECOND

#: yields some columns of a table, {index: type}, in blocks, each with the bytes read, and counts faults
Blocks = Callable[[Path, Layout, Mapping[int, DataType], Counter[str]], Iterator[tuple[RecordBatch, int]]]
Piece = tuple[Integers, dict[Column, Floats], int]

UNTIMED = Note("no_time", "rows without a usable time left out")
INCOMPLETE = Note("incomplete", "rows without a number in every used column")
JUMP = 3600 * SECOND  #: ns; in a damaged packed file, a longer step forward shows where the damage begins
STREAMS = ("gyro", "accel", "latitude", "speed", "temperature", *RATES)  #: quantities that make a stream
MOST_UNUSABLE = 0.5  #: share of rows; if more rows are unusable, the file is not a log with these columns


def table(path: Path, layout: Layout, options: ReadOptions, rows: Blocks) -> Iterator[Batch | Remark]:
    """Yield the streams of a table of named columns, of text or of another kind.

    Args:
        path: the file; messages name it, and a sidecar may lie beside it.
        layout: names of its columns, and the cells of its first rows.
        options: what the file does not state itself.
        rows: as ``imuwb.readers.text.cells.blocks``; called once.

    Raises:
        UsageError: the columns, units or rate of the file are unknown.
        UnreadableLogError: the file has no row of numbers, or the numbers contradict their stated unit.
    """
    options, remarks = with_sidecar(path, options)
    yield from remarks
    yield from Table(path, layout, options, rows).parts()


class Table:
    """A table whose columns and clock are known."""

    def __init__(
        self, path: Path, layout: Layout, options: ReadOptions, rows: Blocks, limits: Limits | None = None
    ) -> None:
        """Find the columns and the clock of a table; of a part of it, if there are limits. The other arguments and the errors are those of ``table``."""
        shape = shape_of_log(path, layout, options)
        found = used_columns(path, layout, options, shape)
        if shape is not None:
            options = shape.completing(options)
        self.path, self.layout, self._shape, self._found = path, layout, shape, found
        self.options = options  #: with what the shape states
        self.blocks = rows  #: of the whole file
        #: what each column measures, in which stream
        self.keys = {(c.stream, RATES.get(c.quantity, c.quantity), c.axis) for c in found if c.quantity in STREAMS}
        # A file of nothing that is known needs no clock.
        known = found if shape is not None else ()
        fast = bool(self.sensors)
        self._clock = clock_of(path, layout, options, known, fast=fast) if self.keys else Clock("log")
        timing = {column.index for column in self._clock.columns}  # a column of dates is a time, whatever its name
        self._used = tuple(c for c in found if c.quantity not in ("time", "week") and c.index not in timing)
        if limits is not None:
            if any(column.quantity in RATES for column in found):  # an increment covers the step from the row before
                raise CannotSeekError
            rows = Search(self._clock, limits).blocks
        self._rows = _Rows(path, layout, self._used, self._clock, options, shape, rows)

    @property
    def name(self) -> str:
        """The tag of a table in a file of several, else the name of its file."""
        return name_of(self.layout) or self.path.name

    @property
    def label(self) -> str:
        """The words of the name apart from its sensor; the whole name if it states no sensor."""
        name = name_of(self.layout) or stem(self.path)
        stated = sensor_name(name)
        return name if stated is None else "-".join(sorted(stated.rest - BETTER))

    @property
    def record(self) -> frozenset[str] | None:
        """The words of the name that tell records apart; None for a name without a sensor."""
        stated = sensor_name(name_of(self.layout) or stem(self.path))
        return None if stated is None else stated.rest - BETTER - WORSE

    @property
    def frame(self) -> str:
        """The directions of x, y and z that the shape states; empty if it states none."""
        return "" if self._shape is None else self._shape.frame

    @property
    def preference(self) -> bool:
        """False for a table that goes before others of the same sensor."""
        stated = sensor_name(self.name)
        return stated is None or not stated.rest & BETTER

    @property
    def sensors(self) -> set[str]:
        """Which of gyro and accelerometer the columns are of."""
        return {quantity for _, quantity, _ in self.keys if quantity in RATES.values()}

    @property
    def epoch(self) -> str:
        """The start of its time."""
        return self._clock.epoch

    @property
    def start(self) -> int:
        """The time of the first row that has one, ns; 0 without such a row."""
        return next((int(time[0]) for time in self._times()), 0)

    @property
    def end(self) -> int:
        """The time of the last row that has one, ns; 0 without such a row. The whole table is read."""
        return max((int(time[-1]) for time in self._times()), default=0)

    def _times(self) -> Iterator[Integers]:
        """Yield the times of the rows in pieces, none of which is empty."""
        for block, _ in blocks(self.path, self.layout, self._clock.kinds, Counter()):
            time, _ = self._clock.time(block, 0)
            if time.size:
                yield time

    @property
    def has_stream(self) -> bool:
        """Whether a stream can be made of the columns."""
        return bool(self.keys)

    def parts(self, label: str = "") -> Iterator[Batch | Remark]:
        """Yield the streams, under a name if the file has several of a kind."""
        if not self.has_stream:
            yield Remark(no_stream(self.layout.names, self._found))
            return
        clock, used, shape = self._clock, self._used, self._shape
        notes = (*_layout_notes(self.layout, used, shape), *clock.notes)
        yield from map(Remark, notes)
        yield from unused_columns(self.layout.names, (*used, *clock.columns, *clock.others), shape)
        yield from self._rows.batches(label)


def _layout_notes(layout: Layout, used: tuple[Column, ...], shape: Shaped | None) -> Iterator[Note]:
    if shape is not None:
        yield Note("shape", "; ".join(filter(None, (f"read as {shape.shape.name}", shape.shape.remark))))
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
        self,
        path: Path,
        layout: Layout,
        used: tuple[Column, ...],
        clock: Clock,
        options: ReadOptions,
        shape: Shaped | None,
        rows: Blocks,
    ) -> None:
        self._blocks = rows
        self._path, self._layout, self._used, self._clock, self._options = path, layout, used, clock, options
        self._shape, self._increments = shape, Increments()
        self._sparse = is_sparse(layout.sample, used) or (shape is not None and shape.shape.sparse)
        self._name = ""  # of the first stream
        self._fields, self._checked = set[str](), set[str]()  # fields so far, and streams whose gravity is checked
        self._faults = Counter[str]()
        self._rows = self._unusable = 0  # rows with a time, and the rows among them that have no sample of the IMU

    def batches(self, label: str = "") -> Iterator[Batch | Remark]:
        """Yield the streams of each piece of the file, under a name if it is given, then its faults."""
        for time, values, bytes_read in self._pieces():
            self._rows += time.size
            sensors = list(sensors_of(self._increments.as_rates(time, values)))
            self._unusable += 0 if self._sparse else _incomplete(sensors)
            for sensor, rows, part in sensors:
                yield from self._sensor(sensor or label, *_taken(time, part, rows), bytes_read)
        if self._fields:
            yield from left_over(self._used, self._fields)
        elif self._rows:
            yield Remark(no_stream(self._layout.names, (*self._clock.columns, *self._used)))
        self._check_usable()
        yield from self._repairs()

    def _sensor(self, sensor: str, time: Integers, values: Mapping[Column, Floats], bytes_read: int) -> Iterator[Batch]:
        """Yield the streams of one sensor in one piece."""
        for kind, fields, rows in streams_of(values, self._options.frame or "FRD"):
            name = stream_name(kind, sensor)
            unchecked = name not in self._checked and "specific_force" in fields
            if unchecked and check_gravity(self._path, fields["specific_force"], tuple(values)):
                self._checked.add(name)
            if name not in self._checked and kind in ("gnss", "reference"):
                stated = (
                    {c.quantity for c in self._used}
                    if self._shape is not None
                    else units_by_quantity(self._options.units)
                )
                if check_position(self._path, fields["position"], self._used, stated):
                    self._checked.add(name)
            self._fields.update(fields)
            self._name = self._name or name
            exact = self._clock.stamp is None  # the times come from the rate
            for there, part in _present(kind, fields) if self._sparse else ((rows, fields),):
                kept = part if there is None else {field: array[there] for field, array in part.items()}
                timed = time if there is None else time[there]
                yield Batch(name, kind, timed, kept, self._origin(kind), bytes_read, exact)

    def _pieces(self) -> Iterator[Piece]:
        """Yield the rows that have a time; the rows of a damaged file only up to a jump in time."""
        first_row, before = 0, None
        kinds = {**{column.index: float64() for column in self._used}, **self._clock.kinds}
        for block, bytes_read in self._blocks(self._path, self._layout, kinds, self._faults):
            time, timed = self._clock.time(block, first_row)
            first_row += block.num_rows
            self._faults[UNTIMED] += int(np.count_nonzero(~timed))
            good = _rising(time, before) if self._layout.fault else time.size
            kept = slice(good) if timed.all() else np.flatnonzero(timed)[:good]
            values = {c: floats(of(block, c.index))[kept] for c in self._used}
            yield time[:good], values, bytes_read
            if good < time.size:
                text = "the damage shows at a jump in time; all later rows are left out"
                self._faults[damaged(self._layout.fault, text)] = 1
                return
            before = int(time[-1]) if time.size else before

    def _origin(self, kind: Kind) -> Origin:
        quantities = ("gyro", "accel", *RATES) if kind == "imu" else ("latitude", "height", "height_msl")
        units = units_text((c.quantity, c.unit) for c in self._used if c.quantity in quantities)
        if kind != "imu":
            above = f" ({MEAN_SEA_LEVEL})" if heights_above_sea(self._used) else ""
            return Origin(units + above, "NED", self._clock.epoch)
        if any(column.quantity in RATES for column in self._used):
            units += " (increments)"
        return Origin(units, self._frame(), self._clock.epoch)

    def _frame(self) -> str:
        if self._options.frame:
            return f"{self._options.frame} (stated)"
        if self._shape is None:
            return "FRD (assumed)"
        frame, name = self._shape.frame, self._shape.shape.name
        return f"{frame} ({name})" if frame else f"FRD (assumed; {name})"

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
        name = self._name or ("imu" if any(c.quantity in ("gyro", "accel", *RATES) for c in self._used) else "gnss")
        if self._layout.fault and not any(getattr(fault, "id", "") == "packed_damaged" for fault in self._faults):
            note = damaged(self._layout.fault, "no row shows where, so any row may be wrong")
            yield Remark(note, name, self._rows, "value")
        for fault, count in self._faults.items():
            if count:
                yield Remark(fault, name, count, "value" if fault == CELLS else "lost")


def _present(kind: Kind, fields: Mapping[str, Floats]) -> Iterator[tuple[Booleans, Mapping[str, Floats]]]:
    """Yield the fields of a stream in a log whose rows have the cells of some sensors alone, each with the rows that have them."""
    main = {"gnss": "position", "reference": "position"}.get(kind)
    for parts in ({name: fields[name]} for name in fields) if main is None else (fields,):
        values = fields[main] if main is not None else next(iter(parts.values()))
        there: Booleans = np.isfinite(values) if values.ndim == 1 else np.isfinite(values).sum(axis=1) > 0
        yield there, parts


def _taken(
    time: Integers, values: Mapping[Column, Floats], rows: Booleans | None
) -> tuple[Integers, Mapping[Column, Floats]]:
    """Return some rows of time and columns; None: all."""
    return (time, values) if rows is None else (time[rows], {column: cells[rows] for column, cells in values.items()})


def _incomplete(sensors: Iterable[Sensor]) -> int:
    """Return how many rows have no sample of any IMU, because a cell is no number."""
    missing = [
        np.any(cells, axis=0)
        for _, _, part in sensors
        if (cells := [~np.isfinite(x) for column, x in part.items() if column.quantity in ("gyro", "accel")])
    ]
    return int(np.count_nonzero(np.all(missing, axis=0))) if missing else 0


def _rising(time: Integers, before: int | None) -> int:
    """Return how many times follow the one before and each other without a step back or a jump."""
    steps = np.diff(time, prepend=time[:1] - 1 if before is None else before)
    odd = np.flatnonzero((steps <= 0) | (steps > JUMP))
    return int(odd[0]) if odd.size else time.size
