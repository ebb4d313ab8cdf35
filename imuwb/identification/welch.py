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


def welch(values: Floats, dt: float, size: int) -> tuple[Floats, float]:
    """Return the one-sided density at frequencies k/(size dt), and how many independent segments it is worth.

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
    return total, count / (1 + NEIGHBOURS * (count - 1) / count)
