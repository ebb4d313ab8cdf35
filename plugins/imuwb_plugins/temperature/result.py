"""The result of noise over temperature."""

from dataclasses import dataclass, field

from imuwb.arrays import Floats
from imuwb.health import Doubts
from imuwb.identification.temperature import AxisTemperatures, Dependence, FirstOrder, FunctionCandidate, Hysteresis
from imuwb.statistics import Coefficient, Estimate
from imuwb.texts import counted, estimate_text

CONVENTION = "AR(1): x(n) = -alpha x(n-1) + beta0 w(n); the paper's b(k+1) = C b(k) + e has C = -alpha"


@dataclass(frozen=True, eq=False, slots=True)
class TemperatureResult:
    """One axis at one temperature, in SI."""

    temperature: float  #: °C
    samples: int
    duration: float  #: s
    records: int
    coefficients: dict[str, Coefficient]
    ar1: FirstOrder
    deviation: Coefficient  #: standard deviation of the samples
    slope: Estimate | None  #: slope of a free line in the Allan curve, where random walk dominates
    slope_times: tuple[float, float] | None  #: s, averaging times of that line
    bias: Estimate  #: mean of a gyro; change of an accelerometer's mean from the reference temperature
    explained_to: float  #: Hz, highest frequency that the sum explains
    averaging_time: Floats
    allan_deviation: Floats
    white_deviation: Floats  #: Allan deviation of N alone; empty if N is not identified

    def __repr__(self) -> str:
        """Return the coefficients, in one line."""
        sizes = ", ".join(f"{letter} {c}" for letter, c in self.coefficients.items())
        return f"{self.temperature:.4g} °C: {sizes}"


@dataclass(frozen=True, eq=False, slots=True)
class DependenceResult:
    """The tests of dependence on temperature; ``p_value`` and ``depends`` are those of N."""

    p_value: float | None
    depends: bool | None
    text: dict[str, str]  #: verdict of each test
    by_coefficient: dict[str, Dependence | None]


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class FunctionResult:
    """A coefficient as a function of temperature, in SI."""

    kind: str | None  #: None: the coefficient is not in the error model
    formula: str
    reason: str
    limit: float | None  #: upper limit, if the coefficient is not in the error model
    candidates: tuple[FunctionCandidate, ...]
    temperature: Floats  #: °C
    value: Floats
    lower: Floats
    upper: Floats


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class PolynomialResult:
    """The bias X0 + X1 d + X2 d² + X3 d³, d = T - reference, fitted to the samples of one record, in SI."""

    log: str
    reference: float  #: °C
    factors: tuple[Estimate, ...]  #: X0 (of an accelerometer 0) ... X3
    lowest: float  #: °C, coldest temperature of the record; the polynomial does not hold below
    highest: float  #: °C, hottest temperature of the record; the polynomial does not hold above
    temperature: Floats  #: °C
    value: Floats
    lower: Floats
    upper: Floats


@dataclass(frozen=True, eq=False, slots=True)
class LagResult:
    """The lag of one log's thermometer."""

    log: str
    lag: Estimate  #: s; positive: the thermometer lags the sensor; negative: the sensor lags the thermometer
    removed: bool  #: whether the record shows it, or it was given
    hysteresis: dict[str, Estimate]  #: bias with rising minus bias with falling temperature, over the whole log, SI

    def __repr__(self) -> str:
        """Return the lag, in one line."""
        return f"{self.log}: {self.lag}{'' if self.removed else ', not removed'}"


def lag_sentence(one: LagResult) -> str:
    """Return what lags, by how much, such as: the thermometer lags the sensor by 120.4 [119.6, 121.2] s; the lag is removed."""
    late, early = ("thermometer", "sensor") if one.lag.value > 0 else ("sensor", "thermometer")
    size = one.lag if one.lag.value > 0 else one.lag.scaled(-1.0, "s")
    return f"the {late} lags the {early} by {estimate_text(size, 's')}; the lag is removed"


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class TemperatureAxis:
    """One axis."""

    by_temperature: tuple[TemperatureResult, ...]
    dependence: DependenceResult
    functions: dict[str, FunctionResult]
    hysteresis: tuple[Hysteresis, ...]
    turn_on: float | None  #: standard deviation of the bias between logs at one temperature
    polynomial: PolynomialResult | None  #: of the record with the widest range; None: no record has a range
    reference_bias: float  #: value of ``bias`` at the reference temperature, by its function
    over: AxisTemperatures = field(metadata={"document": False})


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """All axes of one IMU."""

    imu: str
    source: str
    level: float
    size: float  #: probability of a false alarm of each test
    reference: float  #: °C
    convention: str
    cut: tuple[str, ...]  #: division of each log
    lags: tuple[LagResult, ...]  #: of the logs whose temperature changes
    rate_hz: dict[str, float]
    axes: dict[str, TemperatureAxis]
    notes: tuple[str, ...]
    doubts: Doubts  #: what the records themselves show against their noise
    #: which sensor of an autopilot it is, as the provenance of a model states it
    identity: dict[str, str] = field(default_factory=dict[str, str])

    def __repr__(self) -> str:
        """Return the verdicts on N, one line for each axis."""
        rows = (
            f"  {name}: {counted(len(a.by_temperature), 'temperature')}; {a.dependence.text['N']}"
            for name, a in self.axes.items()
        )
        return "\n".join([self.imu, *rows])


@dataclass(frozen=True, eq=False, slots=True)
class StudyCase:
    """AR(1) of all axes in one setting."""

    settings: dict[str, str]
    axes: dict[str, tuple[tuple[float, FirstOrder], ...]]  #: by temperature, °C
    text: str = field(metadata={"document": False})  #: the setting, for people


@dataclass(frozen=True, eq=False, slots=True)
class Study:
    """AR(1) by temperature and setting."""

    convention: str
    cases: tuple[StudyCase, ...]
