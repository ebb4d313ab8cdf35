"""How far the text of a damaged packed file can be used: up to the first line that is no row like the others."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

DAMAGED = "the packed file is damaged"  #: how a note of it begins
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf)(inity)?", re.IGNORECASE)


def is_number(text: str) -> bool:
    """Return whether a cell reads as a number (nan and inf are)."""
    return bool(_NUMBER.fullmatch(text.strip().strip('"')))


def trusted(lines: Sequence[bytes], first: Sequence[str], mark: bytes) -> int:
    """Return how many of the lines are rows like the first one, before one that is not.

    Args:
        lines: with their ends.
        first: the cells of a row that is sound.
        mark: between cells.
    """
    kinds = [is_number(cell) for cell in first]
    shapes = [_shape(cell) for cell in first]
    for i, line in enumerate(lines):
        cells = [cell.strip().strip('"') for cell in line.decode("ascii", "replace").strip().split(mark.decode())]
        if cells == [""]:
            continue
        alike = len(cells) == len(kinds) and all(
            not cell or (is_number(cell) if number else _shape(cell) == shape or not any(c.isdigit() for c in shape))
            for cell, number, shape in zip(cells, kinds, shapes, strict=True)
        )
        if not alike:
            return i
    return len(lines)


def _shape(cell: str) -> str:
    """Return a date, say, with all digits alike."""
    return re.sub(r"\d", "0", cell)
