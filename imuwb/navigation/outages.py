"""Outages: branches off a solution's checkpoints, along which no fix is used."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.navigation import kernel
from imuwb.navigation.covariance import NAVIGATION, flat
from imuwb.navigation.filter import empty_track
from imuwb.navigation.tables import Marks
from imuwb.navigation.workspace import workspace
from imuwb.progress import tracked

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.log import Floats
    from imuwb.navigation.filter import Solution

EACH = 1.0  #: s between two marks
BEHIND = np.iinfo(np.int64).max  #: every sample


@dataclass(frozen=True, eq=False, slots=True)
class Drift:
    """What a filter says on its way through outages: s of them, at L marks each."""

    event: NDArray[np.int64]  #: (s,) the last fix before each, among the solution's events
    start: Floats  #: (s,) s from the log's start
    elapsed: Floats  #: (L,) s since the start, to a sample
    mark: NDArray[np.int64]  #: (s, L) sample behind which
    time: Floats  #: (s, L) s from the log's start
    state: Floats  #: (s, L, 10) latitude rad, longitude rad, height m, velocity NED m/s, quaternion
    covariance: Floats  #: (s, L, 9, 9) of position m, velocity m/s, attitude rad
    sound: NDArray[np.bool_]  #: (s,) whether all that are numbers that can be


def marks_of(solution: Solution, events: NDArray[np.int64], duration: float) -> NDArray[np.int64]:
    """Return the samples behind which outages are looked at: each second, and at their end; (s, L)."""
    first = solution.found.events.at[events] + 1
    return first[:, None] + np.rint(seconds_of(duration) / solution.moves.interval).astype(np.int64)


def seconds_of(duration: float) -> Floats:
    """Return when outages are looked at, s since their start: each second, and at the end."""
    whole = np.arange(EACH, duration + 1e-6, EACH)
    return whole if whole.size and duration - whole[-1] < 1e-6 else np.append(whole, duration)  # noqa: PLR2004 - rounding


def drift(
    solution: Solution, events: NDArray[np.int64], duration: float, *, with_covariance: bool = True
) -> Drift:  # fmt: skip
    """Return where a filter drifts when no fix follows some of its own; all in parallel.

    Args:
        solution: the filter's run over the whole log.
        events: (s,) of the solution's events, the last fix before each outage.
        duration: s; the log must go on for as long.
        with_covariance: whether its covariance is carried on, too; else it is that of the checkpoint.

    Raises:
        ValueError: an outage that goes on behind the log's end.
    """
    marks = marks_of(solution, events, duration)
    if marks.size and marks.max() > solution.moves.time.size:
        message = f"an outage of {duration:g} s goes on behind the end of the log"
        raise ValueError(message)
    count, length = marks.shape
    states, spreads = np.zeros((count, length, 10)), np.zeros((count, length, NAVIGATION, NAVIGATION))
    sound = np.zeros(count, dtype=bool)
    found, track = solution.found, solution.track
    n = int(solution.tables.first[6])
    nothing = empty_track(0, n)

    def work(part: NDArray[np.int64]) -> None:
        space = workspace(n)
        for k in part:
            e = int(events[k])
            ended, _ = kernel.run(
                track.state[e].copy(), track.axes[e].copy(), flat(track.covariance[e]), solution.moves.samples,
                found.events, solution.rules, solution.tables, space, int(found.events.at[e]) + 1, e + 1, -1, BEHIND,
                Marks(marks[k], with_covariance, states[k], spreads[k]), nothing,
            )  # fmt: skip
            sound[k] = ended == kernel.FINE and bool(np.isfinite(states[k]).all())

    threads = os.cpu_count() or 1
    parts = [part for part in np.array_split(np.arange(count), max(threads * 8, 1)) if part.size]
    with ThreadPoolExecutor(threads) as pool:
        for _ in tracked(pool.map(work, parts), len(parts)):
            pass
    time = solution.moves.time[marks - 1]
    return Drift(
        events, solution.moves.time[found.events.at[events]], seconds_of(duration), marks, time, states, spreads, sound
    )
