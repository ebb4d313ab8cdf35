"""Options of the wavelet denoising."""

from dataclasses import dataclass
from typing import Annotated, Literal

from imuwb.options import POSITIVE, Between, Form, check

AXES = 6
ORDER = 40


@dataclass(frozen=True)
class Parameters:
    """Options of ``--through wavelet:...``."""

    levels: Annotated[
        Literal["auto"] | tuple[int, ...],
        "levels of decomposition: one number for all axes, six for gyro x, y, z, accel x, y, z, or auto (by motion_band)",
        Between(0, 30),
        Form("K|K/K/K/K/K/K|auto", "7/7/7/7/6/6"),
    ] = "auto"
    motion_band: Annotated[
        Literal["measured"] | float,
        "highest frequency of the motion, which auto keeps; measured: from a record that moves (Hz)",
        POSITIVE,
    ] = 5.0
    wavelet: Annotated[str, "name of a discrete wavelet of PyWavelets"] = "db4"
    threshold: Annotated[
        Literal["sure", "universal", "bayes", "all", "none"],
        "rule of the threshold; all removes every detail, none removes nothing",
    ] = "sure"
    scale: Annotated[
        Literal["level", "first", "none"],
        "sigma of the noise: of each level, of the finest level for all, or none: 1 in SI units, which removes every detail of a still record; then "
        "an AR process of the samples shows the low-pass and not the sensor, as in Quinchia's table 2",
    ] = "level"
    shrinkage: Annotated[Literal["soft", "hard"], "soft: details above the threshold shrink; hard: they stay"] = "soft"
    causal: Annotated[bool, "denoise in a sliding window of past samples, in place of the whole record"] = False
    hop: Annotated[int, "samples between two windows, with causal", Between(1)] = 8

    def __post_init__(self) -> None:
        """Check the values."""
        check(self)
        if self.levels != "auto" and len(self.levels) not in (1, AXES):
            raise ValueError(
                f"levels is {'/'.join(map(str, self.levels))}; give auto, one number, or six such as 7/7/7/7/6/6"
            )
