"""The lines of one axis: steady and drifting, with names."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.lssa import DriftingLine, Peak, drifting_lines
from imuwb.noise_results import line_name
from imuwb.statistics import Estimate
from imuwb_plugins.lssa.parameters import Parameters
from imuwb_plugins.lssa.result import PeakResult


def lines_of(
    series: Floats, dt: float, peaks: Sequence[Peak], parameters: Parameters, highest: float
) -> tuple[PeakResult, ...]:
    """Return steady and drifting lines, the largest first.

    Args:
        series: (n,) longest part without gaps, without constituents.
        dt: s.
        peaks: steady lines of the whole record.
        parameters: options.
        highest: Hz.
    """
    drifting, steady = drifting_lines(series, dt, peaks, parameters.level, parameters.confidence)
    variance = float(np.var(series))
    lines = [
        PeakResult(
            x.frequency, x.amplitude, x.phase, x.percent, x.probability, x.significant, x.in_both_halves, True, ""
        )
        for x in steady
    ]
    lines += [_drifting(line, variance) for line in drifting if line.frequency <= highest]
    lines = sorted(lines, key=lambda line: -line.amplitude.value)[: parameters.peaks]
    names = [line_name(line.frequency.value, (x.frequency.value for x in lines[:k])) for k, line in enumerate(lines)]
    return tuple(replace(line, name=name) for line, name in zip(lines, names, strict=True))


def _drifting(line: DriftingLine, variance: float) -> PeakResult:
    frequency = Estimate(line.frequency, line.frequency - line.resolution, line.frequency + line.resolution)
    percent = 50 * line.amplitude.value**2 / variance
    return PeakResult(frequency, line.amplitude, None, percent, None, True, line.in_both_halves, False, "")


def without_lines(series: Floats, time: Floats, lines: Sequence[PeakResult]) -> Floats:
    """Return a series minus its steady lines, which are not noise.

    Args:
        series: (n,).
        time: (n,) s from the axis's first sample.
        lines: the lines of the series.
    """
    for line in lines:
        if line.phase is not None:
            series = series - line.amplitude.value * np.cos(2 * np.pi * line.frequency.value * time + line.phase.value)
    return series
