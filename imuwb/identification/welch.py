"""The averaged periodogram that spectra and the search for lines share (Welch 1967)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

#: Between the powers of neighbouring Hann-windowed segments that half overlap, both sides added up.
NEIGHBOURS = 2 * (1 / 6) ** 2
ASIDE = 1 / 36  #: the same, at the next frequency
#: Of one segment, at frequencies a bin, and two, apart.
APART_1, APART_2 = (2 / 3) ** 2, (1 / 6) ** 2


def welch(values: Floats, dt: float, size: int) -> tuple[Floats, int]:
    """Return the one-sided density at frequencies k/(size dt), and of how many segments it is the mean.

    Hann windows, half overlapping; each segment's straight line is taken off.

    Args:
        values: (n,) evenly spaced samples, n at least ``size``.
        dt: s.
        size: samples of a segment.
    """
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)
    line = np.arange(size) - (size - 1) / 2
    starts = range(0, values.size - size + 1, max(size // 2, 1))
    total = np.zeros(size // 2 + 1)
    for start in starts:
        piece = values[start : start + size]
        slope = float(np.einsum("i,i", line, piece)) * 12 / (size * (size**2 - 1.0))
        piece = piece - (float(piece.mean()) + slope * line)
        piece *= window
        transform = fft.rfft(piece)
        total += transform.real**2 + transform.imag**2
    count = len(starts)
    total *= 2 * dt / (count * float(np.einsum("i,i", window, window)))
    return total, count


def independent(count: int, width: float = 1.0) -> float:
    """Return of how many independent segments the mean over ``width`` neighbouring frequencies is worth, times the width.

    Powers of half-overlapping segments correlate, at the same frequency and at the next one; those of one segment at
    frequencies one and two apart.
    """
    across = 2 * APART_1 * (width - 1) / width + 2 * APART_2 * max(width - 2, 0.0) / width
    overlapping = (NEIGHBOURS + 4 * ASIDE * (width - 1) / width) * (count - 1) / count
    return count * width / (1 + across + overlapping)
