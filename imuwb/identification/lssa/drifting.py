"""Lines whose frequency drifts over the record.

A spectrum of short segments shows such a line as one line; the spectrum of the whole record shows many lines.

For example, the frequency of a swaying bench drifts, and a sinusoid with a constant phase over hours explains little of it. Such
a line is found in the averaged spectrum of segments (Welch), above the noise around it. It has a frequency and an amplitude, but
no phase.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from imuwb.arrays import Floats
from imuwb.identification.lssa.peaks import Peak
from imuwb.identification.spectral.lines import Line, find_lines
from imuwb.statistics import Estimate

HELD = 0.5  #: share of a line's power in one steady sinusoid, from which the line is steady
NEAR = 2.0  #: resolutions of the segments' spectrum; a steady sinusoid closer than this is part of a drifting line


@dataclass(frozen=True, slots=True)
class DriftingLine:
    """A line whose frequency drifts."""

    frequency: float  #: Hz, centre
    resolution: float  #: Hz, of the segments' spectrum; the line drifts by about as much, or more
    amplitude: Estimate  #: peak amplitude, in the unit of the samples
    in_both_halves: bool  #: whether each half of the record shows the line by itself


def drifting_lines(
    values: Floats, dt: float, peaks: Sequence[Peak], level: float = 0.99, confidence: float = 0.95
) -> tuple[tuple[DriftingLine, ...], tuple[Peak, ...]]:
    """Return the drifting lines of a record, and the steady lines that are not part of a drifting line.

    ``find_lines`` judges for both whether each half of the record shows them; a steady line that it does not find keeps its own
    verdict.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        peaks: steady lines of the record.
        level: 1 - the probability that noise alone shows a line.
        confidence: level of the amplitudes' intervals.
    """
    whole = find_lines(values, dt, confidence, 1 - level)
    drifting = [
        line
        for line in whole
        if not any(_near(line, p) and p.amplitude.value**2 > HELD * line.amplitude.value**2 for p in peaks)
    ]
    steady: list[Peak] = []
    for peak in peaks:
        near = [line for line in whole if _near(line, peak)]
        if not any(line in drifting for line in near):
            steady.append(replace(peak, in_both_halves=all(line.in_both_halves for line in near)) if near else peak)
    lines = tuple(DriftingLine(x.frequency, x.resolution, x.amplitude, x.in_both_halves) for x in drifting)
    return lines, tuple(steady)


def _near(line: Line, peak: Peak) -> bool:
    return abs(line.frequency - peak.frequency.value) < NEAR * line.resolution
