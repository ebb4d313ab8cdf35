"""A record at one temperature, and its residuals without drift."""

from dataclasses import dataclass

from imuwb.arrays import Floats
from imuwb.identification.record.suitable import unsuitable
from imuwb.identification.temperature.thermal_trend import trend_of, without_trend

FEWEST = 1024  #: samples of a record at one temperature


@dataclass(frozen=True, eq=False, slots=True)
class Record:
    """Evenly spaced samples of one axis at one temperature, without gaps."""

    values: Floats  #: (n,)
    start: float  #: s, in a time common to all records
    celsius: float  #: mean temperature
    thermometer: Floats | None = None  #: (n,) °C, smoothed; None: constant
    rising: bool | None = None  #: whether the temperature came from below; None: not known
    log: int = 0  #: number of its log; records of one log share a turn-on bias

    def __repr__(self) -> str:
        """Return size and temperature, in one line."""
        return f"{self.values.size} samples at {self.celsius:.4g} °C"


def residuals(record: Record) -> tuple[Floats, Floats]:
    """Return the columns of a record's drift, (n, p), and the samples without the drift, (n,).

    Raises:
        ValueError: fewer than 1024 samples, or a constant channel.
    """
    why = unsuitable(record.values, FEWEST)
    if why is not None:
        raise ValueError(why)
    trend = trend_of(record.values.size, record.thermometer)
    return trend, without_trend(record.values, trend)
