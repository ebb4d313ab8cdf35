"""Allan variances of a record with samples missing, without bias, from the pairs of samples there are.

The Allan variance is a weighted sum of half the mean squared differences of samples a lag apart (the variogram).
Each lag's mean is taken over the pairs that exist, so whatever is missing at random biases nothing;
filling gaps, or averaging what is left of a block, would.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

FEWEST_PAIRS = 30  #: at a lag; with fewer it is left out, and averaging times that need it with it


def variogram(values: Floats, place: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Return half the mean squared difference, and the number of pairs, at lags 0, 1, ... of a grid.

    Args:
        values: (n,) samples.
        place: (n,) their places on an even grid, rising from 0.
    """
    size = int(place[-1]) + 1
    length = fft.next_fast_len(2 * size, real=True)
    there, value, square = np.zeros((3, size))
    centered = values - values.mean()
    there[place], value[place], square[place] = 1.0, centered, centered**2
    mask, plain, squared = (fft.rfft(series, length) for series in (there, value, square))
    pairs = np.rint(fft.irfft(np.abs(mask) ** 2, length)[:size])
    # (x - y)²: x² + y² with the other's presence, less 2 xy; a correlation and its mirror image add up to twice the real part
    sums = fft.irfft(2 * (squared * mask.conj()).real - 2 * np.abs(plain) ** 2, length)[:size]
    return np.divide(sums, 2 * pairs, out=np.zeros(size), where=pairs > 0), pairs


def bridged(values: Floats, place: NDArray[np.int64], factors: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Return the Allan variance (of samples, not times dt) at each factor, NaN where pairs are missing, and the share of pairs.

    A Haar window of 2 m samples has the autocorrelation (2m - 3l)/m² up to lag m, and -(2m - l)/m² from there to 2m.

    Args:
        values: (n,) samples.
        place: (n,) places on an even grid.
        factors: (k,) averaging factors.
    """
    half, pairs = variogram(values, place)
    lags = np.arange(half.size, dtype=np.float64)
    plain = np.cumsum(half)
    weighted = np.cumsum(half * lags)
    possible = half.size - lags
    share = np.minimum.accumulate(np.where(pairs >= np.minimum(FEWEST_PAIRS, possible), pairs / possible, 0.0))
    variance, known = np.full(factors.size, np.nan), np.zeros(factors.size)
    for i, m in enumerate(factors):
        if 2 * m >= half.size:
            continue
        known[i] = share[2 * m]
        if known[i] > 0:
            near = 2 * m * (plain[m] - plain[0]) - 3 * weighted[m]
            far = 2 * m * (plain[2 * m] - plain[m]) - (weighted[2 * m] - weighted[m])
            variance[i] = (far - near) / float(m) ** 2
    return variance, known
