"""Findings as results, and in words."""

from __future__ import annotations

from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from imuwb.statistics import Coefficient
from imuwb.units import coefficient_units
from imuwb_plugins.temperature.result import (
    AxisResult,
    DependenceResult,
    FirstOrderResult,
    FunctionResult,
    HysteresisResult,
    SlopeResult,
    TemperatureResult,
)

if TYPE_CHECKING:
    from imuwb.identification.temperature import AxisTemperatures, Bias, Dependence, FirstOrder, Law, SetPoint

NAMES = {"N": "N", "B": "B", "K": "K", "Q": "Q", "alpha": "AR(1)", "bias": "the bias"}
CURVE = 101  #: temperatures at which a function is drawn
CLEAR = 1e-4


def axis_result(axis: str, found: AxisTemperatures, reference: float) -> AxisResult:
    """Return an axis's findings."""
    return AxisResult(
        tuple(_at(axis, p, b, _reference_bias(axis, found, reference), found.level) for p, b in zip(found.points, found.biases.at, strict=True)),
        _dependence(found),
        {name: _function(name, axis, law, found, reference) for name, law in found.laws.items()},
        tuple(HysteresisResult(h.celsius, h.value, h.lower, h.upper) for h in found.biases.hysteresis),
        found.biases.turn_on,
        found,
    )  # fmt: skip


def _at(axis: str, point: SetPoint, bias: Bias, reference: float, level: float) -> TemperatureResult:
    rate = coefficient_units(axis, "rate")[0].name
    half = normal_half(level) * bias.sigma
    change = bias.value - reference
    region = point.region
    return TemperatureResult(
        point.celsius, point.samples, point.duration, len(point.means),
        {x: _coefficient(c, coefficient_units(axis, x)[0].name) for x, c in point.coefficients.items()},
        first_order_result(point.first),
        _coefficient(point.deviation, rate),
        None if region is None else SlopeResult(region.slope, region.lower, region.upper, region.start, region.end),
        Coefficient(change, change - half, change + half, rate),
        point.fit.highest, point.curve.averaging_time, point.curve.deviation,
    )  # fmt: skip


def normal_half(level: float) -> float:
    """Return how many standard errors an interval reaches to each side."""
    return NormalDist().inv_cdf((1 + level) / 2)


def first_order_result(first: FirstOrder) -> FirstOrderResult:
    """Return AR(1) as it is documented."""
    return FirstOrderResult(first.alpha, first.sigma, first.sigma_if_ar, first.paper)


def _coefficient(found: Coefficient, unit: str) -> Coefficient:
    return found.in_unit(unit)


def _reference_bias(axis: str, found: AxisTemperatures, reference: float) -> float:
    """Return what a bias is told against: for an accelerometer the value at the reference temperature, else 0."""
    law = found.laws.get("bias")
    if not axis.startswith("accel") or law is None or law.function is None:
        return 0.0
    return float(law.function.at(np.array([reference]))[0][0])


def _function(name: str, axis: str, law: Law, found: AxisTemperatures, reference: float) -> FunctionResult:
    none = np.empty(0)
    if law.choice is None:
        return FunctionResult(None, "not in the model", law.how, law.limit, (), none, none, none, none)
    function = law.choice.function
    celsius = np.linspace(found.points[0].celsius, found.points[-1].celsius, CURVE)
    offset = _reference_bias(axis, found, reference) if name == "bias" else 0.0
    value, lower, upper = (part - offset for part in function.at(celsius, found.level))
    how = f"{law.how}: {law.choice.why}" if law.choice.why else law.how
    text = f"{function.text}, gravity's part of the mean in it" if offset else function.text
    return FunctionResult(function.kind, text, how, law.limit, law.choice.candidates, celsius, value, lower, upper)


def _dependence(found: AxisTemperatures) -> DependenceResult:
    white = found.dependence["N"]
    text = " ".join(told(name, test) for name, test in found.dependence.items() if name != "Q" or _is_there(test))
    if white is None:
        return DependenceResult(None, None, "", None, 0.0, None, text, found.dependence)
    return DependenceResult(
        white.p_value, white.statistic, white.distribution, white.critical, white.size, white.depends, text, found.dependence
    )  # fmt: skip


def _is_there(test: Dependence | None) -> bool:
    return test is not None and test.depends is not None


def told(name: str, test: Dependence | None) -> str:
    """Return a test in words."""
    what = NAMES[name]
    if test is None:
        return f"{what}: nothing to compare."
    if test.statistic is None or test.p_value is None or test.depends is None:
        return f"{what}: no sure trace of it, so nothing that could depend on temperature."
    p = f"p = {test.p_value:.2g}" if test.p_value >= CLEAR else f"p < {CLEAR:g}"
    verdict = "depends on temperature" if test.depends else "is tenable as one value at all temperatures"
    return f"{what} {verdict} ({p})."
