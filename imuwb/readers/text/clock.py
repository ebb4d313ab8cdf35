"""The time of a text log's rows: from a column of numbers or ISO dates, or from a rate."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from datetime import UTC, datetime
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
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.time_tag import TagClock, tag_clock
from imuwb.readers.text.trust import is_number
from imuwb.units import SECOND, Epoch, Unit, unit

Times = tuple[Integers, Booleans]

WEEK_END = 604_801  #: s; no time of a GPS week is later, not even with a leap second
LATEST_WEEK = 10_000  #: GPS week of the year 2171
LATEST = 2**63 - 1025  #: ns, the largest double below the end of int64
OUR_DAYS = (5e8, 3e9)  #: s since 1970 (years 1985 and 2065); a time in between counts from 1970
DIGITS = {"s": 9, "ms": 6, "us": 3, "ns": 0}  #: decimals of each unit, down to 1 ns
_ISO = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d")
_ZONE = re.compile(r"(Z|[+-]\d\d(:?\d\d)?)$")


@dataclass(frozen=True, slots=True)
class Clock:
    """How the time of a row is found."""

    column: Column | None  #: None: the time comes from the rate
    kind: pa.DataType  #: type of the parsed column
    epoch: Epoch
    rate: float = 0.0  #: Hz
    notes: tuple[Note, ...] = ()
    week: Column | None = None  #: GPS week; the column is then the time of week
    ahead: int = 0  #: s by which GPS time is ahead of UTC in the whole log
    tag: TagClock | None = None  #: of a log with a time tag

    def time(self, block: pa.RecordBatch, first_row: int) -> Times:
        """Return the time (ns) of the rows that have one, and which rows these are."""
        if self.column is None:
            row = np.arange(first_row, first_row + block.num_rows)
            return np.rint(row * (SECOND / self.rate)).astype(np.int64), np.ones(row.size, dtype=bool)
        stamps = block.column(self.column.name)
        time, possible = _nanoseconds(stamps, self.column.unit)
        timed = possible & cells.known(stamps)
        if self.tag is not None:
            return self.tag.unix(time[timed]), timed
        if self.week is None:
            return time[timed] - self.ahead * SECOND, timed
        weeks = cells.floats(block.column(self.week.name))
        timed &= (weeks >= 0) & (weeks < LATEST_WEEK)
        milliseconds, rest = np.divmod(time[timed], 1_000_000)
        return unix_of_gps(weeks[timed].astype(np.int64), milliseconds, self.ahead) + rest, timed


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


def clock_of(path: Path, layout: Layout, used: tuple[Column, ...], options: ReadOptions) -> Clock:
    """Return how the rows of a log are timed.

    Raises:
        UsageError: there is neither a time column nor a rate, or the unit of the time column is unknown.
    """
    column = next((column for column in used if column.quantity == "time"), None)
    if column is None:
        if not options.rate:
            raise UsageError(
                f"{path}: there is no time column among {', '.join(c.name for c in used)}; state --rate HZ"
            )
        return Clock(None, pa.null(), options.epoch or "log", options.rate)
    first = layout.first[column.index].strip().strip('"')
    if _ISO.match(first):
        return Clock(column, pa.timestamp("ns", "UTC" if _ZONE.search(first) else None), "unix")
    if not is_number(first):
        raise UsageError(f"{path}: time column {column.name!r} has {first!r}; it must be a number or an ISO date")
    return _week_clock(layout, used, column, first) or _number_clock(path, layout, column, first, options)


def _week_clock(layout: Layout, used: tuple[Column, ...], column: Column, first: str) -> Clock | None:
    """Return a clock of GPS weeks and times of week; None for a log without these."""
    week = next((column for column in used if column.quantity == "week"), None)
    number = layout.first[week.index].strip() if week is not None else ""
    value = float(first)
    if not (is_number(number) and 0 <= float(number) < LATEST_WEEK and value < WEEK_END * 1000):
        return None
    measure = column.unit or unit("s" if value < WEEK_END else "ms")
    kind = pa.decimal128(28, 9) if measure.name == "s" and "e" not in first.lower() else pa.float64()
    ahead = leap_seconds(int(float(number)), int(value * measure.factor * 1000))
    note = Note("gps_time", f"GPS week and time of week converted to UTC with {ahead} leap seconds")
    return Clock(replace(column, unit=measure), kind, "unix", notes=(note,), week=week, ahead=ahead)


def _number_clock(path: Path, layout: Layout, column: Column, first: str, options: ReadOptions) -> Clock:
    """Return a clock of numbers in a unit of time."""
    value, notes = float(first), list[Note]()
    measure = column.unit
    if measure is None:
        measure = next((u for u in map(unit, DIGITS) if OUR_DAYS[0] < value * u.factor < OUR_DAYS[1]), None)
        if measure is None:
            raise UsageError(
                f"{path}: the unit of time column {column.name!r} is unknown (its first number is {value:g}); "
                "state it: --units time=s (or ms, us, ns)"
            )
        text = f"time column {column.name!r} taken as {measure.name} since 1970, by the size of its first number"
        notes.append(Note("time_unit_guessed", text))
    epoch, ahead = options.epoch or "log", 0
    if options.epoch is None and OUR_DAYS[0] < value * measure.factor < OUR_DAYS[1]:
        epoch, ahead = "unix", _ahead_of_utc(column, value * measure.factor, notes)
    decimals = len(first.partition(".")[2])
    exact = measure.name in DIGITS and "e" not in first.lower() and decimals <= DIGITS[measure.name]
    kind = pa.decimal128(28, DIGITS[measure.name]) if exact else pa.float64()
    clock = Clock(replace(column, unit=measure), kind, epoch, notes=tuple(notes), ahead=ahead)
    return _tagged(clock, path, layout) if options.epoch is None and epoch == "log" else clock


def _tagged(clock: Clock, path: Path, layout: Layout) -> Clock:
    """Return a clock with the time tag beside the log, if there is one that fits."""
    column = cast("Column", clock.column)
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
