"""The frame of a figure: where a point lies in the view, and which parts of curves are inside."""

import math
from collections.abc import Iterable
from typing import TypeAlias

from imuwb.analysis import Figure
from imuwb.review.scale import Scale

Point: TypeAlias = tuple[float, float]

WIDTH, HEIGHT = 1200.0, 560.0  #: size of the frame, in the view's own units
SAME = 1e-6  #: greatest distance between two points that count as one, in the view's units


class Frame:
    """The two axes of a figure."""

    def __init__(self, figure: Figure) -> None:
        """Choose axes that contain all curves and intervals; faint curves may be cut off."""
        solid = [curve for curve in figure.curves if curve.style != "faint"] or list(figure.curves)
        self.x = Scale.around(figure.x_scale, (curve.x for curve in solid), figure.x_limits)
        heights = (part for curve in solid for part in (curve.y, curve.lower, curve.upper))
        self.y = Scale.around(figure.y_scale, heights, figure.y_limits)

    def place(self, x: float, y: float) -> Point:
        """Return where a point lies in the view; y grows downward there."""
        return _view((self.x.position(x), self.y.position(y)))

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
        return [_view((across, max(bottom, 0.0))), _view((across, min(self.y.position(high), 1.0)))]

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
                begin, end = _view(piece[0]), _view(piece[1])
                if last is None or not parts or math.dist(parts[-1][-1], begin) > SAME:
                    parts.append([begin])
                if last is not None:
                    parts[-1].append(end)
            last = now
        return parts


def _view(position: Point) -> Point:
    """Return the point of the view for a position on both axes, 0 to 1 from left to right and from bottom to top."""
    return WIDTH * position[0], HEIGHT * (1 - position[1])


def _clip(a: Point, b: Point) -> tuple[Point, Point] | None:
    """Return the part of a straight line whose height lies between 0 and 1."""
    if max(a[1], b[1]) < 0 or min(a[1], b[1]) > 1:
        return None

    def at(y: float) -> Point:
        return a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]), y

    first, last = (p if 0 <= p[1] <= 1 else at(min(max(p[1], 0.0), 1.0)) for p in (a, b))
    return first, last
