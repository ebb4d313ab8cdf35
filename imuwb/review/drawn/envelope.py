"""A long series as the extremes of short spans: no peak is lost, and the series is drawn fast."""

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.log import SECOND

SPANS = 700  #: about one a pixel of a chart that has half a screen
GAP_STEPS = 10  #: a longer step than this many median steps is a gap
SHORTEST_GAP = SECOND  #: ns


def envelope(time: Integers, values: Floats, spans: int = SPANS) -> tuple[Integers, Floats]:
    """Return the extremes of a series; a gap becomes a row of NaN, which is drawn as a break.

    Args:
        time: (n,) ns.
        values: (n, k).
        spans: number of spans.
    """
    time, values = extremes(time, values, spans)
    steps = np.diff(time)
    gaps = np.flatnonzero(steps > max(GAP_STEPS * np.median(steps), SHORTEST_GAP)) if steps.size else steps
    return np.insert(time, gaps + 1, time[gaps] + 1), np.insert(values, gaps + 1, np.nan, axis=0)


def extremes(time: Integers, values: Floats, spans: int = SPANS) -> tuple[Integers, Floats]:
    """Return a series that alternates between the smallest and the largest value of each span.

    A series of at most 2 x ``spans`` rows stays as it is. Spans have equal numbers of rows. Arguments are those of ``envelope``.
    """
    if time.size <= 2 * spans:
        return time, values
    size = -(-time.size // spans)
    starts = np.arange(0, time.size, size)
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    middles = np.minimum(starts + size // 2, time.size - 1)
    time = np.stack([time[starts], time[middles]], axis=1).ravel()
    values = np.stack([low, high], axis=1).reshape(-1, values.shape[1])
    later = np.concatenate([[True], np.diff(time) > 0])
    return time[later], values[later]
