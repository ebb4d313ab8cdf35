"""Lines of a series, taken out one behind the other, the strongest first, and then fitted together with intervals.

A line is A cos(2 pi f t + phi) with t from the first sample on. What is left is searched again until nothing is significant in
the record as a whole.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg, ndimage

from imuwb.identification.lssa.significance import correlation, record_probability, significance
from imuwb.identification.lssa.trigonometric import summit, sums
from imuwb.identification.lssa.whitening import Recursion
from imuwb.statistics.distributions import normal_limit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.identification.lssa.significance import Significance
    from imuwb.identification.lssa.spectrum import Adjusted, Spectrum
    from imuwb.identification.lssa.trigonometric import Grid

    Floats = NDArray[np.float64]

MOST = 12  #: lines of one series
ROUNDS = 8
APART = 3.0  #: cycles over the record, by which lines must differ to be two
LEAKS = 10.0  #: times the power that stronger lines leak there, that a weaker one must have at the same time
TOGETHER = 8.0  #: cycles, below which lines are fitted together
TURNS = 4  #: of fitting the groups, at most
SETTLED = 1e-4  #: of the noise's level, by which a turn must lessen the residual to need another
HALVES = 0.05  #: probability of a false alarm that is granted to each half


@dataclass(frozen=True, slots=True)
class Peak:
    """A line; ends of intervals at the level asked for."""

    frequency: float  #: Hz
    frequency_interval: tuple[float, float]
    amplitude: float  #: of the samples' unit
    lower: float
    upper: float
    phase: float  #: rad, -pi ... pi, of a cosine, at the first sample
    phase_interval: tuple[float, float]
    percent: float  #: of the residual that it takes up
    exceedance: float  #: minus log probability at this one frequency
    probability: float  #: that noise shows as much anywhere in the record
    significant: bool  #: in the record as a whole
    in_both_halves: bool  #: whether each half shows it by itself


@dataclass(frozen=True, eq=False, slots=True)
class Extraction:
    """The lines of a series, and what is left."""

    peaks: tuple[Peak, ...]  #: the strongest first
    spectrum: Spectrum  #: of the series
    found: Significance  #: in it
    left: Spectrum  #: of the series without the lines
    left_found: Significance
    residual: Floats  #: (rows,) whitened, without the lines


@dataclass(slots=True)
class _Line:
    """A line being fitted; its wave is a cos + b sin."""

    frequency: float
    a: float
    b: float
    exceedance: float
    probability: float


def extract(spectrum: Spectrum, level: float = 0.99, confidence: float = 0.95, most: int = MOST) -> Extraction:
    """Return the significant lines of a spectrum.

    Args:
        spectrum: of the series.
        level: of significance in the record as a whole.
        confidence: of intervals.
        most: lines at most.
    """
    first = significance(spectrum, level)
    leakage = _leakage(spectrum)
    left, found = spectrum, first
    lines: list[_Line] = []
    residual = spectrum.adjusted.residual
    for _ in range(ROUNDS):
        new = _candidates(left, found, leakage, lines, most - len(lines))
        if not new:
            break
        lines += new
        lines.sort(key=lambda line: line.frequency)
        residual = _fit(spectrum.adjusted, lines)
        left = spectrum.without(residual)
        found = significance(left, level)
    peaks = [_peak(spectrum, found, line, lines, residual, confidence) for line in lines]
    peaks.sort(key=lambda peak: -peak.amplitude)
    return Extraction(tuple(peaks), spectrum, first, left, found, residual)


def _leakage(spectrum: Spectrum) -> Floats:
    """Return the share of a line's power that shows k steps away at most, (m,) for k = 1 ...: the spectral window.

    Missing samples give it side lobes far from the line: half a second of each second, at every whole hertz.
    """
    adjusted, grid = spectrum.adjusted, spectrum.grid
    ones = np.ones((1, adjusted.time.size))
    window = np.abs(sums(adjusted.time, adjusted.lattice, ones, grid)[0]) ** 2 / adjusted.time.size**2
    # A line lies between frequencies, where the window is not the one of the grid.
    highest = ndimage.maximum_filter1d(window, 2 * spectrum.oversampling + 1)
    apart = np.pi * np.arange(1, grid.count + 1) * grid.step * float(adjusted.time[-1])
    return np.maximum(highest, 1 / apart**2)


def _leaked(leakage: Floats, grid: Grid, at: int, line: int) -> float:
    """Return the share of a line's power that shows elsewhere: the window at their difference, and at their sum."""
    both = at + line + 2
    both = min(both, grid.length - both) if grid.length else both  # beyond half the rate it comes back
    mirrored = float(leakage[both - 1]) if both <= leakage.size else 0.0
    return max(float(leakage[abs(at - line) - 1]), mirrored)


