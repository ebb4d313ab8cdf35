"""Result of the Allan analysis."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from imuwb.arrays import Floats, Integers
from imuwb.health import Doubts
from imuwb.identification import Disturbance, ModelChoice, Region, Stationarity
from imuwb.noise_results import LineResult, ModelCurves
from imuwb.notes import Note
from imuwb.statistics import Coefficient, Estimate
from imuwb.stochastic import Sum
from imuwb.texts import coefficients_text


@dataclass(frozen=True, slots=True)
class FitQuality:
    """How well the sum explains the curve."""

    from_averaging_time: float  #: s; shorter averaging times are left out of the fit
    misfit: float  #: chi-square over degrees of freedom
    probability: float  #: probability that chance makes a misfit as large


@dataclass(frozen=True, slots=True)
class ReadOut:
    """Where a coefficient is read on the Allan curve. SI."""

    letter: str
    averaging_time: float  #: s
    deviation: float  #: deviation of the term's own line, or of the flat level


@dataclass(frozen=True, eq=False, slots=True)
class OtherDeviation:
    """A deviation of the Allan family other than the Allan deviation itself."""

    kind: str
    averaging_time: Floats
    deviation: Floats
    lower: Floats
    upper: Floats


@dataclass(frozen=True, eq=False, slots=True)
class EstimatorComparison:
    """The estimates of all estimators, stationarity, and the comparison of sums."""

    headline: str  #: the estimator with the least error: "likelihood" where the record allows it
    by: dict[str, dict[str, Coefficient]]  #: estimator -> coefficients
    processes: Sum  #: the sum in the headline's error model
    intervals_apply: bool  #: whether the headline's intervals belong to that sum; not if it has a Gauss-Markov process
    highest: float | None  #: Hz, up to which the likelihood's sum explains the spectrum
    agree: bool  #: intervals of all estimators overlap
    disagreements: tuple[str, ...]
    stationarity: Stationarity | None
    choice: ModelChoice | None
    mean: float  #: mean of the samples
    notes: tuple[Note, ...]


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class AllanAxis:
    """One axis. SI."""

    averaging_time: Floats
    allan_deviation: Floats
    lower: Floats
    upper: Floats
    degrees_of_freedom: Floats
    noise_exponent: Integers
    fitted: Floats | None
    coefficients: Mapping[str, Coefficient]
    regions: tuple[Region, ...] = ()
    correlation_time: Estimate | None = None  #: s, middle of the flat part, between its begin and end
    gauss_markov_time: float | None = None  #: s, Tc of the Gauss-Markov process whose peak is that middle
    lines: tuple[LineResult, ...] = ()
    fit: FitQuality | None = None
    processes: Sum | None = None
    read_outs: tuple[ReadOut, ...] = ()
    why_no_fit: str | None = None
    other: OtherDeviation | None = None
    estimates: EstimatorComparison | None = None
    model_curves: ModelCurves | None = field(default=None, metadata={"document": False})

    def __repr__(self) -> str:
        """Return the coefficients, or why there are none."""
        return self.why_no_fit or coefficients_text(self.coefficients)


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Result:
    """All axes of one IMU."""

    imu: str
    source: str  #: path and hash of the log
    level: float  #: of all intervals and limits
    rate_hz: dict[str, float]
    duration: float  #: s
    axes: dict[str, AllanAxis]
    moving: bool | None  #: most of the record is not still; None: the record is too short, or its rate too low, to test
    disturbances: tuple[Disturbance, ...]
    quiet: tuple[float, float] | None  #: s from the start of the log; None: not tested
    notes: tuple[str, ...]
    model: str  #: coefficients that the error model takes: "allan" or "headline"
    doubts: Doubts  #: what the record itself shows against the coefficients

    def __repr__(self) -> str:
        """Return the coefficients of each axis."""
        return "\n".join(
            [f"{self.imu}, {self.duration:.0f} s, Allan fit:", *(f"  {a}: {r}" for a, r in self.axes.items())]
        )
