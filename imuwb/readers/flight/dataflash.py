"""ArduPilot's logs, binary (.bin) and as text (.log): every IMU, receiver and high-rate batch, and the solution."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.log import MEAN_SEA_LEVEL, Origin
from imuwb.readers.assembly.gps_time import unix_of_gps
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.flight.dataflash_records import FMT, FMT_SIZE, HEAD, Tables, formats
from imuwb.readers.flight.dataflash_text import TextTables
from imuwb.readers.flight.receiver import GpsRows, attitude_at, gps_columns, left_out, usable_fixes, usable_position
from imuwb.readers.text.trust import DAMAGED
from imuwb.units import UNITS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from imuwb.log import Epoch
    from imuwb.readers.batch import ReadOptions

    Columns = Mapping[str, NDArray[Any]]

format = "dataflash"  # noqa: A001 - the contract's name
uses: tuple[str, ...] = ()
IMUS, RECEIVERS, ACCURACIES = ("IMU", "IMU2", "IMU3"), ("GPS", "GPS2"), ("GPA", "GPA2")
SOLUTIONS = ("XKF1", "NKF1", "EKF1")
WANTED = {*IMUS, *RECEIVERS, *ACCURACIES, *SOLUTIONS, "POS", "ATT", "ISBH", "ISBD", "FMTU", "UNIT", "MULT"}
HOTTEST = 300.0  #: °C
FULL_TURNS = 1000.0  #: rad; an angle beyond is a damaged record
FASTEST, STRONGEST = 200.0, 5000.0  #: rad/s and m/s²; more is a damaged record, not motion
NEAR = 500_000_000  #: ns between a fix and its accuracy
BATCH_SIZE = 32  #: samples in a record of a high-rate batch
ACCEL = 0  #: the kind of a batch
_HEAD = ("N", "type", "instance", "mul", "smp_cnt", "SampleUS", "smp_rate")
_NONE = np.empty(0)
FIXED = 3  #: least status of a fix in three dimensions
_TEXT = re.compile(rb"^FMT, ?128, ?89, ?FMT,", re.MULTILINE)


class _Tables(Protocol):
    records: int

    def table(self, name: str) -> dict[str, NDArray[Any]] | None: ...


def probe(head: bytes) -> bool:
    """Return whether the file holds a record that describes records, binary or as text."""
    return _binary(head) or _TEXT.search(head) is not None


def _binary(head: bytes) -> bool:
    if b"\0" not in head:
        return False
    # The record that describes records describes itself.
    return HEAD + bytes([FMT, FMT, FMT_SIZE]) in head


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams; the file is read first, for its formats and its clock.

    Raises:
        UnreadableLogError: not one record.
    """
    del options  # the format says everything itself; it has one clock
    trouble: list[str] = []
    tables = _read_binary(path, trouble) if _binary(source.head(path)) else _read_text(path, trouble)
    if not tables.records:
        message = f"{path}: no record that its formats describe"
        raise UnreadableLogError(message)
    yield from (Remark(text) for text in trouble)
    yield from _Streams(tables, path.stat().st_size).all()


def _read_binary(path: Path, trouble: list[str]) -> Tables:
    known: dict[int, Any] = {}
    tail = b""
    with source.open_unpacked(path) as file:
        for block, _ in source.blocks(file, []):  # the second reading says what is wrong
            data = tail + block
            known = {**formats(np.frombuffer(data, np.uint8)), **known}
            tail = data[-FMT_SIZE:]  # a record may lie across the edge
    tables, rest = Tables(known, WANTED), b""
    with source.open_unpacked(path) as file:
        for block, last in source.blocks(file, trouble):
            data = rest + block
            rest = data[tables.take(np.frombuffer(data, np.uint8), last=last) :]
    if tables.skipped:
        trouble.append(f"{tables.skipped} bytes that belong to no record left out")
    return tables


