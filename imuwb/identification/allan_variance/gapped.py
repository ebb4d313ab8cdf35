"""Unbiased Allan variances of a record with missing samples, from block means of the samples that are present.

The mean of c out of m samples differs from the mean of all m by an error of variance (1/c - 1/m) s², where s² is the variance of
the samples within the block: the classical law of sampling without replacement (Cochran 1977, 2.5). The law is valid for any noise
if samples are missing at random. So this excess is subtracted. To fill gaps, or to keep the excess, would bias every averaging time.
"""

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.compiled import compiled

FEWEST = 2  #: least number of samples in an incomplete block; its variance needs them
FULLNESS = 0.8  #: least share of samples in a block, over that share in the whole record; emptier blocks are left out


def bridged(values: Floats, place: Integers, factors: Integers) -> tuple[Floats, Integers, Floats]:
    """Return the Allan variance at each factor (NaN where there is none), the number of differences, and the clear share.

    The clear share is the part of the mean square that is left without the excess. If it is small, the scatter of the
    excess itself counts much.

    Args:
        values: (n,) samples.
        place: (n,) indices of the samples on an even grid, rising from 0.
        factors: (k,) averaging factors.
    """
    size = int(place[-1]) + 1
    count, total, square = np.zeros((3, size + 1))
    centered = values - values.mean()
    count[place + 1], total[place + 1], square[place + 1] = 1.0, centered, centered**2
    for sums in (count, total, square):
        np.cumsum(sums, out=sums)
    least = FULLNESS * values.size / size
    variance, clear = np.full((2, factors.size), np.nan)
    terms = np.zeros(factors.size, dtype=np.int64)
    for i, m in enumerate(factors):
        if 2 * m <= size:
            squares, excess, terms[i] = _block_differences(count, total, square, int(m), least)
            if terms[i] and squares > 0:
                variance[i], clear[i] = (squares - excess) / terms[i] / 2, 1 - excess / squares
    return variance, terms, clear


@compiled()
def _block_differences(
    count: Floats, total: Floats, square: Floats, m: int, least: float
) -> tuple[float, float, int]:  # pragma: no cover - compiled
    """Return the sums of squared differences of neighbouring block means and of their excess, and the number of terms."""
    squares = off = 0.0
    terms = 0
    for k in range(count.size - 2 * m):
        difference = excess = 0.0
        for side in range(2):
            begin = k + side * m
            c = count[begin + m] - count[begin]
            if c < least * m or c < min(m, FEWEST):
                break
            mean = (total[begin + m] - total[begin]) / c
            difference += mean if side else -mean
            if c < m:
                within = (square[begin + m] - square[begin] - c * mean * mean) / (c - 1.0)
                excess += (1.0 / c - 1.0 / m) * within
        else:
            squares += difference * difference
            off += excess
            terms += 1
    return squares, off, terms
