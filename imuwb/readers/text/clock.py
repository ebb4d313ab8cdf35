"""The time of a text log's rows: from columns of numbers, dates, or GPS weeks, or from a rate."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

import numpy as np
import pyarrow as pa

from imuwb.arrays import Booleans, Integers
from imuwb.errors import UsageError
from imuwb.notes import Note
from imuwb.readers.gps_time import ahead_of_utc, leap_seconds, unix_of_gps
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text import cells
from imuwb.readers.text.column_names import Column, scale_of
from imuwb.readers.text.instants import Days, Form, nanoseconds
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.stamp_choice import chosen
from imuwb.readers.text.stamps import Stamp
from imuwb.readers.text.time_tag import TagClock, tag_clock
from imuwb.readers.text.trust import is_number
from imuwb.units import SECOND, Epoch, Unit, unit

Times = tuple[Integers, Booleans]

WEEK_END = 604_801  #: s; no time of a GPS week is later, not even with a leap second
LATEST_WEEK = 10_000  #: GPS week of the year 2171
LATEST = 2**63 - 1025  #: ns, the largest double below the end of int64
OUR_DAYS = (5e8, 3e9)  #: s since 1970 (years 1985 and 2065); a time in between counts from 1970
DIGITS = {"s": 9, "ms": 6, "us": 3, "ns": 0}  #: decimals of each unit, down to 1 ns
SHORTEST_STEP, SEVERAL = 2e-5, 32  #: s on average, over so many rows at least; no IMU samples faster
SLOW_STEP = 5.0  #: s; few IMUs are logged so rarely
LONGEST_STEP = 1.0  #: s; samples of an IMU that are further apart show that the unit is a shorter one
_ISO = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d{1,9})?)?(Z|[+-]\d\d(:?\d\d)?)?")
_ZONE = re.compile(r"(Z|[+-]\d\d(:?\d\d)?)$")


@dataclass(frozen=True, slots=True)
class Clock:
    """How the time of a row is found."""

    epoch: Epoch
    stamp: Stamp | None = None  #: None: the time comes from the rate
    kinds: Mapping[int, pa.DataType] = field(default_factory=dict[int, pa.DataType])  #: column -> type when parsed
    rate: float = 0.0  #: Hz
    notes: tuple[Note, ...] = ()
    others: tuple[Column, ...] = ()  #: columns of times that are not used; a note names them
    ahead: int = 0  #: s by which GPS time is ahead of UTC in the whole log
    tag: TagClock | None = None  #: of a log with a time tag
    days: Days = field(default_factory=Days)  #: of times of day

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns that the time is made of."""
        stamp = self.stamp
        return () if stamp is None else (*stamp.columns, *((stamp.week,) if stamp.week is not None else ()))

    def time(self, block: pa.RecordBatch, first_row: int) -> Times:
        """Return the time (ns) of the rows that have one, and which rows these are."""
        stamp = self.stamp
        if stamp is None:
            row = np.arange(first_row, first_row + block.num_rows)
            return np.rint(row * (SECOND / self.rate)).astype(np.int64), np.ones(row.size, dtype=bool)
        if stamp.form is not None and not pa.types.is_timestamp(self.kinds[stamp.columns[0].index]):
            return self._of_texts(block, stamp, stamp.form)
        if stamp.kind == "calendar":
            return _of_calendar(block, stamp, self.days)
        time, timed = _number(block, stamp.columns[0])
        for column in stamp.columns[1:]:
            rest, known = _number(block, column)
            timed &= known & (rest >= 0) & (rest < SECOND)  # a part of a second
            time = time + rest
        if self.tag is not None:
            return self.tag.unix(time[timed]), timed
        if stamp.week is None:
            return time[timed] - self.ahead * SECOND, timed
        weeks = cells.floats(cells.of(block, stamp.week.index))
        timed &= (weeks >= 0) & (weeks < LATEST_WEEK)
        milliseconds, rest = np.divmod(time[timed], 1_000_000)
        return unix_of_gps(weeks[timed].astype(np.int64), milliseconds, self.ahead) + rest, timed

    def _of_texts(self, block: pa.RecordBatch, stamp: Stamp, form: Form) -> Times:
        columns = [cells.texts(cells.of(block, column.index)) for column in stamp.columns]
        rows = ("T".join(row) if all(row) else "" for row in zip(*columns, strict=True))
        found = [nanoseconds(text, form) for text in rows]
        timed = np.array([time is not None for time in found], dtype=bool)
        times = [time for time in found if time is not None]
        if not form.dated:
            times = [self.days.continued(time) for time in times]
        return np.array(times, np.int64), timed


