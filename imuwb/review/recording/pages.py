"""The pages of a tab: what fits on one screen is one page; more goes on on pages of its own, so that nothing is below the fold."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TypeAlias

import rerun.blueprint as rrb

from imuwb.analysis import Figure, Table
from imuwb.review.figures.sizes import (
    AREA,
    ROW,
    TABLE_FRAME,
    TABS_BAR,
    TITLE_BAR,
    notes_height,
    table_height,
    table_width,
    text_width,
)
from imuwb.texts import printable

LEAST_FIGURE, LEAST_SERIES = 385.0, 120.0  #: heights
IN_PAIRS = 3  #: more series than this are in two columns, the first half on the left
MOST_SERIES = 6  #: on a page
ABREAST, MOST_OF_GROUP = 4, 8  #: figures of a group in a row, and on a page
MOST_TEXTS = 3  #: tables in a row
MOST_PARTS = 4  #: pages of a long table
LINES = 4  #: lines of a row whose cells are broken; a table of few rows is never looked at
UNLIKE, SHORT = 2.0, 280.0  #: ratio of heights that do not go together, unless both are below this height
NOTES_WIDTH = 620.0  #: of notes beside a table
NAME_LETTERS = 34  #: of a page


@dataclass(frozen=True, slots=True)
class Notes:
    """Notes that share a view."""

    texts: tuple[str, ...]


Item: TypeAlias = Figure | Table | Notes | rrb.View  #: a view is drawn already: a series, a track, a map


@dataclass(frozen=True, slots=True)
class Cell:
    """What a view shows, and the size of the view, px."""

    item: Item
    width: float
    height: float = 0.0
    group: tuple[Figure, ...] = ()  #: figures that share their axes with this one


@dataclass(frozen=True, slots=True)
class Row:
    """Views side by side."""

    cells: tuple[Cell, ...]
    least: float  #: height
    grows: float  #: share of the height that is left on the page


@dataclass(frozen=True, slots=True)
class Page:
    """Rows that fill one screen."""

    name: str
    rows: tuple[Row, ...]


def pages(
    pictures: Sequence[rrb.View | Figure], series: Sequence[rrb.View], tables: Sequence[Table], notes: Sequence[str]
) -> tuple[Page, ...]:
    """Return the pages of a tab; each has a name for a tab within the tab."""
    texts: list[Table | Notes] = list(tables)
    if notes:
        own = Notes(tuple(notes))
        texts.insert(1 if tables and not tables[0].wide and _beside(tables[0], own) else len(texts), own)
    rows = [*_pictures(pictures), *_series(series), *_texts([part for item in texts for part in _parted(item)])]
    whole = _broken(rows, AREA[1])
    parts = whole if len(whole) < 2 else _broken(rows, AREA[1] - TABS_BAR)  # noqa: PLR2004 - several need a bar of tabs
    height = AREA[1] - (TABS_BAR if len(parts) > 1 else 0.0)
    return tuple(Page(name, _filled(part, height)) for name, part in zip(_names(parts), parts, strict=True))


def _pictures(items: Sequence[rrb.View | Figure]) -> Iterator[Row]:
    """Yield figures in pairs, and the figures of a group side by side."""
    for name, group in groupby(items, key=lambda item: item.group if isinstance(item, Figure) else ""):
        members = list(group)
        figures = tuple(item for item in members if isinstance(item, Figure)) if name else ()
        for start in range(0, len(members), MOST_OF_GROUP):
            page = members[start : start + MOST_OF_GROUP]
            abreast = -(-len(page) // -(-len(page) // ABREAST)) if name else 2
            for first in range(0, len(page), abreast):
                part = page[first : first + abreast]
                width = AREA[0] / (abreast if name else len(part))
                yield Row(tuple(Cell(item, width, group=figures) for item in part), LEAST_FIGURE, 3.0)


def _series(views: Sequence[rrb.View]) -> Iterator[Row]:
    for start in range(0, len(views), MOST_SERIES):
        page = views[start : start + MOST_SERIES]
        if len(page) <= IN_PAIRS:
            yield from (Row((Cell(view, AREA[0]),), LEAST_SERIES, 1.0) for view in page)
            continue
        half = -(-len(page) // 2)
        for i in range(half):
            part = page[i::half]
            yield Row(tuple(Cell(view, AREA[0] / len(part)) for view in part), LEAST_SERIES, 1.0)


def _texts(items: Sequence[Table | Notes]) -> Iterator[Row]:
    """Yield tables and notes; those that fit are side by side."""
    row: list[tuple[Table | Notes, float]] = []
    for item in items:
        width = AREA[0] if isinstance(item, Table) and item.wide else _natural(item)
        full = len(row) == MOST_TEXTS or sum(w for _, w in row) + width > AREA[0]
        if row and (full or not _alike(_height(item, width), _height(*row[0]))):
            yield _text_row(row)
            row = []
        row.append((item, width))
    if row:
        yield _text_row(row)


def _beside(table: Table, notes: Notes) -> bool:
    """Return whether notes fit beside a table."""
    widths = _natural(table), _natural(notes)
    return sum(widths) <= AREA[0] and _alike(*map(_height, (table, notes), widths))


def _parted(item: Table | Notes) -> tuple[Table | Notes, ...]:
    """Return a table that is higher than a page as several; the last of them may be higher, because a viewer can scroll."""
    if not isinstance(item, Table):
        return (item,)
    rows, parts, most = item.rows, list[Table](), int((AREA[1] - TABS_BAR - TITLE_BAR - TABLE_FRAME) / ROW) - 1
    while len(rows) > most // LINES and len(parts) < MOST_PARTS - 1:
        count = next((n for n in range(min(most, len(rows)), 1, -1) if _fits(replace(item, rows=rows[:n]))), 1)
        if count == len(rows):
            break
        parts.append(replace(item, rows=rows[:count], caption=""))
        rows = rows[count:]
    return (*parts, replace(item, rows=rows))


def _fits(table: Table) -> bool:
    """Return whether a page has room for a table."""
    return _height(table, AREA[0]) <= AREA[1] - TABS_BAR


def _alike(one: float, other: float) -> bool:
    """Return whether two heights go together; a short table has no place beside a long one, whose page may be another one."""
    return max(one, other) <= max(UNLIKE * min(one, other), SHORT)


def _natural(item: Table | Notes) -> float:
    if isinstance(item, Table):
        return min(max(table_width(item), text_width(item.title) + 110.0, 300.0), AREA[0])
    return min(max(map(text_width, item.texts)) + 60.0, NOTES_WIDTH)


def _text_row(row: Sequence[tuple[Table | Notes, float]]) -> Row:
    whole = sum(width for _, width in row)
    cells = tuple(Cell(item, AREA[0] * width / whole) for item, width in row)
    return Row(cells, max(_height(cell.item, cell.width) for cell in cells), 0.0)


def _height(item: Item, width: float) -> float:
    if isinstance(item, Table):
        return table_height(item, width)
    return notes_height(list(item.texts), width) if isinstance(item, Notes) else 0.0


def _broken(rows: Sequence[Row], height: float) -> list[list[Row]]:
    """Return the rows of each page."""
    parts: list[list[Row]] = []
    for row in rows:
        if not parts or sum(other.least for other in parts[-1]) + row.least > height:
            parts.append([])
        parts[-1].append(row)
    return parts


def _filled(rows: Sequence[Row], height: float) -> tuple[Row, ...]:
    """Return the rows with heights that fill a page: figures and series grow, a table only where nothing else does."""
    left = max(height - sum(row.least for row in rows), 0.0)
    growth = [row.grows for row in rows] if any(row.grows for row in rows) else [row.least for row in rows]
    heights = [row.least + left * own / sum(growth) for row, own in zip(rows, growth, strict=True)]
    return tuple(
        Row(
            tuple(Cell(cell.item, cell.width, max(high - TITLE_BAR, 1.0), cell.group) for cell in row.cells),
            high, row.grows,
        )
        for row, high in zip(rows, heights, strict=True)
    )  # fmt: skip


def _names(parts: Sequence[Sequence[Row]]) -> list[str]:
    """Return the names of pages: what each begins with; a name that comes again has a number."""
    names: list[str] = []
    for rows in parts:
        name = _begin(rows[0].cells[0].item)
        count = sum(other.partition(" (")[0] == name for other in names)
        names.append(f"{name} ({count + 1})" if count else name)
    return names


def _begin(item: Item) -> str:
    if isinstance(item, Figure):
        return "Figures"
    if isinstance(item, Notes):
        return "Notes"
    if isinstance(item, rrb.TimeSeriesView):
        return "Over time"
    title = item.title if isinstance(item, Table) else str(item.name or "Map")
    title = title.partition(":")[0]
    return printable(title if len(title) <= NAME_LETTERS else f"{title[: NAME_LETTERS - 1].rstrip()}…")
