"""The averaged periodogram (Welch 1967), which the spectrum and the search for lines share."""

import numpy as np
from scipy import fft

from imuwb.arrays import Complexes, Floats
from imuwb.compiled import compiled

#: Sum of the correlations of a segment's power with those of both neighbours; Hann windows that overlap by half.
NEIGHBOURS = 2 * (1 / 6) ** 2
ASIDE = 1 / 36  #: sum of the correlations with a neighbour's powers at all higher frequencies, mostly the next one
#: Correlations of the powers of one segment at frequencies one and two bins apart.
APART_1, APART_2 = (2 / 3) ** 2, (1 / 6) ** 2


def welch(values: Floats, dt: float, size: int) -> tuple[Floats, int]:
    """Return the one-sided density at frequencies k/(size dt), and the number of segments.

    Segments have Hann windows and overlap by half; a straight line is taken off each.

    Args:
        values: (n,) evenly spaced samples, n at least ``size``.
        dt: s.
        size: samples of a segment.
    """
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)
    starts = range(0, values.size - size + 1, max(size // 2, 1))
    total, piece = np.zeros(size // 2 + 1), np.empty(size)
    for start in starts:
        _tapered(values[start : start + size], window, piece)
        _add_power(np.asarray(fft.rfft(piece)), total)
    count = len(starts)
    total *= 2 * dt / (count * float(np.einsum("i,i", window, window)))
    return total, count


@compiled(reorder=True)
def _tapered(values: Floats, window: Floats, out: Floats) -> None:  # pragma: no cover - compiled
    """Write the values less their least-squares line, tapered."""
    n = values.size
    middle, total, moment = (n - 1) / 2.0, 0.0, 0.0
    for k in range(n):
        x = values[k] - values[0]  # a large mean would cost digits
        total += x
        moment += (k - middle) * x
    mean, slope = values[0] + total / n, moment * 12.0 / (n * (float(n) * n - 1.0))
    for k in range(n):
        out[k] = (values[k] - mean - slope * (k - middle)) * window[k]


@compiled()
def _add_power(transform: Complexes, total: Floats) -> None:  # pragma: no cover - compiled
    for k in range(total.size):
        total[k] += transform[k].real ** 2 + transform[k].imag ** 2


def independent(count: int, width: float = 1.0) -> float:
    """Return the number of independent powers in a mean over ``count`` segments and ``width`` neighbouring frequencies.

    Powers of segments that overlap by half are correlated, at the same frequency and at the next ones. So are the powers of one
    segment at frequencies one and two bins apart.
    """
    across = 2 * APART_1 * (width - 1) / width + 2 * APART_2 * max(width - 2, 0.0) / width
    overlapping = (NEIGHBOURS + 4 * ASIDE * (width - 1) / width) * (count - 1) / count
    return count * width / (1 + across + overlapping)
