"""Options of the correction."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from imuwb.options import check


@dataclass(frozen=True)
class Parameters:
    """Options of ``--through correction:...``."""

    model: Annotated[Path, "error model (TOML) whose deterministic terms are removed"]

    def __post_init__(self) -> None:
        """Check the path."""
        check(self)
