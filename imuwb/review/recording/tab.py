"""One tab of a recording: what an analysis shows on it, drawn when its layout is known."""

from __future__ import annotations

from dataclasses import dataclass, field

import rerun as rr
import rerun.blueprint as rrb

from imuwb.analysis import Figure, Series, Table
from imuwb.review.figures import chart
from imuwb.review.figures.drawing import entity_name
from imuwb.review.figures.sizes import fitted
from imuwb.review.figures.track import Maps, Tracks
from imuwb.review.recording.charts import charts
from imuwb.review.recording.pages import Cell, Item, Notes, Page, pages
from imuwb.review.scene.shading import event_list, shade
from imuwb.review.scene.theatre import Theatre
from imuwb.review.scene.timelines import Timelines
from imuwb.review.tables.markdown import markdown
from imuwb.scene import Event, Scene, Span
from imuwb.texts import markdown_text, printable


@dataclass(slots=True)
class Tab:
    """What an analysis shows on one tab."""

    name: str
    path: str  #: entity path of all that the tab shows
    tracks: Tracks
    maps: Maps
    pictures: list[rrb.View | Figure] = field(default_factory=list[rrb.View | Figure])  #: figures, tracks and maps
    quantities: list[Series] = field(default_factory=list[Series])  #: over time
    series: list[rrb.View] = field(default_factory=list[rrb.View])  #: the charts of ``quantities``, and the events
    tables: list[Table] = field(default_factory=list[Table])
    notes: list[str] = field(default_factory=list[str])
    spans: list[Span] = field(default_factory=list[Span])
    events: list[Event] = field(default_factory=list[Event])
    stage: Theatre | None = None  #: the views of the scene
    _drawn: int = 0  #: number of items that have entities

    @staticmethod
    def of(name: str) -> Tab:
        """Return an empty tab."""
        path = f"/{entity_name(name.lower())}"
        return Tab(printable(name), path, Tracks(f"{path}/track"), Maps(f"{path}/map"))

    def show(self, scene: Scene, recording: rr.RecordingStream, timelines: Timelines) -> None:
        """Log a scene.

        Raises:
            ValueError: the tab has a scene already.
        """
        if self.stage is not None:
            raise ValueError(
                f"tab {self.name}: a second scene, {scene.title}; a tab shows one, so open another tab for it"
            )
        self.stage = Theatre.of(scene, recording, timelines, f"{self.path}/scene")

    def finish(self, recording: rr.RecordingStream, timelines: Timelines) -> None:
        """Log the tracks, and the spans and the events, whose places in the charts follow from all that the tab shows."""
        self.tracks.log(recording)
        drawn = list(charts(
            self.quantities, recording, timelines, self.path, beside=self.stage is not None,
            plain=not (self.spans or self.events),
        ))  # fmt: skip
        self.series += [view for view, _ in drawn]
        if self.series and self.stage is None and timelines.windows:
            first, whole = timelines.windows[0].name, timelines.clock.timeline
            self.notes.insert(0, f"The charts show the {first}: for the whole log, choose {whole} at the lower left.")
        for _, shown in drawn:
            shade(shown, [*shown.spans, *self.spans], self.events, recording, timelines)
        if self.events:
            view = event_list(self.events, timelines, f"{self.path}/events")
            (self.series if self.stage is None else self.stage.below).append(view)

    def layout(self, recording: rr.RecordingStream) -> rrb.Container | None:
        """Draw all that the tab shows, and return the arrangement of the views, with tabs for several pages; None: nothing."""
        parts = pages(self.pictures, self.series if self.stage is None else (), self.tables, self.notes)
        shown = [self._page(part, recording) for part in parts]
        if self.stage is not None:
            shown.insert(0, self.stage.layout("In time", self.series, [*map(self._entries, self.quantities)]))
        if not shown:
            return None
        if len(shown) == 1:
            return rrb.Vertical(*shown[0].contents, row_shares=shown[0].row_shares, name=self.name)
        return rrb.Tabs(*shown, name=self.name)

    def _entries(self, series: Series) -> int:
        """Return the number of rows of the legend of a chart beside a scene."""
        shaded = {span.text for span in (*series.spans, *self.spans)}
        marked = {event.level for event in self.events if event.level != "note"}
        return len({*series.names}) + len(shaded) + len(marked)

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
            name, text = "Notes", "\n".join(f"- {markdown_text(note)}" for note in item.texts)
        else:
            name, text = item.title, markdown(fitted(item, cell.width))
        path = f"{self.path}/text_{number}"
        recording.log(path, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
        return rrb.TextDocumentView(origin=path, name=printable(name))
