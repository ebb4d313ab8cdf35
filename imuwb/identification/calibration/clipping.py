"""Stretches in which an axis stands at the end of its range."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

SHARE = 0.2  #: of the samples at one extreme value
FINE = 8  #: values of a stretch that is not clipped


def clipped(stretches: Sequence[NDArray[np.float64]]) -> NDArray[np.bool_]:
    """Return which axes of which stretches are clipped, (P, 3): many samples at one extreme, where others take many values.

    An axis that shows nothing but its largest value, where another stretch differs and another axis is noisy, is clipped too.

    Args:
        stretches: each (n, 3).
    """
    found = np.zeros((len(stretches), 3), dtype=np.bool_)
    for axis in range(3):
        counts = [np.unique(s[:, axis], return_counts=True)[1] for s in stretches]
        usual = float(np.median([c.size for c in counts]))
        for p, count in enumerate(counts):
            at_end = max(int(count[0]), int(count[-1])) > SHARE * count.sum()
            found[p, axis] = at_end and count.size < usual and usual >= FINE
    for p, s in enumerate(stretches):
        values = [np.unique(column).size for column in s.T]
        for axis in np.flatnonzero((np.array(values) == 1) & (max(values) >= FINE)):
            elsewhere = np.abs([other[0, axis] for other in stretches])
            found[p, axis] |= elsewhere[p] == elsewhere.max() and any(
                (other[:, axis] != s[0, axis]).any() for other in stretches
            )
    return found
