"""A figure as line strips and labels in a 2D view, which zooms and needs no plotting library.

The size of the view is chosen first. A unit of the view is a pixel of a screen of 1440 x 900; the viewer draws the same larger on
a larger screen. Everything beside the frame has a margin of its own, so that no text hides a curve.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from imuwb.analysis import Curve, Figure, Vertical
from imuwb.colors import FRAME, GRID, INK, SUBGRID
from imuwb.review.figures import drawing, legend
from imuwb.review.figures.band import band
from imuwb.review.figures.drawing import Drawing
from imuwb.review.figures.frame import Frame, Point
from imuwb.review.figures.sizes import text_width

if TYPE_CHECKING:
    import numpy as np
    import rerun as rr
    import rerun.blueprint as rrb

LABEL_DROP = 11.0  #: the viewer puts a label below its point by this much
LEFT, BOTTOM, RIGHT = 16.0, 52.0, 16.0  #: margins besides those of texts
TITLE, TEXT_ROW = 16.0, 18.0  #: height of the y axis's title above the frame; height of a row of texts there
X_TICK, X_TITLE = 14.0, 36.0  #: distances below the frame
LEAST_FRAME = 120.0  #: width and height
MARK_ABOVE, MARK_NEAR = 13.0, 14.0  #: distance of a mark's number above its point, and between numbers
POINT, LARGE_POINT, FEW_POINTS = 2.2, 3.5, 60  #: sizes of points; number up to which they are large
DASH = 7.0  #: length of a dash of a vertical line
THICKNESS = {"line": 1.6, "curve": 1.3, "points": 1.6, "fit": 0.9, "faint": 0.5, "band": 0.8, "bar": 4.5}
ALPHA = {"line": 255, "curve": 255, "points": 255, "fit": 220, "faint": 110, "band": 160, "bar": 255}
INTERVAL_ALPHA = 130
DOTTED = ("line", "points")  #: styles that show each point
GRID_ORDER, INTERVAL_ORDER, VERTICAL_ORDER, POINT_ORDER, LEGEND_ORDER, MARK_ORDER = 0, 10, 15, 25, 30, 40
#: what is drawn over what: a sigma is over the errors that it is compared with
CURVE_ORDER = {"band": 5, "faint": 12, "fit": 21, "line": 20, "curve": 22, "points": 20, "bar": 20}


@dataclass(frozen=True, slots=True)
class Margins:
    """The space around the frame, px."""

    left: float
    right: float
    top: float
    bottom: float


def draw(
    figure: Figure,
    recording: rr.RecordingStream,
    path: str,
    size: Point,
    group: Sequence[Figure] = (),
) -> rrb.View:
    """Log a figure below an entity path, and return its view.

    Args:
        figure: to draw.
        recording: where it is drawn.
        path: of its entities.
        size: width and height of the view, px.
        group: figures that share their axes with this one; the legend of the first names the curves.
    """
    sheet, bounds = drawn(figure, size, group)
    sheet.log(recording, path)
    return drawing.plane_view(path, figure.title, *bounds)


def drawn(figure: Figure, size: Point, group: Sequence[Figure] = ()) -> tuple[Drawing, tuple[Point, Point]]:
    """Return a figure as a drawing, and the ranges of x and y that its view shows."""
    group = group or (figure,)
    rows = legend.in_group(figure, group)
    margins = _margins(figure, rows, size, Frame(group, *size), above=len(group) > 1)
    width, height = size[0] - margins.left - margins.right, size[1] - margins.top - margins.bottom
    frame = Frame(group, max(width, LEAST_FRAME), max(height, LEAST_FRAME))
    sheet = Drawing()
    _grid(frame, sheet)
    texts = _axis_texts(figure, frame, margins)
    for i, curve in enumerate(figure.curves):
        _curve(curve, frame, sheet, f"curves/{i:02d}_{drawing.entity_name(curve.label) or 'curve'}")
    texts += _verticals(figure.verticals, frame, sheet)
    texts += _marks(figure, frame, sheet)
    texts += _legend(rows, frame, margins, sheet, above=len(group) > 1)
    sheet.text("texts", [((x, y - LABEL_DROP), text) for (x, y), text in texts], INK)
    x_range, y_range = (-margins.left, frame.width + margins.right), (-margins.top, frame.height + margins.bottom)
    return sheet, (x_range, y_range)


def _margins(figure: Figure, rows: Sequence[legend.Entry], size: Point, frame: Frame, *, above: bool) -> Margins:
    """Return the margins that the texts need: ticks on the left, the legend on the right or above, texts of verticals above."""
    left = LEFT + max((text_width(tick.label) for tick in frame.y.ticks()), default=0.0)
    texts_above = len(_rows_above(figure.verticals, frame)) + (
        len(legend.wrapped(rows, size[0] - left)) if above else 0
    )
    right = 0.0 if above else legend.width(rows, size[0])
    return Margins(left, max(right, RIGHT), 2 * TITLE + TEXT_ROW * texts_above, BOTTOM)


def _grid(frame: Frame, sheet: Drawing) -> None:
    """Draw the frame and its grid."""
    across = [(frame.width * tick.at, tick.label) for tick in frame.x.ticks()]
    up = [(frame.height * (1 - tick.at), tick.label) for tick in frame.y.ticks()]
    w, h = frame.width, frame.height
    strips = [[(x, 0.0), (x, h)] for x, _ in across] + [[(0.0, y), (w, y)] for y, _ in up]
    colors = [GRID if label else SUBGRID for _, label in (*across, *up)]
    strips.append([(0.0, 0.0), (w, 0.0), (w, h), (0.0, h), (0.0, 0.0)])
    sheet.line("grid", strips, [*colors, FRAME], 0.5, GRID_ORDER)


def _axis_texts(figure: Figure, frame: Frame, margins: Margins) -> list[tuple[Point, str]]:
    """Return the labels of the ticks and the titles of the axes; a label is centred on its point."""
    across = [((frame.width * tick.at, frame.height + X_TICK), tick.label) for tick in frame.x.ticks() if tick.label]
    up = [
        ((-6.0 - text_width(tick.label) / 2, frame.height * (1 - tick.at)), tick.label)
        for tick in frame.y.ticks()
        if tick.label
    ]
    title = legend.cut(figure.y_title, margins.left + frame.width)
    left = max(text_width(title) / 2 - margins.left, 0.0) if text_width(title) > frame.width else text_width(title) / 2
    return [
        *_apart(across), *up, ((frame.width / 2, frame.height + X_TITLE), figure.x_title), ((left, -TITLE), title)
    ]  # fmt: skip


def _apart(texts: list[tuple[Point, str]]) -> list[tuple[Point, str]]:
    """Return every text, or every second, third and so on, so that neighbours do not touch."""
    step = 1
    while step < len(texts) and any(
        b[0][0] - a[0][0] < (text_width(a[1]) + text_width(b[1])) / 2 + legend.GAP
        for a, b in zip(texts[::step], texts[step::step], strict=False)
    ):
        step += 1
    return texts[::step]


def _curve(curve: Curve, frame: Frame, sheet: Drawing, name: str) -> None:
    """Draw a curve: its line, its intervals and its points, as far as its style has these."""
    color = (*curve.color, ALPHA[curve.style])
    if curve.style == "band":
        band(curve, frame, sheet, name, CURVE_ORDER["band"])
        return
    if curve.style == "bar":
        ends = zip(curve.x, curve.y.clip(max=0.0), curve.y.clip(min=0.0), strict=True)
        bars = [bar for x, low, high in ends if (bar := frame.bar(x, low, high)) is not None]
        sheet.line(name, bars, [color] * len(bars), THICKNESS["bar"], CURVE_ORDER["bar"])
        return
    parts = frame.strips(curve.x, curve.y)
    strips = [part for part in parts if len(part) > 1]
    if strips and curve.style != "points":
        order = CURVE_ORDER[curve.style]
        sheet.line(name, strips, [color] * len(strips), THICKNESS[curve.style], order)
    if curve.lower is not None and curve.upper is not None:
        _intervals(curve, curve.lower, curve.upper, frame, sheet, name)
    if curve.style in DOTTED:
        places = [place for part in parts for place in part]
        sheet.point(name, places, [color] * len(places), _size(curve), POINT_ORDER)


def _size(curve: Curve) -> float:
    """Return the size of the points of a curve; the points of a short curve without a line are large."""
    return LARGE_POINT if curve.style == "points" and curve.x.size <= FEW_POINTS else POINT


def _intervals(curve: Curve, lower: np.ndarray, upper: np.ndarray, frame: Frame, sheet: Drawing, name: str) -> None:
    intervals = zip(curve.x, lower, upper, strict=True)
    bars = [bar for x, low, high in intervals if (bar := frame.bar(x, low, high)) is not None]
    if bars:
        colors = [(*curve.color, INTERVAL_ALPHA)] * len(bars)
        sheet.line(f"{name}/intervals", bars, colors, 0.8, INTERVAL_ORDER)


def _rows_above(verticals: Sequence[Vertical], frame: Frame) -> list[list[tuple[float, Vertical]]]:
    """Return the vertical lines inside, in as few rows as keep their texts apart; each with the middle of its text."""
    rows: list[list[tuple[float, Vertical]]] = []
    for vertical in sorted((v for v in verticals if frame.x.contains(v.x)), key=lambda v: v.x):
        half = text_width(vertical.text) / 2
        at = min(max(frame.width * frame.x.position(vertical.x), half), max(frame.width - half, half))
        for row in rows:
            last, other = row[-1]
            if at - half > last + text_width(other.text) / 2 + legend.GAP:
                row.append((at, vertical))
                break
        else:
            rows.append([(at, vertical)])
    return rows


def _verticals(verticals: Sequence[Vertical], frame: Frame, sheet: Drawing) -> list[tuple[Point, str]]:
    """Draw the dashed vertical lines, and return their texts, which are above the frame."""
    rows = _rows_above(verticals, frame)
    shown = [vertical for row in rows for _, vertical in row]
    if not shown:
        return []
    at = [frame.width * frame.x.position(vertical.x) for vertical in shown]
    steps = [2 * DASH * i for i in range(math.ceil(frame.height / (2 * DASH)))]
    dashes = [[(x, y), (x, min(y + DASH, frame.height))] for x in at for y in steps]
    colors = [vertical.color for vertical in shown for _ in steps]
    sheet.line("verticals", dashes, colors, 0.8, VERTICAL_ORDER)
    top = -2 * TITLE - TEXT_ROW * (len(rows) - 0.5)
    return [((x, top + TEXT_ROW * i), v.text) for i, row in enumerate(reversed(rows)) for x, v in row]


def _marks(figure: Figure, frame: Frame, sheet: Drawing) -> list[tuple[Point, str]]:
    """Draw the marks, and return their numbers; a number that another would hide stands higher."""
    numbers = legend.numbered(figure.marks)
    inside = [(m, n) for m, n in zip(figure.marks, numbers, strict=True) if frame.contains(m.x, m.y)]
    if not inside:
        return []
    places = [frame.place(mark.x, mark.y) for mark, _ in inside]
    sheet.point("marks", places, [mark.color for mark, _ in inside], 4.5, MARK_ORDER)
    texts: list[tuple[Point, str]] = []
    for (x, y), (_, number) in zip(places, inside, strict=True):
        height = y - MARK_ABOVE
        while any(math.dist((x, height), other) < MARK_NEAR for other, _ in texts):
            height -= MARK_NEAR
        if number:
            texts.append(((x, height), number))
    return texts


def _legend(
    rows: Sequence[legend.Entry],
    frame: Frame,
    margins: Margins,
    sheet: Drawing,
    *,
    above: bool,
) -> list[tuple[Point, str]]:
    """Draw the samples of the legend, and return its texts: right of the frame, or above the frame in rows."""
    places: list[tuple[Point, legend.Entry]] = []
    if above:
        for i, line in enumerate(legend.wrapped(rows, frame.width + margins.right)):
            places += [((x, TEXT_ROW * (i + 0.5) - margins.top), row) for x, row in line]
    else:
        x = frame.width + legend.GAP
        places += [((x, y), row) for y, row in legend.fitting(rows, frame.height, margins.right)]
    lines = [(p, row) for p, row in places if row.style not in ("mark", "")]
    dots = [(p, row) for p, row in places if row.style == "mark"]
    if lines:
        strips = [[(x, y), (x + legend.SAMPLE, y)] for (x, y), _ in lines]
        thickness = [THICKNESS[row.style] for _, row in lines]
        sheet.line("legend", strips, [row.color for _, row in lines], thickness, LEGEND_ORDER)
    if dots:
        middles = [(x + legend.SAMPLE / 2, y) for (x, y), _ in dots]
        sheet.point("legend", middles, [row.color for _, row in dots], 4.5, MARK_ORDER)
    return [((x + legend.SAMPLE + legend.GAP + text_width(row.text) / 2, y), row.text) for (x, y), row in places]
