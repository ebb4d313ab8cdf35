"""Options of the decimation."""

from dataclasses import dataclass
from typing import Annotated

from imuwb.options import POSITIVE, Between, check

ORDER = 50
STUDY = {"rate": ("rate", {"anti_alias": "false"})}


@dataclass(frozen=True)
class Parameters:
    """Options of ``--through decimate:...``."""

    rate: Annotated[float | None, "new rate, the log's rate divided by a whole number (Hz)", POSITIVE] = None
    factor: Annotated[int | None, "number of samples of which one is kept, in place of rate", Between(1)] = None
    anti_alias: Annotated[bool, "filter first; otherwise frequencies above half the new rate fold down"] = True
    causal: Annotated[bool, "use past samples only, and be late by the delay of the filter"] = False

    def __post_init__(self) -> None:
        """Check the values, and that one of rate and factor is given."""
        check(self)
        if (self.rate is None) == (self.factor is None):
            raise ValueError("give either rate (Hz) or factor (a whole number)")
