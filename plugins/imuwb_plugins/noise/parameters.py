"""Options of the noise analysis."""

from dataclasses import dataclass
from typing import Annotated

from imuwb.options import Between, Level, Options


@dataclass(frozen=True)
class Parameters(Options):
    """Options of ``imuwb noise``."""

    choose: Annotated[bool, "Compare sums of processes, which takes most of the time."] = True
    denoise: Annotated[
        int, "Number of levels of wavelet denoising in the autocorrelation and on the denoising tab; 0: no denoising.", Between(0, 20)
    ] = 6  # fmt: skip
    level: Level = 0.95
