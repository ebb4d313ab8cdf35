"""What an analysis has drawn: its calls of a review as frozen values, for renderers other than the recording."""

from dataclasses import dataclass
from typing import TypeAlias

from imuwb.analysis import Bars, Figure, Series, Table
from imuwb.arrays import Floats
from imuwb.colors import Color
from imuwb.scene import Event, Scene, Span


@dataclass(frozen=True, eq=False, slots=True)
class Track:
    """A trajectory."""

    name: str
    position: Floats  #: (n, 3) latitude rad, longitude rad, height m
    color: Color
    label: str = ""
    picture: str = ""  #: title of the picture that tracks share; empty: all such tracks of a tab


Item: TypeAlias = Figure | Bars | Series | Table | Track | Scene | Span | Event | str  #: a text is a note


@dataclass(frozen=True, eq=False, slots=True)
class Drawn:
    """One call, and the tab it was made on."""

    tab: str
    item: Item
