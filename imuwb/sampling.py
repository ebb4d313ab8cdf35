"""The clock of a stream: its interval, its gaps, its jitter.

Stamps may be rounded (to milliseconds, for example), late, or missing. The median step would
then be wrong by tens of per cent, and so would gaps that are found as steps longer than the median.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Integers, blocks_of, step_blocks, step_range
from imuwb.texts import counted
from imuwb.units import SECOND

SPAN = 100  #: steps; over this number of steps rounding averages out
GAP = 1.5  #: intervals; a longer step misses at least one sample
UNEVEN = 1.8  #: intervals; a step up to this may belong to an uneven clock that misses no sample
ENDS = 0.05  #: share of the sums of SPAN steps, at each end, that may contain gaps
EVEN = 0.01  #: intervals; a step that differs from the interval by less is not rounded
SCATTERED, FAR = (
    0.25,
    3.0,
)  #: intervals; where steps scatter by more than the first, only steps of so many long ones are gaps
ROUNDED = 0.9  #: share of steps near the interval; with a smaller share the stamps are rounded


@dataclass(frozen=True, slots=True)
class Sampling:
    """The clock of one stream."""

    interval: float  #: s, without the gaps; nan for fewer than two samples
    gaps: tuple[tuple[float, float], ...]  #: (start from the first row, length), s
    breaks: tuple[int, ...]  #: rows before which samples are missing
    jitter: float  #: standard deviation of the steps between gaps, in intervals

    @property
    def rate(self) -> float | None:
        """Samples per second; None for fewer than two samples."""
        return None if np.isnan(self.interval) else 1 / self.interval

    @property
    def missing(self) -> float:
        """Seconds without samples."""
        return sum(length for _, length in self.gaps) - len(self.gaps) * self.interval

    def __repr__(self) -> str:
        """Return rate, gaps and jitter in a line."""
        longest = f" (longest {max(length for _, length in self.gaps):.3g} s)" if self.gaps else ""
        return f"{self.rate or 0:.4g} Hz, {counted(len(self.gaps), 'gap')}{longest}, jitter {self.jitter:.2g} intervals"


def longest_part(breaks: Iterable[int], last: int, first: int = 0) -> slice:
    """Return the longest part of rows without a break; of equal parts the first.

    Args:
        breaks: rising rows before which samples are missing.
        last: the row after the last one.
        first: the first row.
    """
    edges = np.array([first, *(row for row in breaks if first < row < last), max(first, last)])
    part = int(np.argmax(np.diff(edges)))
    return slice(int(edges[part]), int(edges[part + 1]))


def runs(inside: Booleans) -> tuple[Integers, Integers]:
    """Return the first row and the length of each run of True, (k,) each."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]])))
    return edges[::2], edges[1::2] - edges[::2]


def nearest(time: Integers, at: Integers) -> Integers:
    """Return for each time the row whose time is nearest to it; of two rows that are equally near, the first.

    Args:
        time: (n,)
        at: (m,) times of the rows, rising.
    """
    after = np.searchsorted(at, time).clip(0, at.size - 1)
    before = (after - 1).clip(0)
    return np.where(np.abs(at[after] - time) < np.abs(time - at[before]), after, before)


def _scatter(time: Integers, mean: float) -> float:
    """Return the standard deviation of the steps about their mean."""
    squares = sum(float(np.square(steps - mean).sum()) for steps in step_blocks(time))
    return float((squares / (time.size - 1)) ** 0.5)


def sampling(time: Integers) -> Sampling:
    """Return the clock of a stream.

    Args:
        time: (n,) ns, rising.
    """
    if time.size < 2:  # noqa: PLR2004 - a step needs two rows
        return Sampling(float("nan"), (), (), 0.0)
    mean = float(time[-1] - time[0]) / (time.size - 1)
    shortest, longest = step_range(time)
    if longest <= GAP * shortest or _is_complete(time, float(longest), mean):
        return Sampling(mean / SECOND, (), (), _scatter(time, mean) / mean)
    steps = np.diff(time)
    interval, rounding = _interval(time, steps)
    long = steps > GAP * interval + rounding
    usual = steps[~long]
    if (
        not rounding and usual.size and usual.std() > SCATTERED * usual.mean()
    ):  # an uneven clock, which has no usual step
        long = steps > FAR * float(np.quantile(steps, 1 - ENDS))
        usual = steps[~long]
    breaks = np.flatnonzero(long) + 1
    mean = float(usual.mean()) if usual.size else float(steps.mean())
    gaps = tuple((float(time[i - 1] - time[0]) / SECOND, float(steps[i - 1]) / SECOND) for i in breaks)
    jitter = float(usual.std()) / mean if usual.size else 0.0
    return Sampling(mean / SECOND, gaps, tuple(int(i) for i in breaks), jitter)


def _is_complete(time: Integers, longest: float, mean: float) -> bool:
    """Return whether all spans of a number of samples last equally long; a missing sample prolongs them by an interval."""
    span = min(SPAN, (time.size - 1) // 2) // 2 * 2  # even: short and long steps may alternate
    if not span or longest > UNEVEN * mean:
        return False
    low, high = np.iinfo(np.int64).max, np.iinfo(np.int64).min
    for rows in blocks_of(time.size - span):
        sums = time[rows.start + span : rows.stop + span] - time[rows]
        low, high = min(low, int(sums.min())), max(high, int(sums.max()))
    return float(high - low) < mean / 2


def _interval(time: Integers, steps: Integers) -> tuple[float, float]:
    """Return the interval, and by how much rounding may prolong a step, in ns.

    The steps of an even but rounded clock differ, while sums of many of them hardly do. Missing samples scatter the sums too.
    """
    usual = float(np.median(steps))
    grain = float(np.gcd.reduce(steps))
    if time.size > 4 * SPAN:
        sums = time[SPAN:] - time[:-SPAN]
        low, middle, high = np.quantile(sums, (ENDS, 0.5, 1 - ENDS))
        if high - low <= grain:
            interval = float(middle) / SPAN
            near = float(np.mean(np.abs(steps - interval) < EVEN * interval))
            return interval, grain if near < ROUNDED else 0.0
    return usual, 0.0
