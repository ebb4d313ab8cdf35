"""Pictures of a page: what was drawn as SVG, with a title and a description in words."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.analysis import AxisScale, Figure, Series
from imuwb.log import SECOND
from imuwb.review.drawn.calls import Drawn, Track
from imuwb.review.page.canvas import Drawing, Entry, Look, mark_text, render, render_apart
from imuwb.review.page.small import small
from imuwb.texts import names_text, seconds_text

SAMPLE = 1.5  #: lines of a legend are so much thicker than those of the drawing, which a page enlarges


@dataclass(frozen=True, slots=True)
class Picture:
    """An SVG element, and what it shows in words."""

    title: str
    svg: str
    legend: tuple[tuple[str, str], ...] = ()  #: (a sample of the line as SVG, its name), if the drawing has no legend


def drawings(drawn: Sequence[Drawn]) -> Iterator[tuple[str, Drawing]]:
    """Yield tab and content of each picture: figures and series alone, the tracks of a tab together; empty ones are left out."""
    for tab in dict.fromkeys(one.tab for one in drawn):
        items = [one.item for one in drawn if one.tab == tab]
        for item in items:
            if isinstance(item, Figure) or (isinstance(item, Series) and item.time.size):
                yield tab, item
        tracks = [item for item in items if isinstance(item, Track) and len(item.position)]
        for name in dict.fromkeys(track.picture for track in tracks):
            yield tab, [track for track in tracks if track.picture == name]


def title_of(drawing: Drawing) -> str:
    """Return the title of a picture."""
    if isinstance(drawing, Figure | Series):
        return drawing.title
    return f"{drawing[0].picture or f'Track of {drawing[0].name}'}: north up"


def picture(drawing: Drawing, look: Look, prefix: str, *, apart: bool = False) -> Picture:
    """Return a picture; its ids begin with a prefix, and its legend may be apart, so that the drawing fits a phone."""
    title, words = title_of(drawing), described(drawing)
    if not apart:
        return Picture(title, small(render(drawing, look, "svg").decode("utf-8"), prefix, title, words))
    text, entries = render_apart(drawing, look)
    return Picture(
        title, small(text.decode("utf-8"), prefix, title, words), tuple((_sample(e), e.label) for e in entries)
    )


def _sample(entry: Entry) -> str:
    """Return the line and the point of a curve as they are in the drawing."""
    look = f"opacity: {entry.opacity:g}" if entry.opacity < 1 else ""
    dashes = "stroke-dasharray: 3 1.5; " if entry.dashed else ""
    paths = ""
    if entry.line:
        style = f"fill: none; stroke: {entry.color}; stroke-width: {SAMPLE * entry.line:g}; {dashes}{look}"
        paths += f'<path d="M2 5h20" style="{style.rstrip("; ")}"/>'
    if entry.mark:
        paths += f'<path d="M12 2l3 3-3 3-3-3z" style="fill: {entry.color}"/>'
    elif entry.dot:
        style = f"fill: none; stroke: {entry.color}; stroke-width: {SAMPLE * entry.dot:g}; stroke-linecap: round"
        paths += f'<path d="M12 5h0" style="{style}"/>'
    return f'<svg viewBox="0 0 24 10" aria-hidden="true">{paths}</svg>'


_SCALES: dict[AxisScale, str] = {"log": "log", "linear": "linear", "whole": "whole numbers"}


def described(drawing: Drawing) -> str:
    """Return what a picture shows in words: its curves, its axes and their ranges, its marks."""
    if isinstance(drawing, Figure):
        curves = _names([curve.label for curve in drawing.curves])
        across = _extent([np.asarray(curve.x, float) for curve in drawing.curves])
        up = _extent([np.asarray(curve.y, float) for curve in drawing.curves])
        marks = "; ".join(mark_text(drawing, mark) for mark in drawing.marks)
        return (
            f"{curves}Across: {drawing.x_title}, {across}, {_SCALES[drawing.x_scale]}. Up: {drawing.y_title}, {up}, {_SCALES[drawing.y_scale]}."
            f"{f' Marks: {marks}.' if marks else ''}"
        )
    if isinstance(drawing, Series):
        span = seconds_text(float(drawing.time[-1] - drawing.time[0]) / SECOND) if drawing.time.size else "0 s"
        return f"{_names(drawing.names)}Over {span}, in {drawing.unit}, {_extent([np.asarray(drawing.values, float)])}."
    return f"{_names([track.label or track.name for track in drawing])}Metres east and north of the start."


def _names(labels: Sequence[str]) -> str:
    names = [label for label in dict.fromkeys(labels) if label]
    return f"Lines: {names_text(names)}. " if names else ""


def _extent(parts: Sequence[np.ndarray]) -> str:
    values = np.concatenate([part.ravel() for part in parts]) if parts else np.empty(0)
    values = values[np.isfinite(values)]
    return f"{values.min():.3g} to {values.max():.3g}" if values.size else "no values"
