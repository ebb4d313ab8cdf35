"""The band that samples can show: below what the record's length, above what the spacing tells apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

from imuwb.identification.lssa.trigonometric import Grid, summit, sums

if TYPE_CHECKING:
    from imuwb.identification.lssa.spectrum import Adjusted
    from imuwb.identification.lssa.trigonometric import Lattice

MIRRORED = 0.5  #: share of a line's power that another frequency shows, from which on it is the same line
FAR = 8.0  #: usual rates, up to which mirrors are looked for
LOOKED_AT = 1 << 15  #: samples, which are enough to see them


@dataclass(frozen=True, slots=True)
class UsableBand:
    """Frequencies that a line can be told to have."""

    lowest: float  #: Hz, one cycle in the record
    highest: float  #: Hz
    mirror: (
        float | None
    )  #: Hz; a line f shows at this less f as well; None: up to eight times the usual rate there is none


def usable_band(adjusted: Adjusted) -> UsableBand:
    """Return the band of a series' spacing, by its spectral window (Deeming 1975).

    Args:
        adjusted: the series.
    """
    time, interval = adjusted.time, adjusted.interval
    lowest = 1 / float(time[-1])
    if adjusted.lattice is not None:
        mirror = _within(adjusted.lattice)
        return UsableBand(lowest, mirror / 2, mirror)
    time = time[: min(time.size, LOOKED_AT)]
    step = 0.5 / float(time[-1])
    count = int(FAR / interval / step)
    window = np.abs(sums(time, None, np.ones((1, time.size)), Grid(step, count))[0]) ** 2 / time.size**2
    begin = int(0.25 / interval / step)  # the window's own peak is behind
    high = np.flatnonzero(window[begin:] > MIRRORED)
    if not high.size:
        return UsableBand(lowest, FAR / interval / 2, None)
    top = begin + int(high[0])
    while top + 1 < count and window[top + 1] > window[top]:
        top += 1
    mirror = (top + 1 + summit(window, top)) * step
    return UsableBand(lowest, mirror / 2, mirror)


def _within(lattice: Lattice) -> float:
    """Return the mirror of a lattice: its rate, or less where most of its points are missing in turns."""
    index = lattice.index[:LOOKED_AT]
    length = 2 * fft.next_fast_len(2 * (int(index[-1]) + 1), real=True)
    window = np.abs(fft.rfft(np.bincount(index, minlength=length).astype(float))) ** 2 / index.size**2
    begin = length // 4
    high = np.flatnonzero(window[begin:] > MIRRORED)
    if not high.size:
        return 1 / lattice.interval
    top = begin + int(high[0])
    while top + 1 < window.size and window[top + 1] > window[top]:
        top += 1
    return top / (length * lattice.interval)
