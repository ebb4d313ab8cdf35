"""The error model of one sensor axis: a sum of processes and deterministic terms."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from typing import Any, TypeAlias, cast

import numpy as np

from imuwb.stochastic.autoregressive import Autoregressive
from imuwb.stochastic.elementary import LARGEST
from imuwb.stochastic.sums import Sum, short_text

LIMITED = ("Q", "N", "B", "K", "R", "sigma", "beta0", "amplitude")  #: parameters that may have a limit
Thermal: TypeAlias = tuple[tuple[float, float], ...]  #: (°C, value), rising


@dataclass(frozen=True, slots=True)
class AxisModel:
    """One sensor axis. SI: rad/s for a gyro, m/s² for an accelerometer.

    Between two set-points everything is linear in temperature; below the first and above the last it is constant.

    Raises:
        ValueError: a term out of its range, a value outside of its interval, a limit that is not positive, or set-points that
            do not rise or differ in their processes.
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
    #: of denoised samples, one of each order: the biases of the filters 15AR and 27AR, and no part of the sum
    autoregressive: tuple[Autoregressive, ...] = ()

    def __post_init__(self) -> None:
        """Check the ranges, the intervals and the set-points."""
        self._check_terms()
        self._check_intervals()
        for name in ("bandwidth", "group_delay", "lsb", "range"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}; it must be positive")
        orders = [len(process.alpha) for process in self.autoregressive]
        if len(set(orders)) < len(orders):
            raise ValueError(
                f"the autoregressive processes of denoised samples have the orders {orders}; keep one of each"
            )
        shapes = {tuple((type(t), len(getattr(t, "alpha", ()))) for t in s.terms) for _, s in self.thermal}
        for points in (self.thermal, self.thermal_bias, self.thermal_scale_factor):
            celsius = [t for t, _ in points]
            if len(shapes) > 1 or any(b <= a for a, b in pairwise(celsius)):
                raise ValueError(f"the set-points are {celsius} °C; they must rise, and have the same processes")

    def _check_terms(self) -> None:
        terms = {"bias": (self.bias,), "scale_factor": (self.scale_factor,)}
        terms |= {"scale_factor_nonlinear": (self.scale_factor_nonlinear,)}
        terms |= {"cross_coupling": self.cross_coupling, "g_sensitivity": self.g_sensitivity}
        terms |= {name: sum(getattr(self, name), ()) for name in ("thermal_bias", "thermal_scale_factor")}
        for name, values in terms.items():
            for value in values:
                if not abs(value) < LARGEST:
                    raise ValueError(f"{name} has the value {value}; it must be a number below {LARGEST:g}")

    def _check_intervals(self) -> None:
        for key, (lower, upper) in self.intervals.items():
            place, _, name = key.partition(".")
            known = place.isdecimal() and int(place) < len(self.processes.terms)
            value = getattr(self.processes.terms[int(place)], name, None) if known else None
            if not isinstance(value, float):
                raise ValueError(  # noqa: TRY004 - the key is wrong, not the type
                    f"there is an interval of {key!r}, but no such parameter; write 0.N for N of the first process"
                )
            if not -LARGEST < lower <= value <= upper < LARGEST:
                raise ValueError(
                    f"{name} of process {place} is {value}; it must be in its interval, {lower} to {upper}"
                )
        for name, limit in self.limits.items():
            if name not in LIMITED or not 0 < limit < LARGEST:
                raise ValueError(
                    f"the limit of {name} is {limit}; it must be above 0, and belong to one of {', '.join(LIMITED)}"
                )

    def with_processes(self, processes: Sum, thermal: tuple[tuple[float, Sum], ...] = ()) -> AxisModel:
        """Return the axis with other processes. A process that stays keeps its intervals.

        Args:
            processes: the new processes.
            thermal: (°C, the new processes at that temperature).
        """
        before = self.processes.terms
        kept = {
            f"{i}.{name}": ends
            for i, term in enumerate(processes.terms)
            if term in before
            for key, ends in self.intervals.items()
            for place, _, name in (key.partition("."),)
            if int(place) == before.index(term)
        }
        return replace(self, processes=processes, thermal=thermal, intervals=kept)

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
        apart = ("processes", "intervals", "limits", "thermal", "autoregressive")
        other = [f.name for f in fields(self) if f.name not in apart]
        stated = [f"{name}={short_text(value)}" for name in other if np.any(value := getattr(self, name) or 0.0)]
        return "; ".join([str(self.processes), *stated])


def of_either_sign(value: float, lower: float, upper: float) -> tuple[float, float]:
    """Return the interval of a value from the interval of its magnitude, or that of its magnitude from its own.

    Estimators give the size of a rate ramp with the interval of that size; an error model has the ramp with its sign.
    """
    return (lower, upper) if value >= 0 else (-upper, -lower)


def _between(a: Any, b: Any, share: float) -> Any:  # noqa: ANN401 - whatever process it is given
    def mixed(x: Any, y: Any) -> Any:  # noqa: ANN401 - a number, or the numbers of an AR set
        if isinstance(x, tuple):
            return tuple(mixed(p, q) for p, q in zip(cast("tuple[float, ...]", x), y, strict=True))
        return (1 - share) * x + share * y

    return replace(a, **{f.name: mixed(getattr(a, f.name), getattr(b, f.name)) for f in fields(a)})
