"""The layout of a text file, from its first lines: encoding, delimiter, decimal mark, header, and the first rows."""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import le
from pathlib import Path

from imuwb.errors import ImuwbError, UnreadableLogError
from imuwb.readers.bytes import source
from imuwb.readers.text.column_names import columns
from imuwb.readers.text.encoding import Encoding, encoding_of, head_text
from imuwb.readers.text.grouping import marks_of, ungrouped
from imuwb.readers.text.trust import is_number
from imuwb.units import unit

COMMENT = ("#", "%", "//")
DELIMITER_ROWS = 50  #: number of last rows of the file's head in which the delimiter is found
SAMPLE = 1024  #: rows whose cells are kept
_MARK = re.compile(r"^\s*(?:#+|%+|//+)\s*")
LONGEST_NAME = 120  #: characters
#: (delimiter, decimal mark); of two that fit equally well, the first. A blank means any run of blanks.
_MARKS = (
    (",", "."), (";", "."), ("\t", "."), ("|", "."), (";", ","), ("\t", ","), (",", ","), (" ", "."), (" ", ","),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Tag:
    """What the rows of one table have in common in a file of several."""

    column: int
    text: str  #: the cell of that column
    checked: bool = False  #: rows end with the checksum of NMEA 0183, ``*5F``
    keyed: bool = False  #: a row has a name before each value, as in ``keyed_lines``


@dataclass(frozen=True, slots=True)
class Layout:
    """The delimiter, header and first rows of a text file."""

    delimiter: str  #: " " means any run of blanks
    skip: int  #: lines before the first row of numbers
    names: tuple[str, ...]  #: names in the header, each with its unit; empty without a header
    first: tuple[str, ...]  #: the cells of the first whole row of numbers
    cut_first: bool = False  #: the file begins in the middle of a line, which is skipped
    fault: str = ""  #: why the content of the packed file may be wrong; empty for a sound file
    decimal: str = "."  #: decimal mark; cells in ``first`` and ``sample`` have a point
    thousands: str = ""  #: separator of the thousands of a number; empty in nearly all files
    marked: str = ""  #: mark at the beginning of every row of numbers, such as "#"; empty in nearly all files
    sample: tuple[tuple[str, ...], ...] = ()  #: the cells of the first rows
    comments: tuple[str, ...] = ()  #: the lines before the first row, apart from the header
    encoding: Encoding = field(default_factory=Encoding)
    tag: Tag | None = None  #: of a table in a file of several

    @property
    def parsed_delimiter(self) -> str:
        """The delimiter after runs of blanks are replaced by commas."""
        return "," if self.delimiter == " " else self.delimiter

    def cells(self, column: int) -> list[str]:
        """Return the cells of a column in the first rows."""
        return [row[column] for row in self.sample]


def layout_of(path: Path) -> Layout:
    """Return the layout of a text file, from its first lines.

    Raises:
        UnreadableLogError: these lines have no row of numbers.
    """
    encoding = encoding_of(source.head(path))
    found = _layout(path, head_lines(path))
    return replace(found, fault=source.packed_fault(path), encoding=encoding)


def head_lines(path: Path) -> list[str]:
    """Return the lines of a file's head."""
    head = source.head(path)
    lines = head_text(head, encoding_of(head)).split(b"\n")
    lines = lines[:-1] if len(lines) > 1 else lines  # the last one may continue after the head
    return [line.decode("utf-8", "replace").strip("\r") for line in lines]


def _layout(path: Path, texts: list[str]) -> Layout:
    filled = [i for i, text in enumerate(texts) if text.strip()]
    rows = [i for i in filled if not is_comment(texts[i])]
    marked = ""
    if not rows:
        marked, rows = _marked_rows(texts, filled)
    if not rows:
        raise UnreadableLogError(f"{path}: the first {len(texts)} lines are all comments; a log needs rows of numbers")
    bare = [text.strip().removeprefix(marked) if marked else text for text in texts]
    delimiter, decimal = _marks([bare[i] for i in rows])
    decimal, thousands = _grouped(path, [bare[i] for i in rows], delimiter, decimal)
    if thousands:
        bare = [ungrouped(text.encode(), delimiter, thousands).decode() for text in bare]
    cells = {i: cells_of(bare[i], delimiter, decimal) for i in rows}
    numeric = [i for i in rows if is_numeric(cells[i])]
    if not numeric:
        raise UnreadableLogError(
            f"{path}: this text has no rows of numbers (its first line is {texts[rows[0]][:60]!r}); "
            "a log has numbers separated by commas, semicolons, tabs or blanks"
        )
    usual = max(set(sizes := [len(cells[i]) for i in numeric]), key=sizes.count)
    whole = [i for i in numeric if len(cells[i]) == usual]
    first = _first_like_others(whole, cells)
    before = [i for i in filled if i < first]
    header = _header([texts[i] for i in before], delimiter, usual, ends_empty=all(not cells[i][-1] for i in whole))
    if header.names:  # a first row with a text among its numbers is a row all the same
        last = before[max(header.lines)]
        first = next(i for i in whole if i > last)
        before = [i for i in before if i < first]
    else:
        first, before = whole[0], [i for i in filled if i < numeric[0]]
    return Layout(
        delimiter, first, header.names, tuple(cells[first]),
        cut_first=not header.names and len(cells[numeric[0]]) < usual,
        decimal=decimal, marked=marked, thousands=thousands,
        sample=tuple(tuple(cells[i]) for i in whole if i >= first)[:SAMPLE],
        comments=tuple(texts[i] for k, i in enumerate(before) if k not in header.lines),
    )  # fmt: skip


def _grouped(path: Path, rows: list[str], delimiter: str, decimal: str) -> tuple[str, str]:
    """Return the decimal mark, and the separator of thousands, which only quoted cells, or those of other delimiters, can have."""
    if delimiter == " " or (delimiter == "," and not any('"' in row or "'" in row for row in rows)):
        return decimal, ""
    cells = (cell for row in rows for cell in cells_of(row, delimiter))
    return marks_of(path, cells, decimal)


def _first_like_others(whole: list[int], cells: Mapping[int, list[str]]) -> int:
    """Return the first row that has no text where most rows have numbers: lines such as ``Serial,1234`` may be before a header."""
    texts = [[bool(cell) and not is_number(cell) for cell in cells[i]] for i in whole]
    usual = [2 * sum(column) > len(whole) for column in zip(*texts, strict=True)]
    return next((i for i, row in zip(whole, texts, strict=True) if all(map(le, row, usual))), whole[0])


def is_comment(text: str) -> bool:
    """Return whether a line begins like a comment; it may be a header all the same."""
    return text.lstrip().startswith(COMMENT)


def _marked_rows(texts: list[str], filled: list[int]) -> tuple[str, list[int]]:
    """Return the mark with which all lines begin, and the lines, if most of them are rows of numbers without it."""
    for mark in COMMENT:
        rows = [i for i in filled if texts[i].lstrip().startswith(mark)]
        bare = [texts[i].strip().removeprefix(mark) for i in rows]
        if len(bare) > 1 and any(
            sum(len(cells) > 1 and is_numeric(cells) for cells in (cells_of(x, *marks) for x in bare)) > len(bare) / 2
            for marks in _MARKS
        ):
            return mark, rows
    return "", []


def is_numeric(cells: Sequence[str]) -> bool:
    """Return whether at least half of the cells that are not empty are numbers."""
    filled = [cell for cell in cells if cell]
    numbers = sum(map(is_number, filled))
    return numbers > 0 and numbers * 2 >= len(filled)


def _marks(rows: list[str]) -> tuple[str, str]:
    """Return the delimiter and the decimal mark that make the most rows of numbers, each of as many cells as the others."""
    last = rows[-DELIMITER_ROWS:]
    best = max(_MARKS, key=lambda marks: _fit(last, *marks))
    if best == (",", ".") and all(row.count(",") == 1 for row in last):
        # One column with a decimal comma looks like two columns; the header shows that it is one.
        named = [row for row in rows if not is_numeric(cells_of(row, *best))]
        if named and "," not in named[-1]:
            return ";", ","
    return best


def _fit(rows: list[str], delimiter: str, decimal: str) -> tuple[int, float]:
    """Return how many rows have the usual number of cells and are numeric, and their share of numbers among all cells."""
    numeric = [cells for row in rows if is_numeric(cells := cells_of(row, delimiter, decimal))]
    if not numeric:
        return 0, 0.0
    usual = max(set(sizes := [len(cells) for cells in numeric]), key=sizes.count)
    whole = [cells for cells in numeric if len(cells) == usual]
    numbers = sum(is_number(cell) for cells in whole for cell in cells if cell)
    return len(whole), numbers / sum(1 for cells in whole for cell in cells if cell)


def cells_of(row: str, delimiter: str, decimal: str = ".") -> list[str]:
    """Return the cells of a line, without blanks and quotes around them, and with a decimal point."""
    if delimiter == " ":
        parts = row.split()
    elif '"' in row:
        # A lone CR within a damaged line would end the row for the parser.
        parts = next(csv.reader([row.strip().replace("\r", " ")], delimiter=delimiter, skipinitialspace=True), [""])
    else:
        parts = row.strip(" \r").split(delimiter)
    cells = [part.strip().strip('"') for part in parts]
    return cells if decimal == "." else [_with_point(cell) for cell in cells]


def _with_point(cell: str) -> str:
    """Return a number with a decimal comma with a point; any other text as it is."""
    number = cell.replace(",", ".", 1)
    return number if is_number(number) else cell


@dataclass(frozen=True, slots=True)
class _Header:
    names: tuple[str, ...] = ()
    lines: tuple[int, ...] = ()  #: places of the header's lines


def _header(before: list[str], delimiter: str, usual: int, *, ends_empty: bool) -> _Header:
    """Return the header of a table: a line of names before its rows, and a line of units after it if there is one.

    A line without a comment's mark goes before one with it, and a later line before an earlier one.
    """
    found = {
        k: cells for k, text in enumerate(before) if (cells := _names(text, delimiter, usual, ends_empty=ends_empty))
    }
    if not found:
        return _Header()
    units = [k for k, cells in found.items() if _are_units(cells)]
    titles = [k for k in found if k not in units] or list(found)
    title = max(titles, key=lambda k: (not is_comment(before[k]), k))
    below = next((k for k in units if k > title), None)
    if below is None:
        return _Header(tuple(found[title]), (title,))
    named = (
        f"{name} [{measure}]" if measure and measure != "-" else name
        for name, measure in zip(found[title], map(_bare_unit, found[below]), strict=True)
    )
    return _Header(tuple(named), (title, below))


def _names(text: str, delimiter: str, usual: int, *, ends_empty: bool) -> list[str] | None:
    """Return the cells of a line if they can be the names, or the units, of the columns."""
    comment = is_comment(text)
    bare = _MARK.sub("", text) if comment else text
    for marks in dict.fromkeys((delimiter, ",", ";", "\t")):
        cells = cells_of(bare, marks)
        if len(cells) == usual + 1 and not cells[-1]:
            cells.pop()
        elif len(cells) == usual - 1 and ends_empty:
            cells.append("")
        if len(cells) != usual or is_numeric(cells) or not _are_names(cells):
            continue
        if not comment or marks != " " or _any_known(cells):
            return cells
    return None


def _are_names(cells: list[str]) -> bool:
    """Return whether at least half of the cells are short texts with a letter."""
    return 2 * sum(len(cell) < LONGEST_NAME and any(map(str.isalpha, cell)) for cell in cells) >= len(cells)


def _any_known(cells: list[str]) -> bool:
    """Return whether a cell is the name of a known quantity; a sentence has as many words as some rows have cells."""
    try:
        return bool(columns(tuple(cells), {}))
    except ImuwbError:
        return True


def _bare_unit(cell: str) -> str:
    """Return a cell of a row of units without its brackets."""
    return cell.strip().strip("()[]").strip()


def _are_units(cells: list[str]) -> bool:
    """Return whether at least half of the cells that are not empty are units."""
    filled = [cell for cell in map(_bare_unit, cells) if cell and cell != "-"]
    return bool(filled) and 2 * sum(map(_is_unit, filled)) >= len(filled)


def _is_unit(text: str) -> bool:
    try:
        return bool(unit(text))
    except ImuwbError:
        return False