def _candidates(left: Spectrum, found: Significance, leakage: Floats, lines: list[_Line], most: int) -> list[_Line]:
    """Return lines at the highest exceedances: none beside a known one, none that a stronger one's leakage may be."""
    exceedance = found.exceedance.copy()
    step, span = left.grid.step, float(left.adjusted.time[-1])
    for line in lines:
        near = np.abs(left.frequency - line.frequency) < APART / span
        exceedance[near] = 0.0
    inner = np.concatenate([[-1.0], exceedance, [-1.0]])
    tops = np.flatnonzero((exceedance > found.record) & (inner[1:-1] >= inner[:-2]) & (inner[1:-1] > inner[2:]))
    tops = tops[np.argsort(-exceedance[tops])]
    chosen: list[int] = []
    for top in tops:
        leaked = sum(left.reduction[k] * _leaked(leakage, left.grid, int(top), k) for k in chosen)
        far = all(abs(top - k) * step * span >= APART for k in chosen)
        if far and left.reduction[top] > LEAKS * leaked and len(chosen) < most:
            chosen.append(int(top))
    count, together = int(np.count_nonzero(found.exceedance)), correlation(left)
    return [
        _Line(
            float(left.frequency[k]) + step * summit(left.reduction, k), left.complex_amplitude[k].real,
            -left.complex_amplitude[k].imag, float(found.exceedance[k]),
            record_probability(float(found.exceedance[k]), count, together),
        )
        for k in chosen
    ]  # fmt: skip


def _fit(adjusted: Adjusted, lines: list[_Line]) -> Floats:
    """Fit all lines by least squares, groups of near ones by turns; return the residual without them."""
    groups = _groups(lines, float(adjusted.time[-1]))
    waves = [_waves(adjusted, group) for group in groups]
    residual = adjusted.residual - sum(waves)
    moving = [True] * len(groups)
    for _ in range(TURNS):
        noise = SETTLED * float(np.einsum("i,i", residual, residual)) / adjusted.freedom
        for i, group in enumerate(groups):
            if not moving[i]:
                continue
            whole = residual + waves[i]
            step, gained = _step(_columns(adjusted, group), residual)
            moving[i] = gained > noise
            for line, (frequency, a, b) in zip(group, step, strict=True):
                line.frequency += float(np.clip(frequency, -1 / adjusted.time[-1], 1 / adjusted.time[-1]))
                line.a += a
                line.b += b
            waves[i] = _waves(adjusted, group)
            residual = whole - waves[i]
    return residual


def _step(columns: Floats, residual: Floats) -> tuple[Floats, float]:
    """Return how frequency, a and b of each line change, (k, 3), and how much of the residual that takes away."""
    length = _lengths(columns)
    right = columns.T @ residual / length
    step = linalg.pinvh(columns.T @ columns / np.outer(length, length)) @ right
    return (step / length).reshape(-1, 3), float(step @ right)


def _lengths(columns: Floats) -> Floats:
    """Return the lengths of columns, which are of different units, 1 for one of zeros."""
    found = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    return np.where(found > 0, found, 1.0)


def _groups(lines: list[_Line], span: float) -> list[list[_Line]]:
    """Return lines, rising in frequency, in groups of near ones."""
    groups: list[list[_Line]] = []
    for line in lines:
        if groups and (line.frequency - groups[-1][-1].frequency) * span < TOGETHER:
            groups[-1].append(line)
        else:
            groups.append([line])
    return groups


def _projected(adjusted: Adjusted, columns: Floats) -> Floats:
    """Return whitened columns without what the constituents hold of them."""
    rows = adjusted.noise.whitening.rows(columns)
    rows -= ((rows.T @ adjusted.basis) @ adjusted.basis.T).T  # column by column in memory
    return rows


