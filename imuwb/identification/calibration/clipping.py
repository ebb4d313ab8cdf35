"""A test of whether an axis is at the end of its range."""

from collections.abc import Sequence

import numpy as np

from imuwb.arrays import Booleans, Floats

SHARE = 0.2  #: share of a stretch's samples; a clipped axis has a larger share at its largest or smallest value
FINE = 8  #: least number of different values in a stretch; with fewer, a sensor is too coarse to be judged


def clipped(stretches: Sequence[Floats]) -> Booleans:
    """Return which axes of which stretches are clipped, (P, 3).

    An axis is clipped in a stretch if more than a fifth of the samples have one extreme value, and the stretch has fewer
    different values than the median stretch. An axis that shows one value only, its largest, is clipped as well if another
    stretch has other values and another axis of the same stretch is noisy.

    Args:
        stretches: each (n, 3).
    """
    bad = np.zeros((len(stretches), 3), dtype=np.bool_)
    for axis in range(3):
        counts = [np.unique(s[:, axis], return_counts=True)[1] for s in stretches]
        usual = float(np.median([c.size for c in counts]))
        for p, count in enumerate(counts):
            at_end = max(int(count[0]), int(count[-1])) > SHARE * count.sum()
            bad[p, axis] = at_end and count.size < usual and usual >= FINE
    for p, s in enumerate(stretches):
        values = [np.unique(column).size for column in s.T]
        for axis in np.flatnonzero((np.array(values) == 1) & (max(values) >= FINE)):
            elsewhere = np.abs([other[0, axis] for other in stretches])
            bad[p, axis] |= elsewhere[p] == elsewhere.max() and any(
                (other[:, axis] != s[0, axis]).any() for other in stretches
            )
    return bad
