"""One tab of a recording: what an analysis shows on it, drawn when its layout is known."""

from __future__ import annotations

from dataclasses import dataclass, field

import rerun as rr
import rerun.blueprint as rrb

from imuwb.analysis import Figure, Table
from imuwb.review import chart
from imuwb.review.drawing import entity_name
from imuwb.review.pages import Cell, Item, Notes, Page, pages
from imuwb.review.sizes import fitted
from imuwb.review.track import Maps, Tracks
from imuwb.texts import printable

MARKUP = str.maketrans({c: f"\\{c}" for c in "|*_`<>[]~$\\"})


@dataclass(slots=True)
class Tab:
    """What an analysis shows on one tab."""

    name: str
    path: str  #: entity path of all that the tab shows
    tracks: Tracks
    maps: Maps
    pictures: list[rrb.View | Figure] = field(default_factory=list[rrb.View | Figure])  #: figures, tracks and maps
    series: list[rrb.View] = field(default_factory=list[rrb.View])
    tables: list[Table] = field(default_factory=list[Table])
    notes: list[str] = field(default_factory=list[str])
    _drawn: int = 0  #: number of items that have entities

    @staticmethod
    def of(name: str) -> Tab:
        """Return an empty tab."""
        path = f"/{entity_name(name.lower())}"
        return Tab(name, path, Tracks(f"{path}/track"), Maps(f"{path}/map"))

    def layout(self, recording: rr.RecordingStream) -> rrb.Container | None:
        """Draw all that the tab shows, and return the arrangement of the views, with tabs for several pages; None: nothing."""
        parts = pages(self.pictures, self.series, self.tables, self.notes)
        if not parts:
            return None
        shown = [self._page(part, recording) for part in parts]
        if len(shown) == 1:
            return rrb.Vertical(*shown[0].contents, row_shares=shown[0].row_shares, name=self.name)
        return rrb.Tabs(*shown, name=self.name)

    def _page(self, page: Page, recording: rr.RecordingStream) -> rrb.Vertical:
        rows: list[rrb.Container | rrb.View] = []
        for row in page.rows:
            views = [self._view(cell, recording) for cell in row.cells]
            shares = [cell.width for cell in row.cells]
            rows.append(rrb.Horizontal(*views, column_shares=shares) if len(views) > 1 else views[0])
        return rrb.Vertical(*rows, row_shares=[row.least for row in page.rows], name=page.name)

    def _view(self, cell: Cell, recording: rr.RecordingStream) -> rrb.View:
        """Return the view of a cell; a figure, a table and notes are drawn for the size of the cell."""
        item: Item = cell.item
        if isinstance(item, rrb.View):
            return item
        number, self._drawn = self._drawn, self._drawn + 1
        if isinstance(item, Figure):
            return chart.draw(item, recording, f"{self.path}/figure_{number}", (cell.width, cell.height), cell.group)
        if isinstance(item, Notes):
            name, text = "Notes", "\n".join(f"- {literal(note)}" for note in item.texts)
        else:
            name, text = item.title, markdown(fitted(item, cell.width))
        path = f"{self.path}/text_{number}"
        recording.log(path, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
        return rrb.TextDocumentView(origin=path, name=name)


def markdown(table: Table) -> str:
    """Return a table and its caption as Markdown."""
    head = (" | ".join(map(literal, table.headings)), " | ".join("---" for _ in table.headings))
    lines = [f"| {row} |" for row in (*head, *(" | ".join(map(literal, row)) for row in table.rows))]
    return "\n".join(lines) + (f"\n\n{literal(table.caption)}" if table.caption else "")


def literal(text: str) -> str:
    """Return a text in which no character is read as markup, and which has only characters that can be shown."""
    return printable(text).translate(MARKUP)
