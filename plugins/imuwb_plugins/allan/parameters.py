"""Options of the Allan analysis."""

from dataclasses import dataclass
from typing import Annotated, Literal

from imuwb.options import POSITIVE, Form, Level, check

MOST_TIMES = 10_000  #: for log:N


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb allan``."""

    averaging_times: Annotated[
        tuple[float, ...] | str,
        "Averaging times: octave, log:N (N times, evenly spaced on a log axis), all, or a list (s).",
        Form("octave|log:N|all|SECONDS,...", "log:90 or 0.1,1,10"),
        POSITIVE,
    ] = "octave"
    uncertainty: Annotated[
        Literal["edf", "printed"],
        "Intervals of the curve and of the Allan fit's coefficients: edf (chi-square, degrees of freedom by noise type), or printed (the "
        "papers' 1/√(2(N/n-1)); with --level 0.683 as in Quinchia's table 4).",
    ] = "edf"
    lines: Annotated[bool, "Search for periodic lines, and include them in the fits."] = True
    fast: Annotated[
        bool,
        "Thin the sums at long averaging times; except for quantization noise, the error is below a quarter of an interval.",
    ] = False
    deviation: Annotated[
        Literal["allan", "modified", "hadamard", "total"],
        "Second deviation, shown in a figure of its own; allan: none.",
    ] = "allan"
    estimators: Annotated[
        bool, "Fit the sum by likelihood and by wavelet variances too, and test whether the noise is stationary."
    ] = True
    choose: Annotated[bool, "Compare sums of processes, also with Gauss-Markov and autoregressive terms."] = False
    model: Annotated[
        Literal["allan", "headline"],
        "Coefficients that --save-model writes: of the Allan fit, or of the headline (the estimator with the least error).",
    ] = "allan"
    level: Level = 0.95

    def __post_init__(self) -> None:
        """Check the values."""
        check(self)
        times = self.averaging_times
        if isinstance(times, str) and times not in ("octave", "all"):
            kind, _, number = times.partition(":")
            if not (kind == "log" and number.isdecimal() and 1 < int(number) <= MOST_TIMES):
                raise ValueError(
                    f"averaging_times is {times!r}; it must be octave, log:N (N up to {MOST_TIMES}), all, or positive seconds: "
                    "write log:90 or 0.1,1,10"
                )
        if not times:
            raise ValueError("averaging_times is empty; it must be octave, log:N, all, or positive seconds")
