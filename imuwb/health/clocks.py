"""Faults of a stream's clock: jumps, gaps, drops of the rate, jitter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.health.fault import Fault, runs
from imuwb.sampling import sampling

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from imuwb.log import Floats

JITTER = 0.2  #: of the interval
DROPPED = 1.5  #: times the usual step, over a window
WINDOW = 50  #: steps
MOSTLY = 0.5  #: share of a stream that is missing, from which on it was recorded in batches
MANY = 100  #: gaps
MUCH = 0.01  #: share of a stream that is missing, from which on it is a fault
DAY, YEAR = 86_400.0, 31_557_600.0  #: s
FAR = 10.0  #: times all that is recorded


def clock_faults(name: str, time: Floats, *, inertial: bool) -> Iterator[Fault]:
    """Yield what is wrong with the times of a stream.

    Args:
        name: of the stream.
        time: (n,) s from the log's start, rising.
        inertial: whether its samples are averaged over time, so that gaps limit averaging times.
    """
    if time.size < 2:  # noqa: PLR2004 - a step needs two rows
        yield Fault(name, "a single row", "fault", consequence="nothing can be made of it")
        return
    jumps = _jumps(time)
    for at in jumps:
        length = float(time[at] - time[at - 1])
        what = f"clock jumps by {_long(length)}: {at} rows lie before, {time.size - at} behind"
        yield Fault(
            name,
            what,
            "fault",
            1,
            float(time[at - 1]),
            length,
            "two clocks in one stream: keep one side, with --start or --end",
        )
    for part in np.split(time, jumps):
        if part.size > 1:
            yield from _within(name, part, inertial=inertial)


def _jumps(time: Floats) -> NDArray[np.int64]:
    """Return the rows before which a clock was set: it steps by a day, and by far more than all that is recorded."""
    steps = np.diff(time)
    long = steps > DAY
    return np.flatnonzero(long & (steps > FAR * float(steps[~long].sum()))) + 1


def _long(seconds: float) -> str:
    return f"{seconds / YEAR:.3g} years" if seconds > YEAR else f"{seconds / DAY:.3g} days"


def _within(name: str, time: Floats, *, inertial: bool) -> Iterator[Fault]:
    """Yield gaps, scatter and drops of the rate."""
    clock = sampling(np.rint(time * 1e9).astype(np.int64))
    slow = list(_rate_drops(name, time))
    if clock.gaps and not (slow and len(clock.gaps) > MANY):  # where the rate drops, each step would be a gap
        at, longest = max(clock.gaps, key=lambda gap: gap[1])
        edges = np.array([0, *clock.breaks, time.size])
        whole = float(np.diff(edges).max()) * clock.interval
        lost = clock.missing / max(float(time[-1] - time[0]), 1e-9)
        what = f"{clock.missing:.3g} s missing ({100 * lost:.2g} %)"
        follows = (
            f"averaging times beyond {whole / 2:.3g} s span gaps" if inertial else f"no rows for up to {longest:.3g} s"
        )
        if lost > MOSTLY:
            yield Fault(
                name, f"recorded in batches: {what}", "note", len(clock.gaps), float(time[0]) + at, longest, follows
            )
            return
        yield Fault(
            name,
            f"gaps: {what}",
            "fault" if lost > MUCH else "warning",
            len(clock.gaps),
            float(time[0]) + at,
            longest,
            follows,
        )
    if clock.jitter > JITTER:
        follows = "averaging times near one interval are not to be trusted; another --time-source may be better"
        yield Fault(
            name, f"stamps scatter by {100 * clock.jitter:.0f} % of the interval", "warning", consequence=follows
        )
    yield from slow


def _rate_drops(name: str, time: Floats) -> Iterator[Fault]:
    """Yield spans in which the rate itself is lower, gaps apart."""
    steps = np.diff(time)
    if steps.size < 4 * WINDOW:
        return
    windows = steps[: steps.size // WINDOW * WINDOW].reshape(-1, WINDOW)
    usual = np.median(windows, axis=1)
    slow = usual > DROPPED * float(np.median(usual))
    first, length = runs(slow)
    if first.size:
        longest = int(np.argmax(length))
        starts = time[:-1][: windows.size].reshape(-1, WINDOW)[:, 0]
        spans = [float(windows[a : a + n].sum()) for a, n in zip(first, length, strict=True)]
        least = 1 / float(usual.max())
        yield Fault(
            name, f"the rate drops, down to {least:.3g} Hz", "warning", int(first.size), float(starts[first[longest]]), max(spans),
            "noise at that rate is another; cut it away with --start and --end",
        )  # fmt: skip
