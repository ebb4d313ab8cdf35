"""Figures of noise over temperature."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure
from imuwb.colors import AXIS_COLORS
from imuwb.units import coefficient_units

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.log import Floats
    from imuwb.statistics import Coefficient
    from imuwb.units import Unit
    from imuwb_plugins.temperature.result import Result, Study

CELSIUS = "temperature [°C]"
#: from cold to hot
COLORS = np.array(
    [(64, 108, 210), (72, 176, 198), (118, 190, 92), (236, 196, 74), (236, 132, 50), (222, 64, 60)], float
)
NAMED = 6  #: temperatures in a legend at most
ASIDE = {
    "x": -0.005,
    "y": 0.0,
    "z": 0.005,
}  #: of the span of temperatures, so that the axes' intervals stand side by side
DEVIATION = {"gyro": ("deg/h", np.pi / 180 / 3600), "accel": ("m/s²", 1.0)}
DIM = 0.6  #: of a colour, for limits
SETTING_COLORS = ((76, 120, 168), (242, 142, 43), (84, 162, 75), (228, 87, 86), (176, 122, 161), (118, 183, 178))


def color_of(share: float) -> tuple[int, int, int]:
    """Return the colour of a temperature, 0 the coldest, 1 the hottest."""
    at = np.linspace(0, 1, len(COLORS))
    red, green, blue = (round(float(np.interp(share, at, channel))) for channel in COLORS.T)
    return red, green, blue


def allan(result: Result, axis: str) -> Figure:
    """Return an axis's Allan curves by temperature, and the line of slope -1/2 that each one's N is (figures 4 to 7)."""
    points = result.axes[axis].by_temperature
    unit, factor = DEVIATION[axis.partition("_")[0]]
    named = set(np.linspace(0, len(points) - 1, min(NAMED, len(points))).round().astype(int).tolist())
    curves: list[Curve] = []
    for i, p in enumerate(points):
        color = color_of(i / max(len(points) - 1, 1))
        label = f"{p.temperature:.0f} °C" if i in named else ""
        curves.append(Curve(label, p.averaging_time, p.allan_deviation / factor, color, style="curve"))
        white = p.coefficients["N"].value
        if white is not None:
            line = white / np.sqrt(p.averaging_time) / factor
            curves.append(Curve("N, slope -1/2" if i == 0 else "", p.averaging_time, line, color, style="faint"))
    name = axis.replace("_", " ")
    return Figure(
        f"{name}: Allan deviation by temperature", "averaging time [s]", f"Allan deviation [{unit}]", tuple(curves)
    )


def by_temperature(result: Result, sensor: str, axes: Sequence[str], letter: str, name: str) -> Figure:
    """Return a coefficient against temperature: estimates with intervals, limits, and the function that was chosen."""
    curves: list[Curve] = []
    unit = coefficient_units(axes[0], letter)[1]
    limited = False
    for axis in axes:
        found, color = result.axes[axis], AXIS_COLORS[axis[-1]]
        aside = _aside(result, axis)
        pairs = [(p.temperature + aside, p.coefficients[letter]) for p in found.by_temperature]
        curves.append(_estimates(axis.replace("_", " "), [p for p in pairs if p[1].value is not None], unit, color))
        law = found.functions[letter]
        curves.append(Curve("", law.temperature, law.value / unit.factor, color, style="fit"))
        limits = [(t, c.upper) for t, c in pairs if c.value is None and np.isfinite(c.upper)]
        if limits:
            t, upper = (np.array(column) for column in zip(*limits, strict=True))
            dim = (round(DIM * color[0]), round(DIM * color[1]), round(DIM * color[2]))
            upper = upper / unit.factor
            label = "" if limited else "dark: upper limits"
            curves.append(Curve(label, t, upper, dim, np.zeros(upper.size), upper, style="points"))
            limited = True
    curves.append(Curve("function chosen", np.empty(0), np.empty(0), AXIS_COLORS["x"], style="fit"))
    return Figure(
        f"{sensor}: {name} by temperature", CELSIUS, f"{letter} [{unit.name}]", tuple(curves), x_scale="linear",
        y_scale="linear" if letter == "N" else "log",
    )  # fmt: skip


def _aside(result: Result, axis: str) -> float:
    points = result.axes[axis].by_temperature
    return ASIDE[axis[-1]] * (points[-1].temperature - points[0].temperature)


def _estimates(
    label: str, pairs: Sequence[tuple[float, Coefficient]], unit: Unit, color: tuple[int, int, int]
) -> Curve:
    def column(name: str) -> Floats:
        return np.array([np.nan if (v := getattr(c, name)) is None else unit.from_si(v) for _, c in pairs])

    celsius = np.array([t for t, _ in pairs])
    return Curve(label, celsius, column("value"), color, column("lower"), column("upper"), style="points")


def first_order(result: Result, sensor: str, axes: Sequence[str]) -> Figure:
    """Return AR(1) against temperature (figures 10 and 11)."""
    curves: list[Curve] = []
    for axis in axes:
        found, color = result.axes[axis], AXIS_COLORS[axis[-1]]
        ar1 = [p.ar1 for p in found.by_temperature]
        alpha, half = np.array([a.alpha for a in ar1]), 2 * np.array([a.sigma for a in ar1])
        celsius = np.array([p.temperature for p in found.by_temperature]) + _aside(result, axis)
        curves.append(Curve(axis.replace("_", " "), celsius, alpha, color, alpha - half, alpha + half, style="points"))
        if "alpha" in found.functions:
            law = found.functions["alpha"]
            curves.append(Curve("", law.temperature, law.value, color, style="fit"))
    title = f"{sensor}: AR(1) by temperature, x(n) = -alpha x(n-1) + beta0 w(n)"
    return Figure(title, CELSIUS, "alpha [1], ± 2 standard errors", tuple(curves), x_scale="linear", y_scale="linear")


def bias(result: Result, sensor: str, axes: Sequence[str]) -> Figure:
    """Return each axis's bias as its change from the reference temperature."""
    unit = coefficient_units(axes[0], "rate")[1]
    curves: list[Curve] = []
    for axis in axes:
        found, color = result.axes[axis], AXIS_COLORS[axis[-1]]
        law = found.functions.get("bias")
        offset = (
            0.0 if law is None or not law.value.size else float(np.interp(result.reference, law.temperature, law.value))
        )
        celsius = np.array([p.temperature for p in found.by_temperature]) + _aside(result, axis)
        value, lower, upper = (
            (np.array([getattr(p.bias, end) for p in found.by_temperature]) - offset) / unit.factor
            for end in ("value", "lower", "upper")
        )
        curves.append(Curve(axis.replace("_", " "), celsius, value, color, lower, upper, style="points"))
        if law is not None and law.value.size:
            curves.append(Curve("", law.temperature, (law.value - offset) / unit.factor, color, style="fit"))
    return Figure(
        f"{sensor}: bias by temperature", CELSIUS, f"change from {result.reference:g} °C [{unit.name}]", tuple(curves),
        x_scale="linear", y_scale="linear",
    )  # fmt: skip


