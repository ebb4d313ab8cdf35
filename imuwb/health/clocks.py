"""Faults of a stream's clock: jumps, gaps, drops of the rate, jitter."""

from collections.abc import Iterator

import numpy as np

from imuwb.arrays import Floats, Integers, blocks_of, step_blocks
from imuwb.health.fault import Fault
from imuwb.sampling import Sampling, runs, sampling
from imuwb.texts import seconds_text

SHORT = "short"  #: the kind of fault of a stream that is too short to judge
#: least number of rows of an IMU's stream, and of another stream, that can be judged
FEWEST = {True: 100, False: 10}
JITTER = 0.2  #: share of the interval; a larger scatter of the stamps is a fault
DROPPED = 1.5  #: times the usual step; a window with longer steps shows a drop of the rate
WINDOW = 50  #: steps in a window
AT_ONCE = 1 << 18  #: steps whose windows are looked at together
WINDOWS = 4  #: least number of windows from which the usual step of a stream is known
MOSTLY = 0.5  #: share of missing time; a stream with a larger share was recorded in batches
MANY = 100  #: gaps; if a stream whose rate drops has more gaps, they are the steps of the lower rate
MUCH = 0.01  #: share of missing time; a larger share is a fault
CUT_OFF = 0.01  #: share of the rows; as few rows at an end of a stream can be left out
SLOWEST = 5.0  #: s between the rows of an IMU; a longer interval shows a wrong unit of time
DAY, YEAR = 86_400.0, 31_557_600.0  #: s
FAR = 10.0  #: times the recorded time; a longer step is a jump of the clock


def clock_faults(name: str, time: Floats, *, inertial: bool) -> Iterator[Fault]:
    """Yield what is wrong with the times of a stream.

    Args:
        name: name of the stream.
        time: (n,) s from the log's start, rising.
        inertial: whether the stream is from an IMU; gaps then limit the averaging times.
    """
    if time.size < 2:  # noqa: PLR2004 - a step needs two rows
        yield Fault(name, "single row", "a single row", "fault", consequence="there is nothing to analyse")
        return
    if time.size < FEWEST[inertial]:
        what = f"{time.size} rows in {seconds_text(float(time[-1] - time[0]))} are too few to judge"
        yield Fault(name, SHORT, what, "warning", consequence=f"at least {FEWEST[inertial]} rows show what is wrong")
    jumps = _jumps(time)
    for at in jumps:
        length = float(time[at] - time[at - 1])
        text = f"{length / YEAR:.3g} years" if length > YEAR else f"{length / DAY:.3g} days"
        what = f"clock jumps by {text}: {at} rows before, {time.size - at} after"
        consequence = "two clocks in one stream: keep the rows before or after the jump, with --end or --start"
        yield Fault(name, "clock jump", what, "fault", 1, float(time[at - 1]), length, consequence)
    for part in np.split(time, jumps):
        if part.size > 1:
            yield from _within(name, part, inertial=inertial)


def _jumps(time: Floats) -> Integers:
    """Return the rows before which a clock was set: its step is longer than a day, and far longer than the recorded time."""
    if max(float(steps.max()) for steps in step_blocks(time)) <= DAY:
        return np.empty(0, np.int64)
    steps = np.diff(time)
    long = steps > DAY
    return np.flatnonzero(long & (steps > FAR * float(steps[~long].sum()))) + 1


def _within(name: str, time: Floats, *, inertial: bool) -> Iterator[Fault]:
    """Yield gaps, jitter and drops of the rate."""
    clock = sampling(_nanoseconds(time))
    drops = list(_rate_drops(name, time))
    if clock.gaps and not (drops and len(clock.gaps) > MANY):
        gaps = _gaps(name, time, clock, inertial=inertial)
        yield gaps
        if gaps.kind == "batches":
            return
    if inertial and not clock.gaps and clock.interval > SLOWEST:
        what = f"a row every {seconds_text(clock.interval)}, more slowly than IMUs are logged"
        consequence = "the unit of its times is likely another, such as ms: then rates and noise are wrong; --units time=UNIT states it"
        yield Fault(name, "slow clock", what, "fault", consequence=consequence)
    if clock.jitter > JITTER:
        what = f"stamps scatter by {100 * clock.jitter:.0f} % of the interval"
        consequence = "do not trust averaging times near one interval; another --time-source may be better"
        yield Fault(name, "jitter", what, "warning", consequence=consequence)
    yield from drops


