"""Denoises the axes of a log."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Table
from imuwb.conditioning import (
    Change,
    band_limit,
    condition_streams,
    denoise,
    denoise_causally,
    level_of_band,
    measured_band,
)
from imuwb.log import AXES, Conditioning
from imuwb.units import coefficient_units

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.log import Floats, Log
    from imuwb_plugins.wavelet.parameters import Parameters

QUIETEST = 0.02  #: share of a record's seconds whose scatter is taken for the sensor's own


@dataclass(frozen=True, slots=True)
class AxisChoice:
    """What an axis was denoised with."""

    level: int
    band: float  #: Hz, below which everything is kept
    thresholds: tuple[float, ...]  #: SI, finest level first; of the longest part


@dataclass(frozen=True, slots=True)
class Applied:
    """What the first IMU was denoised with."""

    wavelet: str
    rule: str
    causal: bool
    axes: dict[str, AxisChoice]


def condition(log: Log, parameters: Parameters) -> tuple[Log, Applied]:
    """Return the log with its IMUs denoised, and how."""
    chosen: dict[str, AxisChoice] = {}
    late = [0.0]
    triads = {f"{sensor}_{axis}": (sensor, k) for sensor in ("gyro", "accel") for k, axis in enumerate("xyz")}

    def design(sensor: str, rate: float) -> Change:
        if parameters.causal:
            late.append((parameters.hop - 1) / rate)

        def apply(values: Floats) -> Floats:
            return np.stack([axis(values[:, k], f"{sensor}_{'xyz'[k]}", rate) for k in range(3)], axis=1)

        return Change(apply, 16)

    def axis(values: Floats, name: str, rate: float) -> Floats:
        level = _level(values, rate, parameters, list(triads).index(name))
        series = np.ascontiguousarray(values)
        if parameters.causal:
            done = denoise_causally(
                series, level, parameters.wavelet, parameters.threshold, parameters.shrinkage, parameters.hop
            )
        else:
            done = denoise(series, level, parameters.wavelet, parameters.threshold, parameters.shrinkage)
        chosen.setdefault(name, AxisChoice(level, band_limit(rate, level), done.thresholds))
        return done.values

    text = (
        f"levels={parameters.levels},motion_band={parameters.motion_band},wavelet={parameters.wavelet},"
        f"threshold={parameters.threshold},shrinkage={parameters.shrinkage},causal={parameters.causal}"
    ).lower()
    changed = condition_streams(log, design)
    levels = ", ".join(f"{name} {chosen[name].level}" for name in AXES if name in chosen)
    note = f"levels: {levels}"
    if not any(choice.level for choice in chosen.values()):
        note += ": nothing is taken away, for motion, or noise that looks like it, fills the band; give levels, or motion_band in Hz"
    band = min((choice.band for choice in chosen.values() if choice.level), default=None)
    made = Conditioning("wavelet", text, parameters.causal, max(late), note, band)
    return replace(changed, conditioning=(*log.conditioning, made)), Applied(
        parameters.wavelet, f"{parameters.shrinkage}, {parameters.threshold}", parameters.causal, chosen
    )


def _level(values: Floats, rate: float, parameters: Parameters, place: int) -> int:
    if parameters.levels != "auto":
        parts = parameters.levels.split("/")
        return int(parts[place if len(parts) > 1 else 0])
    if parameters.motion_band != "measured":
        return level_of_band(rate, float(parameters.motion_band))
    block = max(round(rate), 8)
    blocks = values[: values.size // block * block].reshape(-1, block)
    quiet = float(np.quantile(blocks.std(axis=1), QUIETEST))
    return level_of_band(rate, measured_band(values, rate, quiet / rate**0.5))


def draw(found: Applied, review: Review) -> None:
    """Show levels, band limits and thresholds (Quinchia, table 7)."""
    rows: list[tuple[str, ...]] = []
    for name, choice in found.axes.items():
        unit = coefficient_units(name, "rate")[1]
        limits = ", ".join(f"{unit.from_si(t):.3g}" for t in choice.thresholds) or "—"
        rows.append(
            (name, str(choice.level), f"{choice.band:.3g} Hz", f"{limits} {unit.name}" if choice.thresholds else limits)
        )
    kind = "in a window that slides behind (causal)" if found.causal else "of the whole record (not causal)"
    review.table(Table(
        f"Wavelet denoising, {found.wavelet}, {found.rule}, {kind}", ("axis", "level", "keeps all below", "thresholds, finest level first"),
        tuple(rows), "A level k keeps what lies below the rate / 2^(k+1); details above are shrunk by their level's threshold.",
    ))  # fmt: skip
