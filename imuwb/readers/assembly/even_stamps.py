"""Gives even samples even times, where their stamps are times of arrival, or those of a coarse clock.

A sensor samples evenly; what a log states is often when the rows arrived (several at a time over a serial line or a radio), or
a clock that ticks more slowly than the sensor samples. Then single steps say nothing, while counts over durations do. With a
period p and m_k the number of sample k, the stamps T_k are explained if T_k - p m_k is bounded. Where samples are lost, this
residual rises by a whole number of periods and stays there; where rows are only late, it returns. So the lower edge of the
residual (the upper one for a clock that ticks) shows the losses, and it is the line through the times of sampling.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers, step_range
from imuwb.sampling import runs
from imuwb.units import SECOND

Cause = Literal["arrival", "coarse", "jitter"]

FEWEST = 40  #: rows; fewer do not show whether they are even
CALM = 0.05  #: share of the period; steps that scatter by less are left as they are
ENOUGH = 100_000  #: steps that are looked at for whether they scatter
PAUSE, PAUSES = 2.0 * SECOND, 20.0  #: ns, and periods; after a longer step, the recording begins again
SHORT = 0.5  #: share of the period; a shorter step is one within a burst
BATCH = 8  #: rows; bursts of so many rows, all of one size and with even steps, are batches of a sensor, with real gaps between
SHORTEST = 1e5  #: ns; a shorter step is one of arrival, apart from the usual ones
LARGE = 64  #: rows; so many rows do not arrive at once
#: Hz; rates that logs usually have, and the largest relative difference from them. Where the rows of bursts follow each other at no rate
#: of a sensor, while all rows have a usual one, the stamps are times of arrival.
USUAL_RATES = (
    10, 20, 25, 26, 30, 40, 50, 52, 60, 64, 75, 80, 100, 104, 119, 120, 125, 128, 150, 160, 200, 208, 238, 240, 250, 256, 300, 320, 400, 416,
    476, 500, 512, 600, 800, 833, 952, 1000, 1024, 1125, 1200, 1600, 1660, 1666, 2000, 2048, 3200, 3330, 4000, 4800, 6400, 6660, 8000, 32000,
)  # fmt: skip
NEAR_USUAL = 0.003
SAME, EVEN = 0.1, 0.02  #: largest relative scatter of the sizes of batches, and of the steps within them
BLOCK = 32  #: rows at least, in which an edge of the residual is looked for
BURSTS = 4  #: bursts at least, in such a block
STAYS = 4  #: blocks over which the residual must stay higher after a loss
ALIKE = 0.02  #: largest relative difference of these numbers from the whole duration
NEAR = 0.45  #: periods; steps that differ from a whole number of periods by less show the numbers of the samples
LATE = 0.3  #: quantile of the durations of equal counts that no loss prolongs
ROUNDS = 3  #: the period and the losses are found in turn, so often
CLEAR = 4.0  #: standard deviations of the edge; a rise of the residual by more is a loss
HALF = 0.5  #: periods; a loss is a larger rise
ONE_TICK = 1.5  #: the same for a clock that ticks once in several samples, which is off by up to one period itself
SHARP, OF_BURST = 0.35, 0.1  #: shares of a period, of a burst; samples whose edge scatters by more are not even
LEAST_BLOCKS, LARGER = 8, 4  #: blocks that a stream must have; factor by which blocks grow until the edge is sharp
LOST = 0.3  #: largest share of lost samples
STRAIGHT = 0.5  #: periods; if the edge is within so much of a straight line, the times are exactly even
KNOTS = 8  #: blocks between the knots of an edge that is not straight


@dataclass(frozen=True, eq=False, slots=True)
class EvenStamps:
    """Even times of samples."""

    time: Integers  #: (n,) ns, rising
    cause: Cause  #: why the stamps are not even
    scatter: float  #: s, standard deviation of the stamps about the times
    latest: float  #: s, largest difference of a stamp from its time
    lost: int  #: samples that are missing


def even_stamps(stamps: Integers, *, forced: bool = False) -> EvenStamps | None:
    """Return even times of samples; None if the stamps are even, or if they do not show that the samples are.

    Args:
        stamps: (n,) ns, not falling; rows with equal stamps are different samples.
        forced: the samples are even, as the user states; then batches have no gaps between them.
    """
    if stamps.size < FEWEST or (not forced and _is_even(stamps)):
        return None
    steps = np.diff(stamps)
    period = _usual_period(stamps, steps)
    if not period or (_is_calm(steps, period) and not forced):
        return None
    bursts = _Bursts.of(steps, period)
    parts = np.split(stamps, np.flatnonzero(steps > max(PAUSE, PAUSES * period, ONE_TICK * bursts.grain)) + 1)
    if bursts.are_batches and not forced:
        return None
    found = [_even_part(part, period, bursts, forced=forced) for part in parts]
    whole = [part for part in found if part is not None]
    time = np.concatenate([part.time for part in whole]) if len(whole) == len(found) else stamps[:0]
    # Times that run into those of the next part show stamps that are in no order.
    if not time.size or np.diff(time).min() <= 0:
        return None
    off = stamps - time
    latest = float(np.abs(off).max())
    if latest <= CALM * period and steps.min() > 0:
        return None
    return EvenStamps(time, bursts.cause, float(off.std()) / SECOND, latest / SECOND, sum(part.lost for part in whole))


@dataclass(frozen=True, slots=True)
class Batches:
    """Bursts that are taken as batches of a sensor's own clock, although they may be arrivals of even samples."""

    rows: int  #: in a batch
    rate: float  #: Hz, within a batch
    even_rate: float  #: Hz, if the samples are even


