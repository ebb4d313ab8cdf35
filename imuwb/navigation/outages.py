"""Outages: branches from a solution's checkpoints, without the fixes that follow."""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.navigation import kernel
from imuwb.navigation.covariance import NAVIGATION, flat
from imuwb.navigation.filter import Solution, empty_track
from imuwb.navigation.tables import Marks
from imuwb.navigation.workspace import workspace
from imuwb.progress import tracked

EACH = 1.0  #: s between two marks
ALL = np.iinfo(np.int64).max  #: a sample number after the last sample of any log


@dataclass(frozen=True, eq=False, slots=True)
class Drift:
    """A filter's states in s outages, at L marks each."""

    event: Integers  #: (s,) the last fix before each outage, among the solution's events
    start: Floats  #: (s,) s from the log's start
    elapsed: Floats  #: (L,) s since the start of the outage
    mark: Integers  #: (s, L) number of samples up to the mark
    time: Floats  #: (s, L) s from the log's start
    state: Floats  #: (s, L, 10) latitude rad, longitude rad, height m, velocity NED m/s, quaternion
    covariance: Floats  #: (s, L, 9, 9) of position m, velocity m/s, attitude rad
    sound: Booleans  #: (s,) whether all states and variances are valid

    def __repr__(self) -> str:
        """Return number and duration of the outages in a line."""
        return f"Drift: {self.start.size} outages of {self.elapsed[-1]:g} s, {int(self.sound.sum())} of them valid"


def marks_of(solution: Solution, events: Integers, duration: float) -> Integers:
    """Return the marks of outages, (s, L): the number of samples up to each second, and up to the end."""
    first = solution.corrections.events.at[events] + 1
    return first[:, None] + np.rint(seconds_of(duration) / solution.measurement.interval).astype(np.int64)


def seconds_of(duration: float) -> Floats:
    """Return the times of an outage's marks, s since its start: each second, and the end."""
    whole = np.arange(EACH, duration + 1e-6, EACH)
    return whole if whole.size and duration - whole[-1] < 1e-6 else np.append(whole, duration)  # noqa: PLR2004 - rounding


def drift(
    solution: Solution, events: Integers, duration: float, *, with_covariance: bool = True
) -> Drift:  # fmt: skip
    """Return a filter's drift in outages, which are run in parallel.

    Args:
        solution: the filter's run over the whole log.
        events: (s,) the last fix before each outage, among the solution's events.
        duration: s.
        with_covariance: whether the covariance is propagated; if not, it is that at the start of the outage.

    Raises:
        ValueError: an outage that ends after the log.
    """
    marks = marks_of(solution, events, duration)
    time, corrections, track = solution.measurement.time, solution.corrections, solution.track
    if marks.size and marks.max() > time.size:
        raise ValueError(f"an outage of {duration:g} s ends after the log; choose a shorter or an earlier one")
    count, length = marks.shape
    states, covariances = np.zeros((count, length, 10)), np.zeros((count, length, NAVIGATION, NAVIGATION))
    sound = np.zeros(count, dtype=bool)
    n = int(solution.tables.first[6])
    no_track = empty_track(0, n)

    def work(part: Integers) -> None:
        space = workspace(n)
        for k in part:
            e = int(events[k])
            ended, _ = kernel.run(
                track.state[e].copy(), track.axes[e].copy(), flat(track.covariance[e]), solution.measurement.samples,
                corrections.events, solution.rules, solution.tables, space, int(corrections.events.at[e]) + 1, e + 1, -1, ALL,
                Marks(marks[k], with_covariance, states[k], covariances[k]), no_track,
            )  # fmt: skip
            sound[k] = ended == kernel.FINE and bool(np.isfinite(states[k]).all())

    threads = os.cpu_count() or 1
    parts = [part for part in np.array_split(np.arange(count), max(threads * 8, 1)) if part.size]
    with ThreadPoolExecutor(threads) as pool:
        for _ in tracked(pool.map(work, parts), len(parts)):
            pass
    return Drift(
        events, time[corrections.events.at[events]], seconds_of(duration), marks, time[marks - 1], states, covariances, sound
    )  # fmt: skip
