"""Options of the low-pass."""

from dataclasses import dataclass
from typing import Annotated, Literal

from imuwb.options import POSITIVE, Between, Options

ORDER = 20
STUDY = {"bandwidth": ("cutoff", {})}


@dataclass(frozen=True)
class Parameters(Options):
    """Options of ``--through bandwidth:...``."""

    cutoff: Annotated[float, "frequency at which the gain is -3 dB; below half the rate (Hz)", POSITIVE]
    kind: Annotated[Literal["butterworth", "moving-average"], "kind of filter"] = "butterworth"
    order: Annotated[int, "order of a Butterworth filter", Between(1, 8)] = 2
