"""Pictures of a page: what was drawn as SVG, with a title and a description in words."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.analysis import Figure, Series
from imuwb.log import SECOND
from imuwb.review.drawn import Drawn, Track
from imuwb.review.page.canvas import Drawing, Look, mark_text, render
from imuwb.review.page.small import small
from imuwb.texts import names_text, seconds_text


@dataclass(frozen=True, slots=True)
class Picture:
    """An SVG element, and what it shows in words."""

    title: str
    svg: str


def drawings(drawn: Sequence[Drawn]) -> Iterator[tuple[str, Drawing]]:
    """Yield tab and content of each picture: figures and series alone, the tracks of a tab together; empty ones are left out."""
    for tab in dict.fromkeys(one.tab for one in drawn):
        items = [one.item for one in drawn if one.tab == tab]
        for item in items:
            if isinstance(item, Figure) or (isinstance(item, Series) and item.time.size):
                yield tab, item
        tracks = [item for item in items if isinstance(item, Track) and len(item.position)]
        if tracks:
            yield tab, tracks


def title_of(drawing: Drawing) -> str:
    """Return the title of a picture."""
    if isinstance(drawing, Figure | Series):
        return drawing.title
    return f"Track of {drawing[0].name}: north up"


def picture(drawing: Drawing, look: Look, prefix: str) -> Picture:
    """Return a picture; its ids begin with a prefix."""
    title = title_of(drawing)
    return Picture(title, small(render(drawing, look, "svg").decode("utf-8"), prefix, title, described(drawing)))


def described(drawing: Drawing) -> str:
    """Return what a picture shows in words: its curves, its axes and their ranges, its marks."""
    if isinstance(drawing, Figure):
        curves = _names([curve.label for curve in drawing.curves])
        across = _extent([np.asarray(curve.x, float) for curve in drawing.curves])
        up = _extent([np.asarray(curve.y, float) for curve in drawing.curves])
        marks = "; ".join(mark_text(drawing, mark) for mark in drawing.marks)
        return (
            f"{curves}Across: {drawing.x_title}, {across}, {drawing.x_scale}. Up: {drawing.y_title}, {up}, {drawing.y_scale}."
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
