"""What a review shows of a motion in time: a body, what estimators believe, points, spans and events.

Times are ns on the log's clock. Positions are geodetic: latitude rad, longitude rad, height m.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.colors import GREY, Color

Level = Literal["note", "warning", "fault"]


@dataclass(frozen=True, eq=False, slots=True)
class Pose:
    """A body over time."""

    name: str
    time: Integers  #: (n,) ns
    position: Floats  #: (n, 3)
    quaternion: Floats  #: (n, 4) w, x, y, z of the body's axes (forward, right, down) relative to north, east and down

    def __post_init__(self) -> None:
        """Check the lengths.

        Raises:
            ValueError: no row, or parts of different lengths.
        """
        _check_rows(self.name, self.time, self.position, self.quaternion)


@dataclass(frozen=True, eq=False, slots=True)
class Belief:
    """Where an estimator believes the body to be, over time, and how surely."""

    name: str  #: of the estimator
    time: Integers  #: (m,) ns
    position: Floats  #: (m, 3); its height is not drawn
    covariance: Floats  #: (m, 2, 2) m² of north and east
    color: Color

    def __post_init__(self) -> None:
        """Check the lengths.

        Raises:
            ValueError: no row, or parts of different lengths.
        """
        _check_rows(self.name, self.time, self.position, self.covariance)


@dataclass(frozen=True, slots=True)
class Span:
    """A time in which something holds, shaded in the charts of a tab."""

    begin: int  #: ns
    end: int  #: ns
    text: str  #: for the legend, such as "outage"; spans of one text share a colour
    color: Color = GREY


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happens at one time, marked in the charts of a tab and listed."""

    time: int  #: ns
    source: str  #: where it happens, such as the name of a stream
    text: str
    level: Level = "note"


@dataclass(frozen=True, slots=True)
class Caption:
    """What a person reads beside a scene at one time."""

    title: str
    texts: tuple[str, ...] = ()  #: before the table, a paragraph each
    headings: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()  #: the most important one first
    remarks: tuple[str, ...] = ()  #: after the table


@dataclass(frozen=True, eq=False, slots=True)
class Episode:
    """A part of a scene in which estimators are on their own."""

    name: str  #: such as "worst outage"; empty: not to be looked at alone
    begin: int  #: ns
    end: int  #: ns
    beliefs: tuple[
        Belief, ...
    ]  #: all with the same times, which are after ``begin``; the most important estimator first
    captions: tuple[Caption, ...]  #: one for each of these times
    about: Caption  #: shown before the episode

    def __post_init__(self) -> None:
        """Check the times.

        Raises:
            ValueError: it ends before it begins, or the beliefs have different times, or a caption is missing.
        """
        if self.end <= self.begin:
            raise ValueError(
                f"episode {self.name or self.begin}: it ends at {self.end} ns; it must end after {self.begin} ns"
            )
        if any(not np.array_equal(own.time, self.beliefs[0].time) for own in self.beliefs):
            raise ValueError(
                f"episode {self.name or self.begin}: its beliefs have different times; they must have the same"
            )
        if self.beliefs and len(self.captions) != self.beliefs[0].time.size:
            raise ValueError(
                f"episode {self.name or self.begin}: {len(self.captions)} captions; there must be {self.beliefs[0].time.size}, "
                "one for each time"
            )


@dataclass(frozen=True, eq=False, slots=True)
class Points:
    """Points of one kind, such as the fixes of one quality."""

    name: str  #: for the legend; empty: not in it
    position: Floats  #: (k, 3)
    color: tuple[int, ...]  #: RGB or RGBA


@dataclass(frozen=True, eq=False, slots=True)
class Scene:
    """A motion in three dimensions over time: east, north, up in metres from the body's first position.

    Named episodes are shown first, each on a timeline of its own that begins ``before`` seconds ahead of it; the first one is
    shown when the recording opens.
    """

    title: str
    body: Pose
    episodes: tuple[Episode, ...] = ()  #: in order of importance; they must not overlap
    points: tuple[Points, ...] = ()
    distance: float = 500.0  #: m, from the camera to the body
    before: float = 15.0  #: s, shown before a named episode
    after: float = 5.0  #: s, shown after it
    about: Caption = Caption("")  #: shown outside the episodes
    called: str = "episodes"  #: what the episodes are, for the legend

    def __post_init__(self) -> None:
        """Check the episodes.

        Raises:
            ValueError: two episodes overlap, or have one name.
        """
        ordered = sorted(self.episodes, key=lambda episode: episode.begin)
        for one, other in pairwise(ordered):
            if other.begin < one.end:
                raise ValueError(
                    f"the episodes at {one.begin} and {other.begin} ns overlap; a scene shows one at a time"
                )
        names = [episode.name for episode in self.episodes if episode.name]
        if len(set(names)) < len(names):
            raise ValueError(f"episodes {', '.join(names)}: each must have a name of its own")


def _check_rows(name: str, *parts: Floats | Integers) -> None:
    lengths = {len(part) for part in parts}
    if len(lengths) > 1 or lengths == {0}:
        raise ValueError(
            f"{name}: its parts have {', '.join(map(str, sorted(lengths)))} rows; they must have the same, one or more"
        )
