"""UTC of a sensor's time tags, from the fixes around them in the file.

Neither message nor manual states when a tag's clock began; of ESF-RAW the unit is not stated either. So a straight line is laid
through the times of the fixes over the last tag before each. Its slope is the tick. Its constant part is late or early by the
receiver's delay of a fix and by up to one interval of the sensor's messages; this stays unknown, and a note says so.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.log import Nanoseconds
from imuwb.notes import Note
from imuwb.readers.batch import Remark
from imuwb.readers.receivers.ubx_clock import UbxClock
from imuwb.units import SECOND, Epoch

#: s; ESF-MEAS counts ms (ZED-F9R integration manual, "time tagging configuration"), a Bosch sensor 1/25600 s
TICKS = (1e-3, 1 / 25_600)
NEAR = 0.01  #: relative difference of a tick from one of these, below which it may be this one
SURE = 3.0  #: standard errors of the fitted tick; if a usual tick is nearer, it is taken
LEAST, SPAN = 5, 3.0  #: fixes and their duration (s), with fewer or less of which no tick is fitted
LATE = 1000  #: ticks; a larger step back is a restart of the sensor's clock, or its overflow
LARGEST = 2**24, 2**32  #: tags overflow here
SCATTER = 1.0  #: s; fixes further from the line than this show that tags and fixes do not belong together


@dataclass(frozen=True, eq=False, slots=True)
class Tagged:
    """Times of tags, and what is to be said of them."""

    time: Nanoseconds | None  #: (n,) ns; None: unknown
    epoch: Epoch
    remarks: tuple[Remark, ...]


@dataclass(frozen=True, slots=True)
class _Line:
    tick: float  #: s
    start: float  #: s, UTC of the first tag, from the first fix on
    scatter: float  #: s
    fixes: int


def tagged(name: str, place: Integers, tag: Integers, clock: UbxClock | None, *, milliseconds: bool) -> Tagged:
    """Return the times of tags.

    Args:
        name: of the stream.
        place: (n,) offset of each tag's message in the file, rising.
        tag: (n,) ticks, as in the file.
        clock: of the log; None if it states no date.
        milliseconds: whether a tick is 1 ms unless the fixes show another.
    """
    ticks, runs = _unwrapped(tag.astype(np.int64))
    lines = [_line(place[run], ticks[run], clock) for run in runs]
    known = [line for line in lines if line is not None]
    if not known or clock is None:
        if milliseconds:
            text = f"{name}: its time tags are taken as ms, the receiver's default; too few fixes in the file tell their UTC"
            return Tagged(ticks * (SECOND // 1000), "boot", (Remark(Note("sensor_tags", text)),))
        text = (
            f"{name}: {place.size} measurements not used: no unit of its time tags is stated, and too few fixes tell it"
        )
        return Tagged(None, "log", (Remark(Note("sensor_tags_unknown", text)),))
    begin = int(clock.unix(clock.place[:1], clock.gps[:1])[0])
    time = np.zeros(tag.size, np.int64)
    for run, line in zip(runs, lines, strict=True):
        by = line or known[0]  # a run too short for a line of its own goes on with the tick of another
        start = by.start if line is not None else _seconds(clock, place[run][:1], begin)[0]
        time[run] = begin + np.rint((start + (ticks[run] - ticks[run][0]) * by.tick) * SECOND).astype(np.int64)
    best = max(known, key=lambda line: line.fixes)
    text = (
        f"{name}: a tick of its time tags is {best.tick * 1e6:.6g} µs, and their UTC is that of {sum(line.fixes for line in known)} "
        f"fixes in the file (scatter {best.scatter * 1000:.0f} ms); the delay between a measurement and a fix is not known"
    )
    remarks = [Remark(Note("sensor_tags", text))]
    if len(runs) > 1:
        remarks.append(Remark(Note("sensor_restarts", "restarts of the sensor's clock"), name, len(runs) - 1, "time"))
    return Tagged(time, "unix", tuple(remarks))


def _unwrapped(tag: Integers) -> tuple[Integers, list[slice]]:
    """Return tags without overflows, and the runs between restarts of their clock."""
    steps = np.diff(tag, prepend=tag[:1])
    largest = next(size for size in LARGEST if int(tag.max()) < size)
    ticks = tag + np.cumsum(np.where(steps < -largest // 2, largest, 0))
    edges = [0, *np.flatnonzero(np.diff(ticks) < -LATE) + 1, tag.size]
    return ticks, [slice(int(a), int(b)) for a, b in pairwise(edges)]


def _line(place: Integers, ticks: Integers, clock: UbxClock | None) -> _Line | None:
    """Return the line of the times of fixes over the last tag before each; None with too few fixes."""
    if clock is None:
        return None
    last = np.searchsorted(place, clock.place) - 1
    inside = (last >= 0) & (clock.place <= place[-1])
    last, places = last[inside], clock.place[inside]
    if last.size < LEAST:
        return None
    begin = int(clock.unix(clock.place[:1], clock.gps[:1])[0])
    utc = (clock.unix(places, clock.gps[inside]) - begin) / SECOND
    since = (ticks[last] - ticks[0]).astype(np.float64)
    if np.ptp(utc) < SPAN or np.ptp(since) <= 0:
        return None
    kept = np.ones(utc.size, dtype=bool)
    tick = start = scatter = error = 0.0
    for _ in range(3):
        tick, start, scatter, error = _fitted(since[kept], utc[kept])
        kept = np.abs(utc - start - tick * since) <= max(4 * scatter, 1e-3)
    usual = next((t for t in TICKS if abs(tick / t - 1) < NEAR and abs(tick - t) < SURE * error), None)
    if usual is not None:
        tick, start = usual, float(np.median(utc[kept] - usual * since[kept]))
    return _Line(tick, start, scatter, int(kept.sum())) if tick > 0 and scatter < SCATTER else None


def _fitted(x: Floats, y: Floats) -> tuple[float, float, float, float]:
    """Return slope, value at 0, scatter, and standard error of the slope of a straight line."""
    slope, zero = np.polyfit(x, y, 1)
    scatter = float(np.std(y - zero - slope * x))
    return float(slope), float(zero), scatter, scatter / float(np.std(x)) / np.sqrt(x.size)


def _seconds(clock: UbxClock, place: Integers, begin: int) -> Floats:
    """Return the times of the fixes nearest to some places, s after ``begin``."""
    near = clock.nearest(place)
    return (clock.unix(clock.place[near], clock.gps[near]) - begin) / SECOND
