"""What can be asked of the denoising."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

AXES = 6
DEEPEST = 30


@dataclass(frozen=True)
class Parameters:
    """Options of ``--through wavelet:...``."""

    levels: Annotated[
        str, "of decomposition: one for all axes, six as 7/7/7/7/6/6 (gyro x, y, z, accel x, y, z), or auto"
    ] = "auto"
    motion_band: Annotated[str, "with auto: Hz that motion reaches, or measured (on a record that moves)"] = "5"
    wavelet: Annotated[str, "any discrete one of PyWavelets"] = "db4"
    threshold: Annotated[
        Literal["sure", "universal", "bayes", "all", "none"], "rule; all keeps no detail, none keeps all"
    ] = "sure"
    shrinkage: Annotated[Literal["soft", "hard"], "of what is above the threshold"] = "soft"
    causal: Annotated[bool, "in a window that slides behind, instead of the whole record at once"] = False
    hop: Annotated[int, "with causal: samples between windows"] = 8

    def __post_init__(self) -> None:
        """Check the texts."""
        if self.levels != "auto":
            parts = self.levels.split("/")
            if len(parts) not in (1, AXES) or not all(p.isdecimal() and int(p) <= DEEPEST for p in parts):
                message = f"levels is {self.levels!r}; write auto, one number to {DEEPEST}, or six such as 7/7/7/7/6/6"
                raise ValueError(message)
        if self.motion_band != "measured":
            try:
                positive = 0 < float(self.motion_band) < math.inf
            except ValueError:
                positive = False
            if not positive:
                message = f"motion_band is {self.motion_band!r}; write Hz, above 0, or measured"
                raise ValueError(message)
        if self.hop < 1:
            message = f"hop is {self.hop}; it must be at least 1 sample"
            raise ValueError(message)