def batches_of(stamps: Integers) -> Batches | None:
    """Return the batches that ``even_stamps`` leaves as they are; None without such.

    Args:
        stamps: (n,) ns, not falling.
    """
    if stamps.size < FEWEST or _is_even(stamps):
        return None
    steps = np.diff(stamps)
    if SHORT * steps.max() <= steps.min() or not (period := _usual_period(stamps, steps)):
        return None
    bursts = _Bursts.of(steps, period)
    inner = float(np.median(steps[steps < SHORT * period])) if bursts.are_batches else 0.0
    return Batches(bursts.rows, SECOND / inner, SECOND / period) if inner else None


def spread_stamps(stamps: Integers) -> Integers:
    """Return rising times: rows with equal stamps are spread evenly over the time up to the next stamp.

    Args:
        stamps: (n,) ns, not falling.
    """
    first, groups, counts = np.unique(stamps, return_inverse=True, return_counts=True)
    usual = np.median(np.diff(first)) if first.size > 1 else SECOND
    room = np.append(np.diff(first), int(usual))
    begin = np.cumsum(counts) - counts
    within = np.arange(stamps.size) - begin[groups]
    spread = stamps + (within * (np.minimum(room, usual) / counts)[groups]).astype(np.int64)
    return np.maximum.accumulate(spread - np.arange(stamps.size)) + np.arange(stamps.size)


def _is_even(stamps: Integers) -> bool:
    """Return whether all steps are alike, as in nearly all logs; an array of all steps would take the memory of the stamps."""
    shortest, longest = step_range(stamps)
    return shortest > 0 and longest - shortest <= CALM * float(stamps[-1] - stamps[0]) / (stamps.size - 1)


