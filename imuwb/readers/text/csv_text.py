"""Text logs: separated numbers, with units in the header, on the command line, or in a sidecar."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.log import MEAN_SEA_LEVEL, SECOND, Origin
from imuwb.readers.batch import Batch, ReadOptions, Remark
from imuwb.readers.text import lines
from imuwb.readers.text.cells import CELLS, LINES, blocks
from imuwb.readers.text.clock import clock_of
from imuwb.readers.text.column_names import Column, above_sea, columns, said_units
from imuwb.readers.text.sidecar import with_sidecar
from imuwb.readers.text.trust import DAMAGED, is_number
from imuwb.units import STANDARD_GRAVITY, UNITS, unit

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    import pyarrow as pa
    from numpy.typing import NDArray

    from imuwb.log import Epoch, Floats
    from imuwb.readers.batch import Kind
    from imuwb.readers.text.clock import Clock
    from imuwb.readers.text.lines import Layout
    from imuwb.units import Unit

format = "csv"  # noqa: A001 - the contract's name
uses = ("rate", "columns", "units", "frame", "epoch")
_ANGLES = ("roll", "pitch", "heading")
UNTIMED = "rows without a usable time left out"
LEAP = 3600 * SECOND  #: ns forward in time that a damaged file is not trusted with
MOST_BAD = 0.5  #: with a larger share of unusable rows, the file is not what it is taken for


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
    options, beside = with_sidecar(path, options)
    if beside:
        yield Remark(beside)
    layout = lines.layout(path)
    if layout.cut_first:
        yield Remark("first line has fewer cells than the others: left out")
    used = _columns(path, layout, options)
    for column in used:
        named = columns((column.name,), {})
        if named and named[0].unit is not None and column.unit is not None and named[0].unit != column.unit:
            yield Remark(f"column {column.name!r} is taken in {column.unit.name}, as said, not in {named[0].unit.name}")
    clock = clock_of(path, layout, used, options)
    yield from (Remark(text) for text in clock.remarks)
    bad = Counter[str]()
    done = unusable = 0
    found = checked = False
    for time, values, bytes_read in _rows(path, layout, used, clock, bad):
        missing = [~np.isfinite(cells) for column, cells in values.items() if column.quantity in ("gyro", "accel")]
        unusable += int(np.count_nonzero(np.any(missing, axis=0))) if missing else 0
        for kind, fields, there in _streams(values, options.frame or "FRD"):
            if not checked and "specific_force" in fields:
                checked = _check_gravity(path, fields["specific_force"], used)
            found = True
            chosen = fields if there is None else {name: array[there] for name, array in fields.items()}
            rows_time = time if there is None else time[there]
            yield Batch(kind, kind, rows_time, chosen, _origin(kind, used, options, clock.epoch), bytes_read)
        done += time.size
    if not found and done:
        names = ", ".join(column.name for column in used) or "none that is known"
        yield Remark(
            f"nothing in this file can be used (columns: {names}); a triad needs its x, y and z, a fix latitude and longitude"
        )
    if not done or unusable + bad[LINES] > MOST_BAD * (done + bad[UNTIMED] + bad[LINES]):
        bad["rows without a number in every used column"] += unusable
        faults = ", ".join(f"{count} {what}" for what, count in bad.items() if count) or "no row"
        message = f"{path}: hardly a row can be used ({faults}); is this a log of numbers, and are its columns as said?"
        raise UnreadableLogError(message)
    yield from _repairs(layout, used, bad, done)


def _rows(
    path: Path, layout: Layout, used: tuple[Column, ...], clock: Clock, bad: Counter[str]
) -> Iterator[tuple[NDArray[np.int64], dict[Column, Floats], int]]:
    """Yield time, values and bytes read of the rows that have a time; of a damaged file, up to where time leaps."""
    rows, before = 0, None
    for block, bytes_read in blocks(path, layout, used, clock, bad):
        time, timed = clock.time(block, rows)
        rows += block.num_rows
        bad[UNTIMED] += int(np.count_nonzero(~timed))
        good = _rising(time, before) if layout.fault else time.size
        values = {column: _floats(block.column(column.name))[timed] for column in used if column.quantity != "time"}
        yield time[:good], {column: cells[:good] for column, cells in values.items()}, bytes_read
        if good < time.size:
            bad[f"{DAMAGED} ({layout.fault}): it shows where times leap, from where on all is left out"] = 1
            return
        before = int(time[-1]) if time.size else before


def _repairs(layout: Layout, used: tuple[Column, ...], bad: Counter[str], done: int) -> Iterator[Remark]:
    name = "imu" if any(column.quantity in ("gyro", "accel") for column in used) else "gnss"
    if layout.fault and not any(what.startswith(DAMAGED) for what in bad):
        what = f"{DAMAGED} ({layout.fault}), and no row shows where: any of them may be wrong"
        yield Remark(what, name, done, "value")
    for what, count in bad.items():
        if count:
            yield Remark(what, name, count, "value" if what == CELLS else "lost")


def _rising(time: NDArray[np.int64], before: int | None) -> int:
    """Return how many times follow the one before, and each other, upwards and without a leap."""
    steps = np.diff(time, prepend=time[:1] - 1 if before is None else before)
    odd = np.flatnonzero((steps <= 0) | (steps > LEAP))
    return int(odd[0]) if odd.size else time.size


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
    if column.quantity.startswith(("velocity", "sigma_velocity", "speed")):
        usual = "m/s"
    elif column.quantity.startswith("sigma"):
        usual = "m"
    elif column.quantity in ("roll", "pitch", "heading"):
        usual = "deg"
    if usual is not None:
        return replace(column, unit=unit(usual))
    group = [other for other in found if other.quantity == column.quantity]
    hint = "deg/s or rad/s"
    if column.quantity == "accel":
        cells = [layout.first[other.index] for other in group]
        norm = float(np.linalg.norm([float(cell) for cell in cells])) if all(map(_is_small, cells)) else 0.0
        hint = f"its first row has |f| = {norm:.4g}, so likely {_likely(norm) or 'g or m/s²'}"
    named = ", ".join(other.name for other in group)
    message = f"{path}: nobody says the unit of {named} ({hint}); add --units {column.quantity}=UNIT"
    raise UsageError(message)


def _is_small(cell: str) -> bool:
    return is_number(cell) and abs(float(cell)) < 1e9  # noqa: PLR2004 - nan is not, and damage neither


def _likely(norm: float) -> str | None:
    """Return the unit in which ``norm`` is about one gravity."""
    for name in ("m/s²", "g", "mg"):
        if 0.9 < norm * UNITS[name].factor / STANDARD_GRAVITY < 1.1:  # noqa: PLR2004 - a still accelerometer within 10 %
            return name
    return None


def _check_gravity(path: Path, force: Floats, used: tuple[Column, ...]) -> bool:
    """Refuse numbers that are a gravity in another unit than the one stated; return whether there were any."""
    stated = next(column.unit for column in used if column.quantity == "accel")
    whole = force[np.isfinite(force).all(axis=1) & (np.abs(force) < 1e9).all(axis=1)]  # noqa: PLR2004 - damage apart
    if not whole.size:
        return False
    norm = float(np.median(np.linalg.norm(whole, axis=1)))
    if stated is None or STANDARD_GRAVITY / 2 < norm < 2 * STANDARD_GRAVITY:
        return True
    likely = _likely(norm / stated.factor)
    if likely is not None:
        message = (
            f"{path}: accel is stated in {stated.name}, but |f| is {norm / stated.factor:.4g}; a still accelerometer "
            f"reads one gravity, so the unit is likely {likely}: --units accel={likely}"
        )
        raise UnreadableLogError(message)
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
        if ("temperature", 0) in si and np.isfinite(si["temperature", 0]).any():
            yield "imu", {"temperature": si["temperature", 0]}, np.isfinite(si["temperature", 0])
    if ("latitude", 0) in si and ("longitude", 0) in si:
        height = si.get(("height", 0), np.zeros_like(si["latitude", 0]))
        gnss = {"position": np.stack([si["latitude", 0], si["longitude", 0], height], axis=1)}
        for field, prefix in (
            ("velocity", "velocity_"), ("position_sigma", "sigma_"), ("velocity_sigma", "sigma_velocity_"),
        ):  # fmt: skip
            parts = [si.get((f"{prefix}{way}", 0)) for way in ("north", "east", "down")]
            if all(part is not None for part in parts):
                gnss[field] = np.stack(cast("list[Floats]", parts), axis=1)
        if ("fix_type", 0) in si:
            gnss["fix_type"] = si["fix_type", 0]
        there = np.isfinite(si["latitude", 0]) if imu else None
        if all((angle, 0) in si for angle in _ANGLES):  # what knows its attitude is no receiver
            attitude = np.stack([si[angle, 0] for angle in _ANGLES], axis=1)
            told = {"position": gnss["position"], "velocity": gnss.get("velocity"), "attitude": attitude}
            yield "reference", {k: v for k, v in told.items() if v is not None and np.isfinite(v).any()}, there
        else:
            yield "gnss", gnss, there
    if ("speed", 0) in si:
        yield "speed", {"speed": si["speed", 0]}, np.isfinite(si["speed", 0]) if imu else None


def _si(values: Floats, unit: Unit) -> Floats:
    with np.errstate(over="ignore"):
        scaled = values * unit.factor
    return scaled + unit.offset if unit.offset else scaled  # adding nothing would still make +0 of -0


def _origin(kind: Kind, used: tuple[Column, ...], options: ReadOptions, epoch: Epoch) -> Origin:
    wanted = ("gyro", "accel") if kind == "imu" else ("latitude", "height")
    units = dict.fromkeys(c.unit.name for c in used if c.unit is not None and c.quantity in wanted)
    above = f" ({MEAN_SEA_LEVEL})" if kind != "imu" and any(map(above_sea, used)) else ""
    frame = f"{options.frame} (as said)" if options.frame else "FRD (taken as it stands: nobody says)"
    return Origin(", ".join(units) + above, frame if kind == "imu" else "NED", epoch)
