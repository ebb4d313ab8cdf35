"""Options of the calibration methods."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar, TypeAlias

from imuwb.options import POSITIVE, Between, Form, Level, Options, check, text_of

FASTEST = 2e4  #: deg/s
TILT = Between(0.0, 10.0)  #: deg

Latitude: TypeAlias = Annotated[float | None, Between(-90.0, 90.0)]
Duration: TypeAlias = Annotated[float, Between(1.0)]
Raw: TypeAlias = Annotated[
    str,
    "Unit of a log in counts or volts, such as V; default: count for a log that is read with --units gyro=count,accel=count.",
]

AsMeasured: TypeAlias = Annotated[
    bool,
    "First add what the autopilot took off before it logged the samples, by the parameters in a log of ArduPilot or PX4.",
]


@dataclass(frozen=True)
class Positions(Options):
    """Options of both methods with still positions."""

    METHOD: ClassVar[str]
    FEWEST: ClassVar[int]  #: positions

    latitude: Annotated[Latitude, "Latitude, for gravity and the earth's rate (deg)."] = None
    height: Annotated[float, "Height above the ellipsoid, for gravity (m).", Between(-1e5, 1e5)] = 0.0
    gravity: Annotated[float | None, "Gravity; without gravity and latitude: 9.80665 (m/s²).", Between(9.0, 10.5)] = (
        None
    )
    shortest: Annotated[
        float | None,
        "Shortest duration of a still position; default: a third of the median one in the log, 1 to 10 s (s).",
        Between(1.0),
    ] = None
    into: Annotated[
        Path | None, "Error model to complete: the saved model has its processes and the calibrated terms."
    ] = None
    raw: Raw = ""
    misplacement: Annotated[
        float | None,
        "Rms tilt of a position from its stated attitude; default: estimated from the residuals (deg).",
        TILT,
    ] = None
    level: Level = 0.95
    as_measured: AsMeasured = False


@dataclass(frozen=True)
class SixPosition(Positions):
    """Bias, scale factors and cross-couplings from the six faces of a cube (Hassaballa, eq. 3 to 6).

    Give one log of each face in any order, or one log of all: the axis that points up is found from the data. Gyros get a bias
    and a g-sensitivity.

    Example: imuwb calibration six-position cube/*.mcap -o cube.rrd
    """

    METHOD: ClassVar[str] = "six-position"
    FEWEST: ClassVar[int] = 6


@dataclass(frozen=True)
class MultiPosition(Positions):
    """Bias, scale factors and cross-couplings from nine or more still positions, of known or unknown attitudes.

    Without --attitudes, the calibration uses only that gravity is the same in each position; the x axis of the result is then
    the axis of the x accelerometer. If one log has the motions between the positions, as when the sensor is turned by hand, the
    gyros get scale factors and couplings too: integrated over a motion, they must turn up before it into up after it.

    Example: imuwb calibration multi-position turns.mcap --latitude 45
    """

    METHOD: ClassVar[str] = "multi-position"
    FEWEST: ClassVar[int] = 9

    attitudes: Annotated[
        Path | None, "CSV file with roll_deg and pitch_deg of each position, in order; default: unknown attitudes."
    ] = None
    range: Annotated[float | None, "Full range of the accelerometers, on which the non-linear part is defined (g).", POSITIVE] = None  # fmt: skip

    def __post_init__(self) -> None:
        """Check the values."""
        check(self)
        if self.attitudes is None and (self.misplacement is not None or self.range is not None):
            name = "misplacement" if self.misplacement is not None else "range"
            raise ValueError(f"{name} is given without attitudes; it must be used with attitudes: add --attitudes FILE")


@dataclass(frozen=True)
class RateTable:
    """Gyros on a rate table: bias, scale factor, its non-linear part and cross-couplings (Hassaballa, 3.1).

    Give one log for each axis, or several. The steps of each log are found and matched to --rates, clockwise and
    counter-clockwise.

    Example: imuwb calibration rate-table table/*.mcap -o table.rrd
    """

    rates: Annotated[
        tuple[float, ...], "Rates of the table, in either direction (deg/s).", Form("R1,R2,...", "10,50,100"),
        Between(-FASTEST, FASTEST),
    ] = ()  # fmt: skip
    latitude: Annotated[Latitude, "Latitude, for the earth's rate (deg)."] = None
    misplacement: Annotated[
        float,
        "Rms angle between the sensor's axis and the table's; the cross-couplings' intervals include it (deg).",
        TILT,
    ] = 0.05
    range: Annotated[float | None, "Full range of the gyros, on which the non-linear part is defined (deg/s).", POSITIVE] = None  # fmt: skip
    shortest: Annotated[Duration, "Shortest duration of a step (s)."] = 2.0
    into: Annotated[
        Path | None,
        "Error model to complete, such as that of six-position: the saved model has its terms and the calibrated ones; its "
        "g-sensitivity is subtracted from the samples.",
    ] = None
    raw: Raw = ""
    level: Level = 0.95
    as_measured: AsMeasured = False

    def __post_init__(self) -> None:
        """Check the values; the rates become magnitudes, rising, each once."""
        check(self)
        if not all(self.rates):
            raise ValueError(f"rates is {text_of(self.rates)}; each magnitude must be above 0 deg/s")
        object.__setattr__(self, "rates", tuple(sorted({abs(rate) for rate in self.rates})))
