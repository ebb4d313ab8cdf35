"""The figures that an analysis draws, for a paper's figures."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from imuwb.analysis import Bars, Curve, Figure, Review, Series, Table
from imuwb.arrays import Floats
from imuwb.colors import Color
from imuwb.scene import Event, Scene, Span

if TYPE_CHECKING:
    import rerun as rr

MOST_POINTS = 600  #: of a curve: a figure has no more pixels


class Collector(Review):
    """A review that keeps the figures, and shows nothing."""

    def __init__(self) -> None:
        """Begin without figures."""
        self.figures = list[Figure | Bars]()

    def figure(self, figure: Figure) -> None:
        """Keep a figure."""
        self.figures.append(replace(figure, curves=tuple(map(thinned, figure.curves)), group=""))

    def bars(self, bars: Bars) -> None:
        """Keep bars."""
        self.figures.append(bars)

    def tab(self, name: str) -> None:
        """Keep no tab."""

    def series(self, series: Series) -> None:
        """Keep no series."""

    def table(self, table: Table) -> None:
        """Keep no table."""

    def track(self, name: str, position: Floats, color: Color, label: str = "") -> None:
        """Keep no track."""

    def map_track(self, name: str, position: Floats, color: Color) -> None:
        """Keep no track."""

    def note(self, text: str) -> None:
        """Keep no note."""

    def scene(self, scene: Scene) -> None:
        """Keep no scene."""

    def span(self, span: Span) -> None:
        """Keep no span."""

    def event(self, event: Event) -> None:
        """Keep no event."""

    @property
    def recording(self) -> "rr.RecordingStream":
        """There is none."""
        raise AttributeError("figures are collected, so there is no recording")


def figures_of(draw: Callable[[Any, Review], None], result: object) -> tuple[Figure | Bars, ...]:
    """Return the figures that an analysis draws of its result."""
    collector = Collector()
    draw(result, collector)
    return tuple(collector.figures)


def titled(figures: tuple[Figure | Bars, ...], *begins: str) -> tuple[Figure | Bars, ...]:
    """Return the figures whose titles begin with some texts, in the order of the texts."""
    return tuple(figure for begin in begins for figure in figures if figure.title.startswith(begin))


def thinned(curve: Curve) -> Curve:
    """Return a curve with at most ``MOST_POINTS`` of its points."""
    if curve.x.size <= MOST_POINTS:
        return curve
    kept = np.unique(np.geomspace(1, curve.x.size, MOST_POINTS).astype(int)) - 1
    ends: Mapping[str, Floats | None] = {"lower": curve.lower, "upper": curve.upper}
    return replace(
        curve, x=curve.x[kept], y=curve.y[kept], **{name: e if e is None else e[kept] for name, e in ends.items()}
    )
