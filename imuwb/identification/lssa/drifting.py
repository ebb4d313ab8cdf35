"""Lines that do not keep their frequency over the record: in a spectrum of short segments they are one, in that of the whole record many.

The frequency of a swaying bench drifts, and a sinusoid that keeps its phase for hours takes up little of it. Such a line is
told by segments (Welch), against the floor around it, and has a frequency and an amplitude but no phase.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from imuwb.identification.spectral.lines import find_lines

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from imuwb.identification.lssa.peaks import Peak
    from imuwb.identification.spectral.lines import Line

    Floats = NDArray[np.float64]

HELD = 0.5  #: share of a line's power that a steady sinusoid takes up, from which on it is one
NEAR = 2.0  #: resolutions, within which a steady sinusoid is part of a drifting line


@dataclass(frozen=True, slots=True)
class DriftingLine:
    """A line whose frequency drifts; ends of the interval at the confidence asked for."""

    frequency: float  #: Hz, centre
    resolution: float  #: Hz, of the segments' spectrum; it drifts by about so much, or more
    amplitude: float  #: peak, of the samples' unit
    lower: float
    upper: float
    in_both_halves: bool  #: whether each half shows it by itself


def drifting_lines(
    values: Floats, dt: float, peaks: Sequence[Peak], level: float = 0.99, confidence: float = 0.95
) -> tuple[tuple[DriftingLine, ...], tuple[Peak, ...]]:
    """Return the drifting lines of a record, and those of its steady ones that are no part of them.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        peaks: steady lines of the record.
        level: 1 - the probability that a record without lines shows one all the same.
        confidence: of the amplitudes' intervals.
    """
    whole = find_lines(values, dt, confidence, 1 - level)
    drifting = [
        line for line in whole if not any(_near(line, p) and p.amplitude**2 > HELD * line.amplitude**2 for p in peaks)
    ]
    steady = tuple(p for p in peaks if not any(_near(line, p) for line in drifting))
    if not drifting:
        return (), steady
    middle = values.size // 2
    halves = [find_lines(part, dt, confidence, 1 - level) for part in (values[:middle], values[middle:])]
    found = tuple(
        DriftingLine(
            line.frequency, line.resolution, line.amplitude, line.lower, line.upper,
            all(any(abs(other.frequency - line.frequency) < NEAR * other.resolution for other in half) for half in halves),
        )
        for line in drifting
    )  # fmt: skip
    return found, steady


def _near(line: Line, peak: Peak) -> bool:
    return abs(line.frequency - peak.frequency) < NEAR * line.resolution
