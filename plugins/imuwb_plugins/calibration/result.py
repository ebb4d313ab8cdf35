"""What a calibration found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from imuwb.stochastic import ImuErrorModel

    Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter with its interval at the result's level."""

    value: float
    sigma: float
    lower: float
    upper: float
    unit: str


@dataclass(frozen=True, slots=True)
class Printed:
    """An axis by Hassaballa's equations 3 to 6, from two means."""

    up: float
    down: float
    bias: Parameter
    scale_factor: Parameter


@dataclass(frozen=True, eq=False, slots=True)
class Trace:
    """Samples of an axis, thinned, raw and corrected, and what they should be."""

    title: str
    x: Floats  #: s
    raw: Floats
    corrected: Floats
    reference: Floats


@dataclass(frozen=True, slots=True)
class Position:
    """One still position."""

    name: str
    seconds: float
    up: str | None  #: such as "x up"; None: aslant
    mean: dict[str, float]  #: by axis, unit of the samples
    force: tuple[float, float, float]  #: m/s², true as known or found
    residual: dict[str, float]  #: mean less what the parameters make of the force, unit of the samples
    sigma: dict[str, float]  #: of the mean's noise


@dataclass(frozen=True, eq=False, slots=True)
class PositionResult:
    """Accelerometers, and gyros where there are any."""

    imu: str
    level: float
    gravity: float  #: m/s²
    gravity_from: str
    unit: str  #: of the samples, "" for SI
    parameters: dict[str, dict[str, Parameter]]  #: axis -> name -> parameter
    printed: dict[str, Printed]
    misplacement: float | None  #: rad
    probability: float  #: of residuals as large as these by noise alone
    positions: tuple[Position, ...]
    temperature: float | None  #: °C
    notes: tuple[str, ...]
    model: ImuErrorModel = field(metadata={"document": False})
    traces: tuple[Trace, ...] = field(metadata={"document": False})


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a staircase."""

    rate: float  #: rad/s, the table's
    seconds: float
    mean: dict[str, float]
    residual: dict[str, float]
    sigma: dict[str, float]


@dataclass(frozen=True, eq=False, slots=True)
class Run:
    """One run of the table."""

    name: str
    axis: str  #: that turns
    offset: dict[str, Parameter]  #: of each gyro in this attitude
    steps: tuple[Step, ...]


@dataclass(frozen=True, eq=False, slots=True)
class TableResult:
    """Gyros from a rate table."""

    imu: str
    level: float
    unit: str
    full_range: float | None  #: rad/s
    parameters: dict[str, dict[str, Parameter]]
    runs: tuple[Run, ...]
    temperature: float | None
    notes: tuple[str, ...]
    model: ImuErrorModel = field(metadata={"document": False})
    traces: tuple[Trace, ...] = field(metadata={"document": False})
