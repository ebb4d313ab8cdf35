"""Puts rows in the order of their time: repairs damaged stamps, clocks set back, late rows and repeated rows."""

from dataclasses import replace

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers, step_range
from imuwb.log import Nanoseconds, Repair
from imuwb.notes import Note
from imuwb.units import SECOND

# The count of each is set when rows are repaired.
IMPOSSIBLE = Repair(Note("impossible_time", "rows with an impossible time left out"), 0)
ALONE = Repair(Note("lone_time", "rows whose time is far from that of both neighbours left out"), 0)
SET_BACK = Repair(Note("set_back", "clock set back: the time after it goes on by one usual step"), 0, "time")
LATE = Repair(Note("out_of_order", "rows out of order sorted by time"), 0, "order")
REPEATED = Repair(Note("repeated_time", "rows with the same time as the row before left out"), 0)
TWICE = Repair(Note("repeated_row", "rows that repeat the row before, time and values, left out"), 0)

LATEST = 2**62  #: ns from the epoch, the year 2116; differences of such times fit into int64
CLOCK_STEP = SECOND  #: ns; a row that is older than its predecessor by more shows a clock set back; one that is older by less is late
END_STEP = 86_400 * SECOND  #: ns; a first or last row that is further from the others may have a damaged stamp
END_SPANS = 10  #: durations of all other rows; if such a row is further from them than this, its stamp is damaged
FEWEST = 12  #: rows; with fewer rows, no first or last stamp is taken as damaged
MOST_STEPS = 10  #: number of times that a clock may be set back in a log of any length
ROWS_PER_STEP = 100  #: a clock may be set back once in so many rows; rows that step back more often are in no order


def in_order(
    time: Nanoseconds, columns: dict[str, Floats], repairs: list[Repair]
) -> tuple[Nanoseconds, dict[str, Floats]]:
    """Return rows whose time does not fall, and add the repairs; of equal rows that follow each other, the first is kept."""
    if time.size and max(int(time.max()), -int(time.min())) >= LATEST:
        time, columns = _without(np.abs(time) >= LATEST, IMPOSSIBLE, time, columns, repairs)
    if time.size > 1:
        shortest, longest = step_range(time)
        if shortest > 0 and longest <= CLOCK_STEP:
            return time, columns  # nearly all logs
    time, columns = _without(_damaged_stamps(time), ALONE, time, columns, repairs)
    if time.size < 2:  # noqa: PLR2004 - one row is in order
        return time, columns
    continued, times_set_back = _continued(time)
    if 0 < times_set_back <= max(MOST_STEPS, time.size // ROWS_PER_STEP):
        repairs.append(replace(SET_BACK, count=times_set_back))
        time = continued
    late = int(np.count_nonzero(time < np.maximum.accumulate(time)))
    if late:
        repairs.append(replace(LATE, count=late))
        time, columns = taken(time, columns, np.argsort(time, kind="stable"))
    return _without(_repeats(time, columns), TWICE, time, columns, repairs)


def _repeats(time: Nanoseconds, columns: dict[str, Floats]) -> Booleans:
    """Return which rows have the time and all values of the row before."""
    repeats = np.diff(time, prepend=time[0] - 1) == 0
    rows = np.flatnonzero(repeats)
    for values in columns.values():
        now, before = values[rows], values[rows - 1]
        same = (now == before) | (np.isnan(now) & np.isnan(before))
        repeats[rows] &= same if same.ndim == 1 else same.all(axis=1)
    return repeats


def taken(
    time: Nanoseconds, columns: dict[str, Floats], rows: Booleans | Integers
) -> tuple[Nanoseconds, dict[str, Floats]]:
    """Return some rows of time and columns, selected by a mask or by row numbers."""
    return time[rows], {name: values[rows] for name, values in columns.items()}


def _without(
    rows: Booleans, repair: Repair, time: Nanoseconds, columns: dict[str, Floats], repairs: list[Repair]
) -> tuple[Nanoseconds, dict[str, Floats]]:
    """Return time and columns without some rows, and count them."""
    if not rows.any():
        return time, columns
    repairs.append(replace(repair, count=int(np.count_nonzero(rows))))
    return taken(time, columns, ~rows)


def _damaged_stamps(time: Nanoseconds) -> Booleans:
    """Return which rows are alone in time and outside the time span of all other rows; a row inside this span is only late."""
    alone = _alone(time)
    others = time[~alone]
    if not others.size:
        return alone
    return alone & ((time < others.min()) | (time > others.max()))


def _alone(time: Nanoseconds) -> Booleans:
    """Return which rows are far in time from their predecessor, while their successor is near to that predecessor."""
    alone = np.zeros(time.size, dtype=bool)
    if time.size > 2:  # noqa: PLR2004 - both neighbours
        far = np.abs(np.diff(time)) > CLOCK_STEP
        near = np.abs(time[2:] - time[:-2]) <= CLOCK_STEP
        alone[1:-1] = far[:-1] & far[1:] & near
    if time.size >= FEWEST:
        for end, step, rest in ((0, time[1] - time[0], time[1:]), (-1, time[-1] - time[-2], time[:-1])):
            alone[end] |= abs(step) > max(END_STEP, END_SPANS * abs(int(rest[-1] - rest[0])))
    return alone


def _continued(time: Nanoseconds) -> tuple[Nanoseconds, int]:
    """Return the times without the steps of a clock that was set back, and the number of these steps."""
    steps = np.diff(time)
    back = steps < -CLOCK_STEP
    if not back.any():
        return time, 0
    usual = int(np.median(steps[steps > 0])) if (steps > 0).any() else 1
    shift = np.where(back, usual - steps, 0)
    late = np.flatnonzero(_alone(time))  # at a late row the time steps back, then forward again: the clock was not set
    shift[(late - 1).clip(0)] = shift[late.clip(max=shift.size - 1)] = 0
    if float(np.abs(shift.astype(np.float64)).sum()) + float(np.abs(time).max()) >= LATEST:
        return time, 0  # no clock is set back by so much
    return time + np.concatenate([[0], np.cumsum(shift)]), int(np.count_nonzero(shift))
