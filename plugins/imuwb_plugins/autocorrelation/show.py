"""Figures and tables of the autocorrelations."""

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table
from imuwb.arrays import Integers
from imuwb.colors import AXIS_COLORS, PALE
from imuwb.identification import GaussMarkovFit
from imuwb.noise_results import SENSORS, by_sensor
from imuwb.texts import converted_text
from imuwb.units import UNITS, coefficient_units
from imuwb_plugins.autocorrelation.result import CorrelationAxis, CorrelationCurve, Result

DRAWN = 300  #: lags of a curve


def draw(result: Result, review: Review) -> None:
    """Show notes, figures and tables (Quinchia, figures 10 and 11)."""
    for note in result.notes:
        review.note(note)
    for sensor, axes in by_sensor({axis: r for axis, r in result.axes.items() if r.lag.size}).items():
        review.figure(_figure(SENSORS[sensor], axes, result.level))
    for figure in denoised_figures(result):
        review.figure(figure)
    review.table(_table(result))


def denoised_figures(result: Result) -> list[Figure]:
    """Return a figure of each sensor after denoising: it falls slowly enough to see when."""
    denoised = {axis: r.denoised for axis, r in result.axes.items() if r.denoised is not None}
    return [_denoised(SENSORS[sensor], curves, result.denoise) for sensor, curves in by_sensor(denoised).items()]


def _figure(name: str, axes: dict[str, CorrelationAxis], level: float) -> Figure:
    curves = [
        Curve(axis.replace("_", " "), r.lag[rows], r.value[rows], AXIS_COLORS[axis[-1]], style="curve")
        for axis, r in axes.items()
        for rows in (_drawn(r.lag.size),)
    ]
    first = next(iter(axes.values()))
    for sign, label in ((1.0, f"white noise, {100 * level:g} %"), (-1.0, "")):
        edge = np.full(2, sign * (first.band or 0.0))
        curves.append(Curve(label, first.lag[[1, -1]], edge, PALE, style="fit"))
    return Figure(f"{name}: autocorrelation", "lag [s]", "autocorrelation [1]", tuple(curves), y_scale="linear")


def _drawn(lags: int) -> Integers:
    """Return which lags are drawn: all short ones, and equal steps on the logarithmic axis, where thousands would hide each other."""
    return np.unique(np.geomspace(1, max(lags - 1, 1), DRAWN).astype(np.int64))


def _denoised(name: str, axes: dict[str, CorrelationCurve], levels: int) -> Figure:
    curves: list[Curve] = []
    label = "Gauss-Markov process"
    for axis, c in axes.items():
        color, rows = AXIS_COLORS[axis[-1]], _drawn(c.lag.size)
        curves.append(Curve(axis.replace("_", " "), c.lag[rows], c.value[rows], color, style="curve"))
        if c.model is not None:
            curves.append(Curve(label, c.lag[rows], c.model[rows], color, style="faint"))
            label = ""
    title = f"{name}: autocorrelation after wavelet denoising, {levels} levels"
    return Figure(title, "lag [s]", "autocorrelation [1]", tuple(curves), y_scale="linear")


def _table(result: Result) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, r in result.axes.items():
        rows.append((axis, "as recorded", *_cells(axis, r), r.verdict))
        if r.denoised is not None:
            fit = r.denoised.gauss_markov
            verdict = "first order is tenable" if fit and fit.tenable else "first order is not tenable"
            rows.append((axis, "denoised", *_cells(axis, r.denoised), verdict))
    headings = ("axis", "series", "standard deviation", "falls to 1/e at", "likeliest sigma", "likeliest Tc", "verdict")
    caption = (
        f"Sigma and Tc of the likeliest first-order Gauss-Markov process, with {100 * result.level:g} % intervals that are valid if the "
        "process is tenable. The test uses the whole spectrum, at 1 %."
    )
    return Table(f"Correlation of {result.imu}", headings, tuple(rows), caption)


def _cells(axis: str, r: CorrelationCurve) -> tuple[str, ...]:
    unit = coefficient_units(axis, "rate")[1]
    deviation = "—" if r.deviation is None else f"{unit.from_si(r.deviation):.4g} {unit.name}"
    falls = "above 1/e at all lags" if r.falls_to is None else f"{r.falls_to:.3g} s"
    return deviation, falls, *_process(axis, r.gauss_markov)


def _process(axis: str, fit: GaussMarkovFit | None) -> tuple[str, str]:
    if fit is None:
        return "—", "—"
    if fit.vague:
        return "not known", "longer than the record"
    unit = coefficient_units(axis, "rate")[1]
    return converted_text(fit.sigma, unit), converted_text(fit.Tc, UNITS["s"])
