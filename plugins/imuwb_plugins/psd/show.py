"""Figures and tables of the spectra."""

import numpy as np

from imuwb.analysis import Curve, Figure, LineResult, Review, Table, Vertical
from imuwb.colors import AXIS_COLORS
from imuwb.statistics import Estimate
from imuwb.texts import coefficient_text, converted_text
from imuwb.units import coefficient_units
from imuwb_plugins.psd.result import Result, SpectrumAxis

_SENSORS = {"gyro": ("Gyroscopes", "(deg/s)²/Hz", (np.pi / 180) ** 2), "accel": ("Accelerometers", "(m/s²)²/Hz", 1.0)}
SAME = 0.02  #: relative difference of the frequencies of one line in several axes
LABELLED = 4  #: lines that the figure marks, the strongest


def draw(result: Result, review: Review) -> None:
    """Show notes, figures and tables."""
    for note in result.notes:
        review.note(note)
    for sensor in _SENSORS:
        axes = {axis: r for axis, r in result.axes.items() if axis.startswith(sensor) and r.frequency.size}
        if axes:
            review.figure(_figure(sensor, axes, result))
    review.table(_coefficients(result))
    review.table(_slopes(result))
    if any(r.lines for r in result.axes.values()):
        review.table(_lines(result))


def _figure(sensor: str, axes: dict[str, SpectrumAxis], result: Result) -> Figure:
    name, unit, factor = _SENSORS[sensor]
    curves: list[Curve] = []
    for axis, r in axes.items():
        curves += _curves(axis, r, factor, labelled=not any(curve.style == "faint" for curve in curves))
    lines = sorted((line for r in axes.values() for line in r.lines), key=lambda line: -line.amplitude)
    verticals = tuple(Vertical(line.frequency, line.name) for line in _distinct(lines)[:LABELLED])
    return Figure(
        f"{name}: power spectral density", "frequency [Hz]",
        f"one-sided density [{unit}], segments of {result.segment[sensor]} samples", tuple(curves), verticals=verticals,
    )  # fmt: skip


def _curves(axis: str, r: SpectrumAxis, factor: float, *, labelled: bool) -> list[Curve]:
    """Return the curves of an axis; the first fitted sum and its terms are labelled in the legend."""
    color = AXIS_COLORS[axis[-1]]
    curves = [Curve(axis.replace("_", " "), r.frequency, r.density / factor, color, style="curve")]
    model = r.model_densities
    if model is None:
        return curves
    curves.append(Curve("fitted sum" if labelled else "", model.frequency, model.total / factor, color, style="fit"))
    for i, term in enumerate(model.terms):
        label = "its terms" if labelled and i == 0 else ""
        curves.append(Curve(label, model.frequency, term / factor, color, style="faint"))
    return curves


def _distinct(lines: list[LineResult]) -> list[LineResult]:
    kept: list[LineResult] = []
    for line in lines:
        if all(abs(line.frequency / other.frequency - 1) > SAME for other in kept):
            kept.append(line)
    return kept


def _coefficients(result: Result) -> Table:
    rows = tuple(
        (
            axis, *(coefficient_text(r.coefficients[x], coefficient_units(axis, x)[1]) for x in "QNBK"),
            "—" if r.explained_to is None else f"{r.explained_to:.3g} Hz",
            "all frequencies" if r.white_to is None else f"{r.white_to:.3g} Hz ({10 * np.log10(r.excess):+.1f} dB above it)",
        )
        for axis, r in result.axes.items()
    )  # fmt: skip
    headings = (
        "axis", "Q quantization", "N random walk", "B bias instability", "K rate random walk", "fit uses up to", "fit explains up to"
    )  # fmt: skip
    caption = (
        f"Value [{100 * result.level:g} % interval]; < is an upper limit. All come from one fit of 2 (N² + B²/2πf + K²/(2πf)² + Q² ...) to "
        "the one-sided density: N has slope 0, B slope -1, K slope -2."
    )
    return Table(f"Noise coefficients of {result.imu} by power spectral density", headings, rows, caption)


def _slopes(result: Result) -> Table:
    rows = tuple(
        (
            axis, region.letter, f"{region.start:.3g} to {region.end:.3g} Hz",
            f"{region.slope.value:+.3f} [{region.slope.lower:+.3f}, {region.slope.upper:+.3f}]", f"{region.nominal:+.0f}",
            f"{region.departure:+.3f}" + ("" if region.nominal in region.slope else " (differs)"),
        )
        for axis, r in result.axes.items()
        for region in r.regions
    )  # fmt: skip
    headings = ("axis", "term", "dominates from", "free slope [1]", "nominal slope [1]", "difference [1]")
    caption = (
        "The slope of a free line over the frequencies where one term makes more than 60 % of the density, with its "
        f"{100 * result.level:g} % interval."
    )
    return Table("Slopes by band", headings, rows, caption)


def _lines(result: Result) -> Table:
    rows = tuple(
        (
            axis, f"{line.frequency:.4g} Hz", line.name,
            converted_text(Estimate(line.amplitude, line.lower, line.upper), coefficient_units(axis, "rate")[1]),
        )
        for axis, r in result.axes.items()
        for line in r.lines
    )  # fmt: skip
    caption = f"Sinusoids above the local noise floor; amplitude [{100 * result.level:g} % interval]."
    return Table("Periodic lines", ("axis", "frequency", "name", "amplitude"), rows, caption)