def _number(block: pa.RecordBatch, column: Column) -> Times:
    """Return a column of numbers in ns, and which rows have one."""
    numbers = cells.of(block, column.index)
    time, possible = _nanoseconds(numbers, column.unit)
    return time, possible & cells.known(numbers)


#: part of a date or a time of day -> its least and its greatest number
_CALENDAR = {
    "year": (1970, 2200),
    "month": (1, 12),
    "day": (1, 31),
    "hour": (0, 24),
    "minute": (0, 59),
    "second": (0, 61),
}


def _of_calendar(block: pa.RecordBatch, stamp: Stamp, days: Days) -> Times:
    """Return the time of rows with a year, month, day, hour, minute and second, or without a date, and perhaps a part of a second."""
    parts = {c.quantity: cells.floats(cells.of(block, c.index)) for c in stamp.columns}
    timed = np.isfinite(np.sum(list(parts.values()), axis=0))
    for name, values in parts.items():
        least, most = _CALENDAR.get(name, (0, SECOND))
        timed &= (values >= least) & (values <= most)
    known = {name: values[timed] for name, values in parts.items()}
    minutes = known["hour"].astype(np.int64) * 60 + known["minute"].astype(np.int64)
    seconds = known["second"] + sum(c.unit.factor * known[c.quantity] for c in stamp.columns if c.unit is not None)
    time = minutes * 60 * SECOND + np.rint(seconds * SECOND).astype(np.int64)
    if "year" not in known:
        return np.array([days.continued(at) for at in time.tolist()], np.int64), timed
    months = ((known["year"] - 1970) * 12 + known["month"] - 1).astype("M8[M]")
    whole = months.astype("M8[D]").astype(np.int64) + known["day"].astype(np.int64) - 1
    return whole * 86_400 * SECOND + time, timed


def _nanoseconds(stamps: pa.Array[Any], measure: Unit | None) -> Times:
    """Return times in ns, and which of them int64 can hold; the time of a null cell is undefined."""
    if pa.types.is_timestamp(stamps.type):
        return cells.memory(stamps, "<i8")[:, 0], np.ones(len(stamps), dtype=bool)
    if pa.types.is_decimal(stamps.type):
        # A decimal is stored as a 128-bit integer, here in ns: exact, while a double has steps of 200 ns in Unix time.
        low, high = cells.memory(stamps, "<i8", 2).T
        return low, high == low >> 63
    with np.errstate(over="ignore"):
        numbers = cells.floats(stamps) * (cast("Any", measure).factor * SECOND)
    possible = np.isfinite(numbers) & (np.abs(numbers) < LATEST)
    return np.rint(np.where(possible, numbers, 0.0)).astype(np.int64), possible


def clock_of(
    path: Path, layout: Layout, options: ReadOptions, known: Sequence[Column] = (), *, fast: bool = False
) -> Clock:
    """Return how the rows of a log are timed.

    Args:
        path: the log.
        layout: of the log.
        options: what the user states.
        known: the columns of time and week that the log's known shape has.
        fast: whether the log has the samples of an IMU, so that a step of more than a second shows a shorter unit.

    Raises:
        UsageError: there is neither a time column nor a rate, or the unit of the time column is unknown.
    """
    stamp, others, notes = chosen(path, layout, options, known)
    if stamp is None:
        if not options.rate:
            names = ", ".join(name for name in options.columns or layout.names if name and name != "-")
            raise UsageError(f"{path}: there is no time column among {names}; state --rate HZ")
        return Clock(options.epoch or "log", rate=options.rate, notes=notes)
    clock = _clock(path, layout, stamp, options, fast=fast)
    if fast and not options.rate and "time" not in options.units:
        clock = replace(clock, notes=(*clock.notes, *_odd_rate(path, layout, clock)))
    return replace(clock, notes=(*notes, *clock.notes), others=others)


