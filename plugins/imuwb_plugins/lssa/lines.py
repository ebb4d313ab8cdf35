"""The lines of one axis: steady and drifting, with names."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.lssa import DriftingLine, Peak, drifting_lines
from imuwb_plugins.lssa.parameters import Parameters
from imuwb_plugins.lssa.result import PeakResult

HARMONIC = 0.01  #: share of a multiple by which a harmonic may differ from it


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
    lines = [_steady(peak) for peak in steady]
    lines += [_drifting(line, variance) for line in drifting if line.frequency <= highest]
    return _named(sorted(lines, key=lambda line: -line.amplitude)[: parameters.peaks])


def _steady(peak: Peak) -> PeakResult:
    frequency, amplitude, phase = peak.frequency, peak.amplitude, peak.phase
    return PeakResult(
        frequency.value, frequency.lower, frequency.upper, amplitude.value, amplitude.lower, amplitude.upper, phase.value,
        phase.lower, phase.upper, peak.percent, peak.probability, peak.significant, peak.in_both_halves, True, "",
    )  # fmt: skip


def _drifting(line: DriftingLine, variance: float) -> PeakResult:
    amplitude = line.amplitude
    return PeakResult(
        line.frequency, line.frequency - line.resolution, line.frequency + line.resolution, amplitude.value, amplitude.lower,
        amplitude.upper, None, None, None, 50 * amplitude.value**2 / variance, None, True, line.in_both_halves, False, "",
    )  # fmt: skip


def _named(lines: Sequence[PeakResult]) -> tuple[PeakResult, ...]:
    """Return lines with names; a harmonic of a larger line is named as its multiple."""
    named: list[PeakResult] = []
    for k, line in enumerate(lines):
        name = f"{line.frequency:.4g} Hz"
        for base in lines[:k]:
            ratio = line.frequency / base.frequency
            if round(ratio) >= 2 and abs(ratio - round(ratio)) < HARMONIC * ratio:  # noqa: PLR2004 - the second harmonic
                name = f"{round(ratio)} × {base.frequency:.4g} Hz"
                break
        named.append(replace(line, name=name))
    return tuple(named)


def without_lines(series: Floats, time: Floats, lines: Sequence[PeakResult]) -> Floats:
    """Return a series minus its steady lines, which are not noise.

    Args:
        series: (n,).
        time: (n,) s from the axis's first sample.
        lines: the lines of the series.
    """
    for line in lines:
        if line.phase is not None:
            series = series - line.amplitude * np.cos(2 * np.pi * line.frequency * time + line.phase)
    return series
