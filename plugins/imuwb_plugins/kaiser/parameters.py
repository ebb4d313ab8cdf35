"""Options of the Kaiser low-pass."""

from dataclasses import dataclass
from typing import Annotated

from imuwb.options import POSITIVE, check

ORDER = 30
WIDTH = 4.0  #: Hz, of the transition where none is given


@dataclass(frozen=True)
class Parameters:
    """Options of ``--through kaiser:...``."""

    f_pass: Annotated[float | None, "end of the pass band (Hz)", POSITIVE] = None
    f_stop: Annotated[float | None, "beginning of the stop band (Hz)", POSITIVE] = None
    fc: Annotated[float | None, "middle between the two bands, in place of their edges (Hz)", POSITIVE] = None
    width: Annotated[float | None, f"width of the transition, with fc; default {WIDTH:g} (Hz)", POSITIVE] = None
    a_stop: Annotated[float, "smallest attenuation in the stop band (dB)", POSITIVE] = 100.0
    a_pass: Annotated[float, "largest ripple in the pass band (dB)", POSITIVE] = 0.0001
    causal: Annotated[bool, "use past samples only, and be late by the delay of the filter"] = False

    def __post_init__(self) -> None:
        """Check the values, and that the bands are given once."""
        check(self)
        edges = self.f_pass is not None and self.f_stop is not None
        if edges == (self.fc is not None) or (self.f_pass is None) != (self.f_stop is None):
            raise ValueError("give either f_pass and f_stop, or fc (and width), in Hz")
        if edges and self.width is not None:
            raise ValueError(
                f"width is {self.width} Hz; use it only with fc; with f_pass and f_stop the width is already known"
            )

    @property
    def bands(self) -> tuple[float, float]:
        """Return the end of the pass band and the beginning of the stop band, Hz."""
        if self.fc is not None:
            half = (WIDTH if self.width is None else self.width) / 2
            return self.fc - half, self.fc + half
        return self.f_pass or 0.0, self.f_stop or 0.0
