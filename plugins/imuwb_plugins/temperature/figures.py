"""Figures of noise over temperature."""

from collections.abc import Sequence

import numpy as np

from imuwb.analysis import Curve, Figure
from imuwb.colors import AXIS_COLORS, BLUE, GREEN, ORANGE, RED, TEAL, YELLOW, Color, between, color_at
from imuwb.statistics import Coefficient, Estimate
from imuwb.units import UNITS, Unit, coefficient_units
from imuwb_plugins.temperature.result import Result, Study

CELSIUS = "temperature [°C]"
COLD_TO_HOT = (BLUE, TEAL, GREEN, YELLOW, ORANGE, RED)
NAMED = 6  #: temperatures in a legend, at most
#: share of the span of temperatures by which the points of an axis are shifted sideways
ASIDE = {"x": -0.005, "y": 0.0, "z": 0.005}
DEVIATION = {"gyro": UNITS["deg/h"], "accel": UNITS["m/s²"]}
DIM = 0.6  #: factor that darkens the colour of limits


def color_of(share: float) -> Color:
    """Return the colour of a temperature: 0 is the coldest, 1 the hottest."""
    place = share * (len(COLD_TO_HOT) - 1)
    k = min(int(place), len(COLD_TO_HOT) - 2)
    return between(COLD_TO_HOT[k], COLD_TO_HOT[k + 1], place - k)


def allan(result: Result, axis: str) -> Figure:
    """Return an axis's Allan curves by temperature, each with the line of slope -1/2 of its N (figures 4 to 7)."""
    points = result.axes[axis].by_temperature
    unit = DEVIATION[axis.partition("_")[0]]
    named = set(np.linspace(0, len(points) - 1, min(NAMED, len(points))).round().astype(int).tolist())
    curves: list[Curve] = []
    for i, p in enumerate(points):
        color = color_of(i / max(len(points) - 1, 1))
        label = f"{p.temperature:.0f} °C" if i in named else ""
        curves.append(Curve(label, p.averaging_time, p.allan_deviation / unit.factor, color, style="curve"))
        if p.white_deviation.size:
            line = p.white_deviation / unit.factor
            curves.append(Curve("N, slope -1/2" if i == 0 else "", p.averaging_time, line, color, style="faint"))
    title = f"{_name(axis)}: Allan deviation by temperature"
    return Figure(title, "averaging time [s]", f"Allan deviation [{unit.name}]", tuple(curves))


def by_temperature(result: Result, sensor: str, axes: Sequence[str], letter: str, name: str) -> Figure:
    """Return a coefficient by temperature: estimates with intervals, limits, and the function."""
    curves: list[Curve] = []
    unit = coefficient_units(axes[0], letter)[1]
    limited = False
    for axis in axes:
        points, color = result.axes[axis].by_temperature, AXIS_COLORS[axis[-1]]
        pairs = [(p.temperature + _aside(result, axis), p.coefficients[letter]) for p in points]
        curves.append(_points(_name(axis), [p for p in pairs if p[1].value is not None], unit, color))
        law = result.axes[axis].functions[letter]
        curves.append(Curve("", law.temperature, law.value / unit.factor, color, style="fit"))
        limits = [(t, unit.from_si(c.upper)) for t, c in pairs if c.value is None and np.isfinite(c.upper)]
        if limits:
            t, upper = (np.array(column) for column in zip(*limits, strict=True))
            dim = (round(DIM * color[0]), round(DIM * color[1]), round(DIM * color[2]))
            label = "" if limited else "dark: upper limits"
            curves.append(Curve(label, t, upper, dim, np.zeros(upper.size), upper, style="points"))
            limited = True
    curves.append(Curve("function", np.empty(0), np.empty(0), AXIS_COLORS["x"], style="fit"))
    return Figure(
        f"{sensor}: {name} by temperature", CELSIUS, f"{letter} [{unit.name}]", tuple(curves), x_scale="linear",
        y_scale="linear" if letter == "N" else "log",
    )  # fmt: skip


def _name(axis: str) -> str:
    return axis.replace("_", " ")


def _aside(result: Result, axis: str) -> float:
    points = result.axes[axis].by_temperature
    return ASIDE[axis[-1]] * (points[-1].temperature - points[0].temperature)


