"""Options of ``imuwb health``."""

from dataclasses import dataclass
from typing import Annotated

SHOWS_FAULTS = True


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb health``."""

    lines: Annotated[bool, "look for periodic lines in still records"] = True
