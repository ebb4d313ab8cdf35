"""Lines of a series: extracted one after another, the strongest first, then fitted together with intervals.

A line is A cos(2 pi f t + phi) with t from the first sample. The residual is searched again until nothing is significant in the
record as a whole.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg, ndimage

from imuwb.arrays import Floats
from imuwb.identification.lssa.significance import Significance, correlation, record_probability, significance
from imuwb.identification.lssa.spectrum import Adjusted, Spectrum
from imuwb.identification.lssa.trigonometric import Grid, summit, sums
from imuwb.identification.lssa.whitening import Recursion
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_limit
from imuwb.texts import counted

MOST = 12  #: largest number of lines of one series
ROUNDS = 8  #: largest number of searches of the residual
APART = 3.0  #: cycles over the record; lines that differ by less are one line
LEAKS = 10.0  #: least ratio of a weaker line to the power that stronger lines of the same search leak to its frequency
TOGETHER = 8.0  #: cycles over the record; lines that differ by less are fitted together
TURNS = 4  #: largest number of turns in which all groups are fitted
HALVES = 0.05  #: probability of a false alarm in each half of the record
SETTLED = 1e-4  #: share of the noise's level; a turn that reduces the residual by less is the last one


@dataclass(frozen=True, slots=True)
class Peak:
    """A steady line."""

    frequency: Estimate  #: Hz
    amplitude: Estimate  #: in the unit of the samples
    phase: Estimate  #: rad, -pi ... pi, of a cosine at the first sample
    percent: float  #: per cent of the residual's quadratic form
    exceedance: float  #: minus the logarithm of the probability at this one frequency
    probability: float  #: probability that noise alone shows as much anywhere in the record
    significant: bool  #: whether the line is significant in the record as a whole
    in_both_halves: bool  #: whether each half of the record shows the line by itself

    def __str__(self) -> str:
        """Return frequency, amplitude and phase with their intervals, in one line."""
        verdict = "" if self.significant else ", not significant"
        return f"{self.frequency} Hz: amplitude {self.amplitude}, phase {self.phase} rad{verdict}"


@dataclass(frozen=True, eq=False, slots=True)
class Extraction:
    """The lines of a series, and the residual without them."""

    peaks: tuple[Peak, ...]  #: the strongest first
    spectrum: Spectrum  #: spectrum of the series
    significance: Significance  #: significance of that spectrum
    left_significance: Significance  #: significance of the spectrum without the lines
    residual: Floats  #: (rows,) whitened, without the lines

    def __repr__(self) -> str:
        """Return one line for each periodic line."""
        return "\n".join([counted(len(self.peaks), "line"), *map(str, self.peaks)])


@dataclass(slots=True)
class _Line:
    """A line during the fit; its wave is a cos + b sin."""

    frequency: float
    a: float
    b: float
    exceedance: float
    probability: float


def extract(spectrum: Spectrum, level: float = 0.99, confidence: float = 0.95, most: int = MOST) -> Extraction:
    """Return the significant lines of a spectrum.

    Args:
        spectrum: spectrum of the series.
        level: level of significance in the record as a whole.
        confidence: level of the intervals.
        most: largest number of lines.
    """
    first = significance(spectrum, level)
    leakage = _leakage(spectrum)
    left, left_significance = spectrum, first
    lines: list[_Line] = []
    residual = spectrum.adjusted.residual
    for _ in range(ROUNDS):
        new = _new_lines(left, left_significance, leakage, lines, most - len(lines))
        if not new:
            break
        lines += new
        lines.sort(key=lambda line: line.frequency)
        residual = _fit(spectrum.adjusted, lines)
        left = spectrum.without(residual)
        left_significance = significance(left, level)
    peaks = [_peak(spectrum, left_significance, line, lines, residual, confidence) for line in lines]
    peaks.sort(key=lambda peak: -peak.amplitude.value)
    return Extraction(tuple(peaks), spectrum, first, left_significance, residual)


def _leakage(spectrum: Spectrum) -> Floats:
    """Return the largest share of a line's power that leaks to k steps away, (m,) for k = 1 ...: the spectral window.

    Gaps make side lobes far from the line; for example, gaps of half a second in each second make them at every whole hertz.
    """
    adjusted, grid = spectrum.adjusted, spectrum.grid
    ones = np.ones((1, adjusted.time.size))
    window = np.abs(sums(adjusted.time, adjusted.lattice, ones, grid)[0]) ** 2 / adjusted.time.size**2
    # A line lies between frequencies of the grid, where the window differs.
    highest = ndimage.maximum_filter1d(window, 2 * spectrum.oversampling + 1)
    apart = np.pi * np.arange(1, grid.count + 1) * grid.step * float(adjusted.time[-1])
    return np.maximum(highest, 1 / apart**2)


def _leaked(leakage: Floats, grid: Grid, at: int, line: int) -> float:
    """Return the share of a line's power that leaks to another frequency: the window at their difference and at their sum."""
    both = at + line + 2
    both = min(both, grid.length - both) if grid.length else both  # above half the rate the sum is mirrored
    mirrored = float(leakage[both - 1]) if both <= leakage.size else 0.0
    return max(float(leakage[abs(at - line) - 1]), mirrored)


