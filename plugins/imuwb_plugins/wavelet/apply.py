"""Wavelet denoising of the axes of a log."""

from dataclasses import dataclass, replace

import numpy as np

from imuwb.analysis import Review, Table
from imuwb.arrays import Floats
from imuwb.conditioning import (
    Change,
    band_limit,
    condition_streams,
    denoise,
    denoise_causally,
    level_of_band,
    measured_band,
)
from imuwb.log import AXES, Conditioning, Log
from imuwb.units import coefficient_units
from imuwb_plugins.wavelet.parameters import Parameters

QUIETEST = 0.02  #: share of a record's seconds whose scatter is the sensor's own
LEAST_BLOCK = 8  #: samples of such a second, where the rate is low
SHORTEST = 16  #: samples of a part; shorter ones are left out


@dataclass(frozen=True, slots=True)
class AxisChoice:
    """What an axis was denoised with."""

    level: int
    band: float  #: Hz, below which everything is kept
    thresholds: tuple[float, ...]  #: SI, finest level first; of the first part


@dataclass(frozen=True, slots=True)
class Applied:
    """What the first IMU was denoised with."""

    wavelet: str
    rule: str
    causal: bool
    axes: dict[str, AxisChoice]


def condition(log: Log, parameters: Parameters) -> tuple[Log, Applied]:
    """Return the log with its IMUs denoised, and how.

    Raises:
        ValueError: an unknown wavelet, or a part too short for the levels.
    """
    axes: dict[str, AxisChoice] = {}
    delays = [0.0]

    def design(sensor: str, rate: float) -> Change:
        if parameters.causal:
            delays.append((parameters.hop - 1) / rate)
        names = [f"{sensor}_{axis}" for axis in "xyz"]

        def apply(values: Floats) -> Floats:
            columns = zip(names, values.T, strict=True)
            return np.stack(
                [c if np.isnan(c[0]) else axis(np.ascontiguousarray(c), name, rate) for name, c in columns], axis=1
            )

        return Change(apply, SHORTEST)

    def axis(values: Floats, name: str, rate: float) -> Floats:
        level = _level(values, rate, parameters, AXES.index(name))
        how = (level, parameters.wavelet, parameters.threshold, parameters.shrinkage, parameters.scale)
        done = denoise_causally(values, *how, parameters.hop) if parameters.causal else denoise(values, *how)
        axes.setdefault(name, AxisChoice(level, band_limit(rate, level), done.thresholds))
        return done.values

    changed = condition_streams(log, design)
    band = min((choice.band for choice in axes.values() if choice.level), default=None)
    step = Conditioning("wavelet", _text(parameters), parameters.causal, max(delays), _note(axes), band)
    noise = {"level": "each level", "first": "the finest level", "none": "1 SI unit"}[parameters.scale]
    rule = f"{parameters.shrinkage}, {parameters.threshold}, noise of {noise}"
    applied = Applied(parameters.wavelet, rule, parameters.causal, axes)
    return replace(changed, conditioning=(*log.conditioning, step)), applied


def _level(values: Floats, rate: float, parameters: Parameters, place: int) -> int:
    """Return the level of an axis: as it is given, or the deepest that keeps the motion."""
    if parameters.levels != "auto":
        return parameters.levels[place if len(parameters.levels) > 1 else 0]
    if parameters.motion_band != "measured":
        return level_of_band(rate, parameters.motion_band)
    block = max(round(rate), LEAST_BLOCK)
    blocks = values[: values.size // block * block].reshape(-1, block)
    quiet = float(np.quantile(blocks.std(axis=1), QUIETEST))
    return level_of_band(rate, measured_band(values, rate, quiet / rate**0.5))


def _text(parameters: Parameters) -> str:
    levels = parameters.levels if parameters.levels == "auto" else "/".join(map(str, parameters.levels))
    band = parameters.motion_band if parameters.motion_band == "measured" else f"{parameters.motion_band:g}"
    return (
        f"levels={levels},motion_band={band},wavelet={parameters.wavelet},"
        f"threshold={parameters.threshold},scale={parameters.scale},shrinkage={parameters.shrinkage},causal={parameters.causal}"
    ).lower()


def _note(axes: dict[str, AxisChoice]) -> str:
    note = f"levels: {', '.join(f'{name} {axes[name].level}' for name in AXES if name in axes)}"
    if any(choice.level for choice in axes.values()):
        return note
    return f"{note}: nothing is removed, because the motion uses the whole band; give levels, or motion_band in Hz"


def draw(applied: Applied, review: Review) -> None:
    """Show levels, band limits and thresholds (Quinchia, table 7)."""
    rows: list[tuple[str, ...]] = []
    for name, choice in applied.axes.items():
        unit = coefficient_units(name, "rate")[1]
        limits = ", ".join(f"{unit.from_si(t):.3g}" for t in choice.thresholds)
        rows.append((name, str(choice.level), f"{choice.band:.3g} Hz", f"{limits} {unit.name}" if limits else "—"))
    kind = "in a sliding window (causal)" if applied.causal else "of the whole record (not causal)"
    review.table(Table(
        f"Wavelet denoising, {applied.wavelet}, {applied.rule}, {kind}",
        ("axis", "level", "keeps all frequencies below", "thresholds, finest level first"), tuple(rows),
        "Level k keeps frequencies below the rate / 2^(k+1); details above them shrink by the threshold of their level.",
    ))  # fmt: skip
