"""Finds the shape of a text log from its name, its header, and its first rows."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from statistics import median

from imuwb.readers.text.column_names import parts_of, with_units
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.shapes.shape import Shape, shapes
from imuwb.readers.text.trust import is_number
from imuwb.units import STANDARD_GRAVITY, Unit, unit

SOUND = 0.95  #: least share of the first rows that have the values of a shape; a log may have damaged rows
ROWS = 256  #: number of first rows whose values must fit
DIFFERENT = 2.0  #: factor between the median specific force of a vehicle and one gravity


#: what file managers and browsers add to the name of a copy: ``Gyroscope (1).csv``, ``Gyroscope - Copy.csv``
_COPY = re.compile(r"(?:[ _-]*(?:\(\d+\)|copy|kopie)|[ _-]\d+)(?=\.\w+$)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Head:
    """What a shape is recognised by."""

    file: str  #: name of the file; of a table in a file of several, its tag
    text: str  #: the lines before its first row
    names: tuple[str, ...]  #: of the columns; empty without a header
    rows: tuple[tuple[float, ...], ...]  #: the first rows of numbers, nan for another cell


def head_of(path: Path, layout: Layout) -> Head:
    """Return the head of a log."""
    text = "\n".join((*layout.comments, ",".join(layout.names)))
    rows = layout.sample[:ROWS] or (layout.first,)
    file = path.name if layout.tag is None else layout.tag.text
    return Head(file, text, layout.names, tuple(tuple(map(_number, row)) for row in rows))


def shape_of(head: Head) -> Shape | None:
    """Return the shape of a log; None for an unknown one."""
    names = {end for name in head.names for end, _, _ in ends_of(name)}
    return next((shape for shape in shapes() if _fits(shape, head, names)), None)


def ends_of(name: str) -> Iterator[tuple[str, int, Unit | None]]:
    """Yield the ends of a column's name, the longest first, each with the number of parts before it and the unit of the name."""
    for text, measure in with_units(name.lstrip("#% ")):
        parts = parts_of(text)
        for count in range(len(parts)):
            yield ".".join(parts[count:]), count, measure


def _fits(shape: Shape, head: Head, names: set[str]) -> bool:
    if shape.row:
        if head.names or len(head.rows[0]) != shape.cells or not _in_ranges(shape, head):
            return False
    elif not (names and names.issuperset(shape.header) and names.isdisjoint(shape.absent)):
        return False
    files = head.file, _COPY.sub("", head.file)
    if shape.file and not any(re.search(shape.file, file, re.IGNORECASE) for file in files):
        return False
    return not shape.text or re.search(shape.text, head.text, re.MULTILINE) is not None


def _in_ranges(shape: Shape, head: Head) -> bool:
    """Return whether nearly all of the first rows have the values of a shape, and its time rises by its steps."""
    within = [all(low <= row[cell] <= high for cell, (low, high) in shape.ranges.items()) for row in head.rows]
    times = {cell: unit(m.unit).factor for cell, m in enumerate(shape.row) if m and m.quantity == "time"}
    if sum(within) < SOUND * len(within):
        return False
    pairs = [(before, after) for before, after in pairwise(head.rows) if all(map(math.isfinite, (*before, *after)))]
    if not times or not pairs:
        return True
    steps = [sum(factor * (after[cell] - before[cell]) for cell, factor in times.items()) for before, after in pairs]
    near = [all(abs(after[c] - before[c]) <= most for c, most in shape.changes.items()) for before, after in pairs]
    step = median(steps)
    if not all(near) or sum(step > 0 for step in steps) < SOUND * len(pairs):
        return False
    return shape.steps[0] <= step <= shape.steps[1] and _is_gravity(shape, head, step)


def _is_gravity(shape: Shape, head: Head, step: float) -> bool:
    """Return whether the velocity increments over a step (s) are about one gravity; True for a shape without them."""
    cells = [cell for cell, meaning in enumerate(shape.row) if meaning and meaning.quantity == "velocity_increment"]
    if not cells:
        return True
    if step <= 0:
        return False
    force = median(math.hypot(*(row[cell] for cell in cells)) for row in head.rows) / step
    return STANDARD_GRAVITY / DIFFERENT < force < STANDARD_GRAVITY * DIFFERENT


def _number(cell: str) -> float:
    return float(cell) if is_number(cell) else float("nan")
