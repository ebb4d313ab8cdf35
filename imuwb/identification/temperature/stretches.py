"""The stretches of a log with one temperature each: the whole log, its plateaus, or the bins of a ramp."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from imuwb.arrays import Booleans, Floats

Cut = Literal["set-point", "plateaus", "bins"]
STEADY = 2.0  #: °C; a log whose temperature spans no more is one set-point
PLATEAU = 1.0  #: °C, largest span of a plateau
DWELL = 3.0  #: least ratio of the duration of a plateau to the average time in which the log passes that span
MOST = 0.5  #: share of the log; with a smaller share in plateaus, the log is a ramp
TURN = 2.0  #: °C; a ramp that goes back by more has turned
WIDTHS = (5.0, 10.0, 20.0)  #: °C, widths of bins; the first with enough samples is taken, else the last
ENOUGH = 20_000  #: samples of the median bin
BLOCK, BLOCKS = 5.0, 4000  #: s, shortest block of the averaged thermometer, and largest number of blocks


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a log with one temperature."""

    start: float  #: s
    end: float  #: s
    celsius: float  #: mean
    spread: float  #: °C, standard deviation of the thermometer
    nominal: float  #: °C, middle of a bin, else the mean; stretches with the same nominal temperature belong together
    rising: bool | None  #: whether the temperature came from below; None: not known


def stretches(
    time: Floats, celsius: Floats, rate: float, cut: Cut | None = None, width: float = 0.0, around: float = 0.0
) -> tuple[Cut, tuple[Stretch, ...]]:
    """Return how a log was divided, and its stretches in order of time.

    Args:
        time: (n,) s of the thermometer's readings, rising.
        celsius: (n,) °C.
        rate: Hz, sampling rate of the sensor, for the number of samples in a bin.
        cut: None: a set-point if the temperature spans at most 2 °C, plateaus if they make up half of the time, else bins.
        width: °C of a bin; 0: 5, or 10 or 20 if smaller bins have too few samples.
        around: s on both sides of a turn of the temperature that no bin has.
    """
    at, mean = _blocks(time, celsius)
    plateaus = _plateaus(at, mean)
    if cut is None:
        held = sum(float(at[b] - at[a]) for a, b in plateaus)
        longest = float(at[-1] - at[0])
        cut = "set-point" if np.ptp(mean) <= STEADY else "plateaus" if held >= MOST * longest else "bins"
    if cut == "set-point":
        return cut, (_stretch(time, celsius, time[0], time[-1], None, None),)
    if cut == "plateaus":
        levels = [float(mean[a : b + 1].mean()) for a, b in plateaus]
        came = [None, *(now > before for before, now in pairwise(levels))]
        return cut, tuple(
            _stretch(time, celsius, at[a], at[b], None, up)
            for (a, b), up in zip(plateaus, came, strict=False)  # without a plateau ``came`` still has one item
        )
    turns = at[[begin for begin, _ in legs_of(mean)[1:]]]
    apart = np.abs(at[:, None] - turns).min(axis=1, initial=np.inf) > around if around else np.ones(at.size, dtype=bool)
    width = width or _wide_enough(at, mean, rate, apart)
    return cut, tuple(
        _stretch(time, celsius, at[a], at[b], middle, up) for a, b, middle, up in _bins(mean, width, apart)
    )


def _stretch(
    time: Floats,
    celsius: Floats,
    start: float,
    end: float,
    nominal: float | None,
    rising: bool | None,  # noqa: FBT001 - data
) -> Stretch:
    inside = celsius[(time >= start) & (time <= end)]
    mean = float(inside.mean())
    return Stretch(float(start), float(end), mean, float(inside.std()), mean if nominal is None else nominal, rising)


def _blocks(time: Floats, celsius: Floats) -> tuple[Floats, Floats]:
    """Return the times and means of blocks, which average out noise and steps of the thermometer."""
    length = max(BLOCK, float(time[-1] - time[0]) / BLOCKS)
    number = ((time - time[0]) / length).astype(np.int64)
    count = np.bincount(number)
    full = count > 0
    at = np.bincount(number, time)[full] / count[full]
    at[0], at[-1] = time[0], time[-1]
    return at, np.bincount(number, celsius)[full] / count[full]


def _plateaus(at: Floats, mean: Floats) -> list[tuple[int, int]]:
    """Return the first and last block of each plateau, in order: the longest plateau, then the longest of the rest, and so on."""
    travelled = float(np.abs(np.diff(mean)).sum())
    dwell = DWELL * PLATEAU * float(at[-1] - at[0]) / max(travelled, PLATEAU)
    plateaus: list[tuple[int, int]] = []
    open_parts = [(0, at.size)]
    while open_parts:
        begin, end = open_parts.pop()
        if end - begin < 2:  # noqa: PLR2004 - a span has two ends
            continue
        a, b = max(_windows(mean[begin:end]), key=lambda w: at[begin + w[1]] - at[begin + w[0]])
        if at[begin + b] - at[begin + a] < dwell:
            continue
        plateaus.append((begin + a, begin + b))
        open_parts += [(begin, begin + a), (begin + b + 1, end)]
    return sorted(plateaus)


def _windows(mean: Floats) -> Iterator[tuple[int, int]]:
    """Yield, for each block, the longest window that ends there and spans no more than a plateau."""
    low: deque[int] = deque()
    high: deque[int] = deque()
    start = 0
    for i, value in enumerate(mean.tolist()):
        while low and mean[low[-1]] >= value:
            low.pop()
        while high and mean[high[-1]] <= value:
            high.pop()
        low.append(i)
        high.append(i)
        while mean[high[0]] - mean[low[0]] > PLATEAU:
            start += 1
            for queue in (low, high):
                if queue[0] < start:
                    queue.popleft()
        yield start, i


def legs_of(mean: Floats) -> list[tuple[int, int]]:
    """Return the first and last block of each rising or falling leg of a temperature, (n,) °C."""
    turns, low, high, way = [0], 0, 0, 0
    for i in range(mean.size):
        low = i if mean[i] <= mean[low] else low
        high = i if mean[i] >= mean[high] else high
        if way >= 0 and mean[high] - mean[i] > TURN:
            turns += [high] if way else []
            way, low = -1, i
            high = i
        elif way <= 0 and mean[i] - mean[low] > TURN:
            turns += [low] if way else []
            way, low = 1, i
            high = i
    edges = sorted({*turns, mean.size - 1})
    return list(pairwise(edges))


def _bins(mean: Floats, width: float, used: Booleans) -> list[tuple[int, int, float, bool]]:
    """Return the first and last used block, the middle and the direction of each bin on each leg."""
    bins: list[tuple[int, int, float, bool]] = []
    for begin, end in legs_of(mean):
        leg = mean[begin : end + 1]
        rising = bool(leg[-1] > leg[0])
        along = np.maximum.accumulate(leg) if rising else np.minimum.accumulate(leg)
        number = np.floor(along / width).astype(np.int64)
        for k in np.unique(number):
            inside = np.flatnonzero((number == k) & used[begin : end + 1])
            if inside.size > 1:
                bins.append((begin + int(inside[0]), begin + int(inside[-1]), (float(k) + 0.5) * width, rising))
    return sorted(bins)


def _wide_enough(at: Floats, mean: Floats, rate: float, used: Booleans) -> float:
    for width in WIDTHS:
        bins = _bins(mean, width, used)
        if bins and float(np.median([at[b] - at[a] for a, b, *_ in bins])) * rate >= ENOUGH:
            return width
    return WIDTHS[-1]
