"""The time of a text log's rows: from a column of numbers or ISO dates, or from a rate."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pyarrow as pa

from imuwb.errors import UsageError
from imuwb.log import SECOND
from imuwb.readers.assembly.gps_time import ahead_of_utc, leap_seconds, unix_of_gps
from imuwb.readers.text.column_names import scale_of
from imuwb.readers.text.trust import is_number
from imuwb.units import unit

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from imuwb.log import Epoch
    from imuwb.readers.batch import ReadOptions
    from imuwb.readers.text.column_names import Column
    from imuwb.readers.text.lines import Layout

LONGEST_WEEK = 604_801_000  #: ms
LATEST_WEEK = 10_000  #: of GPS: the year 2171
LATEST = 2**63 - 1025  #: ns, the largest a float holds below the end of int64
DIGITS = {"s": 9, "ms": 6, "us": 3, "ns": 0}  #: behind the point, down to 1 ns
_ISO = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d")
_ZONE = re.compile(r"(Z|[+-]\d\d(:?\d\d)?)$")


@dataclass(frozen=True, slots=True)
class Clock:
    """How a row's time is found."""

    column: Column | None  #: None: from the rate
    kind: pa.DataType  #: that the column is parsed as
    rate: float  #: Hz
    epoch: Epoch
    remarks: tuple[str, ...] = ()
    week: Column | None = None  #: of GPS; the column then holds seconds of it
    ahead: int = 0  #: s, of GPS time over UTC, through the whole log

    def time(self, block: pa.RecordBatch, first_row: int) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return the time in ns of the rows that have one, and which those are."""
        if self.column is None:
            row = np.arange(first_row, first_row + block.num_rows)
            return np.rint(row * (SECOND / self.rate)).astype(np.int64), np.ones(row.size, dtype=bool)
        cells = cast("pa.Array[Any]", block.column(self.column.name))
        there = np.asarray(cells.is_valid()).copy()
        time, inside = self._nanoseconds(cells.drop_null())
        there[there] = inside
        time = time[inside]
        if self.week is not None:
            weeks = np.asarray(block.column(self.week.name).to_numpy(zero_copy_only=False), np.float64)[there]
            known = (weeks >= 0) & (weeks < LATEST_WEEK)
            there[there] = known
            time = (
                unix_of_gps(weeks[known].astype(np.int64), time[known] // 1_000_000, self.ahead)
                + time[known] % 1_000_000
            )
        elif self.ahead:
            time = time - self.ahead * SECOND
        return time, there

    def _nanoseconds(self, cells: pa.Array[Any]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return cells as ns, and which of them are a time that int64 holds."""
        if pa.types.is_timestamp(cells.type):
            return np.asarray(cells.cast(pa.int64())), np.ones(len(cells), dtype=bool)
        if pa.types.is_decimal(cells.type):
            # Below a decimal lies a 128-bit integer, here in ns: exact, where a float has 200 ns steps in Unix time.
            words = np.frombuffer(cast("Any", cells.buffers()[1]), "<i8").reshape(-1, 2)
            low, high = words[cells.offset : cells.offset + len(cells)].T
            return low, high == low >> 63
        with np.errstate(over="ignore"):
            numbers = np.asarray(cells) * (cast("Any", self.column).unit.factor * SECOND)
        inside = np.isfinite(numbers) & (np.abs(numbers) < LATEST)
        return np.rint(np.where(inside, numbers, 0.0)).astype(np.int64), inside


def clock_of(path: Path, layout: Layout, used: tuple[Column, ...], options: ReadOptions) -> Clock:
    """Return how the rows of a log are timed.

    Raises:
        UsageError: neither a time column nor a rate, or a time column in a unit that nobody says.
    """
    column = next((column for column in used if column.quantity == "time"), None)
    if column is None:
        if not options.rate:
            message = f"{path}: no time column (columns: {', '.join(c.name for c in used)}); say the rate: --rate HZ"
            raise UsageError(message)
        return Clock(None, pa.null(), options.rate, cast("Epoch", options.epoch or "log"))
    remarks = ("--rate not used: the file has a time column",) if options.rate else ()
    first = layout.first[column.index].strip().strip('"')
    if _ISO.match(first):
        return Clock(column, pa.timestamp("ns", "UTC" if _ZONE.search(first) else None), 0.0, "unix", remarks)
    if not is_number(first):
        message = f"{path}: {first!r} in time column {column.name!r} is neither a number nor an ISO time"
        raise UsageError(message)
    value = float(first)
    week = next((one for one in used if one.quantity == "week"), None)
    weeks = layout.first[week.index].strip() if week is not None else ""
    if week is not None and is_number(weeks) and 0 <= float(weeks) < LATEST_WEEK and value < LONGEST_WEEK:
        if column.unit is None:
            column = replace(column, unit=unit("s" if value < 700_000 else "ms"))  # noqa: PLR2004 - a week has 604 800 s
        remarks = (*remarks, "GPS week and time of week made UTC by the leap seconds of the date")
        kind = (
            pa.decimal128(28, 9) if cast("Any", column.unit).name == "s" and "e" not in first.lower() else pa.float64()
        )
        milliseconds = value * cast("Any", column.unit).factor * 1000
        return Clock(column, kind, 0.0, "unix", remarks, week, leap_seconds(int(float(weeks)), int(milliseconds)))
    if column.unit is None:
        column = replace(column, unit=unit(_unit_by_size(path, column, value, first)))
        remarks = (
            *remarks,
            f"time column {column.name!r} taken as {cast('Any', column.unit).name} since 1970, as its size tells",
        )
    named = cast("Any", column.unit)
    epoch, ahead, said = _counted_from(column, value * named.factor, cast("Epoch | None", options.epoch))
    remarks = (*remarks, *said)
    whole = named.name in DIGITS and "e" not in first.lower()
    behind = len(first.partition(".")[2])
    kind = pa.decimal128(28, DIGITS[named.name]) if whole and behind <= DIGITS[named.name] else pa.float64()
    return Clock(column, kind, 0.0, epoch, remarks, ahead=ahead)


def _counted_from(column: Column, seconds: float, said: Epoch | None) -> tuple[Epoch, int, tuple[str, ...]]:
    """Return where a column's times count from, the leap seconds that they are ahead of UTC, and what is to be told of it."""
    if said is not None:
        return said, 0, ()
    if not 5e8 < seconds < 3e9:  # noqa: PLR2004 - 1985 to 2065
        return "log", 0, ()
    scale = scale_of(column)
    if scale == "GPS":
        ahead = ahead_of_utc(datetime.fromtimestamp(seconds, UTC))
        return (
            "unix",
            ahead,
            (f"time column {column.name!r} is GPS time, as its name says: made UTC by {ahead} leap seconds",),
        )
    told = () if scale == "UTC" else (f"time column {column.name!r} taken as UTC: its name says no time scale",)
    return "unix", 0, told


def _unit_by_size(path: Path, column: Column, value: float, first: str) -> str:
    """Return the unit in which ``value`` is a time of our days since 1970."""
    since_1970 = {"s": 1e9, "ms": 1e12, "us": 1e15, "ns": 1e18}
    for name, size in since_1970.items():
        if 0.5 < value / size < 3:  # noqa: PLR2004 - 1985 to 2065
            return name
    message = (
        f"{path}: nobody says the unit of time column {column.name!r} (its first value is {first}); "
        "add --units time=s (or ms, us, ns)"
    )
    raise UsageError(message)
