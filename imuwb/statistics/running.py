"""Running medians and closed gaps of short series, without ``scipy.ndimage``, whose import takes a tenth of a second."""

from typing import Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from imuwb.arrays import Booleans, Floats

FEW = 1_000_000  #: numbers in all windows, up to which numpy is as fast
_PAD: dict[str, Literal["reflect", "edge"]] = {"mirror": "reflect", "nearest": "edge"}


def running_median(values: Floats, size: int, mode: Literal["mirror", "nearest"]) -> Floats:
    """Return the median of the ``size`` values around each value, as ``scipy.ndimage.median_filter`` does.

    Args:
        values: (n,) finite numbers.
        size: an odd number, at most n, or n + 1 for an even n.
        mode: how the series goes on beyond its ends.
    """
    if values.size > 1 and values.size * size <= FEW:
        padded = np.pad(values, size // 2, _PAD[mode])
        return np.median(sliding_window_view(padded, size), axis=1)
    from scipy import ndimage  # noqa: PLC0415 - slow to import

    return ndimage.median_filter(values, size, mode=mode)


def closed(rows: Booleans, reach: int) -> Booleans:
    """Return rows with their gaps of up to twice the reach closed, apart from rows within the reach of an end.

    This is a binary closing of as many iterations, with nothing beyond the ends.
    """
    wide = np.logical_or.reduce(sliding_window_view(np.pad(rows, reach), 2 * reach + 1), axis=1)
    return np.logical_and.reduce(sliding_window_view(np.pad(wide, reach), 2 * reach + 1), axis=1)
