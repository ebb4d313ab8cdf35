"""The columns of a log of a known shape, in FRD axes, and the options that the shape states."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

from imuwb.readers.quantities import DIMENSIONS, units_by_quantity
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.column_names import Column, before, columns
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.shapes.recognition import Head, ends_of, head_of, shape_of
from imuwb.readers.text.shapes.shape import Meaning, Shape
from imuwb.units import Unit, unit

#: direction of an axis -> axis of FRD, and sign
_DIRECTIONS = {"F": (0, 1), "B": (0, -1), "R": (1, 1), "L": (1, -1), "D": (2, 1), "U": (2, -1)}
TRIADS = ("gyro", "accel", "attitude_increment", "velocity_increment")


@dataclass(frozen=True, slots=True)
class Shaped:
    """What a shape says of a log."""

    shape: Shape
    columns: tuple[Column, ...]
    refused: Mapping[str, str]  #: name of a column that is not used -> why
    frame: str  #: directions of x, y and z; empty: those of the sensor
    rate: float | None  #: Hz, from the file's first lines

    def completing(self, options: ReadOptions) -> ReadOptions:
        """Return the options, completed by what the shape states; an option that is set goes before it."""
        timed = any(column.quantity == "time" for column in self.columns)
        rate = options.rate if timed else options.rate or self.rate
        return replace(options, rate=rate, epoch=options.epoch or self.shape.epoch)


def shape_of_log(path: Path, layout: Layout, options: ReadOptions) -> Shaped | None:
    """Return what the shape of a log says of it; None for an unknown shape, and if the user names the columns."""
    if options.columns:
        return None
    head = head_of(path, layout)
    shape = shape_of(head)
    return None if shape is None else shaped(shape, head, options)


def shaped(shape: Shape, head: Head, options: ReadOptions) -> Shaped:
    """Return the columns of a log of a known shape; the frame and the units that a user states go before those of the shape."""
    units = units_by_quantity(options.units)
    found = _by_place(shape, units) if shape.row else _by_name(shape, head.names, units)
    found = tuple(_with_whole_time(column, head.rows) for column in found)
    frame = _frame(shape, found, head.rows)
    used = found if options.frame or not frame else tuple(_in_frd(column, frame) for column in found)
    stated = re.search(shape.rate, head.text, re.MULTILINE) if shape.rate else None
    rate = float(stated[1]) if stated else None
    used = tuple(_counted(column, options.rate or rate) for column in used)
    return Shaped(shape, used, _refused(shape, head.names), frame, rate)


def _by_place(shape: Shape, units: Mapping[str, str]) -> tuple[Column, ...]:
    """Return the columns of a log without a header."""
    return tuple(
        _column(i, _place_name(i, meaning), meaning, units)
        for i, meaning in enumerate(shape.row)
        if meaning is not None
    )


def _place_name(index: int, meaning: Meaning) -> str:
    if meaning.quantity == "time":
        return f"time ({meaning.unit}) in column {index + 1}"
    return f"{meaning.quantity}_{'xyz'[meaning.axis]}" if meaning.quantity in TRIADS else meaning.quantity


def _by_name(shape: Shape, names: Sequence[str], units: Mapping[str, str]) -> tuple[Column, ...]:
    """Return the columns that the shape knows, then others whose names say what they are."""
    found: dict[tuple[str, str, int], Column] = {}
    order = list(shape.columns)
    known = [column for i, name in enumerate(names) if (column := _known(shape, i, name, units)) is not None]
    # Of two columns with one meaning, such as two times, that which the shape has first is taken.
    for column, _ in sorted(known, key=lambda pair: order.index(pair[1])):
        found.setdefault((column.stream, column.quantity, column.axis), column)
    taken = {column.index for column, _ in known} | {i for i, name in enumerate(names) if _reason(shape, name)}
    quantities = {column.quantity for column in found.values()}
    for column in columns(tuple("-" if i in taken else name for i, name in enumerate(names)), units):
        if column.quantity not in quantities and column.quantity not in ("time", "week"):  # the clock finds other times
            found[column.stream, column.quantity, column.axis] = column
    return tuple(found.values())


def _known(shape: Shape, index: int, name: str, units: Mapping[str, str]) -> tuple[Column, str] | None:
    """Return the column of a name and the end that the shape knows it by."""
    for end, count, stated in ends_of(name):
        meaning = shape.columns.get(end)
        if meaning is not None:
            column = _column(index, name, meaning, units)
            if stated is not None and stated.dimension == DIMENSIONS[column.quantity] and column.quantity not in units:
                column = replace(column, unit=stated)
            prefix = "" if column.quantity == "time" else before(name.lstrip("#% "), count)
            return replace(column, stream=prefix), end
    return None


def _column(index: int, name: str, meaning: Meaning, units: Mapping[str, str]) -> Column:
    measure = units.get(meaning.quantity, meaning.unit) or (
        "1" if DIMENSIONS[meaning.quantity] == "dimensionless" else ""
    )
    return Column(index, name, meaning.quantity, meaning.axis, unit(measure) if measure else None, sign=meaning.sign)


def _with_whole_time(column: Column, rows: Sequence[tuple[float, ...]]) -> Column:
    """Return a column of time without the shape's unit, ns or us, if its numbers are no whole ones: somebody changed the file."""
    if column.quantity != "time" or column.unit is None or column.unit.name not in ("ns", "us"):
        return column
    whole = all(row[column.index] == round(row[column.index]) for row in rows if math.isfinite(row[column.index]))
    return column if whole else replace(column, unit=None)


def _counted(column: Column, rate: float | None) -> Column:
    """Return a counter of samples as a time, if the rate is known."""
    if column.quantity != "counter" or not rate:
        return column
    return replace(column, quantity="time", unit=Unit("samples", "time", 1 / rate))


def _refused(shape: Shape, names: Sequence[str]) -> dict[str, str]:
    return {name: why for name in names if (why := _reason(shape, name))}


def _reason(shape: Shape, name: str) -> str:
    return next((shape.refused[end] for end, _, _ in ends_of(name) if end in shape.refused), "")


def _frame(shape: Shape, found: Sequence[Column], rows: Sequence[tuple[float, ...]]) -> str:
    """Return the frame of a shape; of two, that which the first rows' specific force shows."""
    if len(shape.frame) < 2:  # noqa: PLR2004 - one frame, or none
        return "".join(shape.frame)
    down = next((c for c in found if c.quantity in ("accel", "velocity_increment") and c.axis == 2), None)  # noqa: PLR2004 - z
    if down is None:
        return ""
    known = [row[down.index] for row in rows if math.isfinite(row[down.index])]
    return shape.frame[0] if known and down.sign * median(known) > 0 else shape.frame[1]


def _in_frd(column: Column, frame: str) -> Column:
    """Return a column of a triad as that of an axis of FRD."""
    if column.quantity not in TRIADS:
        return column
    axis, sign = _DIRECTIONS[frame[column.axis]]
    return replace(column, axis=axis, sign=sign * column.sign)