def _columns(adjusted: Adjusted, group: list[_Line]) -> Floats:
    """Return how the residual depends on frequency, a and b of each line, (rows, 3 k)."""
    columns = np.empty((adjusted.time.size, 3 * len(group)), order="F")
    for k, line in enumerate(group):
        phase = 2 * np.pi * line.frequency * adjusted.time
        c, s = np.cos(phase, out=columns[:, 3 * k + 1]), np.sin(phase, out=columns[:, 3 * k + 2])
        columns[:, 3 * k] = 2 * np.pi * adjusted.time * (line.b * c - line.a * s)
    return _projected(adjusted, columns)


def _waves(adjusted: Adjusted, group: list[_Line]) -> Floats:
    wave = np.zeros(adjusted.time.size)
    for line in group:
        phase = 2 * np.pi * line.frequency * adjusted.time
        wave += line.a * np.cos(phase) + line.b * np.sin(phase)
    return _projected(adjusted, wave[:, None])[:, 0]


def _peak(
    spectrum: Spectrum, found: Significance, line: _Line, lines: list[_Line], residual: Floats, confidence: float
) -> Peak:
    adjusted = spectrum.adjusted
    near = [x for x in lines if abs(x.frequency - line.frequency) * float(adjusted.time[-1]) < TOGETHER]
    columns = _columns(adjusted, near)
    noise = _noise_at(line.frequency, spectrum, found)
    at = 3 * next(i for i, x in enumerate(near) if x is line)
    unit = columns / _lengths(columns)
    own_lengths = _lengths(columns)[at : at + 3]
    covariance = linalg.pinvh(unit.T @ unit)[at : at + 3, at : at + 3] * noise / np.outer(own_lengths, own_lengths)
    amplitude, z = float(np.hypot(line.a, line.b)), normal_limit(confidence)
    # A = |a - ib|, phi = arg(a - ib)
    turn = np.array(
        [[1, 0, 0], [0, line.a / amplitude, line.b / amplitude], [0, line.b / amplitude**2, -line.a / amplitude**2]]
    )
    frequency, size, angle = z * np.sqrt(np.maximum(np.diagonal(turn @ covariance @ turn.T), 0.0))
    phase = float(np.arctan2(-line.b, line.a))
    own = columns[:, at + 1] * line.a + columns[:, at + 2] * line.b
    beside = 0.5 * (amplitude * z / size) ** 2 if size > 0 else np.inf  # what remains of it when all are fitted
    return Peak(
        line.frequency, (line.frequency - frequency, line.frequency + frequency), amplitude, max(amplitude - size, 0.0),
        amplitude + size, phase, (phase - angle, phase + angle), 100 * float(own @ own) / adjusted.rest, line.exceedance,
        line.probability, bool(min(line.exceedance, beside) > found.record), _in_both_halves(adjusted, columns[:, at + 1 : at + 3], residual + own, noise),
    )  # fmt: skip


def _noise_at(frequency: float, spectrum: Spectrum, found: Significance) -> float:
    """Return the noise's level at a frequency, or at the nearest that has neighbours to be told from."""
    k = int(np.clip(round(frequency / spectrum.grid.step) - 1, 0, found.level.size - 1))
    told = np.flatnonzero(found.level > 0)
    return float(found.level[told[np.argmin(np.abs(told - k))]]) if told.size else 0.0


def _in_both_halves(adjusted: Adjusted, columns: Floats, series: Floats, noise: float) -> bool:
    """Return whether each half by itself shows a line of this frequency, more than noise does."""
    time = (
        adjusted.time[adjusted.noise.whitening.kept]
        if isinstance(adjusted.noise.whitening, Recursion)
        else adjusted.time
    )
    middle = int(np.searchsorted(time, 0.5 * adjusted.time[-1]))
    for half in (slice(None, middle), slice(middle, None)):
        part = columns[half]
        share = linalg.lstsq(part, series[half], check_finite=False)[0]
        wave = part @ share
        if 0.5 * float(wave @ wave) <= -np.log(HALVES) * noise:
            return False
    return True
