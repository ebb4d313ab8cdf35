"""Text logs: separated numbers, with units in the header, on the command line, or in a sidecar."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pyarrow as pa
from pyarrow import csv

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.log import SECOND, Origin
from imuwb.readers import text_source
from imuwb.readers.batch import Batch, ReadOptions, Remark
from imuwb.readers.text_columns import Column, columns, said_units
from imuwb.units import STANDARD_GRAVITY, UNITS, unit

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from imuwb.log import Epoch, Floats
    from imuwb.readers.batch import Kind
    from imuwb.readers.text_source import Layout
    from imuwb.units import Unit

format = "csv"  # noqa: A001 - the contract's name
BLOCK = 4 << 20
MOST_BAD = 0.5  #: with a larger share of unusable rows, the file is not what it is taken for
LATEST = 2**63 - 1025  #: ns, the largest a float holds below the end of int64
DIGITS = 9  #: behind the point of a decimal time
_ZONE = re.compile(r"(Z|[+-]\d\d:?\d\d)$")
_ISO = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d")


def probe(head: bytes) -> bool:
    """Return whether the file begins with text that holds digits."""
    if b"\0" in head or not any(digit in head for digit in b"0123456789"):
        return False
    printable = sum(byte >= ord(" ") or byte in b"\t\r\n\f" for byte in head)
    return printable >= 0.99 * len(head)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the rows of a text log in pieces.

    Raises:
        UsageError: the file says neither its columns, its units nor its rate, and nobody else does.
        UnreadableLogError: no row of numbers, or numbers that contradict the stated unit.
    """
    options, sidecar = _with_sidecar(path, options)
    if sidecar is not None:
        yield Remark(f"columns, units, rate and frame as {sidecar.name} says")
    layout = text_source.layout(path)
    if layout.cut_first:
        yield Remark("first line has fewer cells than the others: left out")
    used = _columns(path, layout, options)
    clock = _clock(path, layout, used, options)
    yield from (Remark(text) for text in clock.remarks)
    bad = Counter[str]()
    rows = done = unusable = 0
    found = False
    for block, bytes_read in _blocks(path, layout, used, clock, bad):
        time, timed = clock.time(block, rows)
        rows += block.num_rows
        values = {column: _floats(block.column(column.name))[timed] for column in used if column.quantity != "time"}
        bad["rows without a usable time left out"] += int(np.count_nonzero(~timed))
        missing = [~np.isfinite(cells) for column, cells in values.items() if column.quantity in ("gyro", "accel")]
        unusable += int(np.count_nonzero(np.any(missing, axis=0))) if missing else 0
        for kind, fields, there in _streams(values, options.frame or "FRD"):
            if not done and "specific_force" in fields:
                _check_gravity(path, fields["specific_force"], used)
            found = True
            chosen = fields if there is None else {name: array[there] for name, array in fields.items()}
            rows_time = time if there is None else time[there]
            yield Batch(kind, kind, rows_time, chosen, _origin(kind, used, options, clock.epoch), bytes_read)
        done += int(np.count_nonzero(timed))
    if not found and done:
        names = ", ".join(column.name for column in used) or "none that is known"
        yield Remark(
            f"nothing in this file can be used (columns: {names}); a triad needs its x, y and z, a fix latitude and longitude"
        )
    if not done or unusable + bad[LINES] > MOST_BAD * (rows + bad[LINES]):
        faults = ", ".join(f"{count} {what}" for what, count in bad.items() if count) or "no row"
        message = f"{path}: hardly a row can be used ({faults}); is this a log of numbers, and are its columns as said?"
        raise UnreadableLogError(message)
    stream_name = "imu" if any(column.quantity in ("gyro", "accel") for column in used) else "gnss"
    yield from (Remark(what, stream_name, count) for what, count in bad.items() if count)


LINES = "lines without the usual number of cells left out"
CELLS = "cells that are no number, taken as missing"


