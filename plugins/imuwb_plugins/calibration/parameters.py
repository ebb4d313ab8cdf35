"""What can be asked of a calibration."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path  # noqa: TC003 - the command line reads the annotations as the program runs
from typing import Annotated

LOWEST, HIGHEST = 9.0, 10.5  #: m/s², of gravity on earth, and somewhat more
MOST_TILT = 10.0  #: deg
FASTEST = 2e4  #: deg/s


def check_level(level: float) -> None:
    """Raise ValueError unless a level can be."""
    if not 0.5 <= level < 1:  # noqa: PLR2004 - an interval at even odds is none
        message = f"level is {level}; it must be at least 0.5 and below 1"
        raise ValueError(message)


def check_site(latitude: float | None, shortest: float, misplacement: float | None) -> None:
    """Raise ValueError unless these can be."""
    if latitude is not None and not -90 <= latitude <= 90:  # noqa: PLR2004 - the poles
        message = f"latitude is {latitude}°; it must be -90 to 90"
        raise ValueError(message)
    if not 1 <= shortest < math.inf:
        message = f"shortest is {shortest} s; it must be at least 1"
        raise ValueError(message)
    if misplacement is not None and not 0 <= misplacement <= MOST_TILT:
        message = f"misplacement is {misplacement}°; it must be 0 to {MOST_TILT:g}"
        raise ValueError(message)


@dataclass(frozen=True)
class Positions:
    """Options of both methods with still positions."""

    latitude: Annotated[float | None, "deg; gravity and the earth's rate follow from it"] = None
    height: Annotated[float, "m above the ellipsoid, for gravity"] = 0.0
    gravity: Annotated[float | None, "m/s²; given outright. Without it and latitude: 9.80665"] = None
    shortest: Annotated[float, "s; what stays still for so long is a position"] = 10.0
    into: Annotated[
        Path | None, "an error model, whose processes are kept: the saved model is it with the terms found here"
    ] = None
    raw: Annotated[
        str, "unit of a log in counts or volts, as count or V; read it with --units gyro=rad/s,accel=m/s2"
    ] = ""
    level: Annotated[float, "of all intervals"] = 0.95

    def __post_init__(self) -> None:
        """Check the values."""
        check_level(self.level)
        check_site(self.latitude, self.shortest, None)
        if self.gravity is not None and not LOWEST <= self.gravity <= HIGHEST:
            message = f"gravity is {self.gravity} m/s²; on earth it is 9.76 to 9.84"
            raise ValueError(message)
        if not math.isfinite(self.height) or abs(self.height) > 1e5:  # noqa: PLR2004 - m, beyond any bench
            message = f"height is {self.height} m; it must be within 100 km of the ellipsoid"
            raise ValueError(message)


@dataclass(frozen=True)
class SixPosition(Positions):
    """Options of ``imuwb calibration six-position``."""

    misplacement: Annotated[float | None, "deg; rms tilt of a face on the table. Without it the residuals tell"] = None

    def __post_init__(self) -> None:
        """Check the values."""
        super().__post_init__()
        check_site(self.latitude, self.shortest, self.misplacement)


@dataclass(frozen=True)
class MultiPosition(Positions):
    """Options of ``imuwb calibration multi-position``."""

    attitudes: Annotated[
        Path | None,
        "CSV with roll_deg and pitch_deg of each position, in order. Without it no attitude needs to be known",
    ] = None
    misplacement: Annotated[float | None, "deg; rms error of the attitudes. Without it the residuals tell"] = None
    range: Annotated[float | None, "g; full range, of which the non-linear part is told"] = None

    def __post_init__(self) -> None:
        """Check the values."""
        super().__post_init__()
        check_site(self.latitude, self.shortest, self.misplacement)
        if self.range is not None and not 0 < self.range < math.inf:
            message = f"range is {self.range} g; it must be positive"
            raise ValueError(message)
        if self.attitudes is None and (self.misplacement is not None or self.range is not None):
            name = "misplacement" if self.misplacement is not None else "range"
            message = f"{name} goes with attitudes: without them no attitude is known that could be off, nor a non-linear part"
            raise ValueError(message)


@dataclass(frozen=True)
class RateTable:
    """Options of ``imuwb calibration rate-table``."""

    rates: Annotated[str, "deg/s; the table's rates, as 10,50,100, turned both ways"] = ""
    latitude: Annotated[float | None, "deg; for the earth's rate"] = None
    misplacement: Annotated[
        float, "deg; rms, of the sensor's axis against the table's; in the cross-couplings' intervals"
    ] = 0.05
    range: Annotated[float | None, "deg/s; full range, of which the non-linear part is told"] = None
    shortest: Annotated[float, "s; a step lasts at least so long"] = 2.0
    into: Annotated[
        Path | None,
        "an error model, as of six-position: it is saved with the terms found here; its g-sensitivity is taken off",
    ] = None
    raw: Annotated[
        str, "unit of a log in counts or volts, as count or V; read it with --units gyro=rad/s,accel=m/s2"
    ] = ""
    level: Annotated[float, "of all intervals"] = 0.95

    def __post_init__(self) -> None:
        """Check the values."""
        check_level(self.level)
        check_site(self.latitude, self.shortest, self.misplacement)
        if self.range is not None and not 0 < self.range < math.inf:
            message = f"range is {self.range} deg/s; it must be positive"
            raise ValueError(message)
        self.magnitudes()

    def magnitudes(self) -> tuple[float, ...]:
        """Return the rates, deg/s, without signs, rising."""
        try:
            found = sorted({abs(float(part)) for part in self.rates.split(",") if part.strip()})
        except ValueError as error:
            message = f"rates is {self.rates!r}; write deg/s with commas, as 10,50,100"
            raise ValueError(message) from error
        if not all(0 < rate <= FASTEST for rate in found):
            message = f"rates is {self.rates!r}; they must be above 0 and at most {FASTEST:g} deg/s"
            raise ValueError(message)
        return tuple(found)
