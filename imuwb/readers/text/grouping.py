"""Numbers whose digits are in groups, such as ``1,234.5``: a separator of thousands is no decimal mark."""

import re
from collections.abc import Iterable

from imuwb.errors import UsageError

#: number in groups, by separator and decimal mark; a group never follows a leading 0
_GROUPED = r"[+-]?[1-9]\d{{0,2}}(?:{0}\d{{3}})+(?:{1}\d*)?"
_COMMAS, _POINTS = re.compile(_GROUPED.format(",", r"\.")), re.compile(_GROUPED.format(r"\.", ","))
_APOSTROPHES = re.compile(_GROUPED.format("'", "[.,]"))
_POINT, _COMMA = re.compile(r"[+-]?\d*\.\d+(?:[eE][+-]?\d+)?"), re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
_QUOTED = re.compile(rb'"[^"\n]*"')


def marks_of(path: object, cells: Iterable[str], decimal: str) -> tuple[str, str]:
    """Return the decimal mark and the separator of thousands of the cells of a table's first rows; empty: there is none.

    Args:
        path: the file, for the message.
        cells: as they are in the file.
        decimal: the mark by which most cells are numbers.

    Raises:
        UsageError: commas may be either.
    """
    special, pointed = set[str](), False
    for cell in cells:
        if "," in cell or "'" in cell:
            special.add(cell)
        elif not pointed and "." in cell:
            pointed = _POINT.fullmatch(cell) is not None
    if not special:
        return decimal, ""
    if any(_APOSTROPHES.fullmatch(cell) for cell in special):
        return decimal, "'"
    if any("," in cell and _POINTS.fullmatch(cell) for cell in special):
        return ",", "."
    grouped = [cell for cell in special if _COMMAS.fullmatch(cell)]
    if not grouped or any(_COMMA.fullmatch(cell) and not _COMMAS.fullmatch(cell) for cell in special):
        return decimal, ""
    if decimal == "." or pointed or any("." in cell or cell.count(",") > 1 for cell in grouped):
        return ".", ","
    raise UsageError(
        f"{path}: cells such as {min(grouped)!r} may be thousands or have a decimal comma, and no other cell shows which; write the "
        "numbers without separators of thousands, or with a decimal point"
    )


def ungrouped(data: bytes, delimiter: str, thousands: str) -> bytes:
    """Return lines without separators of thousands; where the separator is the delimiter too, those within quotes."""
    mark = re.escape(thousands.encode())
    between = re.compile(rb"(?<=\d)" + mark + rb"(?=\d{3}(?!\d))")
    if thousands != delimiter:
        return between.sub(b"", data)
    return _QUOTED.sub(lambda cell: between.sub(b"", cell[0]), data)
