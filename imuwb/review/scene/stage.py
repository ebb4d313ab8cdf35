"""A scene in a recording: the body in its attitude with the camera above it, the tracks of estimators and their ellipses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from imuwb.arrays import Floats, Integers
from imuwb.colors import BACKGROUND, GREY, INK, Color
from imuwb.geodesy.tangent_plane import ned_of
from imuwb.review.scene.frames import Frames, Parts
from imuwb.review.scene.timelines import Timelines, Window, seconds
from imuwb.scene import Belief, Episode, Scene

EYE = (-0.25, -0.62, 0.78)  #: direction from the body to the camera: from the south, above
LARGER = 45.0  #: the body is drawn so large that the camera's distance is this many of its half lengths
BOXES = (  #: half sizes and middles, forward, right, down: the body, what is on it, and a bow that shows where it points
    ((1.0, 0.42, 0.2), (0.0, 0.0, 0.0)), ((0.45, 0.36, 0.18), (-0.15, 0.0, -0.36)), ((0.45, 0.07, 0.07), (1.4, 0.0, 0.0)),
)  # fmt: skip
BOW: Color = (120, 160, 220)
HALF_TURN = (0.0, math.sqrt(0.5), math.sqrt(0.5), 0.0)  #: quaternion from north-east-down to east-north-up
RINGS = (1.0, 3.0)  #: sigmas
STRONG, FAINT = 255, 80  #: opacity of the most important estimator, and of the others
WIDE, THIN, DOT = 1.8, 0.7, 3.5  #: widths of lines and of a dot, points of the screen
NOWHERE: Floats = np.empty((0, 3))
MOST_POINTS = 2000
COARSE = 5  #: every such point of a track that grows is drawn, and the last one
CLEARED = 0.5  #: s after an episode, when its tracks vanish
SPEED = 5.0  #: how much faster than time the viewer plays


@dataclass(frozen=True, eq=False, slots=True)
class Ground:
    """East, north and up from the first position of a scene's body."""

    origin: Floats
    time: Integers
    up: Floats  #: (n,) m, of the body

    @staticmethod
    def of(scene: Scene) -> Ground:
        """Return the coordinates of a scene."""
        origin = scene.body.position[0]
        return Ground(origin, scene.body.time, -ned_of(scene.body.position, origin)[:, 2])

    def enu(self, position: Floats) -> Floats:
        """Return positions as metres east, north and up, (n, 3)."""
        ned = ned_of(position, self.origin)
        return np.stack([ned[:, 1], ned[:, 0], -ned[:, 2]], axis=1)

    def level(self, belief: Belief) -> Floats:
        """Return a belief's positions at the height of the body: an error in height would look like one in the plane."""
        places = self.enu(belief.position)
        places[:, 2] = np.interp(belief.time, self.time, self.up)
        return places


def windows_of(scene: Scene) -> Iterator[Window]:
    """Yield the timelines of a scene's named episodes."""
    for episode in scene.episodes:
        if episode.name:
            begin, end = episode.begin - seconds(scene.before), episode.end + seconds(scene.after)
            yield Window(episode.name, begin, episode.begin, end)


