"""Figures and tables of the spectra."""

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table, Vertical
from imuwb.colors import AXIS_COLORS
from imuwb.noise_results import SENSORS, LineResult, by_sensor, line_table, slope_table, with_models
from imuwb.texts import coefficient_text
from imuwb.units import coefficient_units
from imuwb_plugins.psd.result import Result, SpectrumAxis

_UNITS = {"gyro": ("(deg/s)²/Hz", (np.pi / 180) ** 2), "accel": ("(m/s²)²/Hz", 1.0)}
SAME = 0.02  #: relative difference of the frequencies of one line in several axes
LABELLED = 4  #: lines that the figure marks, the strongest


def draw(result: Result, review: Review) -> None:
    """Show notes, figures and tables."""
    for note in result.notes:
        review.note(note)
    for sensor, axes in by_sensor({axis: r for axis, r in result.axes.items() if r.frequency.size}).items():
        review.figure(_figure(sensor, axes, result))
        if any(r.raw is not None for r in axes.values()):
            review.figure(_raw(sensor, axes, result))
    review.table(_coefficients(result))
    level = f"{100 * result.level:g} % interval"
    caption = f"The slope of a free line over the frequencies where one term makes more than 60 % of the density, with its {level}."
    review.table(slope_table("Slopes by band", {axis: r.regions for axis, r in result.axes.items()}, "Hz", caption))
    lines = {axis: r.lines for axis, r in result.axes.items() if r.lines}
    if lines:
        review.table(line_table(lines, f"Sinusoids above the local noise floor; amplitude [{level}]."))


def _figure(sensor: str, axes: dict[str, SpectrumAxis], result: Result) -> Figure:
    unit, factor = _UNITS[sensor]
    curves = with_models(
        (
            (
                Curve(axis.replace("_", " "), r.frequency, r.density / factor, AXIS_COLORS[axis[-1]], style="curve"),
                r.model_densities,
            )
            for axis, r in axes.items()
        ),
        factor,
    )
    lines = sorted((line for r in axes.values() for line in r.lines), key=lambda line: -line.amplitude.value)
    verticals = tuple(Vertical(line.frequency, line.name) for line in _distinct(lines)[:LABELLED])
    return Figure(
        f"{SENSORS[sensor]}: power spectral density", "frequency [Hz]",
        f"one-sided density [{unit}], segments of {result.segment[sensor]} samples", curves, verticals=verticals,
    )  # fmt: skip


def _raw(sensor: str, axes: dict[str, SpectrumAxis], result: Result) -> Figure:
    unit, factor = _UNITS[sensor]
    curves = tuple(
        Curve(axis.replace("_", " "), r.raw[0], r.raw[1] / factor, AXIS_COLORS[axis[-1]], style="curve")
        for axis, r in axes.items()
        if r.raw is not None
    )
    return Figure(
        f"{SENSORS[sensor]}: power spectral density before frequency averaging", "frequency [Hz]",
        f"one-sided density [{unit}], segments of {result.segment[sensor]} samples", curves,
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