def _nanoseconds(time: Floats) -> Integers:
    """Return times in whole ns."""
    whole = np.empty(time.size, np.int64)
    for rows in blocks_of(time.size):
        whole[rows] = np.rint(time[rows] * 1e9)
    return whole


def _gaps(name: str, time: Floats, clock: Sampling, *, inertial: bool) -> Fault:
    at, longest = max(clock.gaps, key=lambda gap: gap[1])
    edges = np.array([0, *clock.breaks, time.size])
    whole = float(np.diff(edges).max()) * clock.interval
    lost = clock.missing / max(float(time[-1] - time[0]), 1e-9)
    what = f"{clock.missing:.3g} s missing ({100 * lost:.2g} %)"
    consequence = f"no rows for up to {longest:.3g} s"
    if inertial:
        consequence = f"averaging times above {whole / 2:.3g} s span gaps"
    kind, text = ("batches", "recorded in batches") if lost > MOSTLY else ("gaps", "gaps")
    # A filter goes on between the fixes of a receiver; noise and attitude do not go on between the samples of an IMU.
    severity = "note" if lost > MOSTLY else "fault" if lost > MUCH and inertial else "warning"
    first, last = _core(edges)
    if severity == "fault" and (first, last) != (0, time.size):
        length = float(time[last - 1] - time[first])
        inside = length - (last - first - 1) * clock.interval
        if inside <= MUCH * length:
            severity = "warning"
            consequence = f"all but {time.size - last + first} rows are from {time[first]:.2f} to {time[last - 1]:.2f} s: leave the others out"
    return Fault(name, kind, f"{text}: {what}", severity, len(clock.gaps), float(time[0]) + at, longest, consequence)  # fmt: skip


def _core(edges: Integers) -> tuple[int, int]:
    """Return the first row, and the row after the last, without the few rows that gaps cut off at the ends of a stream.

    Args:
        edges: 0, the rows before which samples are missing, and the number of rows.
    """
    few = max(CUT_OFF * float(edges[-1]), 1.0)
    first, last = 0, edges.size - 1
    while last - first > 1 and edges[first + 1] - edges[0] <= few:
        first += 1
    while last - first > 1 and edges[-1] - edges[last - 1] <= few:
        last -= 1
    return int(edges[first]), int(edges[last])


def _rate_drops(name: str, time: Floats) -> Iterator[Fault]:
    """Yield spans without gaps in which the rate is lower."""
    count = (time.size - 1) // WINDOW
    if count < WINDOWS:
        return
    starts = time[: count * WINDOW + 1 : WINDOW]
    usual = np.concatenate([np.median(steps, axis=1) for steps in _window_steps(time, count)])
    first, length = runs(usual > DROPPED * float(np.median(usual)))
    if first.size:
        spans = starts[first + length] - starts[first]
        longest = float(starts[first[int(np.argmax(length))]])
        what = f"the rate drops, down to {1 / float(usual.max()):.3g} Hz"
        consequence = "the noise differs at that rate; leave these spans out with --start and --end"
        yield Fault(name, "rate drop", what, "warning", int(first.size), longest, float(spans.max()), consequence)


def _window_steps(time: Floats, count: int) -> Iterator[Floats]:
    """Yield the steps of so many windows, (k, WINDOW), some windows at a time."""
    for some in blocks_of(count, AT_ONCE // WINDOW):
        yield np.diff(time[some.start * WINDOW : some.stop * WINDOW + 1]).reshape(-1, WINDOW)
