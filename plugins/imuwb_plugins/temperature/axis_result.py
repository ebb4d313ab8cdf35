"""From one axis over temperature to its result."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from imuwb.identification.temperature import (
    CONTRADICTED,
    AxisTemperatures,
    Dependence,
    Law,
    SetPoint,
    ThermalLag,
    bias_polynomial,
)
from imuwb.statistics import Estimate
from imuwb.units import coefficient_units
from imuwb_plugins.temperature.result import (
    DependenceResult,
    FunctionResult,
    PolynomialResult,
    TemperatureAxis,
    TemperatureResult,
)

#: quantity -> its name in tables and verdicts
NAMES = {"N": "N", "B": "B", "K": "K", "Q": "Q", "alpha": "AR(1)", "bias": "bias"}
CURVE = 101  #: temperatures of a function's curve
CLEAR = 1e-4  #: smaller p values are not printed
NONE = np.empty(0)
POWERS = ("", "²", "³")  #: of a degree, in the units of a polynomial's factors


def axis_result(
    axis: str, over: AxisTemperatures, reference: float, wanted: float, widest: tuple[str, ThermalLag] | None
) -> TemperatureAxis:
    """Return the result of an axis.

    Args:
        axis: its name.
        over: the axis over temperature.
        reference: °C, of the error model.
        wanted: °C, reference of the polynomial, if it was measured there.
        widest: path and temperature of the log with the widest range; None: no log has a range.
    """
    rate = coefficient_units(axis, "rate")[0].name
    at_reference = _bias_at(over, reference)
    # One attitude does not separate an accelerometer's bias from gravity: only the change is a bias.
    offset = at_reference if axis.startswith("accel") else 0.0
    return TemperatureAxis(
        tuple(
            _at(axis, point, bias.estimate.shifted(-offset).scaled(1.0, rate))
            for point, bias in zip(over.points, over.biases.at, strict=True)
        ),
        _dependence(over),
        {name: _function(law, over, offset if name == "bias" else 0.0) for name, law in over.laws.items()},
        tuple(replace(h, difference=h.difference.scaled(1.0, rate)) for h in over.biases.hysteresis),
        over.biases.turn_on,
        None if widest is None or axis not in widest[1].axes else _polynomial(axis, *widest, wanted, over.level),
        at_reference - offset,
        over,
    )


def _polynomial(axis: str, path: str, thermal: ThermalLag, reference: float, level: float) -> PolynomialResult:
    inside = thermal.celsius[thermal.window.inside]
    about = float(np.clip(reference, inside.min(), inside.max()))
    found = bias_polynomial(thermal, axis, about, level=level)
    rate = coefficient_units(axis, "rate")[0].name
    # One attitude does not separate an accelerometer's bias from gravity: only the change is a bias.
    offset = found.factors[0].value if axis.startswith("accel") else 0.0
    constant = Estimate(0.0, 0.0, 0.0, 0.0) if offset else found.factors[0]
    factors = (constant, *found.factors[1:])
    celsius = np.linspace(found.lowest, found.highest, CURVE)
    curve = (part - offset for part in found.at(celsius))
    units = [rate, *(f"{rate}/°C{power}" for power in POWERS)]
    named = tuple(replace(f, unit=unit) for f, unit in zip(factors, units, strict=False))
    return PolynomialResult(path, about, named, found.lowest, found.highest, celsius, *curve)


def _bias_at(over: AxisTemperatures, celsius: float) -> float:
    """Return the value of the bias's function at a temperature; 0 if there is none."""
    law = over.laws.get("bias")
    return 0.0 if law is None or law.function is None else float(law.function.at(np.array([celsius]))[0][0])


def _at(axis: str, point: SetPoint, bias: Estimate) -> TemperatureResult:
    region, white = point.region, point.coefficients["N"].value
    tau = point.curve.averaging_time
    return TemperatureResult(
        point.celsius, point.samples, point.duration, len(point.means),
        {letter: c.in_unit(coefficient_units(axis, letter)[0].name) for letter, c in point.coefficients.items()},
        point.ar1, point.deviation.in_unit(coefficient_units(axis, "rate")[0].name),
        None if region is None else replace(region.slope, unit="1"),
        None if region is None else (region.start, region.end), bias, point.fit.highest, tau, point.curve.deviation,
        NONE if white is None else white / np.sqrt(tau),
    )  # fmt: skip


def _function(law: Law, over: AxisTemperatures, offset: float) -> FunctionResult:
    if law.choice is None:
        return FunctionResult(None, "not in the error model", law.reason, law.limit, (), NONE, NONE, NONE, NONE)
    function = law.choice.function
    celsius = np.linspace(over.points[0].celsius, over.points[-1].celsius, CURVE)
    value, lower, upper = (part - offset for part in function.at(celsius, over.level))
    reason = f"{law.reason}: {law.choice.reason}" if law.choice.reason else law.reason
    formula = f"{function.text}, including gravity's part of the mean" if offset else function.text
    return FunctionResult(
        function.kind, formula, reason, law.limit, law.choice.candidates, celsius, value, lower, upper
    )


def _dependence(over: AxisTemperatures) -> DependenceResult:
    white = over.dependence["N"]
    text = {name: dependence_text(name, test) + _kept(name, test, over) for name, test in over.dependence.items()}
    p_value, depends = (None, None) if white is None else (white.p_value, white.depends)
    return DependenceResult(p_value, depends, text, over.dependence)


def _kept(name: str, test: Dependence | None, over: AxisTemperatures) -> str:
    """Return why the error model has a constant although the test of a quantity finds a dependence."""
    law = over.laws.get(name)
    if (
        test is None
        or law is None
        or law.choice is None
        or not _is_kept(test.depends, law.choice.function.kind, law.choice.candidates)
    ):
        return ""
    return f"; constant in the model: a function needs p < {CONTRADICTED:g}, or must predict better"


def kept_constant(own: TemperatureAxis, name: str) -> bool:
    """Return whether cross-validation keeps a quantity constant in the error model although its test finds a dependence."""
    test, law = own.dependence.by_coefficient.get(name), own.functions.get(name)
    return test is not None and law is not None and _is_kept(test.depends, law.kind, law.candidates)


def _is_kept(depends: bool | None, kind: str | None, candidates: Sequence[object]) -> bool:  # noqa: FBT001 - None: not tested
    return depends is True and kind == "constant" and bool(candidates)


def dependence_text(name: str, test: Dependence | None) -> str:
    """Return the verdict of a test, such as: N depends on temperature (p < 0.0001)."""
    if test is None:
        return f"{NAMES[name]}: there is no test"
    if test.p_value is None or test.depends is None:
        return f"{NAMES[name]} is not tested: {test.distribution}"
    p = f"p = {test.p_value:.2g}" if test.p_value >= CLEAR else f"p < {CLEAR:g}"
    verdict = "depends on temperature" if test.depends else "may be the same at all temperatures"
    return f"{NAMES[name]} {verdict} ({p})"
