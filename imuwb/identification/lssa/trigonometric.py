"""Sums of many strengths times exp(i omega t), at many frequencies at once.

Where stamps lie on a lattice, gaps and all, a fast Fourier transform gives them; elsewhere one for uneven points (Barnett,
Magland, af Klinteberg 2019).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Complexes = NDArray[np.complex128]

ACCURACY = 1e-11  #: of the uneven transform, relative to the sum of all strengths
STRAY = 6e-6  #: intervals, by which a stamp may miss the lattice: whole nanoseconds at 10 kHz
ROUNDED = 0.05  #: intervals, by which it may where noise needs a lattice
PADDED = 8.0  #: times as long as its samples, that a lattice may be


@dataclass(frozen=True, eq=False, slots=True)
class Lattice:
    """Stamps that are whole multiples of an interval."""

    interval: float  #: s
    index: NDArray[np.int64]  #: (n,) from 0 on


@dataclass(frozen=True, slots=True)
class Grid:
    """Frequencies k step, k = 1 ... count."""

    step: float  #: Hz
    count: int
    length: int = 0  #: of the lattice's transform; 0: the stamps are on none

    @property
    def frequency(self) -> Floats:
        """Return them, (count,) Hz."""
        return np.arange(1, self.count + 1, dtype=np.float64) * self.step


def lattice_of(time: Floats, interval: float, stray: float = STRAY) -> Lattice | None:
    """Return the lattice that stamps lie on; None: on none.

    Args:
        time: (n,) s, rising, from 0 on.
        interval: s, which samples have as a rule; where half of them are missing, the shortest step is what they have.
        stray: intervals, by which a stamp may miss it.
    """
    found = _lattice(time, interval, stray)
    return _lattice(time, float(np.diff(time).min()), stray) if found is None else found


def _lattice(time: Floats, interval: float, stray: float) -> Lattice | None:
    steps = np.rint(np.diff(time) / interval).astype(np.int64)  # an interval a little off must not add up
    if steps.min(initial=1) < 1:
        return None
    steps //= np.gcd.reduce(steps)
    index = np.concatenate([[0], np.cumsum(steps)])
    if index[-1] >= PADDED * time.size:
        return None
    interval = float(time[-1] / index[-1])
    return Lattice(interval, index) if np.abs(time - index * interval).max() < stray * interval else None


def grid_of(time: Floats, lattice: Lattice | None, highest: float, oversampling: int) -> Grid:
    """Return the frequencies of a spectrum: ``oversampling`` of them to each cycle more that the record holds.

    Args:
        time: (n,) s.
        lattice: of the stamps.
        highest: Hz.
        oversampling: 1: those of Fourier.
    """
    if lattice is None:
        step = 1 / (oversampling * float(time[-1] - time[0]) * time.size / (time.size - 1))
        return Grid(step, max(int(np.floor(highest / step * (1 + 1e-12))), 1))
    # A length of small factors; its own frequencies are then a little closer.
    length = fft.next_fast_len(oversampling * (int(lattice.index[-1]) + 1), real=True)
    step = 1 / (length * lattice.interval)
    most = (length - 1) // 2  # at half the rate there is no sine
    return Grid(step, max(min(int(np.floor(highest / step * (1 + 1e-12))), most), 1), length)


def sums(time: Floats, lattice: Lattice | None, strengths: Floats, grid: Grid, multiple: int = 1) -> Complexes:
    """Return sum_j strength_j exp(2 pi i multiple f t_j), (k, count).

    Args:
        time: (n,) s, of samples, or of what else has a strength.
        lattice: of these stamps.
        strengths: (k, n).
        grid: the frequencies.
        multiple: 1, or 2 for twice the frequencies.
    """
    if lattice is None or not grid.length:
        return _uneven(2 * np.pi * multiple * grid.step * time, strengths, grid.count)
    found = np.empty((len(strengths), grid.count), np.complex128)
    where = multiple * np.arange(1, grid.count + 1) % grid.length
    mirrored = where > grid.length // 2
    for row, strength in zip(found, strengths, strict=True):
        whole = np.zeros(grid.length)
        whole[lattice.index] = strength
        spectrum = fft.rfft(whole)
        row[:] = spectrum[np.where(mirrored, grid.length - where, where)]
        np.conjugate(row, out=row, where=~mirrored)  # numpy's transform has the other sign
    return found


def summit(values: Floats, k: int) -> float:
    """Return where between its neighbours a parabola has its top, in steps."""
    if not 0 < k < values.size - 1:
        return 0.0
    before, here, after = values[k - 1 : k + 2]
    bend = before - 2 * here + after
    return float(np.clip(0.5 * (before - after) / bend, -0.5, 0.5)) if bend < 0 else 0.0


def _uneven(phase: Floats, strengths: Floats, count: int) -> Complexes:
    """Return sum_j strength_j exp(i k phase_j), k = 1 ... count; two real ones at a time, as one complex."""
    from finufft import nufft1d1  # noqa: PLC0415 - slow to import, and even stamps need none

    pairs = -(-len(strengths) // 2)
    packed = np.zeros((pairs, phase.size), np.complex128)
    packed.real = strengths[0::2]
    packed.imag[: len(strengths) // 2] = strengths[1::2]
    wrapped = np.remainder(phase + np.pi, 2 * np.pi) - np.pi
    modes = nufft1d1(wrapped, packed, 2 * count + 1, eps=ACCURACY, isign=1, nthreads=1)
    modes = np.reshape(modes, (pairs, 2 * count + 1))
    above, below = modes[:, count + 1 :], modes[:, count - 1 :: -1].conj()
    found = np.empty((2 * pairs, count), np.complex128)
    found[0::2] = 0.5 * (above + below)
    found[1::2] = -0.5j * (above - below)
    return found[: len(strengths)]
