"""What can be asked of noise over temperature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

ABSOLUTE_ZERO, HOTTEST = -273.15, 1000.0  #: °C
WIDEST = 50.0  #: °C, of a bin


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb temperature``."""

    celsius: Annotated[
        str | None, "°C of each log, as -30,0,30 in the order of the logs, in place of their thermometers"
    ] = None
    cut: Annotated[
        Literal["auto", "set-point", "plateaus", "bins"],
        "each log: one set-point, its plateaus, or bins of a ramp; auto decides by how its temperature goes",
    ] = "auto"
    bins: Annotated[float, "°C, width of a ramp's bins; 0: 5, or 10 or 20 where these hold too few samples"] = 0.0
    function: Annotated[
        Literal["auto", "constant", "linear", "quadratic", "cubic", "piecewise", "spline", "arrhenius"],
        "of temperature; auto chooses by cross-validation",
    ] = "auto"
    reference: Annotated[float, "°C of what the model says where no temperature is known, and of bias changes"] = 25.0
    size: Annotated[float, "of the tests: how often they err where nothing depends on temperature"] = 0.05
    level: Annotated[float, "of all intervals and limits"] = 0.95

    def __post_init__(self) -> None:
        """Check the values."""
        self.temperatures()
        if not 0 <= self.bins <= WIDEST:
            message = f"bins is {self.bins} °C; it must be above 0 and at most {WIDEST:g}, or 0 to leave it to the log"
            raise ValueError(message)
        if not ABSOLUTE_ZERO < self.reference < HOTTEST:
            message = f"reference is {self.reference} °C; no sensor is at it"
            raise ValueError(message)
        if not 0 < self.size <= 0.5:  # noqa: PLR2004 - a test that errs more often than not
            message = f"size is {self.size}; it must be above 0 and at most 0.5"
            raise ValueError(message)
        if not 0.6 <= self.level < 1:  # noqa: PLR2004 - a limit at even odds is none
            message = f"level is {self.level}; it must be at least 0.6 and below 1"
            raise ValueError(message)

    def temperatures(self) -> tuple[float, ...] | None:
        """Return the temperatures that were given, °C; None: the logs know theirs.

        Raises:
            ValueError: no numbers, or no temperatures.
        """
        if self.celsius is None:
            return None
        try:
            found = tuple(float(part) for part in self.celsius.split(","))
        except ValueError as error:
            message = f"celsius is {self.celsius!r}; it must be numbers with commas between, as -30,0,30"
            raise ValueError(message) from error
        if not all(ABSOLUTE_ZERO < t < HOTTEST for t in found):
            message = f"celsius is {self.celsius}; no sensor is at such a temperature"
            raise ValueError(message)
        return found
