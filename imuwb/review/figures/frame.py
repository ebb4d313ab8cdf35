"""The frame of a figure: where a point lies in the view, and which parts of curves are inside."""

import math
from collections.abc import Iterable, Sequence
from typing import TypeAlias

from imuwb.analysis import Curve, Figure
from imuwb.review.figures.scale import Scale

Point: TypeAlias = tuple[float, float]

SAME = 1e-6  #: greatest distance between two points that count as one, in the view's units


class Frame:
    """The two axes of a figure, and the size of their frame in the view's units; the origin is its upper left corner."""

    def __init__(self, figures: Sequence[Figure], width: float, height: float) -> None:
        """Choose axes that contain all curves and intervals of the figures that share them; faint curves may be cut off."""
        self.width, self.height = width, height
        first = figures[0]
        curves = [curve for figure in figures for curve in _solid(figure)]
        xs = [limits for figure in figures if (limits := figure.x_limits) is not None]
        ys = [limits for figure in figures if (limits := figure.y_limits) is not None]
        self.x = Scale.around(first.x_scale, (curve.x for curve in curves), _widest(xs))
        heights = (part for curve in curves for part in (curve.y, curve.lower, curve.upper))
        self.y = Scale.around(first.y_scale, heights, _widest(ys))

    def place(self, x: float, y: float) -> Point:
        """Return where a point lies in the view; y grows downward there."""
        return self._view((self.x.position(x), self.y.position(y)))

    def contains(self, x: float, y: float) -> bool:
        """Return whether a point lies inside."""
        return self.x.contains(x) and self.y.contains(y)

    def bar(self, x: float, low: float, high: float) -> list[Point] | None:
        """Return the part of an interval that is inside, as a vertical line; None if no part is."""
        if not (self.x.contains(x) and math.isfinite(low) and self.y.shows(high)) or self.y.position(high) < 0:
            return None
        # On a logarithmic axis the lower end may be 0, below any frame.
        bottom = self.y.position(low) if self.y.shows(low) else 0.0
        if bottom > 1:
            return None
        across = self.x.position(x)
        return [self._view((across, max(bottom, 0.0))), self._view((across, min(self.y.position(high), 1.0)))]

    def strips(self, xs: Iterable[float], ys: Iterable[float]) -> list[list[Point]]:
        """Return the parts of a curve that are inside; a point without a neighbour is a part."""
        parts: list[list[Point]] = []
        last: Point | None = None
        for x, y in zip(xs, ys, strict=True):
            if not (self.x.contains(x) and self.y.shows(y)):
                last = None
                continue
            now = (self.x.position(x), self.y.position(y))
            piece = _clip(last or now, now)
            if piece is not None:
                begin, end = self._view(piece[0]), self._view(piece[1])
                if last is None or not parts or math.dist(parts[-1][-1], begin) > SAME:
                    parts.append([begin])
                if last is not None:
                    parts[-1].append(end)
            last = now
        return parts

    def _view(self, position: Point) -> Point:
        """Return the point of the view for a position on both axes, 0 to 1 from left to right and from bottom to top."""
        return self.width * position[0], self.height * (1 - position[1])


def _solid(figure: Figure) -> Sequence[Curve]:
    return [curve for curve in figure.curves if curve.style != "faint"] or list(figure.curves)


def _widest(limits: Sequence[tuple[float, float]]) -> tuple[float, float] | None:
    return (min(low for low, _ in limits), max(high for _, high in limits)) if limits else None


def _clip(a: Point, b: Point) -> tuple[Point, Point] | None:
    """Return the part of a straight line whose height lies between 0 and 1."""
    if max(a[1], b[1]) < 0 or min(a[1], b[1]) > 1:
        return None

    def at(y: float) -> Point:
        return a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]), y

    first, last = (p if 0 <= p[1] <= 1 else at(min(max(p[1], 0.0), 1.0)) for p in (a, b))
    return first, last
