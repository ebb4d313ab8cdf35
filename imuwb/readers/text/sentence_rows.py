"""The cells of one kind of sentence as the streams that they make up, in SI and FRD."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.errors import UnreadableLogError, UsageError
from imuwb.log import BY_FILTER, MEAN_SEA_LEVEL, Kind, Origin
from imuwb.readers.batch import Batch
from imuwb.readers.gps_time import unix_of_gps
from imuwb.readers.quantities import units_text
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.clock import LATEST, OUR_DAYS
from imuwb.readers.text.column_names import Column
from imuwb.readers.text.csv_streams import heights_above_sea, streams_of
from imuwb.readers.text.gravity import check_gravity
from imuwb.readers.text.increments import RATES, Increments
from imuwb.readers.text.sentence_lines import Line
from imuwb.readers.text.shapes.application import shaped
from imuwb.readers.text.shapes.recognition import Head
from imuwb.readers.text.shapes.sentence import Sentence, sentences
from imuwb.readers.text.trust import is_number
from imuwb.units import SECOND, Epoch, Unit, unit, unix_nanoseconds

#: unit of a time -> its decimals down to 1 ns
_DIGITS = {"s": 9, "ms": 6, "us": 3, "ns": 0}
LONGEST = 20  #: digits of a whole number that may fit into int64
DEG_S, MILLI_G = "deg/s", "mg"


@dataclass(frozen=True, slots=True)
class Row:
    """One sentence that is used."""

    cells: tuple[str, ...]
    stamp: str  #: a host's time before the sentence


class SentenceRows:
    """The rows of one kind of sentence, and of one type of IMU."""

    def __init__(
        self, path: Path, sentence: Sentence, options: ReadOptions, name: str, device: str, offset: int | None = None
    ) -> None:
        """Find the columns.

        Args:
            path: the log.
            sentence: what its cells mean.
            options: what the user states.
            name: of the streams; empty: their kind.
            device: type of the IMU.
            offset: ns since 1970 of the zero of a clock that counts from power-up; None: unknown.

        Raises:
            UsageError: the scale or the unit of the numbers is unknown.
        """
        found = shaped(sentence.shape, Head("", "", (), ()), options)
        self.sentence, self._path, self._options, self._name = sentence, path, options, name
        self._columns = found.columns if not sentence.scale else _scaled(path, sentence, found.columns, device)
        lacking = list(
            dict.fromkeys(
                c.quantity for c in self._columns if c.unit is None and c.quantity in ("gyro", "accel", *RATES)
            )
        )
        if lacking:
            raise UsageError(
                f"{path}: {sentence.tags[0]} does not state the unit of {' and '.join(lacking)}; state it: --units "
                f"{','.join(f'{quantity}=UNIT' for quantity in lacking)}"
            )
        self._frame = (
            f"{options.frame} (stated)" if options.frame else found.frame and f"{found.frame} ({sentence.shape.name})"
        )
        self._increments, self._checked, self._count = Increments(), False, 0
        self._offset = offset
        self._epoch: Epoch = self._epoch_of(options)

    def batches(self, rows: Sequence[Row], bytes_read: int) -> Iterator[Batch]:
        """Yield the streams of some rows.

        Raises:
            UsageError: the rows have no time, and no rate is stated.
            UnreadableLogError: the specific force is not of the size of gravity.
        """
        time, timed = self._time(rows)
        values = {column: _numbers([row.cells[column.index] for row in rows])[timed] for column in self._columns if column.quantity not in ("time", "week")}  # fmt: skip
        for kind, fields, part in streams_of(self._increments.as_rates(time, values), self._options.frame or "FRD"):
            if not self._checked and "specific_force" in fields:
                columns = tuple(self._increments.as_rates(time[:0], {c: v[:0] for c, v in values.items()}))
                self._checked = check_gravity(self._path, fields["specific_force"], columns)
            kept = fields if part is None else {name: array[part] for name, array in fields.items()}
            at = time if part is None else time[part]
            yield Batch(self._name or kind, kind, at, kept, self._origin(kind), bytes_read)

    def _epoch_of(self, options: ReadOptions) -> Epoch:
        if any(column.quantity == "week" for column in self._columns):
            return "unix"
        return options.epoch or self.sentence.shape.epoch or "log"

    def _time(self, rows: Sequence[Row]) -> tuple[Integers, Booleans]:
        """Return the times, ns, of the rows that have one, and which rows these are."""
        column = next((c for c in self._columns if c.quantity == "time"), None)
        week = next((c for c in self._columns if c.quantity == "week"), None)
        if column is None:
            return self._untimed(rows)
        name = column.unit.name if column.unit is not None else "s"
        cells = [row.cells[column.index] for row in rows]
        times = [_date(cell) if "T" in cell else exact(cell, _DIGITS[name]) for cell in cells]
        if any("T" in cell for cell in cells):
            self._epoch = "unix"
        weeks = [1 if week is None else exact(row.cells[week.index], 0) for row in rows]
        timed = np.array([t is not None and w is not None for t, w in zip(times, weeks, strict=True)], dtype=bool)
        time = np.array([t for t, known in zip(times, timed, strict=True) if known], np.int64)
        if week is None:
            shifted = self._offset is not None and self._epoch == "boot"
            return time + (self._offset or 0) if shifted else time, timed
        number = np.array([w for w, known in zip(weeks, timed, strict=True) if known], np.int64)
        milliseconds, rest = np.divmod(time, 1_000_000)
        return unix_of_gps(number, milliseconds) + rest, timed

    def _untimed(self, rows: Sequence[Row]) -> tuple[Integers, Booleans]:
        """Return the times of rows without one: a host's stamps, or those of the stated rate."""
        if not self._options.rate and any(row.stamp for row in rows):
            times = [exact(row.stamp, _DIGITS["s"]) for row in rows]
            timed = np.array([time is not None for time in times], dtype=bool)
            known = [time for time in times if time is not None]
            self._epoch = "unix" if known and known[0] > OUR_DAYS[0] * SECOND else self._epoch
            return np.array(known, np.int64), timed
        if not self._options.rate:
            raise UsageError(
                f"{self._path}: {self.sentence.tags[0]} has no time, and no stamp stands before it; state --rate HZ"
            )
        number = np.arange(self._count, self._count + len(rows))
        self._count += len(rows)
        return np.rint(number * (SECOND / self._options.rate)).astype(np.int64), np.ones(len(rows), dtype=bool)

    def _origin(self, kind: Kind) -> Origin:
        quantities = ("gyro", "accel", *RATES) if kind == "imu" else ("latitude", "height", "height_msl")
        units = units_text((c.quantity, c.unit) for c in self._columns if c.quantity in quantities)
        shifted = self._epoch == "boot" and self._offset is not None
        epoch: Epoch = "unix" if shifted else self._epoch
        if kind == "imu":
            return Origin(units, self._frame, epoch)
        above = f" ({MEAN_SEA_LEVEL})" if heights_above_sea(self._columns) else ""
        return Origin(units + above, f"NED ({BY_FILTER})" if kind == "reference" else "NED", epoch)


