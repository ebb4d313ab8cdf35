"""A figure as line strips and labels in a 2D view, which zooms and needs no plotting library."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from imuwb.review.scale import Scale

if TYPE_CHECKING:
    from collections.abc import Iterable

    from imuwb.analysis import Curve, Figure, Mark

    Point = tuple[float, float]

WIDTH, HEIGHT = 1200.0, 560.0  #: of the frame, in the view's own units
LABEL_DROP = 16.0  #: the viewer hangs a label below its point by about this much
LEGEND_STEP = 32.0
LEGEND_AIR, LEGEND_LINE, LEGEND_HALF = 12.0, 45.0, 60.0
LETTER = 15.0  #: about, of a label in the view's units where the figure has a quarter of the screen
ABOVE = 26.0  #: of a mark's label above its point
THICKNESS = {"line": 1.6, "curve": 1.2, "points": 1.6, "fit": 0.9, "faint": 0.5}
ALPHA = {"line": 255, "curve": 255, "points": 255, "fit": 220, "faint": 110}
DASH = 7.0  #: of a vertical line
EDGE = 1e-9
ASIDE = 42.0  #: between the labels of marks that would lie on each other
GRID, SUBGRID, FRAME, INK = (105, 105, 112), (58, 58, 64), (150, 150, 156), (225, 225, 228)


class Chart:
    """The frame of a figure: what it shows, and where a point of it lies."""

    def __init__(self, figure: Figure) -> None:
        """Choose axes that hold all curves and intervals; faint ones may be cut off."""
        self.figure = figure
        solid = [curve for curve in figure.curves if curve.style != "faint"] or list(figure.curves)
        self.x = Scale.around(figure.x_scale, (curve.x for curve in solid), figure.x_limits)
        heights = (part for curve in solid for part in (curve.y, curve.lower, curve.upper))
        self.y = Scale.around(figure.y_scale, heights, figure.y_limits)

    def place(self, x: float, y: float) -> Point:
        """Return where a point lies in the view; y grows downward there."""
        return WIDTH * self.x.position(x), HEIGHT * (1 - self.y.position(y))

    def draw(self, recording: rr.RecordingStream, path: str) -> None:
        """Log the figure below an entity path."""
        self._frame(recording, path)
        for i, curve in enumerate(self.figure.curves):
            self._curve(recording, f"{path}/curves/{i:02d}_{_word(curve.label)}", curve)
        self._verticals(recording, f"{path}/verticals")
        self._legend(recording, f"{path}/legend")
        self._marks(recording, f"{path}/marks")

    def bounds(self) -> tuple[list[float], list[float]]:
        """Return the x and y range that shows the figure with its titles."""
        return [-90.0, WIDTH + 25.0], [-60.0, HEIGHT + 90.0]

    def _frame(self, recording: rr.RecordingStream, path: str) -> None:
        strips: list[list[Point]] = []
        colors: list[tuple[int, int, int]] = []
        ticks: list[tuple[Point, str]] = []
        for tick in self.x.ticks():
            x = WIDTH * tick.at
            strips.append([(x, 0.0), (x, HEIGHT)])
            colors.append(GRID if tick.label else SUBGRID)
            if tick.label:
                ticks.append(((x, HEIGHT + 26), tick.label))
        for tick in self.y.ticks():
            y = HEIGHT * (1 - tick.at)
            strips.append([(0.0, y), (WIDTH, y)])
            colors.append(GRID if tick.label else SUBGRID)
            if tick.label:
                ticks.append(((-42.0, y), tick.label))
        strips.append([(0.0, 0.0), (WIDTH, 0.0), (WIDTH, HEIGHT), (0.0, HEIGHT), (0.0, 0.0)])
        colors.append(FRAME)
        recording.log(
            f"{path}/grid",
            rr.LineStrips2D(strips, colors=colors, radii=rr.Radius.ui_points(0.5), draw_order=0.0),
            static=True,
        )
        titles = [
            ((WIDTH / 2, HEIGHT + 62), self.figure.x_title),
            ((WIDTH / 2, -22.0), self.figure.y_title),
        ]
        _texts(recording, f"{path}/texts", [*ticks, *titles], INK)

    def _curve(self, recording: rr.RecordingStream, path: str, curve: Curve) -> None:
        thickness = THICKNESS[curve.style]
        color = (*curve.color, ALPHA[curve.style])
        strips = [s for s in self._strips(curve.x, curve.y) if len(s) > 1]
        if strips and curve.style != "points":
            recording.log(
                path,
                rr.LineStrips2D(
                    strips, colors=[color] * len(strips), radii=rr.Radius.ui_points(thickness), draw_order=20.0
                ),
                static=True,
            )
        if curve.lower is not None and curve.upper is not None:
            bars = [
                [self.place(x, self._within(low)), self.place(x, self._within(high))]
                for x, low, high in zip(curve.x, curve.lower, curve.upper, strict=True)
                if self.x.shows(x) and math.isfinite(low) and math.isfinite(high) and self._meets(low, high)
            ]
            if bars:
                recording.log(
                    f"{path}/intervals",
                    rr.LineStrips2D(
                        bars, colors=[(*curve.color, 130)] * len(bars), radii=rr.Radius.ui_points(0.8), draw_order=10.0
                    ),
                    static=True,
                )
        if curve.style in ("line", "points"):
            points = [p for s in self._strips(curve.x, curve.y) for p in s]
            recording.log(
                f"{path}/points",
                rr.Points2D(points, colors=[color] * len(points), radii=rr.Radius.ui_points(2.2), draw_order=25.0),
                static=True,
            )

    def _within(self, y: float) -> float:
        """Return a height held within the frame."""
        ends = (10**self.y.low, 10**self.y.high) if self.y.kind == "log" else (self.y.low, self.y.high)
        return min(max(y, ends[0]), ends[1])

    def _meets(self, low: float, high: float) -> bool:
        """Return whether a bar crosses the frame; on a log axis one may begin at 0."""
        if not self.y.shows(high) or self.y.position(high) < 0:
            return False
        return not self.y.shows(low) or self.y.position(low) <= 1

    def _strips(self, xs: Iterable[float], ys: Iterable[float]) -> list[list[Point]]:
        """Return the curve within the frame, parted where it leaves it."""
        strips: list[list[Point]] = [[]]
        last: Point | None = None
        for x, y in zip(xs, ys, strict=True):
            if not (self.x.shows(x) and self.y.shows(y)) or not -EDGE <= self.x.position(x) <= 1 + EDGE:
                last = None
                strips.append([])
                continue
            now = (self.x.position(x), self.y.position(y))
            if last is not None:
                piece = _clip(last, now)
                if piece is None:
                    strips.append([])
                else:
                    begin, end = ((WIDTH * across, HEIGHT * (1 - up)) for across, up in piece)
                    if not strips[-1] or math.dist(strips[-1][-1], begin) > 1e-6:  # noqa: PLR2004 - the same point
                        strips[-1:] = [strips[-1], [begin]] if strips[-1] else [[begin]]
                    strips[-1].append(end)
            elif 0 <= now[1] <= 1:
                strips[-1].append((WIDTH * now[0], HEIGHT * (1 - now[1])))
            last = now
        return [strip for strip in strips if strip]

    def _verticals(self, recording: rr.RecordingStream, path: str) -> None:
        shown = [v for v in self.figure.verticals if self.x.shows(v.x) and 0 <= self.x.position(v.x) <= 1]
        if not shown:
            return
        at = [WIDTH * self.x.position(v.x) for v in shown]
        dashes = [[(x, y), (x, y + DASH)] for x in at for y in np.arange(0.0, HEIGHT, 2 * DASH)]
        colors = [v.color for v in shown for _ in np.arange(0.0, HEIGHT, 2 * DASH)]
        recording.log(
            f"{path}/lines",
            rr.LineStrips2D(dashes, colors=colors, radii=rr.Radius.ui_points(0.8), draw_order=15.0),
            static=True,
        )
        # Neighbours' labels stand at different heights.
        heights = [HEIGHT - 24.0 - LEGEND_STEP * (i % 4) for i in range(len(shown))]
        _texts(
            recording,
            f"{path}/texts",
            list(zip(zip(at, heights, strict=True), [v.text for v in shown], strict=True)),
            INK,
        )

    def _legend(self, recording: rr.RecordingStream, path: str) -> None:
        named = sorted((c for c in self.figure.curves if c.label), key=lambda curve: curve.style in ("fit", "faint"))
        heights = [28.0 + LEGEND_STEP * i for i in range(len(named))]
        # A label is centred on its point, and as wide on the screen as it is long.
        half = LETTER / 2 * max((len(c.label) for c in named), default=0)
        wide = 2 * max(half, LEGEND_HALF) + 2 * LEGEND_AIR + LEGEND_LINE
        side = (
            WIDTH if self._crowd(WIDTH - wide, WIDTH, heights) <= self._crowd(0.0, wide, heights) else wide + LEGEND_AIR
        )
        center = side - LEGEND_AIR - max(half, LEGEND_HALF)
        end = center - max(half, LEGEND_HALF) - LEGEND_AIR
        strips = [[(end - LEGEND_LINE, y), (end, y)] for y in heights]
        if not strips:
            return
        recording.log(
            f"{path}/lines",
            rr.LineStrips2D(
                strips,
                colors=[INK if c.style in ("fit", "faint") else c.color for c in named],  # a style is of all colours
                radii=rr.Radius.ui_points([THICKNESS[c.style] for c in named]),
                draw_order=30.0,
            ),
            static=True,
        )
        _texts(recording, f"{path}/texts", [((center, y), c.label) for y, c in zip(heights, named, strict=True)], INK)

    def _crowd(self, left: float, right: float, heights: list[float]) -> int:
        """Return how many points of curves lie where a legend would."""
        lowest = max(heights, default=0.0) + LEGEND_STEP
        count = 0
        for curve in self.figure.curves:
            for x, y in zip(curve.x.tolist(), curve.y.tolist(), strict=True):
                if math.isfinite(x) and math.isfinite(y) and (y > 0 or self.figure.y_scale == "linear"):
                    at, height = self.place(x, y)
                    count += left <= at <= right and 0 <= height <= lowest
        return count

    def _marks(self, recording: rr.RecordingStream, path: str) -> None:
        marks = [mark for mark in self.figure.marks if self._inside(mark)]
        if not marks:
            return
        places = [self.place(mark.x, mark.y) for mark in marks]
        colors = [mark.color for mark in marks]
        recording.log(
            f"{path}/points",
            rr.Points2D(places, colors=colors, radii=rr.Radius.ui_points(4.5), draw_order=40.0),
            static=True,
        )
        beside: list[Point] = []
        for x, y in places:  # side by side where they would hide each other
            crowd = sum(math.dist((x, y), other) < ASIDE for other in places[: len(beside)])
            beside.append((x + ASIDE * crowd, y - ABOVE))
        _texts(recording, f"{path}/texts", list(zip(beside, [m.text for m in marks], strict=True)), INK)

    def _inside(self, mark: Mark) -> bool:
        if not (self.x.shows(mark.x) and self.y.shows(mark.y)):
            return False
        return 0 <= self.x.position(mark.x) <= 1 and 0 <= self.y.position(mark.y) <= 1


def _texts(
    recording: rr.RecordingStream, path: str, texts: list[tuple[Point, str]], color: tuple[int, int, int]
) -> None:
    labels = [text for _, text in texts]
    places = [(x, y - LABEL_DROP) for (x, y), _ in texts]
    recording.log(
        path,
        rr.Points2D(
            places, labels=labels, colors=[color] * len(places), radii=rr.Radius.ui_points(0.0), show_labels=True
        ),
        static=True,
    )


def _clip(a: Point, b: Point) -> tuple[Point, Point] | None:
    """Return the part of a straight line whose height lies between 0 and 1."""
    if max(a[1], b[1]) < 0 or min(a[1], b[1]) > 1:
        return None

    def at(y: float) -> Point:
        return a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]), y

    ends = [p if 0 <= p[1] <= 1 else at(min(max(p[1], 0.0), 1.0)) for p in (a, b)]
    return ends[0], ends[1]


def _word(text: str) -> str:
    return "".join(c if c.isalnum() else "_" for c in text) or "curve"
