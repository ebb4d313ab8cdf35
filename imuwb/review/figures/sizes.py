"""Sizes of texts and views on a screen, px: what is drawn is laid out before the viewer shows it."""

import textwrap

from imuwb.analysis import Table

#: what a tab has on a screen of 1440 x 900, below the viewer's bars; larger screens show the same larger
AREA = (1440.0, 806.0)
TABS_BAR = 28.0  #: height of the bar of tabs within a tab
TITLE_BAR = 26.0  #: height of the bar above a view
NARROW, WIDE = frozenset("iljftI.,:;|!'`[]()/\\ "), frozenset("mwMW%@—√")
LETTER, NARROW_LETTER, WIDE_LETTER, CAPITAL = 6.9, 3.9, 10.3, 7.9  # widths
MONOSPACE = 7.7  #: width of a letter in a block of code
ROW, LINE = 23.0, 15.5  #: height of a row of a table, and of a line of text
COLUMN_GAP = 8.0
LEGEND_ROW = 23.0  #: height of a row of the legend of a chart over time
AIR = 30.0  #: around a table, left and right together
TABLE_FRAME, CAPTION_GAP = 52.0, 18.0  #: heights
LEAST_COLUMN = 12  #: letters


def text_width(text: str) -> float:
    """Return the width of a text in the viewer's font."""
    return sum(map(_letter_width, text))


def _letter_width(letter: str) -> float:
    if letter in NARROW:
        return NARROW_LETTER
    if letter in WIDE:
        return WIDE_LETTER
    return CAPITAL if letter.isupper() or letter.isdigit() else LETTER


def table_width(table: Table) -> float:
    """Return the width of a table without a cell that is broken into lines."""
    return sum(_column_widths(table)) + AIR


def _column_widths(table: Table) -> list[float]:
    rows = (table.headings, *table.rows)
    count = max(map(len, rows))
    return [max((text_width(row[i]) for row in rows if i < len(row)), default=0.0) + COLUMN_GAP for i in range(count)]


ROUNDING = 1e-6  #: px, of sums of widths: a column is exactly as wide as its widest cell


def fitted(table: Table, width: float) -> Table:
    """Return a table of at most that width: its widest cells go on in the rows below.

    The viewer cuts off a table that is wider than its view, and breaks no cell.
    """
    widths = _column_widths(table)
    excess = sum(widths) + AIR - width
    while excess > 0 and max(widths) > LEAST_COLUMN * LETTER:
        widest = max(range(len(widths)), key=widths.__getitem__)
        others = sorted(widths, reverse=True)[1:2] or [0.0]
        cut = min(excess, max(widths[widest] - others[0], LETTER))
        widths[widest] -= cut
        excess -= cut
    headings, *rows = (_broken(row, widths) for row in (table.headings, *table.rows))
    # A heading has one row; what does not fit follows as the first row.
    first, *more = headings
    return Table(table.title, first, tuple(line for row in (more, *rows) for line in row), table.caption, table.wide)


def _broken(row: tuple[str, ...], widths: list[float]) -> list[tuple[str, ...]]:
    """Return a row as one or more rows, in which no cell is wider than its column."""
    cells = [broken_text(cell, width - COLUMN_GAP) for cell, width in zip(row, widths, strict=False)]
    return [tuple(cell[i] if i < len(cell) else "" for cell in cells) for i in range(max(map(len, cells), default=1))]


def broken_text(text: str, width: float) -> list[str]:
    """Return a text as lines of at most a width, broken between words; a word that is too long is broken too."""
    if text_width(text) <= width + ROUNDING:
        return [text]
    letters = max(int(len(text) * width / text_width(text)), 1)
    lines = textwrap.wrap(text, letters)
    while letters > 1 and any(text_width(line) > width for line in lines):
        letters -= 1
        lines = textwrap.wrap(text, letters)
    return lines or [""]


def table_height(table: Table, width: float) -> float:
    """Return the height of the view of a table that has that width, with its title and caption."""
    rows = len(fitted(table, width).rows) + 1
    caption = CAPTION_GAP + LINE * len(broken_text(table.caption, width - AIR)) if table.caption else 0.0
    return TITLE_BAR + TABLE_FRAME + ROW * rows + caption


def notes_height(notes: list[str], width: float) -> float:
    """Return the height of the view of notes, one below the other."""
    return TITLE_BAR + 30.0 + sum(LINE * len(broken_text(note, width - 50.0)) + 3.0 for note in notes)