def device_of(sentence: Sentence, line: Line) -> str:
    """Return the type of the IMU that a sentence states; empty if it states none."""
    return line.cells[sentence.device] if 0 <= sentence.device < len(line.cells) else ""


def exact(cell: str, digits: int) -> int | None:
    """Return a decimal number times ten to the power of ``digits``, as a whole number; None for another text, and beyond int64."""
    whole, _, fraction = cell.lstrip("+-").partition(".")
    if (whole + fraction).isdigit() and cell.isascii():
        number = int((whole[:LONGEST] + fraction[:digits].ljust(digits, "0")) or "0")
        if len(whole) > LONGEST or number >= LATEST:
            return None
        return -number if cell.startswith("-") else number
    if not is_number(cell) or "n" in cell.lower():
        return None
    value = float(cell) * 10**digits
    return round(value) if abs(value) < LATEST else None


def _date(cell: str) -> int | None:
    """Return an ISO date in ns since 1970 UTC; None for another text."""
    try:
        return unix_nanoseconds(datetime.fromisoformat(cell))
    except ValueError:
        return None


def _numbers(cells: Sequence[str]) -> Floats:
    try:
        return np.array(cells, dtype=np.float64)
    except ValueError:
        return np.array([float(cell) if is_number(cell) else np.nan for cell in cells])


def _scaled(path: Path, sentence: Sentence, columns: Sequence[Column], device: str) -> tuple[Column, ...]:
    """Return the columns of NovAtel's counts with the scale of a type of IMU."""
    known = sentences()
    number = int(device) if device.isdigit() else -1
    if number in known.increments:
        gyro, accel = known.increments[number]
        units = {
            "attitude_increment": Unit("counts", "angle", gyro),
            "velocity_increment": Unit("counts", "speed", accel),
        }
        return tuple(replace(c, unit=units.get(c.quantity, c.unit)) for c in columns)
    if number in known.rates:
        factors = dict(zip(("gyro", "accel"), known.rates[number], strict=True))
        units = {
            "gyro": Unit("counts", "angular_rate", factors["gyro"] * unit(DEG_S).factor),
            "accel": Unit("counts", "specific_force", factors["accel"] * unit(MILLI_G).factor),
        }
        rates = (replace(c, quantity=RATES.get(c.quantity, c.quantity)) for c in columns)
        return tuple(replace(c, unit=units.get(c.quantity, c.unit)) for c in rates)
    if device:
        raise UnreadableLogError(
            f"{path}: {sentence.tags[0]} is of an IMU of type {device}, whose scale factors are not known; log CORRIMUDATA's source "
            "in physical units, or convert the log with the maker's tool"
        )
    raise UsageError(
        f"{path}: {sentence.tags[0]} has counts, and does not state the type of the IMU, which decides their scale; log RAWIMUSX, "
        "which states it"
    )