def _usual_period(stamps: Integers, steps: Integers) -> float:
    """Return the duration of a sample, ns, from counts of rows over durations; 0: all stamps are equal."""
    mean = float(stamps[-1] - stamps[0]) / steps.size
    if float(steps.max() - steps.min()) <= CALM * mean:
        return mean  # nearly all logs
    bursts = _Bursts.of(steps, mean)
    count = min(max(BLOCK, BURSTS * bursts.rows), stamps.size // 2)
    durations = stamps[count:] - stamps[:-count]
    if bursts.grain:  # ticks are right on average only
        usual = float(durations[durations <= np.median(durations) + 2 * bursts.grain].mean())
    else:
        usual = float(np.quantile(durations, LATE))
    return usual / count or mean


def _is_calm(steps: Integers, period: float) -> bool:
    """Return whether nearly all steps are one period."""
    if steps.min() <= 0:
        return False
    # numpy's quantiles import its masked arrays, which take longer than a small log; most logs need no other quantile.
    some = np.sort(steps[:: steps.size // ENOUGH * 2 + 1])
    low, middle, high = (int(some[round(share * (some.size - 1))]) for share in (CALM, 0.5, 1 - CALM))
    return bool(high - low <= CALM * period and abs(middle - period) <= CALM * period)


@dataclass(frozen=True, slots=True)
class _Bursts:
    """How rows follow each other."""

    rows: int  #: in a large burst; 1: there are none
    grain: float  #: ns, of a clock that ticks; 0: the stamps are finer than a period
    are_batches: bool  #: whether the bursts are batches of a sensor's own clock, with real gaps between them

    @property
    def cause(self) -> Cause:
        return "coarse" if self.grain else "arrival" if self.rows > 1 else "jitter"

    @staticmethod
    def of(steps: Integers, period: float) -> "_Bursts":
        within: Booleans = steps < SHORT * period
        _, lengths = runs(within)
        if lengths.sum() * 10 < steps.size:  # a few rows of a stream that is late now and then
            lengths = lengths[:0]
        sizes = lengths[1:-1] + 1 if lengths.size > 3 else lengths + 1  # noqa: PLR2004 - the first and the last may be cut
        grain = float(np.gcd.reduce(steps))
        positive = steps[steps > 0]
        ticks = bool(
            positive.size and grain >= CALM * period and grain >= SHORT / 2 * float(np.quantile(positive, CALM))
        )
        rows = int(np.quantile(sizes, 0.9)) if sizes.size else 1
        inner = steps[within]
        even = bool(inner.size and inner.min() > 0 and inner.std() <= EVEN * inner.mean())
        same = bool(sizes.size and sizes.std() <= SAME * sizes.mean())
        batches = (
            even
            and same
            and rows >= BATCH
            and not (rows < LARGE and _arrives(float(inner.mean()), period, float(steps.mean())))
        )
        return _Bursts(rows, grain if ticks else 0.0, batches)


def _arrives(step: float, *periods: float) -> bool:
    """Return whether one of the periods of all rows (ns), and not the step within bursts, is that of a sensor."""
    return not _is_usual(step) and (step < SHORTEST or any(map(_is_usual, periods)))


def _is_usual(period: float) -> bool:
    return any(abs(period * rate / SECOND - 1) < NEAR_USUAL for rate in USUAL_RATES)


@dataclass(frozen=True, eq=False, slots=True)
class _Part:
    time: Integers
    lost: int


def _even_part(stamps: Integers, period: float, bursts: _Bursts, *, forced: bool) -> _Part | None:
    """Return the even times of a part without pauses; None if its stamps do not show that the samples are even."""
    if stamps.size < FEWEST:
        return _Part(_rising(stamps[0], period * np.arange(stamps.size, dtype=np.float64)), 0)
    if bursts.grain:  # a clock that ticks is early, not late: backwards in time, its stamps are late
        part = _late(-stamps[::-1], period, bursts, forced=forced)
        return None if part is None else _Part(-part.time[::-1], part.lost)
    return _late(stamps, period, bursts, forced=forced)


def _late(stamps: Integers, period: float, bursts: _Bursts, *, forced: bool) -> _Part | None:
    """Return the even times of samples whose stamps are late."""
    since = (stamps - stamps[0]).astype(np.float64)
    rows = max(BLOCK, BURSTS * bursts.rows)
    least = ONE_TICK if bursts.grain and bursts.rows > 1 else HALF
    edge = _edge(since, period, min(rows, stamps.size // 4), least)
    while edge.scatter > SHARP * edge.period and (rows := rows * LARGER) * LEAST_BLOCKS <= stamps.size:
        edge = min(edge, _edge(since, period, rows, least), key=lambda one: one.scatter)
    missing = round(float(edge.number[-1])) - (stamps.size - 1)
    blurred = edge.scatter > max(SHARP, OF_BURST * bursts.rows) * edge.period
    if not forced and (blurred or missing > LOST * stamps.size):
        return None
    line = edge.line(since)
    if bursts.cause == "jitter":
        line += float(np.mean(since - line))
    return _Part(_rising(stamps[0], line), missing)


@dataclass(frozen=True, eq=False, slots=True)
class _Edge:
    """The line through the stamps that are nearest to the times of their samples."""

    number: Floats  #: (n,) of each sample; lost samples have numbers too
    period: float  #: ns
    scatter: float  #: ns, of the edge from block to block
    rows: Integers  #: (b,) rows on the edge

    def line(self, since: Floats) -> Floats:
        """Return the times of all samples, ns: on a straight line, or where the edge is not straight, on one with knots."""
        at, on = self.number[self.rows], since[self.rows]
        middle = float(np.median(on - self.period * at))
        if np.abs(on - self.period * at - middle).max() <= max(STRAIGHT * self.period, CLEAR * self.scatter):
            return self.period * self.number + middle
        knots = max(2, at.size // KNOTS)
        at, on = (np.array([part.mean() for part in np.array_split(x, knots)]) for x in (at, on))
        first, last = ((on[i + 1] - on[i]) / (at[i + 1] - at[i]) for i in (0, -2))
        ends = self.number[[0, -1]]
        on = np.r_[on[0] + first * (ends[0] - at[0]), on, on[-1] + last * (ends[1] - at[-1])]
        return np.interp(self.number, np.r_[ends[0], at, ends[1]], on)


def _edge(since: Floats, period: float, rows: int, least: float) -> _Edge:
    """Return the lower edge of stamps, found in blocks of some rows; it rises by at least so many periods where samples are lost."""
    blocks = np.arange(0, since.size - rows + 1, rows)
    edge = _Edge(_counted(since, period), period, np.inf, blocks)
    for _ in range(ROUNDS):
        edge = _sharper(since, edge.period, blocks, rows, least)
        if not edge.period > 0:  # damaged times stand still
            return _Edge(edge.number, period, np.inf, blocks)
    return edge


def _sharper(since: Floats, period: float, blocks: Integers, rows: int, least: float) -> _Edge:
    """Return the edge by a period, and the period by that edge."""
    counted = _counted(since, period)
    residual = since - period * counted
    at = np.array([b + int(np.argmin(residual[b : b + rows])) for b in blocks])
    low = residual[at]
    rises = np.diff(low)
    drift = float(np.median(rises))
    scatter = 1.4826 * float(np.median(np.abs(rises - drift)))
    shift = np.zeros(since.size)
    for block, rise in _rises(low - drift * np.arange(low.size), max(least * period, CLEAR * scatter)):
        # The samples are lost after the last row that is still near the old edge.
        inside = residual[blocks[block] : blocks[block + 1] + rows]
        last = inside.size - int(np.argmax(inside[::-1] < low[block] + rise / 2))
        shift[blocks[block] + last] += round(rise / period)
    number = counted + np.cumsum(shift)
    return _Edge(number, _slope(number[at], since[at]), scatter, at)


def _counted(since: Floats, period: float) -> Floats:
    """Return the number of each sample: by the length of each step where all are near whole periods, else by counting rows."""
    steps = np.diff(since) / period
    whole = np.rint(steps)
    like = abs(whole.sum() / steps.sum() - 1) < ALIKE  # else the longer steps are those of a slow clock
    if like and steps.min() > SHORT and np.abs(steps - whole).max() < NEAR:
        return np.concatenate([[0.0], np.cumsum(whole)])
    return np.arange(since.size, dtype=np.float64)


def _rises(low: Floats, least: float) -> Iterator[tuple[int, float]]:
    """Yield each block after which the edge stays higher, and by how much.

    A block whose rows are all late is high too, but the blocks after it are low again: so levels are the lowest of several blocks.
    """
    padded = np.pad(low, STAYS, mode="edge")
    lowest = np.lib.stride_tricks.sliding_window_view(padded, STAYS).min(axis=1)
    first = 0
    for block in np.flatnonzero(lowest[STAYS + 1 : low.size + STAYS] - lowest[1 : low.size] > least):
        before = low[max(first, block + 1 - STAYS) : block + 1].min()
        rise = float(low[block + 1 : block + 1 + STAYS].min() - before)
        if rise > least:
            yield int(block), rise
            first = int(block) + 1


def _slope(x: Floats, y: Floats) -> float:
    """Return the slope of a line through points, of which some are off: the median over pairs half the points apart."""
    half = max(x.size // 2, 1)
    return float(np.median((y[half:] - y[:-half]) / (x[half:] - x[:-half])))


def _rising(start: int, since: Floats) -> Integers:
    """Return times in ns that strictly increase."""
    index = np.arange(since.size)
    return np.maximum.accumulate(start + np.rint(since).astype(np.int64) - index) + index
