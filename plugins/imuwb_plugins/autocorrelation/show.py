"""Figures and tables of the autocorrelations. Nothing is computed here but units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Table
from imuwb.colors import AXIS_COLORS
from imuwb.units import coefficient_units
from imuwb_plugins.autocorrelation.compute import verdict

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.identification import GaussMarkovFit
    from imuwb_plugins.autocorrelation.result import AxisResult, Result

_SENSORS = {"gyro": "Gyroscopes", "accel": "Accelerometers"}
UNKNOWN = 100.0  #: an interval of a correlation time wider than this says nothing
BAND = (200, 200, 205)


def draw(result: Result, review: Review) -> None:
    """Show the result (Quinchia, figures 10 and 11)."""
    for note in result.notes:
        review.note(note)
    for sensor, name in _SENSORS.items():
        axes = {a: r for a, r in result.axes.items() if a.startswith(sensor) and r.lag.size}
        if axes:
            review.figure(_figure(name, axes, result.level))
    after = {a: r for a, r in result.axes.items() if r.denoised is not None}
    for sensor, name in _SENSORS.items():
        axes = {a: r for a, r in after.items() if a.startswith(sensor)}
        if axes:
            review.figure(_denoised(name, axes, result))
    review.table(_table(result))


def _figure(name: str, axes: dict[str, AxisResult], level: float) -> Figure:
    curves = [
        Curve(axis.replace("_", " "), r.lag[1:], r.value[1:], AXIS_COLORS[axis[-1]], style="curve")
        for axis, r in axes.items()
    ]
    first = next(iter(axes.values()))
    for sign in (1.0, -1.0):
        edge = np.full(2, sign * (first.band or 0.0))
        label = f"white, {100 * level:g} %" if sign > 0 else ""
        curves.append(Curve(label, first.lag[[1, -1]], edge, BAND, style="fit"))
    return Figure(f"{name}: autocorrelation", "lag [s]", "autocorrelation [1]", tuple(curves), y_scale="linear")


def _denoised(name: str, axes: dict[str, AxisResult], result: Result) -> Figure:
    curves: list[Curve] = []
    named = False
    for axis, r in axes.items():
        if r.denoised is None:
            continue
        color = AXIS_COLORS[axis[-1]]
        curves.append(Curve(axis.replace("_", " "), r.denoised.lag[1:], r.denoised.value[1:], color, style="curve"))
        fitted = r.denoised.gauss_markov
        if fitted is not None:
            model = np.exp(-r.denoised.lag[1:] / fitted.Tc)
            curves.append(Curve("" if named else "Gauss-Markov", r.denoised.lag[1:], model, color, style="faint"))
            named = True
    return Figure(
        f"{name}: after wavelet denoising, {result.denoise} levels",
        "lag [s]",
        "autocorrelation [1]",
        tuple(curves),
        y_scale="linear",
    )


def _table(result: Result) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, r in result.axes.items():
        interval = result.interval[axis.partition("_")[0]]
        rows.append(
            (
                axis,
                "as it is",
                _std(axis, r.deviation),
                _lag(r.falls_to),
                *_gauss_markov(axis, r.gauss_markov),
                verdict(r, interval),
            )
        )
        if r.denoised is not None:
            d = r.denoised
            tenable = (
                "first order is tenable" if d.gauss_markov and d.gauss_markov.tenable else "first order is not tenable"
            )
            rows.append(
                (
                    axis,
                    "denoised",
                    _std(axis, d.deviation),
                    _lag(d.falls_to),
                    *_gauss_markov(axis, d.gauss_markov),
                    tenable,
                )
            )
    headings = ("axis", "series", "standard deviation", "falls to 1/e at", "likeliest sigma", "likeliest Tc", "verdict")
    caption = (
        f"Sigma and Tc of the likeliest first-order Gauss-Markov process, with {100 * result.level:g} % intervals that hold if the verdict is "
        "tenable; it is tested on the whole spectrum at 1 %."
    )
    return Table(f"Correlation of {result.imu}", headings, tuple(rows), caption)


def _std(axis: str, value: float | None) -> str:
    unit = coefficient_units(axis, "rate")[1]
    return "—" if value is None else f"{unit.from_si(value):.4g} {unit.name}"


def _lag(value: float | None) -> str:
    return "beyond the lags shown" if value is None else f"{value:.3g} s"


def _gauss_markov(axis: str, fitted: GaussMarkovFit | None) -> tuple[str, str]:
    if fitted is None:
        return "—", "—"
    if fitted.Tc_interval[1] > UNKNOWN * fitted.Tc_interval[0]:
        return "not known", "longer than the record"
    unit = coefficient_units(axis, "rate")[1]
    sigma, low, high = (unit.from_si(x) for x in (fitted.sigma, *fitted.sigma_interval))
    return (
        f"{sigma:.3g} [{low:.3g}, {high:.3g}] {unit.name}",
        f"{fitted.Tc:.3g} [{fitted.Tc_interval[0]:.3g}, {fitted.Tc_interval[1]:.3g}] s",
    )
