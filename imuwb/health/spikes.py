"""Lone samples: off both neighbours by far more than samples change, and by more than a few steps of the sensor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.health.channel import LOOKED_AT, shown
from imuwb.health.fault import Fault

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from imuwb.health.channel import Channel
    from imuwb.health.motion import Segment
    from imuwb.log import Floats

STRUCK = 40.0  #: times the usual change, of a lone sample off both neighbours
STEPS = 5.0  #: of the sensor (LSB), by which it is off at least
AROUND = 12  #: samples on each side of a lone one
MOST = 10_000  #: samples that are looked at as lone ones
FEW = 0.002  #: share of lone samples, above which they are motion
SLOWEST = 20.0  #: Hz; between slower samples anything may happen
FEWEST = 100  #: samples; of fewer nobody knows what is usual


@dataclass(frozen=True, eq=False, slots=True)
class Lone:
    """The lone samples of a channel."""

    rows: NDArray[np.int64]  #: (k,)
    off: Floats  #: (k,) by how much, rad/s or m/s²

    def without(self, values: Floats) -> Floats:
        """Return the channel's values with lone ones between their neighbours."""
        if not self.rows.size:
            return values
        mended = values.copy()
        mended[self.rows] = (values[self.rows - 1] + values[self.rows + 1]) / 2
        return mended


def lone_samples(channel: Channel) -> Lone:
    """Return the lone samples; none where samples are too few or too slow to tell, or where it happens all the time."""
    nothing = Lone(np.empty(0, np.int64), np.empty(0))
    values, breaks = channel.values, channel.breaks
    if values.size < FEWEST or not 1 / channel.clock.interval >= SLOWEST:
        return nothing
    # A step is off one neighbour alone: the smaller difference counts, and none where the two have different signs.
    before, behind = values[1:-1] - values[:-2], values[1:-1] - values[2:]
    off = np.where(before * behind > 0, np.minimum(np.abs(before), np.abs(behind)), 0.0)
    off[np.concatenate([breaks - 2, breaks - 1]).clip(0, off.size - 1)] = 0.0  # beside a gap there are no neighbours
    changes = np.abs(before)
    usual = float(np.median(changes[:: max(changes.size // LOOKED_AT, 1)])) * 1.4826 / 2**0.5
    usual = max(usual, float(np.ptp(values[:LOOKED_AT])) * 1e-6)
    far = np.flatnonzero(off > max(STRUCK * usual, (STEPS - 0.5) * channel.step))
    # Of one struck sample both neighbours are off as well: it is the largest of the three.
    rows = np.array([k for k in far[:MOST] if _stands_out(off, changes, int(k))], np.int64)
    return Lone(rows + 1, off[rows]) if 0 < rows.size < max(FEW * values.size, 3) else nothing


def spikes(channel: Channel, lone: Lone, parts: Sequence[Segment]) -> Iterator[Fault]:
    """Yield the lone samples of a channel while it is still: those of a motion may well be part of it."""
    at = channel.time[lone.rows]
    still = np.zeros(at.size, dtype=bool)
    for part in parts:
        if not part.moving:
            still |= (at >= part.start) & (at <= part.end)
    if still.any():
        what = f"lone samples off by up to {shown(channel.axis, float(lone.off[still].max()))}"
        yield Fault(channel.where, what, "warning", int(still.sum()), float(at[still][0]),
                    consequence="each shows in every averaging time")  # fmt: skip


def _stands_out(off: Floats, changes: Floats, k: int) -> bool:
    """Return whether a sample stands out of those around it too, and more than its neighbours: motion shakes many."""
    # Where a motion begins, one side of it is quiet.
    around = max(
        np.median(changes[max(k - AROUND, 0) : k]) if k else 0.0,
        np.median(changes[k + 2 : k + 2 + AROUND]) if k + 2 < changes.size else 0.0,
    )
    return bool(off[k] >= off[max(k - 1, 0) : k + 2].max() and off[k] > STRUCK / 2 * around)
