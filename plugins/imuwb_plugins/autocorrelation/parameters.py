"""What can be asked of the autocorrelation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

DEEPEST = 20


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb autocorrelation``."""

    longest: Annotated[float | None, "longest lag in s; default a tenth of the record"] = None
    denoise: Annotated[int, "levels of wavelet denoising (db4, SURE, soft) for the second curve; 0: none"] = 6
    level: Annotated[float, "of the band and of all intervals"] = 0.95

    def __post_init__(self) -> None:
        """Check the values."""
        if self.longest is not None and not self.longest > 0:
            message = f"longest is {self.longest} s; it must be positive"
            raise ValueError(message)
        if not 0 <= self.denoise <= DEEPEST:
            message = f"denoise is {self.denoise} levels; it must be 0 to {DEEPEST}"
            raise ValueError(message)
        if not 0.6 <= self.level < 1:  # noqa: PLR2004 - a limit at even odds is none
            message = f"level is {self.level}; it must be at least 0.6 and below 1"
            raise ValueError(message)
