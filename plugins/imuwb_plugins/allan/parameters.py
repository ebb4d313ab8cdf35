"""What can be asked of the Allan analysis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

MOST_TIMES = 10_000  #: of log:N


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb allan``."""

    averaging_times: Annotated[str, "octave, log:N (N of them), all, or seconds such as 0.1,1,10"] = "octave"
    uncertainty: Annotated[
        Literal["edf", "printed"], "edf: chi-square, by noise type; printed: the papers' 1/√(2(N/n-1))"
    ] = "edf"
    lines: Annotated[bool, "look for periodic lines and take them into the fit"] = True
    fast: Annotated[
        bool,
        "thin the sums out at long averaging times; for all but quantization off by less than a quarter of an interval",
    ] = False
    deviation: Annotated[
        Literal["allan", "modified", "hadamard", "total"], "another deviation, drawn beside the Allan deviation"
    ] = "allan"
    estimators: Annotated[
        bool, "fit the sum by likelihood and by wavelet variance too, and test whether the noise stays the same"
    ] = True
    choose: Annotated[bool, "compare sums of processes, also with Gauss-Markov and autoregressive terms"] = False
    model: Annotated[
        Literal["allan", "headline"],
        "whose figures --save-model takes: the Allan fit's, or those of the estimator of the least error",
    ] = "allan"
    level: Annotated[float, "of all intervals and limits"] = 0.95

    def __post_init__(self) -> None:
        """Check the values."""
        if not 0.6 <= self.level < 1:  # noqa: PLR2004 - a limit at even odds is none
            message = f"level is {self.level}; it must be at least 0.6 and below 1"
            raise ValueError(message)
        text = self.averaging_times
        kind, _, number = text.partition(":")
        if text in ("octave", "all") or (kind == "log" and number.isdecimal() and 1 < int(number) <= MOST_TIMES):
            return
        try:
            times = [float(part) for part in text.split(",")]
        except ValueError:
            times = []
        if not times or min(times) <= 0:
            message = f"averaging times are {text!r}; write octave, log:90, all, or positive seconds such as 0.1,1,10"
            raise ValueError(message)
