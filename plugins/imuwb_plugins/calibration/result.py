"""The results of a calibration."""

from dataclasses import dataclass, field

from imuwb.arrays import Floats
from imuwb.identification.calibration import PrintedCalibration
from imuwb.statistics import Estimate
from imuwb.stochastic import ImuErrorModel
from imuwb.texts import counted

Terms = dict[str, dict[str, Estimate]]  # axis -> name of the parameter -> parameter


@dataclass(frozen=True, eq=False, slots=True)
class Trace:
    """Thinned samples of one axis before and after the correction, and the true value."""

    title: str
    x: Floats  #: s
    raw: Floats
    corrected: Floats
    reference: Floats
    scaled: bool = True  #: whether the correction leads to SI; a gyro in counts without a scale factor stays in counts


@dataclass(frozen=True, slots=True)
class Position:
    """One still position."""

    name: str
    seconds: float
    up: str | None  #: axis that points up or down, such as "x up"; None: no axis does
    mean: dict[str, float]  #: by axis, in the unit of the samples
    force: tuple[float, float, float]  #: m/s², true specific force, given or estimated
    residual: dict[str, float]  #: mean minus the fit's value, in the unit of the samples
    sigma: dict[str, float]  #: standard deviation of the mean's noise


@dataclass(frozen=True, slots=True)
class Motions:
    """The motions between positions, which give the gyros' scale factors and couplings."""

    before: tuple[int, ...]  #: number of the position, from 1, in which each motion begins
    apart: tuple[float, ...]  #: rad, between up after the motion and up before it as the gyros have turned it
    window: float  #: s, longest part of a position that is used beside a motion
    excess: float  #: rms of these angles over what the known noise makes


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class PositionResult:
    """The calibration of accelerometers, and of gyros if the logs have them, from still positions."""

    imu: str
    level: float
    gravity: float  #: m/s²
    gravity_from: str
    unit: str  #: of the samples, "" for SI
    parameters: Terms
    printed: dict[str, PrintedCalibration]
    misplacement: float | None  #: rad
    probability: float  #: probability that noise alone makes residuals as large as these
    positions: tuple[Position, ...]
    temperature: float | None  #: °C
    notes: tuple[str, ...]
    model: ImuErrorModel = field(metadata={"document": False})
    traces: tuple[Trace, ...] = field(metadata={"document": False})
    motions: Motions | None = None  #: None: the gyros have no scale factors

    def __repr__(self) -> str:
        """Return the parameters, one line for each axis."""
        return _lines(f"{self.imu}: {counted(len(self.positions), 'position')}", self.parameters)


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a staircase of rates."""

    rate: float  #: rad/s, of the table
    seconds: float
    mean: dict[str, float]
    residual: dict[str, float]
    sigma: dict[str, float]
    #: for the turned gyro: mean minus true rate minus offset of the run; for a log in counts or volts, the mean
    error: float
    fitted_error: float  #: value of the fit for ``error``


@dataclass(frozen=True, eq=False, slots=True)
class TableRun:
    """One run of the rate table."""

    name: str
    axis: str  #: axis that turns
    offset: dict[str, Estimate]  #: output of each gyro at rest in this attitude
    steps: tuple[Step, ...]


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class TableResult:
    """The calibration of gyros on a rate table."""

    imu: str
    level: float
    unit: str  #: of the samples, "" for SI
    full_range: float | None  #: rad/s
    parameters: Terms
    runs: tuple[TableRun, ...]
    temperature: float | None  #: °C
    notes: tuple[str, ...]
    model: ImuErrorModel = field(metadata={"document": False})
    traces: tuple[Trace, ...] = field(metadata={"document": False})

    def __repr__(self) -> str:
        """Return the parameters, one line for each axis."""
        return _lines(f"{self.imu}: {len(self.runs)} runs of a rate table", self.parameters)


def _lines(title: str, parameters: Terms) -> str:
    rows = [
        f"  {axis}: {', '.join(f'{name} {value}' for name, value in terms.items())}"
        for axis, terms in parameters.items()
    ]
    return "\n".join([title, *rows])