@dataclass(frozen=True, slots=True)
class _Clock:
    """How a row's time is found."""

    column: Column | None
    kind: pa.DataType
    rate: float  #: Hz, where there is no column
    epoch: Epoch
    remarks: tuple[str, ...] = ()

    def time(self, block: pa.RecordBatch, first_row: int) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return the time of the rows that have one in ns, and which those are."""
        if self.column is None or (self.column.unit is None and not pa.types.is_timestamp(self.kind)):
            row = np.arange(first_row, first_row + block.num_rows)
            return np.rint(row * (SECOND / self.rate)).astype(np.int64), np.ones(row.size, dtype=bool)
        cells = cast("pa.Array[Any]", block.column(self.column.name))
        there = np.asarray(cells.is_valid()).copy()
        time, inside = self._nanoseconds(cells.drop_null())
        there[there] = inside
        return time[inside], there

    def _nanoseconds(self, cells: pa.Array[Any]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return cells as ns, and which of them are a time that int64 holds."""
        if pa.types.is_timestamp(cells.type):
            return np.asarray(cells.cast(pa.int64())), np.ones(len(cells), dtype=bool)
        scale = cast("Any", self.column).unit.factor
        if pa.types.is_decimal(cells.type):
            # The low word of the 128-bit integer below a decimal is the value times 10^9: exact, unlike a float.
            words = np.frombuffer(cast("Any", cells.buffers()[1]), "<i8").reshape(-1, 2)
            low, high = words[cells.offset : cells.offset + len(cells)].T
            time = low if scale == 1 else np.rint(low * scale).astype(np.int64)
            return time, high == low >> 63
        if pa.types.is_integer(cells.type):
            ticks, each = np.asarray(cells), round(scale * SECOND)
            inside = np.abs(ticks) <= LATEST // each
            return np.where(inside, ticks, 0) * each, inside
        numbers = np.asarray(cells) * (scale * SECOND)
        inside = np.isfinite(numbers) & (np.abs(numbers) < LATEST)
        return np.rint(np.where(inside, numbers, 0.0)).astype(np.int64), inside