def _new_lines(left: Spectrum, noise: Significance, leakage: Floats, lines: list[_Line], most: int) -> list[_Line]:
    """Return lines at the highest exceedances, away from known lines and from leakage of stronger lines."""
    exceedance = noise.exceedance.copy()
    step, span = left.grid.step, float(left.adjusted.time[-1])
    for line in lines:
        near = np.abs(left.frequency - line.frequency) < APART / span
        exceedance[near] = 0.0
    inner = np.concatenate([[-1.0], exceedance, [-1.0]])
    tops = np.flatnonzero((exceedance > noise.record) & (inner[1:-1] >= inner[:-2]) & (inner[1:-1] > inner[2:]))
    tops = tops[np.argsort(-exceedance[tops])]
    chosen: list[int] = []
    for top in tops:
        leaked = sum(left.reduction[k] * _leaked(leakage, left.grid, int(top), k) for k in chosen)
        far = all(abs(top - k) * step * span >= APART for k in chosen)
        if far and left.reduction[top] > LEAKS * leaked and len(chosen) < most:
            chosen.append(int(top))
    count, together = int(np.count_nonzero(noise.exceedance)), correlation(left)
    return [
        _Line(
            float(left.frequency[k]) + step * summit(left.reduction, k), left.complex_amplitude[k].real,
            -left.complex_amplitude[k].imag, float(noise.exceedance[k]),
            record_probability(float(noise.exceedance[k]), count, together),
        )
        for k in chosen
    ]  # fmt: skip


def _fit(adjusted: Adjusted, lines: list[_Line]) -> Floats:
    """Fit all lines by least squares, groups of close lines in turn; return the residual without them."""
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
    """Return the changes of frequency, a and b of each line, (k, 3), and the reduction of the residual's quadratic form."""
    length = _lengths(columns)
    right = columns.T @ residual / length
    step = linalg.pinvh(columns.T @ columns / np.outer(length, length)) @ right
    return (step / length).reshape(-1, 3), float(step @ right)


def _lengths(columns: Floats) -> Floats:
    """Return the lengths of columns, 1 for a column of zeros; the columns have different units."""
    length = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    return np.where(length > 0, length, 1.0)


def _groups(lines: list[_Line], span: float) -> list[list[_Line]]:
    """Return lines, in rising frequency, in groups of close lines."""
    groups: list[list[_Line]] = []
    for line in lines:
        if groups and (line.frequency - groups[-1][-1].frequency) * span < TOGETHER:
            groups[-1].append(line)
        else:
            groups.append([line])
    return groups


def _projected(adjusted: Adjusted, columns: Floats) -> Floats:
    """Return whitened columns minus their projection on the constituents."""
    rows = adjusted.noise.whitening.rows(columns)
    rows -= ((rows.T @ adjusted.basis) @ adjusted.basis.T).T  # column by column in memory
    return rows


def _columns(adjusted: Adjusted, group: list[_Line]) -> Floats:
    """Return the derivatives of the residual by frequency, a and b of each line, (rows, 3 k)."""
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
    spectrum: Spectrum, left: Significance, line: _Line, lines: list[_Line], residual: Floats, confidence: float
) -> Peak:
    adjusted = spectrum.adjusted
    near = [x for x in lines if abs(x.frequency - line.frequency) * float(adjusted.time[-1]) < TOGETHER]
    columns = _columns(adjusted, near)
    noise = _noise_at(line.frequency, spectrum, left)
    at = 3 * next(i for i, x in enumerate(near) if x is line)
    unit = columns / _lengths(columns)
    own_lengths = _lengths(columns)[at : at + 3]
    covariance = linalg.pinvh(unit.T @ unit)[at : at + 3, at : at + 3] * noise / np.outer(own_lengths, own_lengths)
    amplitude, z = float(np.hypot(line.a, line.b)), normal_limit(confidence)
    # A = |a - ib|, phi = arg(a - ib)
    turn = np.array(
        [[1, 0, 0], [0, line.a / amplitude, line.b / amplitude], [0, line.b / amplitude**2, -line.a / amplitude**2]]
    )
    halves = z * np.sqrt(np.maximum(np.diagonal(turn @ covariance @ turn.T), 0.0))
    values = line.frequency, amplitude, float(np.arctan2(-line.b, line.a))
    frequency, size, phase = (
        Estimate(value, value - half, value + half) for value, half in zip(values, map(float, halves), strict=True)
    )
    own = columns[:, at + 1] * line.a + columns[:, at + 2] * line.b
    # the exceedance when all lines are fitted together
    together = 0.5 * (amplitude * z / halves[1]) ** 2 if halves[1] > 0 else np.inf
    return Peak(
        frequency, replace(size, lower=max(size.lower, 0.0)), phase, 100 * float(own @ own) / adjusted.rest, line.exceedance,
        line.probability, bool(min(line.exceedance, together) > left.record),
        _in_both_halves(adjusted, columns[:, at + 1 : at + 3], residual + own, noise),
    )  # fmt: skip


def _noise_at(frequency: float, spectrum: Spectrum, left: Significance) -> float:
    """Return the noise's level at a frequency, or at the nearest frequency at which it is known."""
    k = int(np.clip(round(frequency / spectrum.grid.step) - 1, 0, left.level.size - 1))
    known = np.flatnonzero(left.level > 0)
    return float(left.level[known[np.argmin(np.abs(known - k))]]) if known.size else 0.0


def _in_both_halves(adjusted: Adjusted, columns: Floats, series: Floats, noise: float) -> bool:
    """Return whether each half of the record by itself shows a line at this frequency above the noise."""
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
