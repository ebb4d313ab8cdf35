"""The error model of one sensor axis: a sum of processes and deterministic terms."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from typing import Any, TypeAlias, cast

import numpy as np

from imuwb.stochastic.sums import Sum, short_text

Thermal: TypeAlias = tuple[tuple[float, float], ...]  #: (°C, value), rising


@dataclass(frozen=True, slots=True)
class AxisModel:
    """One sensor axis. SI: rad/s for a gyro, m/s² for an accelerometer.

    Between two set-points everything is linear in temperature; below the first and above the last it is constant.

    Raises:
        ValueError: a term out of its range, or set-points that do not rise or differ in their processes.
    """

    processes: Sum = field(default_factory=Sum)
    #: "0.N", the parameter N of the first process -> (lower, upper)
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])
    #: coefficient that the record does not show, such as "K" -> its upper limit
    limits: Mapping[str, float] = field(default_factory=dict[str, float])
    thermal: tuple[tuple[float, Sum], ...] = ()  #: (°C, the same processes at that temperature), rising
    bias: float = 0.0  #: b in measured = true + b; it is the same at each turn-on
    scale_factor: float = 0.0  #: s in measured = (1 + s) true
    thermal_bias: Thermal = ()  #: (°C, bias at that temperature), rising, in place of ``bias``
    thermal_scale_factor: Thermal = ()  #: (°C, scale factor at that temperature), rising, in place of ``scale_factor``
    scale_factor_nonlinear: float = 0.0  #: s2 in s2 |true|/range, as a fraction of the true value
    cross_coupling: tuple[float, float] = (0.0, 0.0)  #: rad, of the two other axes in the order x, y, z
    g_sensitivity: tuple[float, float, float] = (0.0, 0.0, 0.0)  #: rad/s per m/s²; gyros only
    bandwidth: float | None = None  #: Hz, -3 dB
    group_delay: float | None = None  #: s
    lsb: float | None = None  #: smallest step of the output
    range: float | None = None  #: largest output

    def __post_init__(self) -> None:
        """Check the ranges and the set-points."""
        for name in ("bandwidth", "group_delay", "lsb", "range"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}; it must be positive")
        shapes = {tuple((type(t), len(getattr(t, "alpha", ()))) for t in s.terms) for _, s in self.thermal}
        for points in (self.thermal, self.thermal_bias, self.thermal_scale_factor):
            celsius = [t for t, _ in points]
            if len(shapes) > 1 or any(b <= a for a, b in pairwise(celsius)):
                raise ValueError(f"the set-points are {celsius} °C; they must rise, and have the same processes")

    def at(self, celsius: float | None) -> Sum:
        """Return the processes at a temperature.

        Raises:
            ValueError: between two set-points, an AR set that is not stable.
        """
        if celsius is None or not self.thermal:
            return self.processes
        below = [point for point in self.thermal if point[0] <= celsius]
        above = [point for point in self.thermal if point[0] >= celsius]
        (t0, low), (t1, high) = (below or above)[-1 if below else 0], (above or below)[0 if above else -1]
        share = 0.0 if t1 == t0 else (celsius - t0) / (t1 - t0)
        return Sum(tuple(_between(a, b, share) for a, b in zip(low.terms, high.terms, strict=True)))

    def __str__(self) -> str:
        """Return the processes, and the other terms that are stated, in SI."""
        other = [f.name for f in fields(self) if f.name not in ("processes", "intervals", "limits", "thermal")]
        stated = [f"{name}={short_text(value)}" for name in other if np.any(value := getattr(self, name) or 0.0)]
        return "; ".join([str(self.processes), *stated])


def _between(a: Any, b: Any, share: float) -> Any:  # noqa: ANN401 - whatever process it is given
    def mixed(x: Any, y: Any) -> Any:  # noqa: ANN401 - a number, or the numbers of an AR set
        if isinstance(x, tuple):
            return tuple(mixed(p, q) for p, q in zip(cast("tuple[float, ...]", x), y, strict=True))
        return (1 - share) * x + share * y

    return replace(a, **{f.name: mixed(getattr(a, f.name), getattr(b, f.name)) for f in fields(a)})
