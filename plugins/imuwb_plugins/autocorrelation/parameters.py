"""Options of the autocorrelation."""

from dataclasses import dataclass
from typing import Annotated

from imuwb.options import POSITIVE, Between, Level, Options


@dataclass(frozen=True)
class Parameters(Options):
    """Options of ``imuwb autocorrelation``."""

    longest: Annotated[float | None, "Longest lag; default: a tenth of the record (s).", POSITIVE] = None
    denoise: Annotated[
        int, "Number of levels of wavelet denoising (db4, SURE, soft) for the second curve; 0: no second curve.", Between(0, 20)
    ] = 6  # fmt: skip
    level: Level = 0.95
