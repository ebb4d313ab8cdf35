"""One tab of a recording: its views, and how they are laid out."""

from __future__ import annotations

from dataclasses import dataclass, field

import rerun as rr
import rerun.blueprint as rrb

from imuwb.review.drawing import entity_name
from imuwb.review.track import Maps, Tracks

# Shares of the tab's height for one row.
FIGURE_SHARE, SERIES_SHARE, WIDE_SHARE, TEXT_SHARE = 3.0, 1.6, 1.9, 1.5
TEXT_COLUMNS = (1.7, 1.0)  #: shares of a row with two texts; the first table is the widest


@dataclass(slots=True)
class Tab:
    """What an analysis shows on one tab."""

    name: str
    path: str  #: entity path of all that the tab shows
    tracks: Tracks
    maps: Maps
    figures: list[rrb.View] = field(default_factory=list[rrb.View])
    series: list[rrb.View] = field(default_factory=list[rrb.View])
    texts: list[rrb.View] = field(default_factory=list[rrb.View])
    wide: list[rrb.View] = field(default_factory=list[rrb.View])
    notes: list[str] = field(default_factory=list[str])

    @staticmethod
    def of(name: str) -> Tab:
        """Return an empty tab."""
        path = f"/{entity_name(name.lower())}"
        return Tab(name, path, Tracks(f"{path}/track"), Maps(f"{path}/map"))

    def add_text(self, recording: rr.RecordingStream, name: str, markdown: str, *, wide: bool = False) -> None:
        """Log a text below a heading."""
        path = f"{self.path}/text_{len(self.texts) + len(self.wide)}"
        recording.log(path, rr.TextDocument(markdown, media_type=rr.MediaType.MARKDOWN), static=True)
        (self.wide if wide else self.texts).append(rrb.TextDocumentView(origin=path, name=name))

    def add_notes(self, recording: rr.RecordingStream) -> None:
        """Log all notes as one text, and place it beside the first table."""
        if self.notes:
            self.add_text(recording, "Notes", "\n".join(f"- {note}" for note in self.notes))
            self.texts.insert(1, self.texts.pop())

    def layout(self) -> rrb.Container | None:
        """Return the arrangement of the views: figures in pairs, series, wide tables, and texts in pairs; None for an empty tab."""
        rows = [
            *((_pair(self.figures[i : i + 2]), FIGURE_SHARE) for i in range(0, len(self.figures), 2)),
            *((view, SERIES_SHARE) for view in self.series),
            *((view, WIDE_SHARE) for view in self.wide),
            *((_pair(self.texts[i : i + 2], TEXT_COLUMNS), TEXT_SHARE) for i in range(0, len(self.texts), 2)),
        ]
        if not rows:
            return None
        return rrb.Vertical(*(row for row, _ in rows), row_shares=[share for _, share in rows], name=self.name)


def _pair(views: list[rrb.View], shares: tuple[float, float] | None = None) -> rrb.Container | rrb.View:
    """Return two views side by side; a single view as it is."""
    return rrb.Horizontal(*views, column_shares=shares) if len(views) > 1 else views[0]