def _odd_rate(path: Path, layout: Layout, clock: Clock) -> Iterator[Note]:
    """Yield a note on a unit of time in which an IMU samples more slowly than most do.

    Raises:
        UsageError: it would sample faster than any does.
    """
    stamp = clock.stamp
    if stamp is None or stamp.kind != "number" or len(stamp.columns) != 1:
        return
    column, measure = stamp.columns[0], cast("Unit", stamp.columns[0].unit)
    numbers = [float(cell) for cell in layout.cells(column.index) if is_number(cell)]
    step = (max(numbers) - min(numbers)) / (len(numbers) - 1) if len(numbers) >= SEVERAL else 0.0
    if 0 < step * measure.factor < SHORTEST_STEP:
        likely = next(
            (u for u in map(unit, reversed(DIGITS)) if SHORTEST_STEP <= step * u.factor <= LONGEST_STEP), unit("s")
        )
        raise UsageError(
            f"{path}: time column {column.name!r} is taken in {measure.name}, in which the IMU has {1 / (step * measure.factor):.3g} rows a "
            f"second, more than any; its unit is likely {likely.name}: --units time={likely.name}"
        )
    if step * measure.factor > SLOW_STEP:
        text = f"time column {column.name!r} is taken in {measure.name}, so the IMU has a row every {step * measure.factor:.3g} s"
        yield Note("slow_time", f"{text}; if that is not so, state its unit: --units time=ms (or us, ns)")


def _clock(path: Path, layout: Layout, stamp: Stamp, options: ReadOptions, *, fast: bool) -> Clock:
    if stamp.kind == "calendar":
        kinds: dict[int, pa.DataType] = {column.index: pa.float64() for column in stamp.columns}
        return (
            Clock("unix", stamp, kinds) if not stamp.relative else Clock("log", stamp, kinds, notes=(_of_day(stamp),))
        )
    if stamp.kind == "text":
        return _text_clock(path, layout, stamp)
    return _week_clock(layout, stamp, fast=fast) or _number_clock(path, layout, stamp, options)


def _text_clock(path: Path, layout: Layout, stamp: Stamp) -> Clock:
    """Return a clock of dates and times of day."""
    form, first = stamp.form, layout.first[stamp.columns[0].index]
    if form is None:
        raise UsageError(
            f"{path}: time column {stamp.name!r} has {first!r}; it must be a number, or a date and time such as "
            "2024-05-01T12:00:00.25Z"
        )
    if form.ambiguous:
        raise UsageError(
            f"{path}: time column {stamp.name!r} has {first!r}, whose day and month may be exchanged; write the year first, as in "
            "2024-05-01, or state another column with --time-source, or leave it out with --columns, and state --rate HZ"
        )
    if len(stamp.columns) == 1 and _ISO.fullmatch(first):
        kind = pa.timestamp("ns", "UTC" if _ZONE.search(first) else None)
        return Clock("unix", stamp, {stamp.columns[0].index: kind})
    kinds = {column.index: pa.binary() for column in stamp.columns}
    if form.dated:
        return Clock("unix", stamp, kinds)
    return Clock("log", stamp, kinds, notes=(_of_day(stamp),))


def _of_day(stamp: Stamp) -> Note:
    text = f"time column {stamp.name!r} has times of day without a date; times count from the first midnight"
    return Note("time_of_day", text)


def _kinds(layout: Layout, stamp: Stamp) -> dict[int, pa.DataType]:
    """Return the types of the columns of a stamp: decimals where these are exact to 1 ns, else doubles."""
    kinds: dict[int, pa.DataType] = {}
    for column in stamp.columns:
        texts, digits = (
            [cell for cell in layout.cells(column.index) if is_number(cell)],
            DIGITS.get(cast("Unit", column.unit).name),
        )
        exact = digits is not None and not any(
            "e" in cell.lower() or len(cell.partition(".")[2]) > digits for cell in texts
        )
        kinds[column.index] = pa.decimal128(28, digits) if exact and digits is not None else pa.float64()
    if stamp.week is not None:
        kinds[stamp.week.index] = pa.float64()
    return kinds


def _first(layout: Layout, column: Column) -> str:
    """Return the first number of a column."""
    return next((cell for cell in layout.cells(column.index) if is_number(cell)), "nan")


