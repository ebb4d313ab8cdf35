"""The trajectories of a tab: in local east and north, and on a map."""

import math

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from imuwb.arrays import Floats
from imuwb.colors import INK, Color
from imuwb.review.figures import drawing
from imuwb.review.figures.frame import Point

EARTH_RADIUS = 6_371_000.0  #: m; a track is drawn on a plane, where a sphere is good enough
POINTS = 10_000  #: least number of points of a long track that are drawn; a line on a screen shows no more
AIR = 0.15  #: space around a track for the labels, as a share of the extent of the track
BELOW = 0.08  #: distance of the ruler below the track, as a share of the track's extent
RULER_LABEL = 0.04  #: distance of the ruler's text below the ruler, as a share of the track's extent


class Tracks:
    """The tracks of a tab in one picture: east to the right, north up, metres from the first point of the first track."""

    def __init__(self, path: str) -> None:
        """Begin a picture below an entity path."""
        self.path = path
        self._origin: Floats | None = None
        self._count = 0
        self.drawing = drawing.Drawing()

    def log(self, recording: rr.RecordingStream) -> None:
        """Log all tracks."""
        self.drawing.log(recording, self.path)

    def add(self, name: str, position: Floats, color: Color, label: str) -> rrb.View | None:
        """Add a track, with a label at its end; return the picture's view with the first track.

        Args:
            name: name of the track.
            position: (n, 3) latitude rad, longitude rad, height m.
            color: colour of the track.
            label: text at the end of the track; empty: no label.
        """
        origin = self._origin = position[0] if self._origin is None else self._origin
        points = thinned(local_plane(position, origin))
        number, self._count = self._count, self._count + 1
        self.drawing.line(name, [points.tolist()], [color], 1.5)
        if label:
            self.drawing.text(name, [(_point(points[-1]), label)], color, 3.0)
        return None if number else self._framed(name, points)

    def _framed(self, name: str, points: Floats) -> rrb.View:
        """Draw the start and a ruler of the first track, and return a view that is as large as that track."""
        low, high = points.min(axis=0), points.max(axis=0)
        span = max(float((high - low).max()), 1.0)
        length = ruler_length(span)
        left, bottom = float(low[0]), float(high[1]) + BELOW * span
        self.drawing.line("scale", [[(left, bottom), (left + length, bottom)]], [INK], 1.5)
        texts = [
            ((left + length / 2, bottom + RULER_LABEL * span), f"{length:g} m"),
            (_point(points[0]), "start"),
        ]
        self.drawing.text("texts", texts, INK, 2.0)
        air = AIR * span
        x_range, y_range = (left - air, float(high[0]) + air), (float(low[1]) - air, bottom + air)
        return drawing.plane_view(self.path, f"Track of {name}: east to the right, north up", x_range, y_range)


class Maps:
    """The tracks of a tab on one map, which the viewer fetches from the network."""

    def __init__(self, path: str) -> None:
        """Begin a map below an entity path."""
        self.path = path
        self._count = 0

    def add(self, recording: rr.RecordingStream, name: str, position: Floats, color: Color) -> rrb.View | None:
        """Log a track, (n, 3) latitude rad, longitude rad, height m; return the map's view with the first track."""
        number, self._count = self._count, self._count + 1
        points = np.degrees(thinned(position)[:, :2])
        strips = rr.GeoLineStrings(lat_lon=[points], colors=[color], radii=rr.Radius.ui_points(2.0))
        recording.log(f"{self.path}/{number}_{drawing.entity_name(name)}", strips, static=True)
        return None if number else rrb.MapView(origin=self.path, name=f"Map of {name}")


def local_plane(position: Floats, origin: Floats) -> Floats:
    """Return a trajectory in the view of a plane, (n, 2) metres to the east and to the south of an origin.

    Args:
        position: (n, 3) latitude rad, longitude rad, height m.
        origin: latitude rad, longitude rad, height m.
    """
    east = (position[:, 1] - origin[1]) * math.cos(origin[0]) * EARTH_RADIUS
    north = (position[:, 0] - origin[0]) * EARTH_RADIUS
    return np.stack([east, -north], axis=1)


def thinned(points: Floats) -> Floats:
    """Return every k-th point of a long track: at least ``POINTS``, and fewer than twice as many."""
    return points[:: max(1, len(points) // POINTS)]


def ruler_length(span: float) -> float:
    """Return 1, 2 or 5 times a power of ten, m: between a sixth and a half of the extent of a track, m."""
    decade = 10.0 ** math.floor(math.log10(span / 3))
    return next(factor * decade for factor in (5, 2, 1) if factor * decade <= span / 2)


def _point(row: Floats) -> Point:
    return float(row[0]), float(row[1])