def _with_sidecar(path: Path, options: ReadOptions) -> tuple[ReadOptions, Path | None]:
    """Return the options with what ``LOG.toml`` beside the log says where the options are silent."""
    for sidecar in (path.with_name(f"{path.name}.toml"), path.with_name(f"{path.name.split('.')[0]}.toml")):
        if not sidecar.is_file():
            continue
        try:
            said = tomllib.loads(sidecar.read_text("utf-8"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            message = f"{sidecar}: the log's sidecar is not TOML: {error}"
            raise UsageError(message) from error
        unknown = set(said) - {"rate", "columns", "units", "frame"}
        if unknown:
            message = f"{sidecar}: unknown key {min(unknown)!r}; a sidecar has rate, columns, units and frame"
            raise UsageError(message)
        return replace(
            options,
            rate=options.rate or said.get("rate"),
            columns=options.columns or tuple(said.get("columns", ())),
            units={**said.get("units", {}), **options.units},
            frame=options.frame or said.get("frame"),
        ), sidecar
    return options, None


def _columns(path: Path, layout: Layout, options: ReadOptions) -> tuple[Column, ...]:
    """Return the columns that are used, each with its unit."""
    names = options.columns or layout.names
    if not names:
        message = (
            f"{path}: no header line; name its {len(layout.first)} columns, such as "
            "--columns gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z (a - for one that is not used)"
        )
        raise UsageError(message)
    if len(names) != len(layout.first):
        message = f"{path}: {len(names)} column names ({', '.join(names)}), but the rows have {len(layout.first)} cells"
        raise UsageError(message)
    found = columns(names, said_units(dict(options.units)))
    return tuple(_with_unit(path, column, found, layout) for column in found)


def _with_unit(path: Path, column: Column, found: tuple[Column, ...], layout: Layout) -> Column:
    if column.unit is not None or column.quantity == "time":
        return column
    usual = {"temperature": "°C", "latitude": "deg", "longitude": "deg", "height": "m"}.get(column.quantity)
    if column.quantity.startswith("velocity"):
        usual = "m/s"
    if column.quantity.startswith("sigma"):
        usual = "m"
    if usual is not None:
        return replace(column, unit=unit(usual))
    group = [other for other in found if other.quantity == column.quantity]
    hint = "deg/s or rad/s"
    if column.quantity == "accel":
        cells = [layout.first[other.index] for other in group]
        norm = float(np.linalg.norm([float(cell) for cell in cells])) if all(map(text_source.is_number, cells)) else 0.0
        hint = f"its first row has |f| = {norm:.4g}, so likely {_likely(norm) or 'g or m/s²'}"
    named = ", ".join(other.name for other in group)
    message = f"{path}: nobody says the unit of {named} ({hint}); add --units {column.quantity}=UNIT"
    raise UsageError(message)


def _likely(norm: float) -> str | None:
    """Return the unit in which ``norm`` is about one gravity."""
    for name in ("m/s²", "g", "mg"):
        if 0.9 < norm * UNITS[name].factor / STANDARD_GRAVITY < 1.1:  # noqa: PLR2004 - a still accelerometer within 10 %
            return name
    return None


def _check_gravity(path: Path, force: Floats, used: tuple[Column, ...]) -> None:
    """Refuse numbers that are a gravity in another unit than the one stated."""
    stated = next(column.unit for column in used if column.quantity == "accel")
    whole = force[np.isfinite(force).all(axis=1) & (np.abs(force) < 1e9).all(axis=1)]  # noqa: PLR2004 - damage apart
    if not whole.size:
        return
    norm = float(np.median(np.linalg.norm(whole, axis=1)))
    if stated is None or STANDARD_GRAVITY / 2 < norm < 2 * STANDARD_GRAVITY:
        return
    likely = _likely(norm / stated.factor)
    if likely is not None:
        message = (
            f"{path}: accel is stated in {stated.name}, but |f| is {norm / stated.factor:.4g}; a still accelerometer "
            f"reads one gravity, so the unit is likely {likely}: --units accel={likely}"
        )
        raise UnreadableLogError(message)


def _clock(path: Path, layout: Layout, used: tuple[Column, ...], options: ReadOptions) -> _Clock:
    column = next((column for column in used if column.quantity == "time"), None)
    if column is None:
        if not options.rate or options.rate <= 0:
            message = f"{path}: no time column (columns: {', '.join(c.name for c in used)}); say the rate: --rate HZ"
            raise UsageError(message)
        return _Clock(None, pa.null(), options.rate, "log")
    remarks = ("--rate not used: the file has a time column",) if options.rate else ()
    first = layout.first[column.index].strip().strip('"')
    if _ISO.match(first):
        return _Clock(column, pa.timestamp("ns", "UTC" if _ZONE.search(first) else None), 0.0, "unix", remarks)
    if not text_source.is_number(first):
        message = f"{path}: {first!r} in time column {column.name!r} is neither a number nor an ISO time"
        raise UsageError(message)
    value = float(first)
    if column.unit is None:
        since_1970 = {"s": 1e9, "ms": 1e12, "us": 1e15, "ns": 1e18}
        name = next((u for u, size in since_1970.items() if 0.5 < value / size < 3), None)  # noqa: PLR2004 - 1985 to 2065
        if name is None:
            message = (
                f"{path}: nobody says the unit of time column {column.name!r} (its first value is {first}); "
                "add --units time=s (or ms, us, ns)"
            )
            raise UsageError(message)
        remarks = (*remarks, f"time column {column.name!r} taken as {name} since 1970, as its size tells")
        column = replace(column, unit=unit(name))
    factor = cast("Any", column.unit).factor
    epoch: Epoch = "unix" if 5e8 < value * factor < 3e9 else "log"  # noqa: PLR2004 - seconds: 1985 to 2065
    behind = len(first.partition(".")[2]) if "." in first else 0
    if "e" in first.lower() or behind > DIGITS or (behind and factor < 1 and abs(value) > 9e9):  # noqa: PLR2004 - int64
        kind = pa.float64()
    else:
        kind = pa.decimal128(28, DIGITS) if behind or factor == 1 else pa.int64()
    return _Clock(column, kind, 0.0, epoch, remarks)


def _blocks(
    path: Path, layout: Layout, used: tuple[Column, ...], clock: _Clock, bad: Counter[str]
) -> Iterator[tuple[pa.RecordBatch, int]]:
    """Yield the used columns in blocks; where a cell is no number, go on by a slower way that finds it."""
    kinds = {c.name: clock.kind if c.quantity == "time" else pa.float64() for c in used}
    names = [f"unused {i}" for i in range(len(layout.first))]
    for column in used:
        names[column.index] = column.name
    rows = 0
    try:
        for block, bytes_read in _parse(path, layout, names, kinds, bad):
            yield block, bytes_read
            rows += block.num_rows
    except (pa.ArrowInvalid, ValueError):
        bad.clear()
        texts = dict.fromkeys(kinds, pa.binary())
        for block, bytes_read in _parse(path, layout, names, texts, bad):
            fresh = block.slice(min(rows, block.num_rows))
            rows -= block.num_rows - fresh.num_rows
            if fresh.num_rows:
                cast_columns = [_numbers(fresh.column(name), kind, bad) for name, kind in kinds.items()]
                yield pa.RecordBatch.from_arrays(cast_columns, names=list(kinds)), bytes_read


def _parse(
    path: Path, layout: Layout, names: list[str], kinds: Mapping[str, pa.DataType], bad: Counter[str]
) -> Iterator[tuple[pa.RecordBatch, int]]:
    def skip(row: object) -> str:
        del row
        bad[LINES] += 1
        return "skip"

    with text_source.Rows(path, layout) as rows:
        try:
            if rows.is_empty():
                return
            reader = csv.open_csv(
                pa.PythonFile(rows, "r"),
                csv.ReadOptions(column_names=names, block_size=BLOCK),
                csv.ParseOptions(
                    delimiter="," if layout.delimiter == " " else layout.delimiter, invalid_row_handler=skip
                ),
                csv.ConvertOptions(
                    column_types=dict(kinds), include_columns=list(kinds), strings_can_be_null=True,
                    timestamp_parsers=[csv.ISO8601],
                ),
            )  # fmt: skip
            for block in reader:
                yield block, rows.bytes_read
        finally:
            for trouble in rows.trouble:
                bad[trouble] = max(bad[trouble], 1)


def _numbers(cells: pa.Array[Any], kind: pa.DataType, bad: Counter[str]) -> pa.Array[Any]:
    """Return cells of bytes as numbers or times; those that are none as null."""
    try:
        return cells.cast(pa.string()).cast(kind)
    except pa.ArrowInvalid:
        pass
    texts = [None if cell is None else cell.decode("utf-8", "replace").strip() for cell in cells.to_pylist()]
    good = _is_time if pa.types.is_timestamp(kind) else text_source.is_number
    kept = [text if text and good(text) else None for text in texts]
    bad[CELLS] += sum(bool(text) and keep is None for text, keep in zip(texts, kept, strict=True))
    # A whole-number column may turn out to have fractions, or more digits than a decimal has room for.
    for wider in (kind, pa.decimal128(28, DIGITS), pa.float64()):
        try:
            return pa.array(kept, pa.string()).cast(wider)
        except pa.ArrowInvalid:
            continue
    return pa.array([None if text is None else float(text) for text in kept], pa.float64())


def _is_time(text: str) -> bool:
    try:
        datetime.fromisoformat(text)
    except ValueError:
        return False
    return True


def _floats(cells: pa.Array[Any]) -> Floats:
    return np.asarray(cells.to_numpy(zero_copy_only=False), dtype=np.float64)


def _streams(
    values: dict[Column, Floats], frame: str
) -> Iterator[tuple[Kind, dict[str, Floats], NDArray[np.bool_] | None]]:
    """Yield what the columns make up, in SI and FRD, and, for the slower streams, the rows that have them."""
    si = {(c.quantity, c.axis): _si(v, c.unit) for c, v in values.items() if c.unit is not None}
    signs = np.array([1.0, -1.0, -1.0]) if frame == "FLU" else np.ones(3)
    imu = {
        field: np.stack([si[quantity, axis] for axis in range(3)], axis=1) * signs
        for quantity, field in (("gyro", "angular_rate"), ("accel", "specific_force"))
        if all((quantity, axis) in si for axis in range(3))
    }
    if imu:
        yield "imu", imu, None
        if ("temperature", 0) in si:
            yield "imu", {"temperature": si["temperature", 0]}, np.isfinite(si["temperature", 0])
    if ("latitude", 0) in si and ("longitude", 0) in si:
        height = si.get(("height", 0), np.zeros_like(si["latitude", 0]))
        gnss = {"position": np.stack([si["latitude", 0], si["longitude", 0], height], axis=1)}
        for field, prefix in (("velocity", "velocity_"), ("position_sigma", "sigma_")):
            parts = [si.get((f"{prefix}{way}", 0)) for way in ("north", "east", "down")]
            if all(part is not None for part in parts):
                gnss[field] = np.stack(cast("list[Floats]", parts), axis=1)
        if ("fix_type", 0) in si:
            gnss["fix_type"] = si["fix_type", 0]
        yield "gnss", gnss, np.isfinite(si["latitude", 0]) if imu else None


def _si(values: Floats, unit: Unit) -> Floats:
    scaled = values * unit.factor
    return scaled + unit.offset if unit.offset else scaled  # adding nothing would still make +0 of -0


def _origin(kind: Kind, used: tuple[Column, ...], options: ReadOptions, epoch: Epoch) -> Origin:
    wanted = ("gyro", "accel") if kind == "imu" else ("latitude", "height")
    units = dict.fromkeys(c.unit.name for c in used if c.unit is not None and c.quantity in wanted)
    frame = f"{options.frame} (as said)" if options.frame else "FRD (taken as it stands: nobody says)"
    return Origin(", ".join(units), frame if kind == "imu" else "NED", epoch)