def _week_clock(layout: Layout, stamp: Stamp, *, fast: bool) -> Clock | None:
    """Return a clock of GPS weeks and times of week; None for a log without these."""
    if stamp.week is None:
        return None
    column = stamp.columns[0]
    week, value = float(_first(layout, stamp.week)), float(_first(layout, column))
    measure = column.unit or _unit_of_week(layout, column, fast=fast)
    if not (0 <= week < LATEST_WEEK and measure is not None and 0 <= value * measure.factor < WEEK_END):
        return None
    stamp = replace(stamp, columns=(replace(column, unit=measure), *stamp.columns[1:]))
    ahead = leap_seconds(int(week), int(value * measure.factor * 1000))
    note = Note("gps_time", f"GPS week and time of week converted to UTC with {ahead} leap seconds")
    return Clock("unix", stamp, _kinds(layout, stamp), notes=(note,), ahead=ahead)


def _unit_of_week(layout: Layout, column: Column, *, fast: bool) -> Unit | None:
    """Return the longest unit in which a time lies within the week, and its steps are not too long; None if there is none."""
    numbers = [float(cell) for cell in layout.cells(column.index) if is_number(cell)]
    steps = sorted(b - a for a, b in pairwise(numbers) if b > a)
    step = steps[len(steps) // 2] if fast and steps else 0.0
    fitting = [unit(name) for name in DIGITS if numbers and numbers[0] * unit(name).factor < WEEK_END]
    return next((measure for measure in fitting if step * measure.factor <= LONGEST_STEP), next(iter(fitting), None))


def _number_clock(path: Path, layout: Layout, stamp: Stamp, options: ReadOptions) -> Clock:
    """Return a clock of numbers in a unit of time."""
    column = stamp.columns[0]
    value, notes = float(_first(layout, column)), list[Note]()
    measure = unit(options.units["time"]) if "time" in options.units and len(stamp.columns) == 1 else column.unit
    if measure is None:
        measure = next((u for u in map(unit, DIGITS) if OUR_DAYS[0] < value * u.factor < OUR_DAYS[1]), None)
        if measure is None:
            raise UsageError(
                f"{path}: the unit of time column {column.name!r} is unknown (its first number is {value:g}); "
                "state it: --units time=s (or ms, us, ns)"
            )
        text = f"time column {column.name!r} taken as {measure.name} since 1970, by the size of its first number"
        notes.append(Note("time_unit_guessed", text))
    if abs(value) * measure.factor * SECOND > LATEST:
        likely = next((u for u in map(unit, DIGITS) if OUR_DAYS[0] < value * u.factor < OUR_DAYS[1]), unit("ns"))
        raise UsageError(
            f"{path}: time column {column.name!r} is taken in {measure.name}, in which its first number, {value:g}, is later than the year "
            f"2262; its unit is likely {likely.name}: --units time={likely.name}"
        )
    epoch, ahead = options.epoch or "log", 0
    if options.epoch is None and OUR_DAYS[0] < value * measure.factor < OUR_DAYS[1]:
        epoch, ahead = "unix", _ahead_of_utc(replace(column, name=stamp.name), value * measure.factor, notes)
    stamp = replace(stamp, week=None, columns=(replace(column, unit=measure), *stamp.columns[1:]))
    clock = Clock(epoch, stamp, _kinds(layout, stamp), notes=tuple(notes), ahead=ahead)
    return _tagged(clock, path, layout) if options.epoch is None and epoch == "log" else clock


def _tagged(clock: Clock, path: Path, layout: Layout) -> Clock:
    """Return a clock with the time tag beside the log, if there is one that fits."""
    column = cast("Stamp", clock.stamp).columns[0]
    tag = tag_clock(path, column.index, layout.delimiter, cast("Unit", column.unit).factor)
    if tag is None:
        return clock
    if isinstance(tag, Note):
        return replace(clock, notes=(*clock.notes, tag))
    return replace(clock, epoch="unix", notes=(*clock.notes, tag.note), tag=tag)


def _ahead_of_utc(column: Column, seconds: float, notes: list[Note]) -> int:
    """Return the seconds that a column of times since 1970 is ahead of UTC, and add a note on its time scale."""
    scale = scale_of(column)
    if scale == "GPS":
        ahead = ahead_of_utc(datetime.fromtimestamp(seconds, UTC))
        text = (
            f"time column {column.name!r} is GPS time, as its name states; converted to UTC with {ahead} leap seconds"
        )
        notes.append(Note("gps_time", text))
        return ahead
    if scale is None:
        text = f"time column {column.name!r} taken as UTC: its name states no time scale"
        notes.append(Note("taken_as_utc", text))
    return 0
