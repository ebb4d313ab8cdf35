"""How evenly a stream is sampled: its interval, its gaps, its jitter.

Stamps are rounded (to milliseconds, say), late, and missing; an interval taken from the median step, or a
gap taken to be any step above it, is then off by tens of per cent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import SECOND

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

SPAN = 100  #: steps over which rounding averages out
GAP = 1.5  #: intervals: from here on at least one sample is missing
UNEVEN = 1.8  #: intervals: up to here a step may be one of an uneven clock that leaves none out


@dataclass(frozen=True, slots=True)
class Sampling:
    """The clock of one stream."""

    interval: float  #: s, gaps left out; nan for fewer than two samples
    gaps: tuple[tuple[float, float], ...]  #: (start from the first row, length), s
    breaks: tuple[int, ...]  #: rows before which samples are missing
    jitter: float  #: standard deviation of the steps within the parts without gaps, over the interval

    @property
    def rate(self) -> float | None:
        """Samples per second; None for fewer than two samples."""
        return None if np.isnan(self.interval) else 1 / self.interval

    @property
    def missing(self) -> float:
        """Seconds without samples."""
        return sum(length for _, length in self.gaps) - len(self.gaps) * self.interval


def longest_part(breaks: Iterable[int], last: int, first: int = 0) -> slice:
    """Return the longest part of rows without a break, the first of equals.

    Args:
        breaks: rows before which samples are missing, rising.
        last: the row after the last one.
        first: the first row.
    """
    edges = np.array([first, *(row for row in breaks if first < row < last), max(first, last)])
    at = int(np.argmax(np.diff(edges)))
    return slice(int(edges[at]), int(edges[at + 1]))


def sampling(time: NDArray[np.int64]) -> Sampling:
    """Return how a stream is sampled.

    Args:
        time: (n,) ns, rising.
    """
    if time.size < 2:  # noqa: PLR2004 - a step needs two rows
        return Sampling(float("nan"), (), (), 0.0)
    steps = np.diff(time)
    mean = float(time[-1] - time[0]) / steps.size
    # No step can be a gap, however stamps are rounded; or the steps differ, but not the number of samples.
    if steps.max() <= GAP * steps.min() or _is_complete(time, float(steps.max()), mean):
        return Sampling(mean / SECOND, (), (), float(steps.std()) / mean)
    interval, rounding = _interval(time, steps)
    long = steps > GAP * interval + rounding
    breaks = np.flatnonzero(long) + 1
    usual = steps[~long]
    mean = float(usual.mean()) if usual.size else float(steps.mean())
    gaps = tuple((float(time[i - 1] - time[0]) / SECOND, float(steps[i - 1]) / SECOND) for i in breaks)
    jitter = float(usual.std()) / mean if usual.size else 0.0
    return Sampling(mean / SECOND, gaps, tuple(int(i) for i in breaks), jitter)


def _is_complete(time: NDArray[np.int64], longest: float, mean: float) -> bool:
    """Return whether as many samples come in any span as in any other: a missing one makes a sum longer by an interval."""
    span = min(SPAN, (time.size - 1) // 2) // 2 * 2  # even: steps that take turns add up to the same
    if not span or longest > UNEVEN * mean:
        return False
    sums = time[span:] - time[:-span]
    return float(sums.max() - sums.min()) < mean / 2


def _interval(time: NDArray[np.int64], steps: NDArray[np.int64]) -> tuple[float, float]:
    """Return the interval, and how far rounding may stretch a step, in ns.

    Where stamps are an even clock rounded down, steps differ but sums over many of them hardly do; where
    samples are missing, the sums scatter as well.
    """
    usual = float(np.median(steps))
    grain = float(np.gcd.reduce(steps))
    if time.size > 4 * SPAN:
        sums = time[SPAN:] - time[:-SPAN]
        low, middle, high = np.quantile(sums, (0.05, 0.5, 0.95))
        if high - low <= grain:
            even = float(middle) / SPAN
            rounded = float(np.mean(np.abs(steps - even) < 0.01 * even)) < 0.9  # noqa: PLR2004 - else nothing is rounded
            return even, grain if rounded else 0.0
    return usual, 0.0
