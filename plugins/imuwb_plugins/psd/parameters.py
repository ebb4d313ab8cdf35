"""Options of the spectrum."""

from dataclasses import dataclass
from typing import Annotated

from imuwb.options import Between, Level, Options


@dataclass(frozen=True)
class Parameters(Options):
    """Options of ``imuwb psd``."""

    segment: Annotated[int, "Longest segment (samples).", Between(64, 1 << 24)] = 1 << 20
    lines: Annotated[bool, "Search for periodic lines, and leave them out of the fit."] = True
    raw: Annotated[bool, "Draw the spectrum before frequency averaging too."] = False
    level: Level = 0.95
