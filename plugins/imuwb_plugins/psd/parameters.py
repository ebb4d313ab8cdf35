"""What can be asked of the spectrum."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

LONGEST = 1 << 24


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb psd``."""

    segment: Annotated[int, "samples of a segment, at most"] = 1 << 20
    lines: Annotated[bool, "look for periodic lines, and leave them out of the fit"] = True
    level: Annotated[float, "of all intervals and limits"] = 0.95

    def __post_init__(self) -> None:
        """Check the values."""
        if not 64 <= self.segment <= LONGEST:  # noqa: PLR2004 - fewer have no spectrum worth the name
            message = f"segment is {self.segment}; it must be 64 to {LONGEST} samples"
            raise ValueError(message)
        if not 0.6 <= self.level < 1:  # noqa: PLR2004 - a limit at even odds is none
            message = f"level is {self.level}; it must be at least 0.6 and below 1"
            raise ValueError(message)
