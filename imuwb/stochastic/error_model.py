"""The error model of an IMU: for each axis a sum of processes and its deterministic terms."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.stochastic.sums import Sum

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


Thermal: TypeAlias = tuple[tuple[float, float], ...]  #: (°C, value), rising


@dataclass(frozen=True, slots=True)
class AxisModel:
    """One sensor axis. SI: rad/s for a gyro, m/s² for an accelerometer.

    Between set-points everything is linear in temperature, beyond them it is held.

    Raises:
        ValueError: a term that cannot be, or set-points that do not rise or differ in their processes.
    """

    processes: Sum = field(default_factory=Sum)
    #: "0.N", the parameter N of the first process -> (lower, upper)
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])
    #: a coefficient, such as "K", that was looked for and not found -> its upper limit
    limits: Mapping[str, float] = field(default_factory=dict[str, float])
    thermal: tuple[tuple[float, Sum], ...] = ()  #: (°C, the same processes at that temperature), rising
    bias: float = 0.0  #: measured = true + b, the part that is the same at each turn-on
    scale_factor: float = 0.0  #: measured = (1 + s) true
    thermal_bias: Thermal = ()  #: (°C, bias at that temperature), rising, in place of ``bias``
    thermal_scale_factor: Thermal = ()  #: likewise of ``scale_factor``
    scale_factor_nonlinear: float = 0.0  #: s2 in s2 |true|/range, as a fraction of the true value
    cross_coupling: tuple[float, float] = (0.0, 0.0)  #: rad, of the two other axes in the order x, y, z
    g_sensitivity: tuple[float, float, float] = (0.0, 0.0, 0.0)  #: rad/s per m/s²; gyros only
    bandwidth: float | None = None  #: Hz, -3 dB
    group_delay: float | None = None  #: s
    lsb: float | None = None  #: smallest step of the output
    range: float | None = None  #: largest output

    def __post_init__(self) -> None:
        """Check what can be checked."""
        for name in ("bandwidth", "group_delay", "lsb", "range"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                message = f"{name} is {value}; it must be positive"
                raise ValueError(message)
        shapes = {tuple((type(t), len(getattr(t, "alpha", ()))) for t in s.terms) for _, s in self.thermal}
        for points in (self.thermal, self.thermal_bias, self.thermal_scale_factor):
            celsius = [t for t, _ in points]
            if len(shapes) > 1 or any(b <= a for a, b in pairwise(celsius)):
                message = f"the set-points {celsius} °C must rise, and have the same processes"
                raise ValueError(message)

    def at(self, celsius: float | None) -> Sum:
        """Return the processes at a temperature.

        Raises:
            ValueError: what lies between two set-points is no process (an AR set that is not stable).
        """
        if celsius is None or not self.thermal:
            return self.processes
        below = [point for point in self.thermal if point[0] <= celsius]
        above = [point for point in self.thermal if point[0] >= celsius]
        (t0, low), (t1, high) = (below or above)[-1 if below else 0], (above or below)[0 if above else -1]
        share = 0.0 if t1 == t0 else (celsius - t0) / (t1 - t0)
        return Sum(tuple(_between(a, b, share) for a, b in zip(low.terms, high.terms, strict=True)))


def _between(a: Any, b: Any, share: float) -> Any:  # noqa: ANN401 - whatever process it is given
    def mixed(x: Any, y: Any) -> Any:  # noqa: ANN401 - a number, or the numbers of an AR set
        if isinstance(x, tuple):
            return tuple(mixed(p, q) for p, q in zip(cast("tuple[float, ...]", x), y, strict=True))
        return (1 - share) * x + share * y

    return replace(a, **{f.name: mixed(getattr(a, f.name), getattr(b, f.name)) for f in fields(a)})


@dataclass(frozen=True, slots=True)
class ImuErrorModel:
    """Six axes, ``gyro_x`` ... ``accel_z``, and where their figures come from.

    Raises:
        ValueError: an axis of another name.
    """

    name: str
    axes: Mapping[str, AxisModel]
    provenance: Mapping[str, str] = field(default_factory=dict[str, str])

    def __post_init__(self) -> None:
        """Check the names of the axes."""
        for axis in self.axes:
            if axis not in AXES:
                message = f"error model {self.name!r}: no axis {axis!r}; there are {', '.join(AXES)}"
                raise ValueError(message)

    def to_toml(self) -> str:
        """Return the model as text."""
        from imuwb.stochastic.error_model_document import write  # noqa: PLC0415 - it imports these classes

        return write(self)

    @staticmethod
    def from_toml(text: str, where: str = "error model") -> ImuErrorModel:
        """Return the model that a text describes.

        Raises:
            UsageError: not TOML, an unknown key, unit or process; the message says which and where.
        """
        from imuwb.stochastic.error_model_document import read  # noqa: PLC0415 - as above

        return read(text, where)

    @staticmethod
    def read(path: Path) -> ImuErrorModel:
        """Return the model in a file.

        Raises:
            UsageError: the file cannot be read, or is no error model.
        """
        try:
            text = path.read_text("utf-8")
        except (OSError, UnicodeDecodeError) as error:
            message = f"{path}: cannot be read as an error model: {error}"
            raise UsageError(message) from error
        return ImuErrorModel.from_toml(text, str(path))
