"""Options of the bias removal."""

from dataclasses import dataclass
from typing import Annotated, Literal

from imuwb.options import POSITIVE, Options

ORDER = 10


@dataclass(frozen=True)
class Parameters(Options):
    """Options of ``--through bias:...``."""

    seconds: Annotated[
        float | None, "length of the beginning whose mean is taken (causal); without it, the whole record (s)", POSITIVE
    ] = None
    sensors: Annotated[
        Literal["both", "gyro", "accel"], "sensors whose bias is subtracted; an accelerometer's mean includes gravity"
    ] = "both"
