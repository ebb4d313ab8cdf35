"""The effect of wavelet denoising: Allan deviation and spectrum before and after (Quinchia, 5.6 and figure 17)."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

from imuwb.arrays import Floats, alone, standard_deviation
from imuwb.axes import Axis, axes_of, rates
from imuwb.conditioning import band_limit, denoise
from imuwb.identification import allan, power_spectrum
from imuwb.identification.record.suitable import unsuitable
from imuwb.log import Log

SHALLOW = 3  #: levels of the second curve, as in Quinchia's figure 17
FEWEST = 4096  #: samples
SEGMENT = 1 << 16
DEEPEST = 1e-6  #: share of the lowest raw density; a lower density is outside the figure


@dataclass(frozen=True, eq=False, slots=True)
class Denoised:
    """One axis after a number of levels of denoising. SI."""

    axis: str
    levels: int  #: 0: the raw axis
    band: float  #: Hz, below which denoising changes nothing
    slowest: float  #: s; motion must be slower than this
    averaging_time: Floats  #: s
    allan_deviation: Floats
    frequency: Floats  #: Hz
    density: Floats  #: one-sided
    deviation: float  #: standard deviation
    share: float = 1.0  #: ratio to the raw axis's standard deviation


@dataclass(frozen=True, eq=False, slots=True)
class Denoising:
    """The last axis of each sensor before and after denoising."""

    rate_hz: dict[str, float]
    curves: tuple[Denoised, ...]
    density_limits: dict[str, tuple[float, float]] = field(metadata={"document": False})  #: by axis, of its figure


def denoising(log: Log, levels: int) -> Denoising | None:
    """Return the last axis of each sensor, z if it has three, before and after denoising; None if the log is too short."""
    axes = {axis.sensor: axis for axis in axes_of(log.imu()).values()}
    axes = {axis.name: axis for axis in axes.values()}
    axes = {name: x for name, x in axes.items() if unsuitable(x.values[x.longest_rows], FEWEST) is None}
    depths = sorted({0, min(SHALLOW, levels), levels})
    jobs = [(axis, k) for axis in axes.values() for k in depths]
    with ThreadPoolExecutor(2) as pool:
        curves = [curve for curve in pool.map(_denoised, *zip(*jobs, strict=True)) if curve is not None] if jobs else []
    if not curves:
        return None
    raw = {c.axis: c.deviation for c in curves if not c.levels}
    shares = tuple(replace(c, share=c.deviation / raw[c.axis]) for c in curves)
    return Denoising(rates(axes), shares, _density_limits(axes, shares))


def _denoised(axis: Axis, levels: int) -> Denoised | None:
    dt, series = axis.clock.interval, axis.values[axis.longest_rows]
    with alone(series.size):
        try:
            quiet = denoise(series, levels).values
        except ValueError:  # too short for so many levels
            return None
        curve, spectrum = allan(quiet, dt, "log:40", fast=True), power_spectrum(quiet, dt, SEGMENT)
        return Denoised(
            axis.name, levels, band_limit(1 / dt, levels), 2.0 ** (levels + 1) * dt, curve.averaging_time, curve.deviation,
            spectrum.frequency, spectrum.density, standard_deviation(quiet),
        )  # fmt: skip


def _density_limits(axes: Mapping[str, Axis], curves: Sequence[Denoised]) -> dict[str, tuple[float, float]]:
    """Return limits that contain the raw density and six decades below: denoising can remove almost everything."""
    limits: dict[str, tuple[float, float]] = {}
    for axis in axes:
        raw, *others = (c.density[c.density > 0] for c in curves if c.axis == axis)
        least = min(float(d.min()) for d in (raw, *others) if d.size)
        limits[axis] = max(least, float(raw.min()) * DEEPEST) / 2, float(raw.max()) * 2
    return limits
