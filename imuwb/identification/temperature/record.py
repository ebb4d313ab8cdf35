"""A record at one temperature, and what is left of it without its drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from imuwb.identification.record.suitable import unsuitable
from imuwb.identification.temperature.thermal_trend import trend_of, without_trend

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

FEWEST = 1024  #: samples of a record at one temperature


@dataclass(frozen=True, eq=False, slots=True)
class Record:
    """Evenly spaced samples of one axis at one temperature, without gaps."""

    values: Floats  #: (n,)
    start: float  #: s, on a clock that all records share
    celsius: float  #: mean
    thermometer: Floats | None = None  #: (n,) °C, smoothed; None: steady
    rising: bool | None = None  #: whether the temperature came from below; None: unknown
    log: int = 0  #: which log it is of: its turn-on bias is that log's


def residuals(record: Record) -> tuple[Floats, Floats]:
    """Return the columns of a record's drift, (n, p), and the samples without it, (n,).

    Raises:
        ValueError: fewer than 1024 samples, or a constant channel.
    """
    why = unsuitable(record.values, FEWEST)
    if why is not None:
        raise ValueError(why)
    trend = trend_of(record.values.size, record.thermometer)
    return trend, without_trend(record.values, trend)