def _points(
    label: str, pairs: Sequence[tuple[float, Coefficient | Estimate]], unit: Unit, color: Color, style: str = "points",
    offset: float = 0.0,
) -> Curve:  # fmt: skip
    """Return estimates minus an offset, in a display unit, by temperature."""
    celsius = np.array([t for t, _ in pairs])
    value, lower, upper = (
        np.array([np.nan if (v := getattr(e, end)) is None else unit.from_si(v - offset) for _, e in pairs])
        for end in ("value", "lower", "upper")
    )
    return Curve(label, celsius, value, color, lower, upper, style=style)


def first_order(result: Result, sensor: str, axes: Sequence[str]) -> Figure:
    """Return AR(1) by temperature (figures 10 and 11)."""
    curves: list[Curve] = []
    for axis in axes:
        points, color = result.axes[axis].by_temperature, AXIS_COLORS[axis[-1]]
        alpha, half = (
            np.array(column) for column in zip(*((p.ar1.alpha, 2 * p.ar1.sigma) for p in points), strict=True)
        )
        celsius = np.array([p.temperature for p in points]) + _aside(result, axis)
        curves.append(Curve(_name(axis), celsius, alpha, color, alpha - half, alpha + half, style="points"))
        if "alpha" in result.axes[axis].functions:
            law = result.axes[axis].functions["alpha"]
            curves.append(Curve("", law.temperature, law.value, color, style="fit"))
    title = f"{sensor}: AR(1) by temperature, x(n) = -alpha x(n-1) + beta0 w(n)"
    return Figure(title, CELSIUS, "alpha [1], ± 2 standard errors", tuple(curves), x_scale="linear", y_scale="linear")


def bias(result: Result, sensor: str, axes: Sequence[str]) -> Figure:
    """Return each axis's bias as its change from the reference temperature."""
    unit = coefficient_units(axes[0], "rate")[1]
    curves: list[Curve] = []
    for axis in axes:
        over, color = result.axes[axis], AXIS_COLORS[axis[-1]]
        pairs = [(p.temperature + _aside(result, axis), p.bias) for p in over.by_temperature]
        curves.append(_points(_name(axis), pairs, unit, color, offset=over.reference_bias))
        law = over.functions.get("bias")
        if law is not None and law.value.size:
            change = (law.value - over.reference_bias) / unit.factor
            curves.append(Curve("", law.temperature, change, color, style="fit"))
        if over.polynomial is not None:
            p = over.polynomial
            change = (p.value - (0.0 if axis.startswith("accel") else over.reference_bias)) / unit.factor
            curves.append(Curve("", p.temperature, change, color, style="faint"))
    if any(result.axes[axis].polynomial is not None for axis in axes):
        curves.append(Curve("polynomial of the samples", np.empty(0), np.empty(0), AXIS_COLORS["x"], style="faint"))
    return Figure(
        f"{sensor}: bias by temperature", CELSIUS, f"change from {result.reference:g} °C [{unit.name}]", tuple(curves),
        x_scale="linear", y_scale="linear",
    )  # fmt: skip


def hysteresis(result: Result, sensor: str, axes: Sequence[str]) -> Figure:
    """Return the bias with rising temperature minus that with falling temperature."""
    unit = coefficient_units(axes[0], "rate")[1]
    curves = tuple(
        _points(
            _name(axis), [(h.temperature + _aside(result, axis), h.difference) for h in result.axes[axis].hysteresis], unit,
            AXIS_COLORS[axis[-1]], "line",
        )
        for axis in axes
    )  # fmt: skip
    title, y_title = f"{sensor}: hysteresis, 0 if there is none", f"bias, rising minus falling [{unit.name}]"
    return Figure(title, CELSIUS, y_title, curves, x_scale="linear", y_scale="linear")


def study(result: Study, axis: str) -> Figure:
    """Return AR(1) by temperature in each setting (figures 14 and 15 at all temperatures)."""
    curves: list[Curve] = []
    for i, case in enumerate(c for c in result.cases if axis in c.axes):
        pairs = case.axes[axis]
        alpha, half = np.array([f.alpha for _, f in pairs]), 2 * np.array([f.sigma for _, f in pairs])
        curves.append(Curve(case.text, np.array([t for t, _ in pairs]), alpha, color_at(i), alpha - half, alpha + half))
    return Figure(
        f"{_name(axis)}: AR(1) by setting", CELSIUS, "alpha [1], ± 2 standard errors", tuple(curves), x_scale="linear",
        y_scale="linear",
    )  # fmt: skip