def hysteresis(result: Result, sensor: str, axes: Sequence[str]) -> Figure:
    """Return the bias after a rise less that after a fall."""
    unit = coefficient_units(axes[0], "rate")[1]
    curves: list[Curve] = []
    for axis in axes:
        loop = result.axes[axis].hysteresis
        celsius = np.array([h.temperature for h in loop]) + _aside(result, axis)
        value, lower, upper = (
            np.array([unit.from_si(getattr(h, end)) for h in loop]) for end in ("value", "lower", "upper")
        )
        curves.append(Curve(axis.replace("_", " "), celsius, value, AXIS_COLORS[axis[-1]], lower, upper, style="line"))
    title = f"{sensor}: hysteresis, 0 where there is none"
    return Figure(
        title, CELSIUS, f"bias, rising less falling [{unit.name}]", tuple(curves), x_scale="linear", y_scale="linear"
    )


def study(found: Study, axis: str) -> Figure:
    """Return AR(1) against temperature in each setting (figures 14 and 15 at all temperatures)."""
    curves: list[Curve] = []
    for i, case in enumerate(c for c in found.cases if axis in c.axes):
        pairs = case.axes[axis]
        alpha, half = np.array([f.alpha for _, f in pairs]), 2 * np.array([f.sigma for _, f in pairs])
        label = ", ".join(f"{key} {value}" for key, value in case.settings.items())
        color = SETTING_COLORS[i % len(SETTING_COLORS)]
        curves.append(Curve(label, np.array([t for t, _ in pairs]), alpha, color, alpha - half, alpha + half))
    name = axis.replace("_", " ")
    return Figure(
        f"{name}: AR(1) by setting",
        CELSIUS,
        "alpha [1], ± 2 standard errors",
        tuple(curves),
        x_scale="linear",
        y_scale="linear",
    )
