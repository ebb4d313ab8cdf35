"""Finds lone samples. A lone sample differs from both neighbours by far more than usual, and by more than a few steps of the sensor."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.health.channel import LOOKED_AT, Channel

STRUCK = 40.0  #: times the usual change; a lone sample differs by more from both neighbours
STEPS = 5.0  #: steps (LSB) of the sensor; a lone sample differs by at least as much from both neighbours
AROUND = 12  #: samples on each side of a lone sample that show the usual change there
MOST = 10_000  #: largest number of candidates that are examined
FEW = 0.002  #: share of lone samples; a larger share shows motion
LEAST = 3  #: number of samples; fewer lone samples than this are never taken as motion
SLOWEST = 20.0  #: Hz; at a lower rate, the samples do not show what happens between them
FEWEST = 100  #: samples; fewer samples do not show the usual change
CONSISTENT = 1.4826 / 2**0.5  #: sigma of normal samples over the median of their changes
SMALLEST = 1e-6  #: share of the range of the values; the usual change is at least this


@dataclass(frozen=True, eq=False, slots=True)
class Lone:
    """The lone samples of a channel."""

    rows: Integers  #: (k,)
    off: Floats  #: (k,) difference from the nearer neighbour, rad/s or m/s²

    def without(self, values: Floats) -> Floats:
        """Return the channel's values, with each lone sample replaced by the mean of its neighbours."""
        if not self.rows.size:
            return values
        mended = values.copy()
        mended[self.rows] = (values[self.rows - 1] + values[self.rows + 1]) / 2
        return mended


def lone_samples(channel: Channel) -> Lone:
    """Return the lone samples; nothing if the samples are too few, the rate is too low, or the lone samples are too many."""
    nothing = Lone(np.empty(0, np.int64), np.empty(0))
    values = channel.values
    if values.size < FEWEST or not 1 / channel.clock.interval >= SLOWEST:
        return nothing
    changes = np.abs(np.diff(values)[:-1])
    off = _off(values, channel.breaks)
    usual = float(np.median(changes[:: max(changes.size // LOOKED_AT, 1)])) * CONSISTENT
    usual = max(usual, float(np.ptp(values[:LOOKED_AT])) * SMALLEST)
    far = np.flatnonzero(off > max(STRUCK * usual, (STEPS - 0.5) * channel.step))
    # The neighbours of a struck sample also differ from their own neighbours: the lone sample is the largest of the three.
    rows = np.array([k for k in far[:MOST] if _stands_out(off, changes, int(k))], np.int64)
    return Lone(rows + 1, off[rows]) if 0 < rows.size < max(FEW * values.size, LEAST) else nothing


def _off(values: Floats, breaks: Integers) -> Floats:
    """Return how far each sample is from its nearer neighbour, (n - 2,); the first and the last sample are left out.

    The smaller of the two differences counts, because a step differs from one neighbour only. The result is 0 where the two
    differences have different signs.
    """
    before, after = values[1:-1] - values[:-2], values[1:-1] - values[2:]
    off = np.where(before * after > 0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    off[np.concatenate([breaks - 2, breaks - 1]).clip(0, off.size - 1)] = 0.0  # beside a gap a neighbour is missing
    return off


def _stands_out(off: Floats, changes: Floats, k: int) -> bool:
    """Return whether a sample differs by more than its neighbours do, and by far more than the samples around it change."""
    # Where a motion begins, one side is quiet, so the larger change of the two sides counts.
    around = max(
        np.median(changes[max(k - AROUND, 0) : k]) if k else 0.0,
        np.median(changes[k + 2 : k + 2 + AROUND]) if k + 2 < changes.size else 0.0,
    )
    return bool(off[k] >= off[max(k - 1, 0) : k + 2].max() and off[k] > STRUCK / 2 * around)