def _read_text(path: Path, trouble: list[str]) -> TextTables:
    tables, rest, fault = TextTables(WANTED), b"", source.packed_fault(path)
    with source.open_unpacked(path) as file:
        for piece in source.pieces(file, trouble):
            *lines, rest = (rest + piece).split(b"\n")
            tables.take(lines, to_first_bad=bool(fault))
            if fault and tables.bad:
                trouble.append(f"{DAMAGED} ({fault}): all from the first odd line on is left out")
                return tables
    tables.take([rest])
    if tables.bad:
        trouble.append(f"{tables.bad} lines that are cut, or hold something else than numbers, left out")
    return tables


class _Streams:
    """From tables to batches."""

    def __init__(self, tables: _Tables, size: int) -> None:
        self._tables, self._size = tables, size
        self._units = _units(tables)
        self._offset = self._unix_offset()
        self._epoch: Epoch = "boot" if self._offset is None else "unix"

    def all(self) -> Iterator[Batch | Remark]:
        """Yield everything there is."""
        for name in IMUS:
            for stream, columns in self._instances(name):
                yield from self._imu(stream, name, columns)
        yield from self._batches()
        for name, accuracy in zip(RECEIVERS, ACCURACIES, strict=True):
            for stream, columns in self._instances(name):
                yield from self._receiver(
                    stream, columns, dict(self._instances(accuracy)).get(stream.replace(name, accuracy))
                )
        yield from self._solution()
        yield Remark(
            "times count from power-up: no fix tells the date"
            if self._offset is None
            else "times since power-up made UTC by the receiver's week and ms"
        )

    def _table(self, name: str) -> Columns | None:
        table = self._tables.table(name)
        if table is None:
            return None
        if name not in ("ISBH", "ISBD"):  # elsewhere an array is no number, whatever a damaged format says
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
        for one in np.unique(table["I"]):
            rows = table["I"] == one
            yield f"{name}.{int(one)}", {key: column[rows] for key, column in table.items()}

    def _boot(self, columns: Columns) -> NDArray[np.int64]:
        ticks, unit = (columns["TimeUS"], 1000) if "TimeUS" in columns else (columns["TimeMS"], 1_000_000)
        if "TimeUS" not in columns and {"Week", "T"} <= columns.keys():  # of an old fix TimeMS is that of the week
            ticks = columns["T"]
        return ticks.astype(np.int64).clip(0, 2**62 // unit) * unit

    def _time(self, columns: Columns) -> NDArray[np.int64]:
        return self._boot(columns) + (self._offset or 0)

    def _unix_offset(self) -> int | None:
        """Return what makes times since power-up Unix times, ns."""
        found: list[NDArray[np.int64]] = []
        for name in RECEIVERS:
            table = self._table(name)
            if table is None:
                continue
            week = next((table[key] for key in ("GWk", "Week") if key in table), None)
            milliseconds = next((table[key] for key in ("GMS", "TimeMS") if key in table), None)
            if week is None or milliseconds is None or not ("TimeUS" in table or "T" in table):
                continue
            sure = (week > 1000) & (week < 5000) & (table.get("Status", week * 0 + FIXED) >= FIXED)  # noqa: PLR2004 - 1999 ... 2075
            if sure.any():
                unix = unix_of_gps(week[sure].astype(np.int64), milliseconds[sure].astype(np.int64))
                found.append(unix - self._boot(table)[sure])
        return int(np.median(np.concatenate(found))) if found else None

    def _imu(self, stream: str, name: str, columns: Columns) -> Iterator[Batch | Remark]:
        triads = {"angular_rate": "Gyr", "specific_force": "Acc"}
        if not all(f"{prefix}{axis}" in columns for prefix in triads.values() for axis in "XYZ"):
            yield Remark(f"{stream}: lacks a gyro or an accelerometer axis, not used")
            return
        values = {
            key: np.stack(
                [columns[f"{prefix}{axis}"] * self._factor(name, f"{prefix}{axis}") for axis in "XYZ"], axis=1
            )
            for key, prefix in triads.items()
        }
        possible = (np.abs(values["angular_rate"]) < FASTEST).all(axis=1)
        possible &= (np.abs(values["specific_force"]) < STRONGEST).all(axis=1)
        if not possible.all():
            yield Remark("rows with values that no sensor puts out left out", stream, int(np.count_nonzero(~possible)))
        time, origin = self._time(columns), Origin("rad/s, m/s²", "FRD", self._epoch)
        if possible.any():
            yield Batch(stream, "imu", time[possible], {k: v[possible] for k, v in values.items()}, origin, self._size)
        warmth = columns.get("T")
        if warmth is not None and warmth.any():
            warm = possible & (np.abs(warmth) < HOTTEST)
            yield Batch(stream, "imu", time[warm], {"temperature": warmth[warm].astype(float)}, origin, self._size)

    def _factor(self, name: str, field: str) -> float:
        """Return what makes a field SI, by the units that the log states."""
        label, multiplier = self._units.get((name, field), ("", 1.0))
        known = UNITS.get(label)
        return multiplier * (known.factor if known is not None else 1.0)

    def _batches(self) -> Iterator[Batch | Remark]:
        """Yield the high-rate batches: samples of one sensor at its full rate, for a while."""
        heads, data = self._table("ISBH"), self._table("ISBD")
        if (
            heads is None
            or data is None
            or any(heads.get(key, _NONE).ndim != 1 or not heads.get(key, _NONE).size for key in _HEAD)
        ):
            return
        if not {"N", "seqno", "x", "y", "z"} <= data.keys() or any(data[axis].ndim != 2 for axis in "xyz"):  # noqa: PLR2004
            return
        order = np.lexsort((data["seqno"], data["N"]))
        number = data["N"][order]
        samples = np.stack([data[axis][order] for axis in "xyz"], axis=-1).reshape(-1, BATCH_SIZE, 3)
        lost = 0
        for i in range(heads["N"].size):
            first, last = np.searchsorted(number, heads["N"][i]), np.searchsorted(number, heads["N"][i], side="right")
            rate, multiplier = float(heads["smp_rate"][i]), float(heads["mul"][i])
            whole = (last - first) * BATCH_SIZE == int(heads["smp_cnt"][i])
            if not (whole and rate > 0 and multiplier > 0):
                lost += 1
                continue
            values = samples[first:last].reshape(-1, 3) / multiplier
            start = int(heads["SampleUS"][i]) * 1000 + (self._offset or 0)
            time = start + np.rint(np.arange(len(values)) * (1e9 / rate)).astype(np.int64)
            key = "specific_force" if int(heads["type"][i]) == ACCEL else "angular_rate"
            origin = Origin("rad/s, m/s²", "FRD", self._epoch)
            yield Batch(f"ISB.{int(heads['instance'][i])}", "imu", time, {key: values}, origin, self._size)
        if lost:
            yield Remark(f"{lost} high-rate batches that are not whole left out")

    def _receiver(self, stream: str, columns: Columns, accuracy: Columns | None) -> Iterator[Batch | Remark]:
        if not {"Lat", "Lng", "Alt", "Spd"} <= columns.keys():
            return
        unknown = np.full(columns["Lat"].size, np.nan)
        sigmas = {"HAcc": unknown, "VAcc": unknown, "SAcc": unknown}
        if accuracy is not None:
            sigmas = {name: self._nearest(columns, accuracy, name) for name in sigmas}
        rows = GpsRows(
            columns["Lat"], columns["Lng"], columns["Alt"].astype(float), columns["Spd"].astype(float),
            columns.get("GCrs", unknown).astype(float), columns.get("VZ", unknown).astype(float),
            columns.get("Status", unknown).astype(float), sigmas["HAcc"], sigmas["VAcc"], sigmas["SAcc"],
        )  # fmt: skip
        there = usable_fixes(rows)
        yield from left_out(stream, there)
        if there.any():
            kept = {key: column[there] for key, column in gps_columns(rows).items()}
            origin = Origin(f"deg, m ({MEAN_SEA_LEVEL}), m/s", "NED", self._epoch)
            yield Batch(stream, "gnss", self._time(columns)[there], kept, origin, self._size)

    def _nearest(self, columns: Columns, accuracy: Columns, name: str) -> NDArray[np.float64]:
        """Return the accuracy that belongs to each fix; nan where none does."""
        if name not in accuracy:
            return np.full(columns["Lat"].size, np.nan)
        wanted, there = self._boot(columns), self._boot(accuracy)
        behind = np.searchsorted(there, wanted).clip(0, there.size - 1)
        before = (behind - 1).clip(0)
        nearest = np.where(np.abs(there[before] - wanted) < np.abs(there[behind] - wanted), before, behind)
        values = accuracy[name][nearest].astype(float)
        return np.where((np.abs(there[nearest] - wanted) < NEAR) & (values > 0), values, np.nan)

    def _solution(self) -> Iterator[Batch | Remark]:
        """Yield what the flight controller made of it all: position, with velocity and attitude beside it."""
        place = self._table("POS")
        if place is None or not {"Lat", "Lng", "Alt"} <= place.keys():
            return
        boot = self._boot(place)
        columns = {
            "position": np.stack(
                [np.radians(place["Lat"]), np.radians(place["Lng"]), place["Alt"].astype(float)], axis=1
            )
        }
        there = usable_position(columns["position"])
        for name in SOLUTIONS:
            table = self._table(name)
            if table is not None and {"VN", "VE", "VD"} <= table.keys():
                rows = table["C"] == table["C"][0] if "C" in table else np.ones(table["VN"].size, dtype=bool)
                at = self._boot(table)[rows]
                columns["velocity"] = np.stack(
                    [np.interp(boot, at, table[key][rows]) for key in ("VN", "VE", "VD")], axis=1
                )
                break
        attitude = self._table("ATT")
        if attitude is not None and {"Roll", "Pitch", "Yaw"} <= attitude.keys():
            turns = np.stack([np.radians(attitude[key]) for key in ("Roll", "Pitch", "Yaw")], axis=1)
            known = (np.abs(turns) < FULL_TURNS).all(axis=1)
            if known.any():
                columns["attitude"] = attitude_at(boot, self._boot(attitude)[known], turns[known])
        yield from left_out("POS", there)
        if there.any():
            origin = Origin(f"deg, m ({MEAN_SEA_LEVEL}), m/s", "NED", self._epoch)
            kept = {key: column[there] for key, column in columns.items()}
            yield Batch("POS", "reference", self._time(place)[there], kept, origin, self._size)


def _units(tables: _Tables) -> dict[tuple[str, str], tuple[str, float]]:
    """Return {(record, field): (unit's label, multiplier)} as far as a log states them."""
    stated, labels, multipliers = tables.table("FMTU"), tables.table("UNIT"), tables.table("MULT")
    known = getattr(tables, "formats", None)
    if stated is None or labels is None or multipliers is None or known is None:
        return {}
    whole = {"FmtType", "UnitIds", "MultIds"} <= stated.keys() and {"Id", "Label"} <= labels.keys()
    if not whole or not {"Id", "Mult"} <= multipliers.keys():
        return {}
    if [stated["UnitIds"].ndim, stated["MultIds"].ndim, labels["Label"].ndim, multipliers["Mult"].ndim] != [2, 2, 2, 1]:
        return {}
    names = {
        int(i): bytes(text).rstrip(b"\0").decode("ascii", "replace")
        for i, text in zip(labels["Id"], labels["Label"], strict=True)
    }
    factors = {int(i): float(x) for i, x in zip(multipliers["Id"], multipliers["Mult"], strict=True)}
    found: dict[tuple[str, str], tuple[str, float]] = {}
    for number, units, scales in zip(stated["FmtType"], stated["UnitIds"], stated["MultIds"], strict=True):
        described = known.get(int(number))
        if described is None:
            continue
        for field, unit, scale in zip(described.fields, units, scales, strict=False):
            # A field whose type scales it already states the same again.
            factor = factors.get(int(scale), 0.0) if field.factor == 1 else 1.0
            label = {"m/s/s": "m/s²", "degC": "°C"}.get(names.get(int(unit), ""), names.get(int(unit), ""))
            found[described.name, field.name] = label, factor or 1.0
    return found
