"""What the sensors do over temperature."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from imuwb.identification.temperature import AxisTemperatures, Candidate, Dependence
    from imuwb.statistics import Coefficient

    Floats = NDArray[np.float64]

NOT_DOCUMENTED = {"document": False}


@dataclass(frozen=True, slots=True)
class FirstOrderResult:
    """x(n) = -alpha x(n-1) + beta0 w(n)."""

    alpha: float
    sigma: float  #: standard error, Bartlett's
    sigma_if_ar: float  #: √((1 - alpha²)/n)
    paper_c: float  #: of b(k+1) = C b(k) + e: -alpha


@dataclass(frozen=True, slots=True)
class SlopeResult:
    """A free line's slope in the Allan curve, where random walk rules it."""

    value: float
    lower: float
    upper: float
    start: float  #: s
    end: float  #: s


@dataclass(frozen=True, eq=False, slots=True)
class TemperatureResult:
    """One axis at one temperature. SI."""

    temperature: float  #: °C
    samples: int
    duration: float  #: s
    records: int
    coefficients: dict[str, Coefficient]
    ar1: FirstOrderResult
    deviation: Coefficient  #: of the samples
    slope: SlopeResult | None
    bias: Coefficient  #: of a gyro the mean, of an accelerometer the change from the reference temperature
    explained_to: float  #: Hz
    averaging_time: Floats
    allan_deviation: Floats


@dataclass(frozen=True, eq=False, slots=True)
class DependenceResult:
    """Whether N depends on temperature, and the same for all that was tested."""

    p_value: float | None
    statistic: float | None
    distribution: str
    critical: float | None
    size: float
    depends: bool | None
    text: str
    by_coefficient: dict[str, Dependence | None]


@dataclass(frozen=True, eq=False, slots=True)
class FunctionResult:
    """A coefficient as a function of temperature, in SI; ``kind`` None: it is not in the model."""

    kind: str | None
    text: str
    how: str  #: it was decided
    limit: float | None
    candidates: tuple[Candidate, ...]
    temperature: Floats  #: °C
    value: Floats
    lower: Floats
    upper: Floats


@dataclass(frozen=True, slots=True)
class HysteresisResult:
    """Rising less falling."""

    temperature: float
    value: float
    lower: float
    upper: float


@dataclass(frozen=True, eq=False, slots=True)
class AxisResult:
    """One axis."""

    by_temperature: tuple[TemperatureResult, ...]
    dependence: DependenceResult
    functions: dict[str, FunctionResult]
    hysteresis: tuple[HysteresisResult, ...]
    turn_on: float | None  #: standard deviation of the bias from log to log at one temperature
    found: AxisTemperatures = field(metadata=NOT_DOCUMENTED)


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """All axes of one IMU."""

    imu: str
    source: str
    level: float
    reference: float  #: °C
    convention: str
    cut: tuple[str, ...]  #: of each log
    rate_hz: dict[str, float]
    axes: dict[str, AxisResult]
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False, slots=True)
class StudyCase:
    """AR(1) of all axes in one setting."""

    settings: dict[str, str]
    axes: dict[str, tuple[tuple[float, FirstOrderResult], ...]]  #: by temperature


@dataclass(frozen=True, eq=False, slots=True)
class Study:
    """AR(1) by temperature and setting."""

    convention: str
    cases: tuple[StudyCase, ...]
