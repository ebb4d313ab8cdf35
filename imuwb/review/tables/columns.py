"""The columns of a table as quantities: numbers, intervals and units instead of texts for people."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from imuwb.analysis import Answer, Table
from imuwb.units import UNITS

MISSING = ("", "—", "-", "–")
_NUMBER = r"[-+−]?(?:\d{1,3}(?:[ \xa0]\d{3})+|\d+)?(?:\.\d+)?(?:e[-+]?\d+)?"
_UNIT = r"(?P<{}>[^\s\d\[\](),;:<>=][^\s\[\],;]*)"
_CELL = re.compile(
    rf"(?P<limit>[<>] ?)?(?P<value>{_NUMBER})(?: {_UNIT.format('first')})?"
    rf"(?: \[(?P<lower>{_NUMBER}|—), (?P<upper>{_NUMBER}|—)\](?: {_UNIT.format('last')})?)?"
)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A cell as numbers, in the digits of the cell; empty: not known."""

    value: str = ""
    lower: str = ""
    upper: str = ""
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table."""

    heading: str  #: with the unit, if all cells have one
    cells: tuple[str, ...]  #: without the unit that the heading states
    quantities: tuple[Quantity, ...] | None  #: None: it has texts
    unit: str  #: of all cells; empty: none, or several


@dataclass(frozen=True, slots=True)
class Part:
    """A column as programs read it: one value a cell."""

    heading: str
    cells: tuple[str, ...]
    numbers: bool  #: whether all cells are numbers, or empty


def columns_of(table: Table) -> tuple[Column, ...]:
    """Return the columns of a table; a unit that all cells of a column share is in its heading alone."""
    return tuple(
        _column(heading, [row[i] if i < len(row) else "" for row in table.rows])
        for i, heading in enumerate(table.headings)
    )


def parts_of(table: Table) -> Iterator[Part]:
    """Yield the columns of a table for a program: a value, each end of its interval, and the unit where a column has several."""
    for column in columns_of(table):
        quantities = column.quantities
        if quantities is None:
            yield Part(column.heading, column.cells, numbers=False)
            continue
        name, bracket, unit = column.heading.partition(" [")
        yield Part(column.heading, tuple(q.value for q in quantities), numbers=True)
        for end in ("lower", "upper"):
            cells = tuple(getattr(q, end) for q in quantities)
            if any(cells):
                yield Part(f"{name} {end}{bracket}{unit}", cells, numbers=True)
        units = tuple(q.unit for q in quantities)
        if not column.unit and any(units):
            yield Part(f"{name} unit", units, numbers=False)


def quantity(cell: str) -> Quantity | None:
    """Return a cell as numbers; None for a text.

    These are read: "12", "1 298", "2.40 [2.38, 2.43] deg/√h", "22.8 m [19, 29.6]", "< 220 deg/h", and a dash for nothing.
    """
    if cell.strip() in MISSING:
        return Quantity()
    match = _CELL.fullmatch(cell.strip())
    if match is None or not match["value"].strip("+-−") or (match["first"] and match["last"]):
        return None
    value, lower, upper = (_digits(match[name]) for name in ("value", "lower", "upper"))
    unit = match["first"] or match["last"] or ""
    if match["limit"]:
        lower, upper = (value, "") if match["limit"][0] == ">" else ("", value)
        value = ""
    return Quantity(value, lower, upper, unit)


def answer_table(answer: Answer, title: str) -> Table:
    """Return the rows of an answer as a table: each cell has the unit that a row below it states."""
    rows: list[tuple[str, ...]] = []
    below: tuple[str, ...] = ()
    for row in reversed(answer.rows):
        if row and not row[0] and any(cell in UNITS for cell in row):
            below = row
            continue
        units = (*below, *[""] * len(row))
        rows.insert(
            0,
            tuple(
                f"{cell} {unit}" if unit and quantity(cell) else cell for cell, unit in zip(row, units, strict=False)
            ),
        )
    return Table(title, answer.headings, tuple(rows))


def _column(heading: str, cells: Sequence[str]) -> Column:
    read = [quantity(cell) for cell in cells]
    quantities = tuple(q for q in read if q is not None)
    if len(quantities) < len(cells) or not any(q.value or q.lower or q.upper for q in quantities):
        return Column(heading, tuple(cells), None, "")
    units = {q.unit for q in quantities if q.value or q.lower or q.upper}
    unit = units.pop() if len(units) == 1 else ""
    if not unit or "[" in heading:
        return Column(heading, tuple(cells), quantities, "")
    bare = tuple(re.sub(rf" {re.escape(unit)}(?= \[|$)", "", cell) for cell in cells)
    return Column(f"{heading} [{unit}]".strip(), bare, quantities, unit)


def _digits(text: str | None) -> str:
    """Return a number as a program reads it."""
    return "" if text in (None, "—") else re.sub(r"[ \xa0]", "", text).replace("−", "-")
