"""A drawing of lines, points and texts for a 2D view.

An entity takes some kilobytes of a recording, however little it shows, so all parts of a drawing together are two entities.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from operator import attrgetter

import rerun as rr
import rerun.blueprint as rrb

from imuwb.colors import BACKGROUND
from imuwb.review.figures.frame import Point

LINES_ORDER, POINTS_ORDER = 1, 2  #: all points are over all lines


def entity_name(text: str) -> str:
    """Return a text as one part of an entity path."""
    return "".join(c if c.isalnum() else "_" for c in text)


@dataclass(frozen=True, slots=True)
class Part:
    """Some lines, points or texts of a drawing."""

    name: str
    places: Sequence[Sequence[Point]]  #: of each line; of a point or a text the one place
    colors: Sequence[tuple[int, ...]]  #: of each
    radii: Sequence[float]  #: of each: half a width in the view's units; negative: in points of the screen
    order: float = 0.0  #: a part of a higher order is drawn over the others; of one order, the later over the earlier
    texts: Sequence[str] = ()


@dataclass(slots=True)
class Drawing:
    """Lines, points and texts, which are kept until all are known."""

    lines: list[Part] = field(default_factory=list[Part])
    points: list[Part] = field(default_factory=list[Part])
    texts: list[Part] = field(default_factory=list[Part])

    def line(
        self,
        name: str,
        strips: Sequence[Sequence[Point]],
        colors: Sequence[tuple[int, ...]],
        thickness: float | Sequence[float],
        order: float = 0.0,
    ) -> None:
        """Add line strips, a colour for each; their thickness is half a width in points of the screen."""
        self.lines.append(Part(name, strips, colors, _on_screen(thickness, len(strips)), order))

    def area(
        self,
        name: str,
        strips: Sequence[Sequence[Point]],
        colors: Sequence[tuple[int, ...]],
        half: float,
        order: float = 0.0,
    ) -> None:
        """Add line strips that are areas: half their width is in the view's units, so they grow when a person zooms in."""
        self.lines.append(Part(name, strips, colors, [half] * len(strips), order))

    def point(
        self, name: str, places: Sequence[Point], colors: Sequence[tuple[int, ...]], size: float, order: float = 0.0
    ) -> None:
        """Add points, a colour for each; their size is a radius in points of the screen."""
        self.points.append(Part(name, [[place] for place in places], colors, _on_screen(size, len(places)), order))

    def text(
        self, name: str, texts: Iterable[tuple[Point, str]], color: tuple[int, ...], size: float = 0.0
    ) -> None:  # fmt: skip
        """Add texts at points; the points are visible if they have a size, in points of the screen."""
        shown = list(texts)
        places, labels = [[place] for place, _ in shown], [text for _, text in shown]
        self.texts.append(Part(name, places, [color] * len(shown), _on_screen(size, len(shown)), 0.0, labels))

    def log(self, recording: rr.RecordingStream, path: str) -> None:
        """Log all parts at an entity path, and the texts below it."""
        shown: list[rr.AsComponents] = []
        if lines := _merged(self.lines):
            shown.append(rr.LineStrips2D(lines.places, colors=lines.colors, radii=lines.radii, draw_order=LINES_ORDER))
        if points := _merged(self.points):
            places = [place for (place,) in points.places]
            shown.append(rr.Points2D(places, colors=points.colors, radii=points.radii, draw_order=POINTS_ORDER))
        if shown:
            recording.log(path, *shown, static=True)
        if texts := _merged(self.texts):
            places = [place for (place,) in texts.places]
            labelled = rr.Points2D(places, labels=texts.texts, colors=texts.colors, radii=texts.radii, show_labels=True)
            recording.log(f"{path}/texts", labelled, static=True)


def _on_screen(size: float | Sequence[float], count: int) -> Sequence[float]:
    return [-size] * count if isinstance(size, float | int) else [-one for one in size]


def _merged(parts: Sequence[Part]) -> Part | None:
    """Return all parts as one, in the order in which they are drawn; None if there is nothing to draw."""
    ordered = sorted(parts, key=attrgetter("order"))
    places, colors, radii, texts = (
        [item for part in ordered for item in getattr(part, name)] for name in ("places", "colors", "radii", "texts")
    )
    return Part("", places, colors, radii, texts=texts) if places else None


def plane_view(path: str, name: str, x_range: Sequence[float], y_range: Sequence[float]) -> rrb.View:
    """Return the view of a plane, which shows the given ranges."""
    bounds = rrb.VisualBounds2D(x_range=list(x_range), y_range=list(y_range))
    background = rrb.Background(color=BACKGROUND, kind="SolidColor")
    return rrb.Spatial2DView(origin=path, name=name, visual_bounds=bounds, background=background)
