"""A long series as the extremes of short spans: no peak is lost, and it draws at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import SECOND

if TYPE_CHECKING:
    from numpy.typing import NDArray

SPANS = 2000


def envelope(
    time: NDArray[np.int64], values: NDArray[np.float64], spans: int = SPANS
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return a series that zigzags between the least and the greatest value of each span.

    Series of up to 2 x ``spans`` rows come back as they are. Spans hold equal numbers of rows; a gap in
    time longer than a span becomes a row of NaN, which draws as a break.

    Args:
        time: (n,) ns.
        values: (n, k).
        spans: how many.
    """
    if time.size > 2 * spans:
        size = -(-time.size // spans)
        starts = np.arange(0, time.size, size)
        low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
        middles = np.minimum(starts + size // 2, time.size - 1)
        time = np.stack([time[starts], time[middles]], axis=1).ravel()
        values = np.stack([low, high], axis=1).reshape(-1, values.shape[1])
        keep = np.concatenate([[True], np.diff(time) > 0])
        time, values = time[keep], values[keep]
    steps = np.diff(time)
    breaks = np.flatnonzero(steps > max(10 * np.median(steps), SECOND)) if steps.size else np.empty(0, np.int64)
    return (
        np.insert(time, breaks + 1, time[breaks] + 1),
        np.insert(values, breaks + 1, np.nan, axis=0),
    )
