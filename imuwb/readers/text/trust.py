"""Finds how much of the text of a damaged packed file can be used: the lines before the first that does not look like the others."""

import re
from collections.abc import Sequence


def is_number(text: str) -> bool:
    """Return whether a cell is a number; nan and inf count as numbers."""
    try:
        float(text.strip().strip('"'))
    except ValueError:
        return False
    return text.isascii() and "_" not in text  # a number of Python's source code is no number of a log


def trusted(lines: Sequence[bytes], first: Sequence[str], delimiter: bytes) -> int:
    """Return how many lines look like the first row, before the first line that does not.

    Args:
        lines: the lines, with their line ends.
        first: the cells of a sound row.
        delimiter: the text between cells.
    """
    kinds = [(is_number(cell), _shape(cell)) for cell in first]
    for i, line in enumerate(lines):
        cells = [cell.strip().strip('"') for cell in line.decode("ascii", "replace").strip().split(delimiter.decode())]
        if cells == [""]:
            continue
        if len(cells) != len(kinds) or not all(map(_looks_like, cells, kinds)):
            return i
    return len(lines)


def _looks_like(cell: str, kind: tuple[bool, str]) -> bool:
    """Return whether a cell is empty or like the first row's cell: also a number, or a text with digits in the same places."""
    number, shape = kind
    if not cell:
        return True
    return is_number(cell) if number else _shape(cell) == shape or not any(c.isdigit() for c in shape)


def _shape(cell: str) -> str:
    """Return a cell, such as a date, with 0 for each digit."""
    return re.sub(r"\d", "0", cell)
