"""Which of many outages overlap."""

import numpy as np
from numpy.typing import ArrayLike

from imuwb.arrays import Floats, Integers

ROUNDING = 1e-6  #: s; outages that overlap by less do not overlap


def without_overlap(start: ArrayLike, duration: ArrayLike) -> Integers:
    """Return the outages to keep so that no two of them overlap: each one that overlaps none of those kept before it.

    If the outages are in order of time and have one duration, no other choice keeps more.

    Args:
        start: (s,) s, in the order in which the outages are tried.
        duration: s, of all outages, or (s,) of each.
    """
    begin = np.asarray(start, dtype=np.float64)
    end = begin + np.asarray(duration, dtype=np.float64)
    kept = np.zeros(begin.size, dtype=bool)
    for i in range(begin.size):
        kept[i] = not (kept & (begin[i] < end - ROUNDING) & (end[i] > begin + ROUNDING)).any()
    return np.flatnonzero(kept)


def effective_count(start: Floats, duration: float) -> int:
    """Return the largest number of outages of which no two overlap."""
    return without_overlap(np.sort(start), duration).size


def block_length(start: Floats, duration: float) -> int:
    """Return the largest number of outages that begin within the duration of one: the length of a block of neighbours."""
    ordered = np.sort(start)
    after = np.searchsorted(ordered, ordered + duration - ROUNDING)
    return int((after - np.arange(ordered.size)).max(initial=1))
