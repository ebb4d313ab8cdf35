"""The plan of a scene: the whole track from above with the episodes on it, the body where it is, a ruler and a legend."""

from __future__ import annotations

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from imuwb.arrays import Floats
from imuwb.colors import BACKGROUND, GREY, INK
from imuwb.review.figures import drawing
from imuwb.review.figures.frame import Point
from imuwb.review.figures.track import ruler_length
from imuwb.review.scene.stage import Ground, thinned, within
from imuwb.review.scene.timelines import Timelines
from imuwb.scene import Scene

WIDTH, HEIGHT = 330.0, 230.0  #: px of the view on an ordinary screen
LEGEND, AIR = 160.0, 24.0  #: px, of the legend at the right, and round the track
STEP, DROP, LETTER = (
    21.0,
    11.0,
    8.4,
)  #: px between two lines of the legend, from a point to its label, of a letter on a small screen
SWATCH = 12.0  #: px, of a line of the legend
MOST_POINTS = 600


def plan(scene: Scene, recording: rr.RecordingStream, timelines: Timelines, path: str, name: str) -> rrb.View:
    """Log a plan below an entity path, and return its view."""
    ground = Ground.of(scene)
    track = _plane(ground.enu(scene.body.position))
    low, high = track.min(axis=0), track.max(axis=0)
    extent = np.maximum(high - low, 1.0)
    px = float(max(extent[0] / (WIDTH - LEGEND - 2 * AIR), extent[1] / (HEIGHT - 3 * AIR)))  # m
    middle = (low + high) / 2
    left, top = float(middle[0] - (WIDTH - LEGEND) / 2 * px), float(middle[1] - HEIGHT / 2 * px)
    length = ruler_length((WIDTH - LEGEND) * px / 1.5)
    x, y = left + AIR / 2 * px, top + (HEIGHT - AIR) * px
    strips = [track.tolist(), *(track[within(scene, episode)].tolist() for episode in scene.episodes)]
    strips.append([(x, y), (x + length, y)])
    legend = _legend(scene, left + (WIDTH - LEGEND) * px, top, px)
    colors: list[tuple[int, ...]] = [GREY, *(INK for _ in strips[1:]), *(color for *_, color in legend)]
    widths = [0.8, *(2.2 for _ in strips[1:]), *(3.0 for _ in legend)]
    strips += [swatch for _, _, swatch, _ in legend]
    sheet = drawing.Drawing()
    sheet.line("track", strips, colors, widths)
    _points(scene, ground, sheet)
    ruler = f"{length / 1000:g} km" if length >= 1000 else f"{length:g} m"  # noqa: PLR2004 - m in a km
    texts = [((float(track[0, 0]), float(track[0, 1])), "start"), ((x + length / 2, y - 2 * px), ruler)]
    texts += [(place, text) for place, text, _, _ in legend]
    sheet.text("start", texts[:1], INK, 2.5)
    sheet.text("texts", texts[1:], INK)
    sheet.log(recording, path)
    timelines.rows(
        f"{path}/body", scene.body.time,
        lambda rows: rr.Points2D.columns(positions=track[rows]).partition([1] * rows.size),
    )  # fmt: skip
    look = rr.Points2D.from_fields(colors=[INK], radii=rr.Radius.ui_points(5.0), draw_order=5)
    recording.log(f"{path}/body", look, static=True)
    return drawing.plane_view(path, name, (left, left + WIDTH * px), (top, top + HEIGHT * px))


def _plane(enu: Floats) -> Floats:
    return np.stack([enu[:, 0], -enu[:, 1]], axis=1)


def _points(scene: Scene, ground: Ground, sheet: drawing.Drawing) -> None:
    places = [
        (place, points.color)
        for points in scene.points
        for place in _plane(ground.enu(thinned(points.position, scene, MOST_POINTS))).tolist()
    ]
    if places:
        sheet.point("points", [p for p, _ in places], [c for _, c in places], 1.3)


def _legend(
    scene: Scene, left: float, top: float, px: float
) -> list[tuple[Point, str, list[Point], tuple[int, ...]]]:  # fmt: skip
    """Return what is drawn: place and text of its name, and beside it a line in its colour."""
    entries: list[tuple[str, tuple[int, ...]]] = [("north is up", BACKGROUND), (scene.body.name, GREY)]
    entries += [(scene.called, INK)] if scene.episodes else []
    entries += [(points.name, points.color) for points in scene.points if points.name]
    found: list[tuple[Point, str, list[Point], tuple[int, ...]]] = []
    for number, (text, color) in enumerate(entries):
        y, x = top + (16 + STEP * number) * px, left + (SWATCH + 8 + LETTER / 2 * len(text)) * px
        found.append(((x, y - DROP * px), text, [(left, y), (left + SWATCH * px, y)], color))
    return found
