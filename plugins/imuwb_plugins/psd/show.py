"""Figures and tables of the spectra. Nothing is computed here but units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Table, Vertical
from imuwb.colors import AXIS_COLORS
from imuwb.texts import coefficient_text
from imuwb.units import coefficient_units

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb_plugins.psd.result import AxisResult, LineResult, Result

_FIGURES = {"gyro": ("Gyroscopes", "(deg/s)²/Hz", (np.pi / 180) ** 2), "accel": ("Accelerometers", "(m/s²)²/Hz", 1.0)}
SAME = 0.02  #: relative difference of frequencies of one line in several axes
LABELLED = 4  #: lines that get a dashed line, the strongest


def draw(result: Result, review: Review) -> None:
    """Show the result, what a reader must know first."""
    for note in result.notes:
        review.note(note)
    for sensor, (name, unit, factor) in _FIGURES.items():
        axes = {a: r for a, r in result.axes.items() if a.startswith(sensor) and r.frequency.size}
        if axes:
            review.figure(_figure(name, unit, factor, axes, 1 / result.rate_hz[sensor], result))
    review.table(_coefficients(result))
    review.table(_slopes(result))
    if any(found.lines for found in result.axes.values()):
        review.table(_lines(result))


def _figure(name: str, unit: str, factor: float, axes: dict[str, AxisResult], dt: float, result: Result) -> Figure:
    curves: list[Curve] = []
    named = False
    for axis, found in axes.items():
        color = AXIS_COLORS[axis[-1]]
        curves.append(Curve(axis.replace("_", " "), found.frequency, found.density / factor, color, style="curve"))
        if found.processes is None:
            continue
        smooth = np.geomspace(found.frequency[0], found.explained_to or found.frequency[-1], 200)
        whole = 2 * found.processes.power_spectral_density(smooth, dt)
        curves.append(Curve("" if named else "fitted sum", smooth, whole / factor, color, style="fit"))
        for term in found.processes.terms:
            part = 2 * term.power_spectral_density(smooth, dt)
            curves.append(Curve("" if named else "its terms", smooth, part / factor, color, style="faint"))
            named = True
    lines = sorted((line for found in axes.values() for line in found.lines), key=lambda line: -line.amplitude)
    verticals = tuple(Vertical(line.frequency, line.name) for line in _distinct(lines)[:LABELLED])
    sensor = next(iter(axes)).partition("_")[0]
    return Figure(
        f"{name}: power spectral density", "frequency [Hz]",
        f"one-sided density [{unit}], segments of {result.segment[sensor]} samples", tuple(curves), verticals=verticals,
    )  # fmt: skip


def _distinct(lines: list[LineResult]) -> list[LineResult]:
    kept: list[LineResult] = []
    for line in lines:
        if all(abs(line.frequency / other.frequency - 1) > SAME for other in kept):
            kept.append(line)
    return kept


def _coefficients(result: Result) -> Table:
    rows = tuple(
        (
            axis, *(coefficient_text(found.coefficients[x], coefficient_units(axis, x)[1]) for x in "QNBK"),
            "—" if found.explained_to is None else f"{found.explained_to:.3g} Hz",
            "everywhere" if found.white_to is None else f"{found.white_to:.3g} Hz ({10 * np.log10(found.excess):+.1f} dB beyond)",
        )
        for axis, found in result.axes.items()
    )  # fmt: skip
    headings = (
        "axis",
        "Q quantization",
        "N random walk",
        "B bias instability",
        "K rate random walk",
        "fitted up to",
        "as fitted up to",
    )
    caption = (
        f"Value [{100 * result.level:g} % interval]; < is an upper limit. Read from one fit of 2 (N² + B²/2πf + K²/(2πf)² + Q² ...) to the one-sided "
        "density: N at slope 0, B at -1, K at -2."
    )
    return Table(f"Noise coefficients of {result.imu} by power spectral density", headings, rows, caption)


def _slopes(result: Result) -> Table:
    rows = tuple(
        (
            axis, region.letter, f"{region.start:.3g} to {region.end:.3g} Hz",
            f"{region.slope:+.3f} [{region.lower:+.3f}, {region.upper:+.3f}]", f"{region.nominal:+.0f}",
            f"{region.slope - region.nominal:+.3f}" + ("" if region.lower <= region.nominal <= region.upper else " (differs)"),
        )
        for axis, found in result.axes.items()
        for region in found.regions
    )  # fmt: skip
    headings = ("axis", "term", "rules from", "free slope", "nominal", "deviation")
    return Table(
        "Slopes by band", headings, rows, "The slope of a free line where one term makes more than 60 % of the density."
    )


def _lines(result: Result) -> Table:
    rows = tuple(
        (axis, f"{line.frequency:.4g} Hz", line.name, _amplitude(axis, line.amplitude, line.lower, line.upper))
        for axis, found in result.axes.items()
        for line in found.lines
    )
    return Table(
        "Periodic lines", ("axis", "frequency", "name", "amplitude"), rows, "Sinusoids that rise above the local floor."
    )


def _amplitude(axis: str, value: float, lower: float, upper: float) -> str:
    unit = coefficient_units(axis, "rate")[1]
    value, lower, upper = (unit.from_si(x) for x in (value, lower, upper))
    return f"{value:.3g} [{lower:.3g}, {upper:.3g}] {unit.name}"
