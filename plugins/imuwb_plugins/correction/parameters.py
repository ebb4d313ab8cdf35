"""Options of the correction."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from imuwb.options import Options


@dataclass(frozen=True)
class Parameters(Options):
    """Options of ``--through correction:...``."""

    model: Annotated[Path, "error model (TOML) whose deterministic terms are removed"]
