"""What wavelet denoising takes away: Allan deviation and spectrum before and after, by levels (Quinchia, 5.6 and figure 17)."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Table, Vertical
from imuwb.axes import axes_of, rates
from imuwb.colors import AXIS_COLORS
from imuwb.conditioning import band_limit, denoise
from imuwb.identification import allan, power_spectrum
from imuwb.identification.record.suitable import unsuitable
from imuwb.units import UNITS

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.log import Floats, Log

SHALLOW = 3  #: levels of the second curve, as in Quinchia's figure 17
SHOWN = ("gyro_z", "accel_z")
FEWEST = 4096  #: samples
SEGMENT = 1 << 16
_UNITS = {
    "gyro": ("Gyroscope", "deg/h", "(deg/s)²/Hz", (np.pi / 180) ** 2),
    "accel": ("Accelerometer", "m/s²", "(m/s²)²/Hz", 1.0),
}


@dataclass(frozen=True, eq=False, slots=True)
class Denoised:
    """One axis at one number of levels; 0 is the raw one. SI."""

    axis: str
    levels: int
    band: float  #: Hz, below which everything is kept
    averaging_time: Floats  #: s
    allan_deviation: Floats
    frequency: Floats  #: Hz
    density: Floats  #: one-sided
    deviation: float  #: standard deviation


@dataclass(frozen=True, eq=False, slots=True)
class Denoising:
    """Axes before and after."""

    rate_hz: dict[str, float]
    curves: tuple[Denoised, ...]


def denoising(log: Log, levels: int) -> Denoising | None:
    """Return the z axes before and after denoising; None where the log is too short for it."""
    axes = {name: axis for name, axis in axes_of(log.imu()).items() if name in SHOWN}
    axes = {name: axis for name, axis in axes.items() if unsuitable(axis.longest, FEWEST) is None}
    wanted = [(name, k) for name in axes for k in sorted({0, min(SHALLOW, levels), levels})]

    def one(job: tuple[str, int]) -> Denoised | None:
        axis, k = job
        values, dt = axes[axis].longest, axes[axis].clock.interval
        try:
            quiet = denoise(values, k).values
        except ValueError:
            return None
        curve, spectrum = allan(quiet, dt, "log:40", fast=True), power_spectrum(quiet, dt, SEGMENT)
        return Denoised(
            axis,
            k,
            band_limit(1 / dt, k),
            curve.averaging_time,
            curve.deviation,
            spectrum.frequency,
            spectrum.density,
            float(quiet.std()),
        )

    with ThreadPoolExecutor(2) as pool:
        curves = tuple(c for c in pool.map(one, wanted) if c is not None)
    return Denoising(rates(axes), curves) if curves else None


def draw(found: Denoising, review: Review) -> None:
    """Show both, with the limits of the band that is kept."""
    for axis in dict.fromkeys(c.axis for c in found.curves):
        curves = [c for c in found.curves if c.axis == axis]
        sensor = axis.partition("_")[0]
        name, unit, density_unit, factor = _UNITS[sensor]
        rate, scale = found.rate_hz[sensor], 1 / UNITS[unit].factor
        color = AXIS_COLORS["z"]
        shades = {c.levels: _shade(color, i, len(curves)) for i, c in enumerate(curves)}
        limits = tuple(
            Vertical(
                2.0 ** (c.levels + 1) / rate,
                f"{c.levels} levels: {2.0 ** (c.levels + 1) / rate:.3g} s",
                shades[c.levels],
            )
            for c in curves
            if c.levels
        )
        review.figure(Figure(
            f"{name} z: Allan deviation before and after denoising", "averaging time [s]", f"Allan deviation [{unit}]",
            tuple(Curve(_label(c), c.averaging_time, c.allan_deviation * scale, shades[c.levels], style="curve") for c in curves),
            verticals=limits,
        ))  # fmt: skip
        bands = tuple(
            Vertical(c.band, f"{c.levels} levels keep all below {c.band:.3g} Hz", shades[c.levels])
            for c in curves
            if c.levels
        )
        review.figure(Figure(
            f"{name} z: spectrum before and after denoising", "frequency [Hz]", f"one-sided density [{density_unit}]",
            tuple(Curve(_label(c), c.frequency, c.density / factor, shades[c.levels], style="curve") for c in curves), verticals=bands,
            y_limits=_limits([c.density / factor for c in curves]),
        ))  # fmt: skip
    rows = tuple(
        (c.axis, str(c.levels) if c.levels else "0 (raw)", f"{c.band:.3g} Hz" if c.levels else "all", f"{2.0 ** (c.levels + 1) / found.rate_hz[c.axis.partition('_')[0]]:.3g} s" if c.levels else "—",
         f"{100 * c.deviation / next(r.deviation for r in found.curves if r.axis == c.axis):.3g} %")
        for c in found.curves
    )  # fmt: skip
    review.table(Table(
        "Wavelet denoising, db4, soft, SURE", ("axis", "levels", "keeps all below", "motion must be slower than", "of the raw standard deviation"), rows,
        "Short-term noise goes, long-term noise stays. Motion faster than the limit would be taken for noise: choose the levels by how the vehicle moves.",
    ))  # fmt: skip


def _limits(densities: list[Floats]) -> tuple[float, float]:
    """Return limits that hold the raw density, and six decades below its lowest: what denoising leaves is as good as nothing."""
    raw = densities[0][densities[0] > 0]
    low = max(min(float(d[d > 0].min()) for d in densities if (d > 0).any()), float(raw.min()) * 1e-6)
    return low / 2, float(raw.max()) * 2


def _label(c: Denoised) -> str:
    return f"{c.levels} levels" if c.levels else "raw"


def _shade(color: tuple[int, int, int], i: int, count: int) -> tuple[int, int, int]:
    light = 1 - 0.75 * i / max(count - 1, 1)
    ends = (242, 142, 43)
    r, g, b = (round(light * c + (1 - light) * e) for c, e in zip(color, ends, strict=True))
    return r, g, b
