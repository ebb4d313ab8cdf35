"""Periodic lines in a noisy record: peaks of an averaged spectrum above the local noise floor."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import ndimage

from imuwb.arrays import Floats, Integers
from imuwb.identification.spectral.welch import independent, welch
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import chi_square_quantile, normal_limit
from imuwb.stochastic import Sinusoid

LONGEST_SEGMENT = 1 << 16
FLOOR_BINS = 101  #: number of bins of the running median, which is the noise floor
LEAST_SEGMENTS = 8
MOST = 12  #: largest number of lines
DRIFT_BINS = 4  #: lowest bins, in which the window spreads the drift
NEAR = 2.0  #: resolutions of a half; lines that differ by less are one line
CLEARLY, ABOVE = 1.3, 0.5  #: factor and margin over the limit, because the floor itself scatters


@dataclass(frozen=True, slots=True)
class Line:
    """A sinusoid in the data."""

    frequency: float  #: Hz
    amplitude: Estimate  #: peak value of the samples, which are averages over dt
    power_sigma: float  #: standard error of amplitude²
    resolution: float  #: Hz, bin width of the spectrum
    in_both_halves: bool = True  #: whether each half of the record shows the line by itself

    def process(self, dt: float) -> Sinusoid:
        """Return the continuous sinusoid whose averages over dt these samples are."""
        return Sinusoid(self.amplitude.value / float(np.sinc(self.frequency * dt)), self.frequency)

    def __str__(self) -> str:
        """Return frequency and amplitude."""
        return f"line at {self.frequency:.4g} Hz, amplitude {self.amplitude}"


def find_lines(values: Floats, dt: float, level: float = 0.95, false_alarm: float = 0.01) -> tuple[Line, ...]:
    """Return the lines of a record, the strongest first, at most 12.

    A disturbance in a part of the record looks like a line. A fit must leave such a line out, but it is no line of the sensor.
    ``in_both_halves`` states whether a search of each half alone finds the line too; in records of less than 8192 samples, whose
    halves are too short for a search, it is True.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        level: confidence level of the amplitudes' intervals.
        false_alarm: probability that a record without lines shows a line.
    """
    lines = _search(values, dt, level, false_alarm)[:MOST]
    middle = values.size // 2
    if not lines or not _segment(middle):  # a half is too short to be searched
        return lines
    halves = [_search(half, dt, level, false_alarm) for half in (values[:middle], values[middle:])]
    return tuple(replace(line, in_both_halves=all(_shown(line, half) for half in halves)) for line in lines)


def _shown(line: Line, found: Sequence[Line]) -> bool:
    return any(abs(other.frequency - line.frequency) < NEAR * other.resolution for other in found)


def _segment(count: int) -> int:
    """Return the length of a segment (samples) for a search of so many samples; 0: they are too few."""
    size = min(LONGEST_SEGMENT, 1 << max(count // LEAST_SEGMENTS, 1).bit_length() - 1)
    return size if size >= 4 * FLOOR_BINS else 0


def _search(values: Floats, dt: float, level: float, false_alarm: float) -> tuple[Line, ...]:
    """Return the lines of a record or of a part of it, the strongest first."""
    size = _segment(values.size)
    if not size:
        return ()
    density, count = welch(values, dt, size)
    segments = independent(count)
    f = np.arange(density.size) / (size * dt)
    freedom = 2 * segments
    floor = ndimage.median_filter(density, FLOOR_BINS, mode="nearest") / (chi_square_quantile(0.5, freedom) / freedom)
    inside = np.arange(DRIFT_BINS, f.size - 2)
    ratio = np.zeros(f.size)
    ratio[inside] = density[inside] / np.maximum(floor[inside], 1e-300)
    limit = chi_square_quantile(1 - false_alarm / inside.size, freedom) / freedom
    # The floor itself scatters, and falls within its window.
    high = ratio > max(CLEARLY * limit, limit + ABOVE)
    labels, peaks = ndimage.label(ndimage.binary_dilation(high, iterations=1))
    lines = [_line(f, density, floor, np.flatnonzero(labels == i), freedom, level) for i in range(1, peaks + 1)]
    return tuple(sorted(lines, key=lambda line: -line.amplitude.value))


def _line(f: Floats, density: Floats, floor: Floats, bins: Integers, freedom: float, level: float) -> Line:
    """Return the line in these bins and their neighbours: its power is the power above the floor."""
    wide = np.arange(max(bins[0] - 1, 1), min(bins[-1] + 2, f.size))
    step = f[1] - f[0]
    excess = np.maximum(density[wide] - floor[wide], 0.0)
    power = 2 * float(excess.sum()) * step  # amplitude²/2 is the power of a sine
    frequency = float((excess * f[wide]).sum() / excess.sum())
    # The noise in the bins scatters, and beats with the line.
    noise = float(np.sqrt((floor[wide] ** 2 + 2 * floor[wide] * excess).sum() * 2 / freedom)) * 2 * step
    z = normal_limit(level)
    lower, upper = np.sqrt(max(power - z * noise, 0.0)), np.sqrt(power + z * noise)
    return Line(frequency, Estimate(float(np.sqrt(power)), float(lower), float(upper)), noise, float(step))


def passing_text(lines: Sequence[Line]) -> str:
    """Return a sentence on lines that are not in both halves of a record."""
    frequencies = ", ".join(f"{line.frequency:.4g}" for line in lines)
    what, those = ("lines", "they are") if len(lines) > 1 else ("the line", "it is")
    return (
        f"{what} at {frequencies} Hz: not in both halves of the record, so {those} left out of the fits, and not taken for the "
        "sensor's own"
    )
