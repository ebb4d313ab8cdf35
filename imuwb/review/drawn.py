"""What an analysis has drawn: its calls of a review as frozen values, for renderers other than the recording."""

from dataclasses import dataclass
from typing import TypeAlias

from imuwb.analysis import Figure, Series, Table
from imuwb.arrays import Floats
from imuwb.colors import Color


@dataclass(frozen=True, eq=False, slots=True)
class Track:
    """A trajectory."""

    name: str
    position: Floats  #: (n, 3) latitude rad, longitude rad, height m
    color: Color
    label: str = ""


Item: TypeAlias = Figure | Series | Table | Track | str  #: a text is a note


@dataclass(frozen=True, eq=False, slots=True)
class Drawn:
    """One call, and the tab it was made on."""

    tab: str
    item: Item
