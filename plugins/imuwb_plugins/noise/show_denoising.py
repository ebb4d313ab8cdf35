"""Figures and the table of wavelet denoising."""

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table, Vertical
from imuwb.colors import AXIS_COLORS, ORANGE, Color, between
from imuwb.units import UNITS
from imuwb_plugins.noise.denoising import Denoised, Denoising

_SENSORS = {
    "gyro": ("Gyroscope", "deg/h", "(deg/s)²/Hz", (np.pi / 180) ** 2),
    "accel": ("Accelerometer", "m/s²", "(m/s²)²/Hz", 1.0),
}
FARTHEST = 0.75  #: share of the way from the axis's colour to orange, for the deepest denoising


def draw(denoising: Denoising, review: Review) -> None:
    """Show Allan deviation and spectrum, with the limits of the band that denoising keeps."""
    for axis, limits in denoising.density_limits.items():
        curves = [c for c in denoising.curves if c.axis == axis]
        colors = {c.levels: _color(i, len(curves)) for i, c in enumerate(curves)}
        review.figure(_allan(axis, curves, colors))
        review.figure(_spectrum(axis, curves, colors, limits))
    rows = tuple(
        (
            c.axis, str(c.levels) if c.levels else "0 (raw)", f"{c.band:.3g} Hz" if c.levels else "all",
            f"{c.slowest:.3g} s" if c.levels else "—", f"{100 * c.share:.3g} %",
        )
        for c in denoising.curves
    )  # fmt: skip
    headings = (
        "axis",
        "levels",
        "keeps all frequencies below",
        "motion must be slower than",
        "share of the raw standard deviation",
    )
    caption = (
        "Denoising removes short-term noise and keeps long-term noise. It would also remove motion faster than the limit, so choose the "
        "levels by the motion of the vehicle."
    )
    review.table(Table("Wavelet denoising, db4, soft, SURE", headings, rows, caption))


def _allan(axis: str, curves: list[Denoised], colors: dict[int, Color]) -> Figure:
    name, unit, _, _ = _SENSORS[axis.partition("_")[0]]
    scale = 1 / UNITS[unit].factor
    lines = tuple(
        Curve(_label(c), c.averaging_time, c.allan_deviation * scale, colors[c.levels], style="curve") for c in curves
    )
    limits = tuple(
        Vertical(c.slowest, f"{c.levels} levels: {c.slowest:.3g} s", colors[c.levels]) for c in curves if c.levels
    )
    title = f"{name} z: Allan deviation before and after denoising"
    return Figure(title, "averaging time [s]", f"Allan deviation [{unit}]", lines, verticals=limits)


def _spectrum(axis: str, curves: list[Denoised], colors: dict[int, Color], limits: tuple[float, float]) -> Figure:
    name, _, unit, factor = _SENSORS[axis.partition("_")[0]]
    lines = tuple(Curve(_label(c), c.frequency, c.density / factor, colors[c.levels], style="curve") for c in curves)
    bands = tuple(
        Vertical(c.band, f"{c.levels} levels keep all below {c.band:.3g} Hz", colors[c.levels])
        for c in curves
        if c.levels
    )
    return Figure(
        f"{name} z: spectrum before and after denoising", "frequency [Hz]", f"one-sided density [{unit}]", lines,
        verticals=bands, y_limits=(limits[0] / factor, limits[1] / factor),
    )  # fmt: skip


def _label(c: Denoised) -> str:
    return f"{c.levels} levels" if c.levels else "raw"


def _color(place: int, count: int) -> Color:
    return between(AXIS_COLORS["z"], ORANGE, FARTHEST * place / max(count - 1, 1))
