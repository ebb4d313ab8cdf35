"""What the analysis returns."""

from dataclasses import dataclass

from imuwb.arrays import Floats
from imuwb.statistics import Estimate


@dataclass(frozen=True)
class Band:
    """The vibration of one axis in one band."""

    low: float  #: Hz
    high: float  #: Hz
    rms: Estimate  #: rad/s or m/s²
    line: (
        float | None
    )  #: Hz, of the largest density; None: it is at an edge of the band, so it belongs to what is beyond
    share: float  #: of the band's power that is within the largest density and its neighbours, 1


@dataclass(frozen=True, eq=False)
class Axis:
    """The vibration of one axis."""

    bands: tuple[Band, ...]
    rms: Estimate  #: of all bands together
    frequency: Floats  #: (n,) Hz
    density: Floats  #: (n,) one-sided power density, (rad/s)²/Hz or (m/s²)²/Hz
    segments: int


@dataclass(frozen=True, eq=False)
class Result:
    """The vibration of one IMU."""

    imu: str
    level: float
    seconds: float  #: s that are in segments
    axes: dict[str, Axis]
