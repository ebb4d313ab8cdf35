"""The band of frequencies that the samples can show: limited by the record's length and by the spacing of the samples."""

from dataclasses import dataclass

import numpy as np
from scipy import fft

from imuwb.arrays import Floats
from imuwb.identification.lssa.spectrum import Adjusted
from imuwb.identification.lssa.trigonometric import Grid, Lattice, summit, sums

MIRRORED = 0.5  #: share of a line's power at another frequency, from which both frequencies show the same line
FAR = 8.0  #: usual sampling rates, up to which mirrors are searched
ENOUGH = 1 << 15  #: samples that are enough to find mirrors


@dataclass(frozen=True, slots=True)
class UsableBand:
    """The frequencies that can be distinguished."""

    lowest: float  #: Hz, one cycle over the record
    highest: float  #: Hz
    mirror: float | None  #: Hz; a line at f also shows at mirror - f; None: no mirror up to eight usual sampling rates


def usable_band(adjusted: Adjusted) -> UsableBand:
    """Return the usable band of a series, from its spectral window (Deeming 1975).

    Args:
        adjusted: the series.
    """
    time, interval = adjusted.time, adjusted.interval
    lowest = 1 / float(time[-1])
    if adjusted.lattice is not None:
        mirror = _mirror_of(adjusted.lattice)
        return UsableBand(lowest, mirror / 2, mirror)
    time = time[: min(time.size, ENOUGH)]
    step = 0.5 / float(time[-1])
    count = int(FAR / interval / step)
    window = np.abs(sums(time, None, np.ones((1, time.size)), Grid(step, count))[0]) ** 2 / time.size**2
    top = _first_top(window, int(0.25 / interval / step))
    if top is None:
        return UsableBand(lowest, FAR / interval / 2, None)
    mirror = (top + 1 + summit(window, top)) * step
    return UsableBand(lowest, mirror / 2, mirror)


def _mirror_of(lattice: Lattice) -> float:
    """Return the mirror of a lattice: its rate, or less if most points are missing in a regular pattern."""
    index = lattice.index[:ENOUGH]
    length = 2 * fft.next_fast_len(2 * (int(index[-1]) + 1), real=True)
    window = np.abs(fft.rfft(np.bincount(index, minlength=length).astype(float))) ** 2 / index.size**2
    top = _first_top(window, length // 4)
    return 1 / lattice.interval if top is None else top / (length * lattice.interval)


def _first_top(window: Floats, begin: int) -> int | None:
    """Return the index of the first high maximum from ``begin``, which is above the window's own peak; None for none."""
    high = np.flatnonzero(window[begin:] > MIRRORED)
    if not high.size:
        return None
    top = begin + int(high[0])
    while top + 1 < window.size and window[top + 1] > window[top]:
        top += 1
    return top
