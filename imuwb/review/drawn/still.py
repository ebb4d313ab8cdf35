"""What moves, standing still, for a page: a scene as maps, spans as shading of series, events and bars as tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from imuwb.analysis import Bars, Series, Table
from imuwb.arrays import Floats
from imuwb.colors import GREY, INK
from imuwb.geodesy.tangent_plane import ned_of, position_of
from imuwb.log import SECOND
from imuwb.review.drawn.calls import Drawn, Track
from imuwb.scene import Belief, Episode, Event, Scene, Span

CORNERS = 48  #: points of an ellipse
SIGMAS = 3.0  #: of the ellipse at the end of a track


def still(drawn: Sequence[Drawn]) -> list[Drawn]:
    """Return what was drawn as figures, series, tables, tracks and notes alone."""
    spans: dict[str, list[Span]] = {}
    events: dict[str, list[Event]] = {}
    for one in drawn:
        if isinstance(one.item, Span):
            spans.setdefault(one.tab, []).append(one.item)
        elif isinstance(one.item, Event):
            events.setdefault(one.tab, []).append(one.item)
    shown: list[Drawn] = []
    for one in drawn:
        item = one.item
        if isinstance(item, Scene):
            shown += [Drawn(one.tab, track) for track in maps(item)]
        elif isinstance(item, Bars):
            shown.append(Drawn(one.tab, item.table()))
        elif isinstance(item, Series):
            shown.append(Drawn(one.tab, replace(item, spans=(*item.spans, *spans.get(one.tab, ())))))
        elif not isinstance(item, Span | Event):
            shown.append(one)
    return shown + [Drawn(tab, _list(own)) for tab, own in events.items()]


def maps(scene: Scene) -> Iterator[Track]:
    """Yield the tracks of a scene: the whole one with the episodes on it, and a map of each named episode."""
    whole = f"The whole track, with {scene.called}" if scene.episodes else "The whole track"
    yield Track(scene.body.name, scene.body.position, GREY, picture=whole)
    for episode in scene.episodes:
        yield Track(episode.name or "others", _within(scene, episode), INK, scene.called, whole)
    for episode in scene.episodes:
        if not episode.name:
            continue
        picture = f"{episode.name[0].upper()}{episode.name[1:]}, {(episode.end - episode.begin) / SECOND:g} s"
        yield Track(scene.body.name, _within(scene, episode), GREY, picture=picture)
        for belief in episode.beliefs:
            yield Track(belief.name, belief.position, belief.color, picture=picture)
        if episode.beliefs:
            best = episode.beliefs[0]
            yield Track(f"{SIGMAS:g} sigma of {best.name} at the end", _ellipse(best), best.color, picture=picture)


def _within(scene: Scene, episode: Episode) -> Floats:
    first, last = np.searchsorted(scene.body.time, [episode.begin, episode.end])
    return scene.body.position[first : last + 1]


def _ellipse(belief: Belief) -> Floats:
    """Return the ellipse at a belief's last place, (n, 3) geodetic."""
    values, vectors = np.linalg.eigh(belief.covariance[-1])
    turn = np.linspace(0.0, 2 * np.pi, CORNERS)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    north_east = SIGMAS * (circle * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    place = belief.position[-1]
    return position_of(np.column_stack([north_east, np.zeros(CORNERS)]) + ned_of(place[None], place), place)


def _list(events: Sequence[Event]) -> Table:
    first = min(event.time for event in events)
    rows = tuple(
        (f"{(event.time - first) / SECOND:.1f} s", event.source, event.level, event.text)
        for event in sorted(events, key=lambda event: event.time)
    )
    return Table("Events", ("time after the first", "stream", "level", "event"), rows)
