"""What the Allan analysis finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from imuwb.analysis import LineResult
    from imuwb.identification import CorrelationTime, Disturbance, ModelChoice, Region, Stationarity
    from imuwb.statistics import Coefficient
    from imuwb.stochastic import Sum


@dataclass(frozen=True, slots=True)
class FitQuality:
    """How well the sum explains the curve."""

    from_averaging_time: float  #: s; shorter ones are left out of the fit
    misfit: float  #: chi-square over degrees of freedom
    probability: float


@dataclass(frozen=True, eq=False, slots=True)
class OtherDeviation:
    """A relative of the Allan deviation."""

    kind: str
    averaging_time: NDArray[np.float64]
    deviation: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Estimates:
    """What other estimators say of the same record."""

    headline: str  #: the estimator of the least error, "likelihood", where the record allows it
    by: dict[str, dict[str, Coefficient]]  #: estimator -> coefficients
    processes: Sum | None  #: the headline's terms whose intervals do not begin at 0
    highest: float | None  #: Hz, up to which the likelihood's sum explains the spectrum
    agree: bool  #: wherever two estimators give a coefficient, their intervals meet
    disagreements: tuple[str, ...]
    stationarity: Stationarity | None
    choice: ModelChoice | None
    mean: float  #: of the samples
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False, slots=True)
class AxisResult:
    """One axis, SI."""

    averaging_time: NDArray[np.float64]
    allan_deviation: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    degrees_of_freedom: NDArray[np.float64]
    noise_exponent: NDArray[np.int64]
    fitted: NDArray[np.float64] | None
    coefficients: dict[str, Coefficient]
    regions: tuple[Region, ...]
    correlation_time: CorrelationTime | None
    lines: tuple[LineResult, ...]
    fit: FitQuality | None
    processes: Sum | None
    why_no_fit: str | None
    other: OtherDeviation | None = None
    estimates: Estimates | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """All axes of one IMU."""

    imu: str
    source: str  #: path and hash of the log
    level: float  #: of all intervals and limits
    rate_hz: dict[str, float]
    duration: float  #: s
    axes: dict[str, AxisResult]
    moving: bool | None  #: most of the record is not still; None: too short or too slow to tell
    disturbances: tuple[Disturbance, ...]
    quiet: tuple[float, float] | None  #: s from the log's start; None likewise
    notes: tuple[str, ...]
    model: str  #: whose figures go into the error model: "allan" or "headline"
