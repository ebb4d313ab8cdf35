"""The streams of a DataFlash log, from the tables of its records."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Booleans, Floats
from imuwb.errors import UnreadableLogError
from imuwb.log import MEAN_SEA_LEVEL, Epoch, Nanoseconds, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.flight import trajectory
from imuwb.readers.flight.dataflash_batches import high_rate
from imuwb.readers.flight.dataflash_records import FMT_SIZE, formats
from imuwb.readers.flight.dataflash_tables import Tables
from imuwb.readers.flight.dataflash_text import TextTables
from imuwb.readers.flight.dataflash_units import si_factors
from imuwb.readers.flight.left_out import dataflash_left_out
from imuwb.readers.flight.settings import settings_of
from imuwb.readers.gps_time import unix_of_gps
from imuwb.sampling import nearest

Columns = Mapping[str, NDArray[Any]]

IMUS, RECEIVERS, ACCURACIES = ("IMU", "IMU2", "IMU3"), ("GPS", "GPS2"), ("GPA", "GPA2")
#: single sensors at their full rate, of one IMU: accelerometer and gyro, now with an instance, earlier with a number
SENSORS = (("ACC", "GYR"), ("ACC1", "GYR1"), ("ACC2", "GYR2"), ("ACC3", "GYR3"))
SOLUTIONS = ("XKF1", "NKF1", "EKF1")
WANTED = {
    *IMUS, *RECEIVERS, *ACCURACIES, *SOLUTIONS, *(name for pair in SENSORS for name in pair),
    "POS", "ATT", "ISBH", "ISBD", "FMTU", "UNIT", "MULT", "PARM",
}  # fmt: skip
DESCRIPTIONS = ("FMT", "FMTU", "UNIT", "MULT")  #: records about records
HOTTEST = 300.0  #: °C; a temperature beyond is damage
FASTEST, STRONGEST = 200.0, 5000.0  #: rad/s and m/s²; a sample beyond is damage
NEAR = 500_000_000  #: ns; a fix takes an accuracy whose time differs by less
FIXED = 3  #: least status of a fix in three dimensions
WEEKS = (1000, 5000)  #: GPS weeks of 1999 and 2075; a receiver with a week outside does not know the week
IMU_UNITS, POSITION_UNITS = "rad/s, m/s²", f"deg, m ({MEAN_SEA_LEVEL}), m/s"
_TRIADS = {"angular_rate": ("GyrX", "GyrY", "GyrZ"), "specific_force": ("AccX", "AccY", "AccZ")}


def streamed(path: Path, *, binary: bool) -> Iterator[Batch | Remark]:
    """Yield the streams of a log.

    Raises:
        UnreadableLogError: the file has no whole record.
    """
    notes: list[str] = []
    tables = _binary_tables(path, notes) if binary else _text_tables(path, notes)
    if not tables.records:
        raise UnreadableLogError(
            f"{path}: no record has one of the formats that the file describes; it is cut or damaged"
        )
    yield from batches_of(tables, notes, path.stat().st_size)


def batches_of(tables: Tables | TextTables, notes: Iterable[str], size: int) -> Iterator[Batch | Remark]:
    """Yield the streams of records.

    Args:
        tables: the records.
        notes: on the faults of the file.
        size: bytes of the file.
    """
    yield from (Remark(note) for note in (*notes, *_layout_notes(tables)))
    streams = _Streams(tables, size)
    yield from streams.all()
    yield from dataflash_left_out(tables.counts, tables.labels, streams.used)


def _binary_tables(path: Path, notes: list[str]) -> Tables:
    known: dict[int, Any] = {}
    tail = b""
    with source.open_unpacked(path) as file:
        for block, _ in source.blocks(file, []):  # the second reading adds the notes on faults
            data = tail + block
            known = {**formats(np.frombuffer(data, np.uint8)), **known}
            tail = data[-FMT_SIZE:]  # a record may lie across the edge of two blocks
    tables, rest = Tables(known, WANTED), b""
    with source.open_unpacked(path) as file:
        for block, last in source.blocks(file, notes):
            data = rest + block
            rest = data[tables.take(np.frombuffer(data, np.uint8), last=last) :]
    if tables.skipped:
        notes.append(Note("no_record", f"{tables.skipped} bytes that belong to no record left out"))
    return tables


def _text_tables(path: Path, notes: list[str]) -> TextTables:
    tables, fault = TextTables(WANTED - {"ISBD"}), source.packed_fault(path)
    with source.open_unpacked(path) as file:
        for block, last in source.lines(source.pieces(file, notes)):
            tables.take(block.split(b"\n")[: None if last else -1], to_first_bad=bool(fault))
            if fault and tables.bad:
                notes.append(source.damaged(fault, "everything from the first odd line on is left out"))
                return tables
    if tables.bad:
        notes.append(Note("bad_line", f"{tables.bad} lines left out: they are cut, or have text in place of numbers"))
    return tables


def _layout_notes(tables: Tables | TextTables) -> Iterator[Note]:
    """Yield a note for each used record that the log describes in several ways."""
    for name in sorted(WANTED):
        labels = tables.labels_of(name)
        if len(labels) > 1:
            listed = "; ".join(",".join(one) for one in labels)
            yield Note(
                "several_layouts", f"{name} records have {len(labels)} layouts, and each is read by its own: {listed}"
            )


class _Streams:
    """Makes batches from the tables of records."""

    def __init__(self, tables: Tables | TextTables, size: int) -> None:
        self._tables, self._size = tables, size
        self.used: set[str] = {*DESCRIPTIONS}  #: names of the records that are used
        fields = {field for triad in _TRIADS.values() for field in triad}
        self._factors = {key: factor for key, factor in si_factors(tables).items() if key[1] in fields}
        self._offset = self._unix_offset()
        self._epoch: Epoch = "boot" if self._offset is None else "unix"
        self._imu_origin = Origin(IMU_UNITS, "FRD", self._epoch)
        self._position_origin = Origin(POSITION_UNITS, "NED", self._epoch)

    def all(self) -> Iterator[Batch | Remark]:
        """Yield all streams, then a note on the clock."""
        for name in IMUS:
            for stream, columns in self._instances(name):
                yield from self._imu(stream, columns)
        yield from self._single_sensors()
        yield from self._high_rate()
        for name, accuracy in zip(RECEIVERS, ACCURACIES, strict=True):
            accuracies = dict(self._instances(accuracy))
            for stream, columns in self._instances(name):
                yield from self._receiver(stream, columns, accuracies.get(stream.replace(name, accuracy)))
        yield from self._solution()
        yield (settings := settings_of(self._tables.stated()))
        self.used |= {"PARM"} if settings.settings else set()
        if self._offset is None:
            yield Remark(Note("no_date", "times count from power-up: no fix states the date"))
        else:
            text = "times since power-up converted to UTC with the receiver's week and time of week"
            yield Remark(Note("utc_by_receiver", text))

    def _table(self, name: str) -> Columns | None:
        """Return the columns of a kind of record; None if the log has no such record, or none with a time."""
        table = self._tables.table(name, self._factors)
        if table is None:
            return None
        if name not in ("ISBH", "ISBD"):  # a damaged format may state arrays where there are none
            table = {key: column for key, column in table.items() if column.ndim == 1}
        return table if "TimeUS" in table or "TimeMS" in table else None

    def _instances(self, name: str) -> Iterator[tuple[str, Columns]]:
        """Yield a record's rows by instance."""
        table = self._table(name)
        if table is None:
            return
        if "I" not in table:
            yield name, table
            return
        instance = table["I"].astype(np.float64)
        for one in np.unique(instance):  # nan: records of a layout without an instance
            rows = np.isnan(instance) if np.isnan(one) else instance == one
            stream = name if np.isnan(one) else f"{name}.{int(one)}"
            yield stream, {key: column[rows] for key, column in table.items()}

    def _boot(self, columns: Columns) -> Nanoseconds:
        """Return the time since power-up."""
        # TimeMS of an old fix is its time of week
        old = columns.get("T" if {"Week", "T"} <= columns.keys() else "TimeMS")
        ticks = columns.get("TimeUS")
        if ticks is None or (old is not None and np.isnan(ticks).any()):  # of records in two layouts, some have each
            assert old is not None  # noqa: S101 - _table has checked
            ticks = old.astype(np.float64) * 1000 if ticks is None else np.where(np.isnan(ticks), old * 1000.0, ticks)
        return _microseconds(ticks)

    def _time(self, columns: Columns) -> Nanoseconds:
        return self._boot(columns) + (self._offset or 0)

    def _unix_offset(self) -> int | None:
        """Return the offset (ns) of Unix time from the time since power-up; None if no fix states the date."""
        offsets = [np.empty(0, np.int64)]
        for table in filter(None, map(self._table, RECEIVERS)):
            week, milliseconds = _either(table, "GWk", "Week"), _either(table, "GMS", "TimeMS")
            if week is None or milliseconds is None or not ("TimeUS" in table or "T" in table):
                continue
            first, last = WEEKS
            dated = (week > first) & (week < last) & np.isfinite(milliseconds)
            dated &= table.get("Status", np.full(week.size, FIXED)) >= FIXED
            unix = unix_of_gps(week[dated].astype(np.int64), milliseconds[dated].astype(np.int64))
            offsets.append(unix - self._boot(table)[dated])
        every = np.concatenate(offsets)
        return int(np.median(every)) if every.size else None

    def _imu(self, stream: str, columns: Columns) -> Iterator[Batch | Remark]:
        if not all(field in columns for fields in _TRIADS.values() for field in fields):
            text = f"{stream}: not used: it lacks an axis of the gyro or the accelerometer"
            yield Remark(Note("missing_axis", text))
            return
        self.used.add(stream.partition(".")[0])
        values = {key: trajectory.triples(columns, fields) for key, fields in _TRIADS.items()}
        possible = _possible(values)
        yield from _impossible(stream, possible)
        time, origin = self._time(columns), self._imu_origin
        if possible.any():
            yield Batch(
                stream,
                "imu",
                time[possible],
                {k: v[possible] for k, v in values.items()},
                origin,
                self._size,
                exact=True,
            )
        temperature = columns.get("T")
        if temperature is not None and temperature.any():
            rows = possible & (np.abs(temperature) < HOTTEST)
            yield Batch(
                stream,
                "imu",
                time[rows],
                {"temperature": temperature[rows].astype(float)},
                origin,
                self._size,
                exact=True,
            )

    def _single_sensors(self) -> Iterator[Batch | Remark]:
        """Yield accelerometers and gyros that are logged at their full rate, each with the clock of its samples."""
        for names in SENSORS:
            for name, key in zip(names, ("specific_force", "angular_rate"), strict=True):
                for stream, columns in self._instances(name):
                    if not set(_TRIADS[key]) <= columns.keys():
                        yield Remark(Note("missing_axis", f"{stream}: not used: it lacks an axis"))
                        continue
                    self.used.add(name)
                    imu = "+".join(stream.replace(name, one) for one in names)
                    values = {key: trajectory.triples(columns, _TRIADS[key])}
                    possible = _possible(values)
                    yield from _impossible(imu, possible)
                    sampled = columns.get("SampleUS", np.zeros(1))
                    time = _microseconds(sampled) + (self._offset or 0) if sampled.all() else self._time(columns)
                    if possible.any():
                        kept = {key: values[key][possible]}
                        yield Batch(imu, "imu", time[possible], kept, self._imu_origin, self._size, exact=True)

    def _high_rate(self) -> Iterator[Batch | Remark]:
        heads, data = self._table("ISBH"), self._table("ISBD")
        if heads is not None and data is not None:
            self.used |= {"ISBH", "ISBD"}
            yield from high_rate(heads, data, self._offset or 0, self._imu_origin, self._size)

    def _receiver(self, stream: str, columns: Columns, accuracy: Columns | None) -> Iterator[Batch | Remark]:
        if not {"Lat", "Lng", "Alt", "Spd"} <= columns.keys():
            return
        self.used |= {stream.partition(".")[0], *(ACCURACIES if accuracy is not None else ())}
        unknown = np.full(columns["Lat"].size, np.nan)
        fields = {name: columns.get(name, unknown).astype(float) for name in ("Spd", "GCrs", "VZ", "Status")}
        if "VZ" in columns and accuracy is not None and "VV" in accuracy:  # whether there is a vertical velocity
            fields["VZ"] = np.where(np.isnan(self._accuracies(columns, accuracy, "VV")), np.nan, fields["VZ"])
        sigmas = {name: self._accuracies(columns, accuracy, name) for name in ("HAcc", "VAcc", "SAcc")}
        known = {
            "position": trajectory.positions(columns["Lat"], columns["Lng"], columns["Alt"]),
            "velocity": trajectory.velocities(fields["Spd"], fields["GCrs"], fields["VZ"]),
            "position_sigma": trajectory.sigmas(sigmas["HAcc"], sigmas["VAcc"]),
            "velocity_sigma": trajectory.sigmas(sigmas["SAcc"], sigmas["SAcc"]),
            "fix_type": trajectory.fix_types(fields["Status"]),
        }
        yield from trajectory.located(stream, "gnss", self._time(columns), known, self._position_origin, self._size)

    def _accuracies(self, fixes: Columns, accuracy: Columns | None, name: str) -> Floats:
        """Return the accuracy of each fix, nearest in time; nan if none is near."""
        if accuracy is None or name not in accuracy:
            return np.full(fixes["Lat"].size, np.nan)
        time, at = self._boot(fixes), self._boot(accuracy)
        rows = nearest(time, at)
        values = accuracy[name][rows].astype(float)
        return np.where((np.abs(at[rows] - time) < NEAR) & (values > 0), values, np.nan)

    def _solution(self) -> Iterator[Batch | Remark]:
        """Yield the navigation solution: position, with velocity and attitude of other records."""
        place = self._table("POS")
        if place is None or not {"Lat", "Lng", "Alt"} <= place.keys():
            return
        self.used.add("POS")
        boot = self._boot(place)
        columns = {"position": trajectory.positions(place["Lat"], place["Lng"], place["Alt"])}
        names = ("VN", "VE", "VD")
        for name in SOLUTIONS:
            table = self._table(name)
            if table is not None and set(names) <= table.keys():
                self.used.add(name)
                rows = table["C"] == table["C"][0] if "C" in table else np.ones(table["VN"].size, dtype=bool)
                columns["velocity"] = trajectory.interpolated(
                    boot, self._boot(table)[rows], trajectory.triples(table, names)[rows]
                )
                break
        attitude = self._table("ATT")
        if attitude is not None and {"Roll", "Pitch", "Yaw"} <= attitude.keys():
            self.used.add("ATT")
            angles = np.radians(trajectory.triples(attitude, ("Roll", "Pitch", "Yaw")))
            columns |= trajectory.attitudes(boot, self._boot(attitude), angles)
        origin = Origin(POSITION_UNITS, trajectory.ESTIMATED, self._epoch)
        yield from trajectory.located("POS", "reference", self._time(place), columns, origin, self._size)


def _microseconds(ticks: NDArray[Any]) -> Nanoseconds:
    """Return microseconds as nanoseconds; a damaged number becomes a time that later is found to be impossible."""
    if ticks.dtype.kind == "f":
        ticks = np.nan_to_num(ticks)
    return ticks.clip(0, 2**62 // 1000).astype(np.int64) * 1000


def _either(table: Columns, name: str, other: str) -> NDArray[Any] | None:
    """Return a column, and where it is missing or nan the other; None if the table has neither."""
    first, second = table.get(name), table.get(other)
    if first is None or second is None:
        return second if first is None else first
    return np.where(np.isnan(first), second, first)


def _possible(values: Mapping[str, Floats]) -> Booleans:
    """Return which rows a sensor can have measured."""
    limits = {"angular_rate": FASTEST, "specific_force": STRONGEST}
    return np.all([(np.abs(columns) < limits[key]).all(axis=1) for key, columns in values.items()], axis=0)


def _impossible(stream: str, possible: Booleans) -> Iterator[Remark]:
    if not possible.all():
        note = Note("impossible_value", "rows with values beyond any sensor's range left out")
        yield Remark(note, stream, int(np.count_nonzero(~possible)))
