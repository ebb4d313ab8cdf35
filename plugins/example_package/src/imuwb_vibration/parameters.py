"""Options of the analysis."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

from imuwb.options import POSITIVE, Between, Form, Options


@dataclass(frozen=True)
class Parameters(Options):
    """Options of ``imuwb vibration``."""

    edges: Annotated[
        tuple[float, ...], "edges of the bands, rising; the last band ends at half the rate (Hz)", Form("HZ,HZ,...", "1,5,20,80"), POSITIVE
    ] = (1.0, 5.0, 20.0, 80.0)  # fmt: skip
    segment: Annotated[float, "length of a segment (s)", Between(0.1, 600.0)] = 4.0
    level: Annotated[float, "level of the intervals", Between(0.6, 1.0, open_most=True)] = 0.95

    def __post_init__(self) -> None:
        """Check the values, and that the edges rise.

        Raises:
            ValueError: a value that is not allowed.
        """
        super().__post_init__()
        if not self.edges or any(b <= a for a, b in pairwise(self.edges)):
            raise ValueError(
                f"edges is {','.join(f'{edge:g}' for edge in self.edges)}; they must be one or more numbers that rise"
            )
        if self.edges[0] * self.segment < 1:
            raise ValueError(
                f"segment is {self.segment:g}; it must hold a cycle of the lowest edge, {self.edges[0]:g} Hz, so {1 / self.edges[0]:g} s or more"
            )
