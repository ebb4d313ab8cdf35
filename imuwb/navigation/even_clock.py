"""The even clock that a sensor samples with, from stamps with jitter and gaps."""

import numpy as np

from imuwb.arrays import Floats, Integers

FIRST = 32  #: first samples, over which the median interval alone gives the clock
EVEN = 0.6  #: intervals; a stamp that differs by less from an even clock lies on it


def even_clock(time: Floats) -> tuple[Floats, float, Integers]:
    """Return the stamps of an even clock, its interval, and the position of each sample among those stamps.

    Each sample takes the nearest stamp of the even clock, and no two samples take the same. Where the clock drifts too much
    to be even, every step is rounded to a whole number of intervals instead.

    Args:
        time: (n,) s, rising.
    """
    index, start, dt = _line(time)
    start, index = start + dt * index[0], index - index[0]
    if np.abs(time - (start + dt * index)).max() < EVEN * dt:
        return start + dt * np.arange(index[-1] + 1), dt, index
    steps = np.diff(time)
    dt = float(np.median(steps))
    index = np.concatenate([[0], np.cumsum(np.maximum(np.rint(steps / dt), 1))]).astype(np.int64)
    return np.interp(np.arange(index[-1] + 1), index, time), dt, index


def _line(time: Floats) -> tuple[Integers, float, float]:
    """Return the numbers of the samples, and start and interval of the straight line through their stamps."""
    count = min(time.size - 1, FIRST)
    dt = float(np.median(time[count:] - time[:-count])) / count  # many steps share the jitter, and gaps are few
    start = float(np.median(time[:count] - dt * np.arange(count)))
    while True:
        index = _rising(np.rint((time[:count] - start) / dt).astype(np.int64))
        centred, later = index - index.mean(), time[:count] - time[0]
        dt = float(centred @ later / (centred @ centred))
        start = float(time[0] + later.mean() - dt * index.mean())
        if count == time.size:
            return index, start, dt
        # A line through some samples also numbers as many samples after them.
        count = min(2 * count, time.size)


def _rising(index: Integers) -> Integers:
    """Return whole numbers that rise by at least one, none of them smaller than those given."""
    count = np.arange(index.size)
    return np.maximum.accumulate(index - count) + count
