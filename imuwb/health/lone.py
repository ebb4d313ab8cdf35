"""Finds lone samples. A lone sample differs from both neighbours by far more than usual, and by more than a few steps of the sensor."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats, Integers, blocks_of
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
    some = np.arange(0, values.size - 2, max((values.size - 2) // LOOKED_AT, 1))
    usual = float(np.median(np.abs(values[some + 1] - values[some]))) * CONSISTENT
    usual = max(usual, float(np.ptp(values[:LOOKED_AT])) * SMALLEST)
    limit = max(STRUCK * usual, (STEPS - 0.5) * channel.step)
    off = _Off(values, channel.breaks)
    far = np.concatenate([rows.start + np.flatnonzero(off[rows] > limit) for rows in blocks_of(values.size - 2)])
    # The neighbours of a struck sample also differ from their own neighbours: the lone sample is the largest of the three.
    rows = np.array([k for k in far[:MOST] if _stands_out(off, int(k))], np.int64)
    lone = 0 < rows.size < max(FEW * values.size, LEAST)
    return Lone(rows + 1, np.array([off[k : k + 1][0] for k in rows])) if lone else nothing


class _Off:
    """How far each sample is from its nearer neighbour, (n - 2,), a part at a time; the first and the last sample are left out.

    The smaller of the two differences counts, because a step differs from one neighbour only. The result is 0 where the two
    differences have different signs.
    """

    def __init__(self, values: Floats, breaks: Integers) -> None:
        self.values = values
        self.size = values.size - 2
        self._broken = np.unique(np.concatenate([breaks - 2, breaks - 1]).clip(0, self.size - 1))

    def __getitem__(self, rows: slice) -> Floats:
        first, end = rows.start, min(rows.stop, self.size)
        values = self.values[first : end + 2]
        before, after = values[1:-1] - values[:-2], values[1:-1] - values[2:]
        off = np.where(before * after > 0, np.minimum(np.abs(before), np.abs(after)), 0.0)
        broken = slice(*np.searchsorted(self._broken, (first, end)))
        off[self._broken[broken] - first] = 0.0  # beside a gap a neighbour is missing
        return off

    def changes(self, first: int, end: int) -> Floats:
        """Return the changes from some samples to the next ones."""
        return np.abs(np.diff(self.values[max(first, 0) : min(end, self.size) + 1]))


def _stands_out(off: _Off, k: int) -> bool:
    """Return whether a sample differs by more than its neighbours do, and by far more than the samples around it change."""
    # Where a motion begins, one side is quiet, so the larger change of the two sides counts.
    around = max(
        np.median(off.changes(k - AROUND, k)) if k else 0.0,
        np.median(off.changes(k + 2, k + 2 + AROUND)) if k + 2 < off.size else 0.0,
    )
    near = off[max(k - 1, 0) : k + 2]
    own = near[min(k, 1)]
    return bool(own >= near.max() and own > STRUCK / 2 * around)
