"""A log-log figure as line strips and labels in a 2D view, which zooms and needs no plotting library."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Iterable

    from imuwb.analysis import Curve, Figure, Mark

    Point = tuple[float, float]

WIDTH, HEIGHT = 1200.0, 560.0  #: of the frame, in the view's own units
LABEL_DROP = 16.0  #: the viewer hangs a label below its point by about this much
LEGEND_STEP = 32.0
ABOVE = 26.0  #: of a mark's label above its point
THICKNESS = {"line": 1.6, "fit": 0.9, "faint": 0.5}
ASIDE = 42.0  #: between the labels of marks that would lie on each other
GRID, SUBGRID, FRAME, INK = (105, 105, 112), (58, 58, 64), (150, 150, 156), (225, 225, 228)
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class LogLog:
    """The frame of a figure: which decades it shows, and where a point of it lies."""

    def __init__(self, figure: Figure) -> None:
        """Choose whole or third decades that hold all curves and intervals."""
        self.figure = figure
        solid = [curve for curve in figure.curves if curve.style != "faint"] or list(figure.curves)
        self.x0, self.x1 = _limits(_positive(curve.x for curve in solid))
        self.y0, self.y1 = _limits(_positive(part for curve in solid for part in (curve.y, curve.lower, curve.upper)))

    def place(self, x: float, y: float) -> Point:
        """Return where a point lies in the view; y grows downward there."""
        across = (math.log10(x) - self.x0) / (self.x1 - self.x0)
        up = (math.log10(y) - self.y0) / (self.y1 - self.y0)
        return WIDTH * across, HEIGHT * (1 - up)

    def draw(self, recording: rr.RecordingStream, path: str) -> None:
        """Log the figure below an entity path."""
        self._frame(recording, path)
        for i, curve in enumerate(self.figure.curves):
            self._curve(recording, f"{path}/curves/{i:02d}_{_word(curve.label)}", curve)
        self._legend(recording, f"{path}/legend")
        self._marks(recording, f"{path}/marks")

    def bounds(self) -> tuple[list[float], list[float]]:
        """Return the x and y range that shows the figure with its titles."""
        return [-90.0, WIDTH + 25.0], [-60.0, HEIGHT + 90.0]

    def _frame(self, recording: rr.RecordingStream, path: str) -> None:
        strips: list[list[Point]] = []
        colors: list[tuple[int, int, int]] = []
        ticks: list[tuple[Point, str]] = []
        for decade in range(math.floor(self.x0), math.ceil(self.x1) + 1):
            for digit in range(1, 10):
                at = decade + math.log10(digit)
                if self.x0 - 1e-9 <= at <= self.x1 + 1e-9:
                    x = WIDTH * (at - self.x0) / (self.x1 - self.x0)
                    strips.append([(x, 0.0), (x, HEIGHT)])
                    colors.append(GRID if digit == 1 else SUBGRID)
                    if digit == 1:
                        ticks.append(((x, HEIGHT + 26), _power(decade)))
        for decade in range(math.floor(self.y0), math.ceil(self.y1) + 1):
            for digit in range(1, 10):
                at = decade + math.log10(digit)
                if self.y0 - 1e-9 <= at <= self.y1 + 1e-9:
                    y = HEIGHT * (1 - (at - self.y0) / (self.y1 - self.y0))
                    strips.append([(0.0, y), (WIDTH, y)])
                    colors.append(GRID if digit == 1 else SUBGRID)
                    if digit == 1:
                        ticks.append(((-38.0, y), _power(decade)))
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
        thickness, alpha = THICKNESS[curve.style], {"line": 255, "fit": 220, "faint": 110}[curve.style]
        color = (*curve.color, alpha)
        strips = [s for s in self._strips(curve.x, curve.y) if len(s) > 1]
        if strips:
            recording.log(
                path,
                rr.LineStrips2D(
                    strips, colors=[color] * len(strips), radii=rr.Radius.ui_points(thickness), draw_order=20.0
                ),
                static=True,
            )
        if curve.lower is not None and curve.upper is not None:
            bars = [
                [self.place(x, max(low, 10**self.y0)), self.place(x, min(high, 10**self.y1))]
                for x, low, high in zip(curve.x, curve.lower, curve.upper, strict=True)
                if np.isfinite(low) and np.isfinite(high) and high > 0 and low < 10**self.y1 and high > 10**self.y0
            ]
            if bars:
                recording.log(
                    f"{path}/intervals",
                    rr.LineStrips2D(
                        bars, colors=[(*curve.color, 130)] * len(bars), radii=rr.Radius.ui_points(0.8), draw_order=10.0
                    ),
                    static=True,
                )
        if curve.style == "line":
            points = [p for s in self._strips(curve.x, curve.y) for p in s]
            recording.log(
                f"{path}/points",
                rr.Points2D(points, colors=[color] * len(points), radii=rr.Radius.ui_points(2.2), draw_order=25.0),
                static=True,
            )

    def _strips(self, xs: Iterable[float], ys: Iterable[float]) -> list[list[Point]]:
        """Return the curve within the frame, parted where it leaves it."""
        strips: list[list[Point]] = [[]]
        last: Point | None = None
        for x, y in zip(xs, ys, strict=True):
            if not (x > 0 and y > 0 and math.isfinite(x) and math.isfinite(y)):
                last = None
                strips.append([])
                continue
            now = (math.log10(x), math.log10(y))
            if last is not None:
                piece = _clip(last, now, self.y0, self.y1)
                if piece is None:
                    strips.append([])
                else:
                    begin, end = ((self.place(10**a, 10**b)) for a, b in piece)
                    if not strips[-1] or math.dist(strips[-1][-1], begin) > 1e-6:  # noqa: PLR2004 - the same point
                        strips.append([begin])
                    strips[-1].append(end)
            elif self.y0 <= now[1] <= self.y1:
                strips[-1].append(self.place(x, y))
            last = now
        return [strip for strip in strips if strip]

    def _legend(self, recording: rr.RecordingStream, path: str) -> None:
        named = sorted((c for c in self.figure.curves if c.label), key=lambda curve: curve.style != "line")
        heights = [28.0 + LEGEND_STEP * i for i in range(len(named))]
        strips = [[(WIDTH - 190, y), (WIDTH - 145, y)] for y in heights]
        if not strips:
            return
        recording.log(
            f"{path}/lines",
            rr.LineStrips2D(
                strips,
                colors=[c.color if c.style == "line" else INK for c in named],  # a style is of all colours
                radii=rr.Radius.ui_points([THICKNESS[c.style] for c in named]),
                draw_order=30.0,
            ),
            static=True,
        )
        _texts(
            recording, f"{path}/texts", [((WIDTH - 75, y), c.label) for y, c in zip(heights, named, strict=True)], INK
        )

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
        return (
            mark.x > 0
            and mark.y > 0
            and self.x0 <= math.log10(mark.x) <= self.x1
            and self.y0 <= math.log10(mark.y) <= self.y1
        )


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


def _positive(parts: Iterable[object]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    arrays = [np.asarray(part, dtype=np.float64) for part in parts if part is not None]
    values = np.concatenate(arrays) if arrays else np.ones(1)
    values = values[np.isfinite(values) & (values > 0)]
    return values if values.size else np.ones(1)


def _limits(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> tuple[float, float]:
    """Return the exponents between which the values lie, at least a decade apart, with some air."""
    low, high = float(np.log10(values.min())), float(np.log10(values.max()))
    low, high = math.floor(low * 3 - 0.2) / 3, math.ceil(high * 3 + 0.2) / 3
    if high - low < 1:
        middle = (low + high) / 2
        low, high = middle - 0.5, middle + 0.5
    return low, high


def _clip(a: Point, b: Point, low: float, high: float) -> tuple[Point, Point] | None:
    """Return the part of a straight line (on log axes) whose y lies between two limits."""
    if max(a[1], b[1]) < low or min(a[1], b[1]) > high:
        return None

    def at(y: float) -> Point:
        return a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]), y

    ends = [p if low <= p[1] <= high else at(min(max(p[1], low), high)) for p in (a, b)]
    return ends[0], ends[1]


def _power(exponent: int) -> str:
    return f"10{str(exponent).translate(_SUPERSCRIPTS)}"


def _word(text: str) -> str:
    return "".join(c if c.isalnum() else "_" for c in text) or "curve"
