"""A figure as line strips and labels in a 2D view, which zooms and needs no plotting library."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure
from imuwb.colors import FRAME, GRID, INK, SUBGRID
from imuwb.review import drawing
from imuwb.review.frame import HEIGHT, WIDTH, Frame, Point

if TYPE_CHECKING:
    import rerun as rr
    import rerun.blueprint as rrb

# Lengths are in the view's own units, in which the frame is 1200 wide.
MARGIN_X, MARGIN_Y = (90.0, 25.0), (60.0, 90.0)  #: space for titles and labels: left and right, above and below
LABEL_DROP = 16.0  #: the viewer puts a label below its point by about this much
LEGEND_STEP = 32.0  #: distance between the lines of the legend
LEGEND_AIR, LEGEND_LINE, LEGEND_HALF = 12.0, 45.0, 60.0
LETTER = 15.0  #: approximate width of a letter if the figure fills a quarter of the screen
ABOVE = 26.0  #: distance of a mark's label above its point
ASIDE = 42.0  #: distance between the labels of marks that would hide each other
DASH = 7.0  #: length of a dash of a vertical line
VERTICAL_ROWS = 4  #: number of heights at which the texts of neighbouring vertical lines are placed
THICKNESS = {"line": 1.6, "curve": 1.2, "points": 1.6, "fit": 0.9, "faint": 0.5}
ALPHA = {"line": 255, "curve": 255, "points": 255, "fit": 220, "faint": 110}
INTERVAL_ALPHA = 130
DOTTED = ("line", "points")  #: styles that show each point
#: styles that curves of several colours share; the legend shows these styles in the colour of text
BACKGROUND_STYLES = ("fit", "faint")
GRID_ORDER, INTERVAL_ORDER, VERTICAL_ORDER, CURVE_ORDER, POINT_ORDER, LEGEND_ORDER, MARK_ORDER = (
    0,
    10,
    15,
    20,
    25,
    30,
    40,
)


def draw(figure: Figure, recording: rr.RecordingStream, path: str) -> rrb.View:
    """Log a figure below an entity path, and return its view."""
    frame = Frame(figure)
    _grid(figure, frame, recording, path)
    for i, curve in enumerate(figure.curves):
        _curve(curve, frame, recording, f"{path}/curves/{i:02d}_{drawing.entity_name(curve.label) or 'curve'}")
    _verticals(figure, frame, recording, f"{path}/verticals")
    _legend(figure, frame, recording, f"{path}/legend")
    _marks(figure, frame, recording, f"{path}/marks")
    x_range, y_range = (-MARGIN_X[0], WIDTH + MARGIN_X[1]), (-MARGIN_Y[0], HEIGHT + MARGIN_Y[1])
    return drawing.plane_view(path, figure.title, x_range, y_range)


def _grid(figure: Figure, frame: Frame, recording: rr.RecordingStream, path: str) -> None:
    """Log the frame, its grid, the labels of the ticks and the titles of the axes."""
    across = [(WIDTH * tick.at, tick.label) for tick in frame.x.ticks()]
    up = [(HEIGHT * (1 - tick.at), tick.label) for tick in frame.y.ticks()]
    strips = [[(x, 0.0), (x, HEIGHT)] for x, _ in across] + [[(0.0, y), (WIDTH, y)] for y, _ in up]
    colors = [GRID if label else SUBGRID for _, label in (*across, *up)]
    strips.append([(0.0, 0.0), (WIDTH, 0.0), (WIDTH, HEIGHT), (0.0, HEIGHT), (0.0, 0.0)])
    drawing.lines(recording, f"{path}/grid", strips, [*colors, FRAME], 0.5, GRID_ORDER)
    texts = [
        *(((x, HEIGHT + 26), label) for x, label in across if label),
        *(((-42.0, y), label) for y, label in up if label),
        ((WIDTH / 2, HEIGHT + 62), figure.x_title),
        ((WIDTH / 2, -22.0), figure.y_title),
    ]
    _texts(recording, f"{path}/texts", texts)


def _curve(curve: Curve, frame: Frame, recording: rr.RecordingStream, path: str) -> None:
    """Log a curve: its line, its intervals and its points, as far as its style has these."""
    color = (*curve.color, ALPHA[curve.style])
    parts = frame.strips(curve.x, curve.y)
    strips = [part for part in parts if len(part) > 1]
    if strips and curve.style != "points":
        drawing.lines(recording, path, strips, [color] * len(strips), THICKNESS[curve.style], CURVE_ORDER)
    if curve.lower is not None and curve.upper is not None:
        intervals = zip(curve.x, curve.lower, curve.upper, strict=True)
        bars = [bar for x, low, high in intervals if (bar := frame.bar(x, low, high)) is not None]
        if bars:
            colors = [(*curve.color, INTERVAL_ALPHA)] * len(bars)
            drawing.lines(recording, f"{path}/intervals", bars, colors, 0.8, INTERVAL_ORDER)
    if curve.style in DOTTED:
        places = [place for part in parts for place in part]
        drawing.points(recording, f"{path}/points", places, [color] * len(places), 2.2, POINT_ORDER)


def _verticals(figure: Figure, frame: Frame, recording: rr.RecordingStream, path: str) -> None:
    """Log the dashed vertical lines; the texts of neighbours are placed at different heights."""
    shown = [vertical for vertical in figure.verticals if frame.x.contains(vertical.x)]
    if not shown:
        return
    at = [WIDTH * frame.x.position(vertical.x) for vertical in shown]
    rows = np.arange(0.0, HEIGHT, 2 * DASH).tolist()
    dashes = [[(x, y), (x, y + DASH)] for x in at for y in rows]
    colors = [vertical.color for vertical in shown for _ in rows]
    drawing.lines(recording, f"{path}/lines", dashes, colors, 0.8, VERTICAL_ORDER)
    heights = [HEIGHT - 24.0 - LEGEND_STEP * (i % VERTICAL_ROWS) for i in range(len(shown))]
    texts = [((x, y), vertical.text) for x, y, vertical in zip(at, heights, shown, strict=True)]
    _texts(recording, f"{path}/texts", texts)


def _legend(figure: Figure, frame: Frame, recording: rr.RecordingStream, path: str) -> None:
    """Log the names of the curves, in the upper corner where fewer points lie."""
    named = sorted((curve for curve in figure.curves if curve.label), key=lambda c: c.style in BACKGROUND_STYLES)
    if not named:
        return
    heights = [28.0 + LEGEND_STEP * i for i in range(len(named))]
    # A label is centred on its point.
    half = max(LETTER / 2 * max(len(curve.label) for curve in named), LEGEND_HALF)
    wide = 2 * half + 2 * LEGEND_AIR + LEGEND_LINE
    lowest = heights[-1] + LEGEND_STEP
    on_right = _crowd(figure, frame, WIDTH - wide, WIDTH, lowest) <= _crowd(figure, frame, 0.0, wide, lowest)
    center = (WIDTH if on_right else wide + LEGEND_AIR) - LEGEND_AIR - half
    end = center - half - LEGEND_AIR
    strips = [[(end - LEGEND_LINE, y), (end, y)] for y in heights]
    colors = [INK if curve.style in BACKGROUND_STYLES else curve.color for curve in named]
    drawing.lines(recording, f"{path}/lines", strips, colors, [THICKNESS[c.style] for c in named], LEGEND_ORDER)
    _texts(recording, f"{path}/texts", [((center, y), curve.label) for y, curve in zip(heights, named, strict=True)])


def _crowd(figure: Figure, frame: Frame, left: float, right: float, lowest: float) -> int:
    """Return how many points of curves lie in an upper part of the frame."""
    points = [p for curve in figure.curves for p in zip(curve.x.tolist(), curve.y.tolist(), strict=True)]
    places = [frame.place(x, y) for x, y in points if frame.x.shows(x) and frame.y.shows(y)]
    return sum(left <= at <= right and 0 <= height <= lowest for at, height in places)


def _marks(figure: Figure, frame: Frame, recording: rr.RecordingStream, path: str) -> None:
    """Log the marks; labels that would hide each other are placed side by side."""
    marks = [mark for mark in figure.marks if frame.contains(mark.x, mark.y)]
    if not marks:
        return
    places = [frame.place(mark.x, mark.y) for mark in marks]
    drawing.points(recording, f"{path}/points", places, [mark.color for mark in marks], 4.5, MARK_ORDER)
    texts: list[tuple[Point, str]] = []
    for (x, y), mark in zip(places, marks, strict=True):
        crowd = sum(math.dist((x, y), other) < ASIDE for other in places[: len(texts)])
        texts.append(((x + ASIDE * crowd, y - ABOVE), mark.text))
    _texts(recording, f"{path}/texts", texts)


def _texts(recording: rr.RecordingStream, path: str, texts: list[tuple[Point, str]]) -> None:
    """Log texts whose middle lies at the given points."""
    drawing.labels(recording, path, [((x, y - LABEL_DROP), text) for (x, y), text in texts], INK)
