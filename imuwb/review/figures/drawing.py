"""Logs the lines, points and labels of 2D views."""

from collections.abc import Sequence

import rerun as rr
import rerun.blueprint as rrb

from imuwb.colors import BACKGROUND
from imuwb.review.figures.frame import Point


def entity_name(text: str) -> str:
    """Return a text as one part of an entity path."""
    return "".join(c if c.isalnum() else "_" for c in text)


def lines(
    recording: rr.RecordingStream,
    path: str,
    strips: Sequence[Sequence[Point]],
    colors: Sequence[tuple[int, ...]],
    thickness: float | Sequence[float],
    order: float | None = None,
) -> None:
    """Log line strips, a colour for each; strips of a higher ``order`` are drawn over the others."""
    radii = rr.Radius.ui_points(thickness)
    recording.log(path, rr.LineStrips2D(strips, colors=colors, radii=radii, draw_order=order), static=True)


def areas(
    recording: rr.RecordingStream,
    path: str,
    columns: Sequence[Sequence[Point]],
    color: tuple[int, ...],
    half: float,
    order: float,
) -> None:
    """Log columns of a half width, in the view's units, which together fill an area."""
    recording.log(path, rr.LineStrips2D(columns, colors=[color], radii=half, draw_order=order), static=True)


def points(
    recording: rr.RecordingStream,
    path: str,
    places: Sequence[Point],
    colors: Sequence[tuple[int, ...]],
    size: float,
    order: float | None = None,
) -> None:
    """Log points, a colour for each."""
    radii = rr.Radius.ui_points(size)
    recording.log(path, rr.Points2D(places, colors=colors, radii=radii, draw_order=order), static=True)


def labels(
    recording: rr.RecordingStream,
    path: str,
    texts: Sequence[tuple[Point, str]],
    color: tuple[int, ...],
    size: float = 0.0,
) -> None:
    """Log texts at points; the points are visible if they have a size."""
    places, shown = [place for place, _ in texts], [text for _, text in texts]
    labelled = rr.Points2D(
        places, labels=shown, colors=[color] * len(places), radii=rr.Radius.ui_points(size), show_labels=True
    )
    recording.log(path, labelled, static=True)


def plane_view(path: str, name: str, x_range: Sequence[float], y_range: Sequence[float]) -> rrb.View:
    """Return the view of a plane, which shows the given ranges."""
    bounds = rrb.VisualBounds2D(x_range=list(x_range), y_range=list(y_range))
    background = rrb.Background(color=BACKGROUND, kind="SolidColor")
    return rrb.Spatial2DView(origin=path, name=name, visual_bounds=bounds, background=background)