def stage(scene: Scene, recording: rr.RecordingStream, timelines: Timelines, path: str) -> rrb.View:
    """Log a scene below an entity path, and return its view; what changes in time goes through the timelines."""
    ground = Ground.of(scene)
    recording.log(path, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    _still(scene, ground, recording, path)
    _body(scene, ground, recording, timelines, path)
    _looks(scene, recording, path)
    for episodes, on in groups(scene):
        _beliefs(scene, episodes, on, ground, timelines, path)
    eye = rrb.EyeControls3D(
        kind="Orbital", position=[scene.distance * part for part in EYE], look_target=[0, 0, 0], eye_up=[0, 0, 1]
    )
    return rrb.Spatial3DView(
        origin=f"{path}/follow", contents=[f"{path}/**"], name=scene.title, eye_controls=eye,
        background=rrb.Background(color=BACKGROUND, kind="SolidColor"),
    )  # fmt: skip


def groups(scene: Scene) -> Iterator[tuple[tuple[Episode, ...], tuple[str, ...]]]:
    """Yield episodes that are on the same timelines, and the names of these; "" is that of the whole log, and the last."""
    for episode in scene.episodes:
        if episode.name:
            yield (episode,), (episode.name, "")
    yield tuple(episode for episode in scene.episodes if not episode.name), ("",)


def announced(scene: Scene, episode: Episode) -> int:
    """Return when an episode is announced, ns: some time before it begins, but not while the one before it is shown."""
    ends = [other.end + seconds(CLEARED) + 1 for other in scene.episodes if other.end <= episode.begin]
    return max([episode.begin - seconds(scene.before), *ends]) if episode.name else episode.begin


def within(scene: Scene, episode: Episode) -> slice:
    """Return the rows of the body within an episode."""
    first, last = np.searchsorted(scene.body.time, [episode.begin, episode.end])
    return slice(int(first), int(last) + 1)


def _still(scene: Scene, ground: Ground, recording: rr.RecordingStream, path: str) -> None:
    """Log what does not change in time: the body's track, the episodes on it, and the points."""
    track = ground.enu(scene.body.position)
    strips = [track, *(track[within(scene, episode)] for episode in scene.episodes)]
    colors = [GREY, *(INK for _ in scene.episodes)]
    widths = rr.Radius.ui_points([0.8, *(1.6 for _ in scene.episodes)])
    recording.log(f"{path}/track", rr.LineStrips3D(strips, colors=colors, radii=widths), static=True)
    own = [(ground.enu(thinned(points.position, scene)), points.color) for points in scene.points]
    if own:
        places = np.concatenate([place for place, _ in own])
        shades = [color for place, color in own for _ in place]
        recording.log(f"{path}/points", rr.Points3D(places, colors=shades, radii=rr.Radius.ui_points(1.8)), static=True)


def thinned(position: Floats, scene: Scene, most: int = MOST_POINTS) -> Floats:
    """Return every k-th point, so that all points of a scene together are not too many."""
    count = sum(len(points.position) for points in scene.points)
    return position[:: -(-count // most)] if len(position) > 1 else position


def _body(scene: Scene, ground: Ground, recording: rr.RecordingStream, timelines: Timelines, path: str) -> None:
    """Log the body: the camera follows its place without turning; the box below has its attitude."""
    size = scene.distance / LARGER
    sizes, middles = (np.array([box[i] for box in BOXES]) * size for i in range(2))
    shape = rr.Boxes3D(half_sizes=sizes, centers=middles, colors=[INK, BOW, BOW], fill_mode="solid")
    recording.log(f"{path}/follow/body", shape, static=True)
    places, quaternions = ground.enu(scene.body.position), _of_enu(scene.body.quaternion)
    body = scene.body.time
    timelines.rows(f"{path}/follow", body, lambda rows: rr.Transform3D.columns(translation=places[rows]))
    timelines.rows(f"{path}/follow/body", body, lambda rows: rr.Transform3D.columns(quaternion=quaternions[rows]))


def _of_enu(quaternion: Floats) -> Floats:
    """Return attitudes relative to east-north-up as x, y, z, w, of those relative to north-east-down as w, x, y, z."""
    a, b, c, d = HALF_TURN
    w, x, y, z = quaternion.T
    return np.stack([
        a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w,
        a * w - b * x - c * y - d * z,
    ], axis=1)  # fmt: skip


def _looks(scene: Scene, recording: rr.RecordingStream, path: str) -> None:
    """Log the colours and widths of estimators, which are the same in all episodes; the first one is strong."""
    colors = [*_estimators(scene).values()]
    faint = [(*color, FAINT) for color in colors]
    ringed = [color for own in ([(*c, STRONG) for c in colors[:1]] + faint[1:]) for color in (own,) * len(RINGS)]
    widths = [-(1.0 if i < len(RINGS) else 0.5) for i in range(len(ringed))]
    recording.log(f"{path}/ahead", rr.LineStrips3D.from_fields(colors=faint, radii=-THIN), static=True)
    recording.log(
        f"{path}/now",
        rr.LineStrips3D.from_fields(colors=colors, radii=-WIDE),
        rr.Ellipsoids3D.from_fields(colors=ringed, line_radii=widths, fill_mode="MajorWireframe"),
        rr.Points3D.from_fields(radii=-DOT, show_labels=True),
        static=True,
    )


def _estimators(scene: Scene) -> dict[str, Color]:
    """Return the estimators of all episodes in their order, and their colours."""
    return {belief.name: belief.color for episode in scene.episodes for belief in episode.beliefs}


def _beliefs(
    scene: Scene, episodes: Sequence[Episode], on: tuple[str, ...], ground: Ground, timelines: Timelines, path: str
) -> None:
    """Keep the tracks, ellipses and labels of estimators in some episodes that are on the same timelines."""
    # What changes at the same times is one entity: each entity takes some kilobytes of the file on each timeline.
    ahead, now = Frames((rr.LineStrips3D,)), Frames((rr.LineStrips3D, rr.Ellipsoids3D, rr.Points3D))
    for episode in episodes:
        if not episode.beliefs:
            continue
        known = {belief.name: belief for belief in episode.beliefs}
        beliefs = [known.get(name) for name in _estimators(scene)]
        places = [NOWHERE if belief is None else ground.level(belief) for belief in beliefs]
        ahead.add(announced(scene, episode), {"strips": places})
        ringed = len(places) if episode.name else 1  # elsewhere the first one is enough: rings take most room
        for k, time in enumerate(episode.beliefs[0].time.tolist()):
            kept = np.append(np.arange(0, k, COARSE), k)
            grown: Parts = {"strips": [place[kept] if len(place) else place for place in places]}
            here = [place[k] for place in places if len(place)]
            labels = _labels([own for own in beliefs if own], here, _body_at(scene, ground, time))
            now.add(time, grown, _rings(beliefs[:ringed], places[:ringed], k), labels)
        for frames in (ahead, now):
            frames.clear(episode.end + seconds(CLEARED))
    ahead.keep(timelines, f"{path}/ahead", on)
    now.keep(timelines, f"{path}/now", on)


def _rings(beliefs: Sequence[Belief | None], places: Sequence[Floats], k: int) -> Parts:
    """Return the ellipses of all estimators at one time; one that is not there has none."""
    parts: dict[str, list[object]] = {"centers": [], "half_sizes": [], "quaternions": []}
    for belief, place in zip(beliefs, places, strict=True):
        north_east = np.zeros((2, 2)) if belief is None else belief.covariance[k]
        values, vectors = np.linalg.eigh(north_east[::-1, ::-1])  # of east and north
        axes = np.sqrt(np.maximum(values, 0.0))
        half = math.atan2(vectors[1, 0], vectors[0, 0]) / 2
        for ring in RINGS:
            parts["centers"].append(np.zeros(3) if belief is None else place[k])
            parts["half_sizes"].append([ring * axes[0], ring * axes[1], 0.0])
            parts["quaternions"].append([0.0, 0.0, math.sin(half), math.cos(half)])
    return parts


def _body_at(scene: Scene, ground: Ground, time: int) -> Floats:
    row = min(int(np.searchsorted(scene.body.time, time)), scene.body.time.size - 1)
    return ground.enu(scene.body.position[row : row + 1])[0]


def _labels(beliefs: Sequence[Belief], here: Sequence[Floats], body: Floats) -> Parts:
    """Return labels at the first estimator and at the one that is farthest off; more could not be read."""
    off = [float(np.hypot(*(place - body)[:2])) for place in here]
    shown = dict.fromkeys((0, int(np.argmax(off))))
    texts = [f"{beliefs[i].name}: {_metres(off[i])} off" for i in shown]
    colors: list[Color] = [beliefs[i].color for i in shown]
    return {"positions": [here[i] for i in shown], "labels": texts, "colors": colors}


def _metres(value: float) -> str:
    return f"{value:.1f} m" if value < 10 else f"{value:.0f} m"  # noqa: PLR2004 - two digits
