"""Sums of many strengths times exp(i omega t), at many frequencies at once.

If the time stamps lie on a lattice, with or without gaps, a fast Fourier transform gives the sums; else one for uneven points does
(``uneven.py``).
"""

from dataclasses import dataclass

import numpy as np
from scipy import fft

from imuwb.arrays import Complexes, Floats, Integers
from imuwb.identification.lssa.uneven import uneven_sums

STRAY = 6e-6  #: intervals, by which a time stamp may miss the lattice: rounding to nanoseconds at 5 kHz
ROUNDED = 0.05  #: intervals, by which a time stamp may miss the lattice if the structure of the noise needs a lattice
PADDED = 8.0  #: largest number of lattice points for each sample


@dataclass(frozen=True, eq=False, slots=True)
class Lattice:
    """Time stamps that are whole multiples of an interval."""

    interval: float  #: s
    index: Integers  #: (n,) the multiples, from 0


@dataclass(frozen=True, slots=True)
class Grid:
    """The frequencies k step, k = 1 ... count."""

    step: float  #: Hz
    count: int
    length: int = 0  #: length of the lattice's transform; 0: the time stamps lie on no lattice

    @property
    def frequency(self) -> Floats:
        """Return the frequencies, (count,) Hz."""
        return np.arange(1, self.count + 1, dtype=np.float64) * self.step


def lattice_of(time: Floats, interval: float, stray: float = STRAY) -> Lattice | None:
    """Return the lattice of time stamps; None if they lie on none.

    Args:
        time: (n,) s, rising, from 0.
        interval: s, usual sampling interval; the shortest step is tried as well, for logs that lack half of the samples.
        stray: intervals, by which a time stamp may miss the lattice.
    """
    lattice = _lattice(time, interval, stray)
    return _lattice(time, float(np.diff(time).min()), stray) if lattice is None else lattice


def _lattice(time: Floats, interval: float, stray: float) -> Lattice | None:
    # Rounded step by step: an error of the interval must not add up.
    steps = np.rint(np.diff(time) / interval).astype(np.int64)
    if steps.min(initial=1) < 1:
        return None
    steps //= np.gcd.reduce(steps)
    index = np.concatenate([[0], np.cumsum(steps)])
    if index[-1] >= PADDED * time.size:
        return None
    interval = float(time[-1] / index[-1])
    return Lattice(interval, index) if np.abs(time - index * interval).max() < stray * interval else None


def grid_of(time: Floats, lattice: Lattice | None, highest: float, oversampling: int) -> Grid:
    """Return the frequencies of a spectrum.

    Args:
        time: (n,) s.
        lattice: lattice of the time stamps.
        highest: Hz.
        oversampling: frequencies for each cycle over the record; 1: the Fourier frequencies.
    """
    if lattice is None:
        step = 1 / (oversampling * float(time[-1] - time[0]) * time.size / (time.size - 1))
        return Grid(step, max(int(np.floor(highest / step * (1 + 1e-12))), 1))
    # The next length with small factors; its frequencies are a little closer.
    length = fft.next_fast_len(oversampling * (int(lattice.index[-1]) + 1), real=True)
    step = 1 / (length * lattice.interval)
    most = (length - 1) // 2  # at half the rate the sine vanishes
    return Grid(step, max(min(int(np.floor(highest / step * (1 + 1e-12))), most), 1), length)


def sums(time: Floats, lattice: Lattice | None, strengths: Floats, grid: Grid, multiple: int = 1) -> Complexes:
    """Return sum_j strength_j exp(2 pi i multiple f t_j), (k, count).

    Args:
        time: (n,) s, of the samples or other instants.
        lattice: lattice of these instants.
        strengths: (k, n).
        grid: the frequencies.
        multiple: 1, or 2 for twice the frequencies.
    """
    if lattice is None or not grid.length:
        return uneven_sums(multiple * grid.step * time, strengths, grid.count)
    result = np.empty((len(strengths), grid.count), np.complex128)
    where = multiple * np.arange(1, grid.count + 1) % grid.length
    mirrored = where > grid.length // 2
    for row, strength in zip(result, strengths, strict=True):
        whole = np.zeros(grid.length)
        whole[lattice.index] = strength
        spectrum = fft.rfft(whole)
        row[:] = spectrum[np.where(mirrored, grid.length - where, where)]
        np.conjugate(row, out=row, where=~mirrored)  # numpy's transform has the other sign
    return result


def summit(values: Floats, k: int) -> float:
    """Return the position of a parabola's maximum relative to index k, in steps."""
    if not 0 < k < values.size - 1:
        return 0.0
    before, here, after = values[k - 1 : k + 2]
    bend = before - 2 * here + after
    return float(np.clip(0.5 * (before - after) / bend, -0.5, 0.5)) if bend < 0 else 0.0
