"""A smoothed trajectory at the rate of the IMU, with the forward run, the backward one, and their separation.

The filter runs forward with extra events without a measurement, so that no two events are far apart, also where fixes are
missing. The smoother (Rauch, Tung and Striebel 1965) gives the error of the forward run at each event; between events the error is a
straight line in time, and is removed from the forward run at each sample.

The smoothed error is independent of the difference d = smoothed - forward, because d follows from the fixes. Therefore
cov d = P_forward - P_smoothed, and for each component

    backward = forward + P_forward / cov d * d,    P_backward = P_forward P_smoothed / cov d

is the solution from the fixes after that time: its error is independent of the forward run's, and the two, weighted with their variances,
give the smoothed one (Fraser and Potter 1969). The separation backward - forward over its sigma equals d over the root of cov d.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.geodesy.earth import ned_scale
from imuwb.navigation import kernel
from imuwb.navigation.alignment import Alignment
from imuwb.navigation.corrections import Corrections
from imuwb.navigation.covariance import NAVIGATION, flat
from imuwb.navigation.filter import Solution, empty_track, solve
from imuwb.navigation.outages import ALL
from imuwb.navigation.smoother import backward_pass, corrections_of_events
from imuwb.navigation.strapdown import QUATERNION, VELOCITY
from imuwb.navigation.tables import STRAIGHT, Events, Marks
from imuwb.navigation.workspace import workspace

EACH = 0.5  #: s, largest time between two events
LEAST = 1e-6  #: share of the forward variance; if the later fixes remove less, there is no backward solution


@dataclass(frozen=True, eq=False, slots=True)
class NavigationTrack:
    """A trajectory with the sigmas of its nine errors."""

    position: Floats  #: (n, 3) latitude rad, longitude rad, height m
    velocity: Floats  #: (n, 3) m/s, NED
    quaternion: Floats  #: (n, 4) w, x, y, z, of the body to NED
    sigma: Floats  #: (n, 9) m, m/s, rad about north, east and down


@dataclass(frozen=True, eq=False, slots=True)
class Separation:
    """Forward, backward and smoothed trajectories at n samples."""

    model: str  #: name of the filter
    time: Floats  #: (n,) s from the log's start
    forward: NavigationTrack
    smoothed: NavigationTrack
    backward: NavigationTrack  #: nan where the later fixes say nothing
    off: Floats  #: (n, 9) smoothed minus forward, m, m/s, rad
    off_sigma: Floats  #: (n, 9) of this difference
    event: Integers  #: (m,) the samples of the events that are fixes

    def __repr__(self) -> str:
        """Return filter, samples and the share of the separations within their interval in a line."""
        return f"Separation of {self.model}: {self.time.size} samples, {self.inside95() * 100:.0f} % within 95 %"

    def inside95(self) -> float:
        """Return the share of the horizontal positions at fixes whose separation lies within its own 95 % interval."""
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio = np.abs(self.off[self.event, :2] / self.off_sigma[self.event, :2])
        known = np.isfinite(ratio)
        return float((ratio[known] < 1.96).mean()) if known.any() else float("nan")  # noqa: PLR2004 - 97.5 % quantile


def separation(solution: Solution) -> Separation:
    """Return the forward, backward and smoothed trajectories of a filter's run.

    Args:
        solution: a run over a log, with or without what a smoother needs: the filter runs again.

    Raises:
        MissingDataError: a state or a variance becomes invalid.
    """
    corrections, alignment = _dense(solution)
    run = solve(solution.model, solution.measurement, corrections, alignment, smooth=True)
    order, error, variance = backward_pass(run)
    track, before = run.track, run.track.before
    after_variance = _diagonal(track.covariance[order])
    prior_variance = _diagonal(before.covariance[order])
    # The smoothed error before an event belongs to the state before: the correction is added.
    removed = corrections_of_events(run, order)
    removed[0] = 0.0
    error_before = error + removed
    at = run.corrections.events.at[order]
    samples = np.arange(at[0], at[-1] + 1)
    left = np.searchsorted(at, samples, side="right") - 1
    right = np.minimum(left + 1, order.size - 1)
    span = np.maximum(at[right] - at[left], 1)
    share = np.where(right > left, (samples - at[left]) / span, 0.0)[:, None]

    def between(begin: Floats, end: Floats) -> Floats:
        return begin[left] + share * (end[right] - begin[left])

    n = slice(0, NAVIGATION)
    off = -between(error[:, n], error_before[:, n])
    forward_variance = between(after_variance[:, n], prior_variance[:, n])
    smoothed_variance = np.minimum(between(variance[:, n], variance[:, n]), forward_variance)
    removed = forward_variance - smoothed_variance
    forward = _states(run, order, samples)
    with np.errstate(divide="ignore", invalid="ignore"):
        known = removed > LEAST * forward_variance
        gain = np.where(known, forward_variance / removed, np.nan)
        backward_variance = gain * smoothed_variance
    tracks = (
        _moved(forward, np.zeros_like(off), np.sqrt(forward_variance)),
        _moved(forward, off, np.sqrt(smoothed_variance)),
        _moved(forward, gain * off, np.sqrt(backward_variance)),
    )
    fixes = np.unique(run.corrections.events.at[run.events]) - at[0]
    return Separation(
        run.model.name, run.measurement.time[samples], *tracks, off, np.sqrt(np.where(known, removed, np.nan)), fixes
    )


def _diagonal(covariance: Floats) -> Floats:
    return np.maximum(np.diagonal(covariance, axis1=1, axis2=2), 0.0)


def _dense(solution: Solution) -> tuple[Corrections, Alignment]:
    """Return the events with others between them that measure nothing, and the alignment among them."""
    own, events = solution.corrections, solution.corrections.events
    first = solution.alignment.event
    step = max(1, int(EACH / solution.measurement.interval))
    ends = [*events.at[first:].tolist(), solution.measurement.time.size - 1]
    extra = [k for a, b in pairwise(ends) for k in range(a + step, b, step)]
    if ends[-1] > ends[-2]:
        extra.append(ends[-1])
    count = len(extra)
    at = np.concatenate([events.at, np.array(extra, dtype=np.int64)])
    order = np.argsort(at, kind="stable")
    blank = np.zeros((count, 6))
    joined = Events(
        at[order], np.concatenate([events.kind, np.full(count, STRAIGHT)])[order],
        np.concatenate([events.late, np.zeros(count)])[order], np.concatenate([events.value, blank])[order],
        np.concatenate([events.variance, blank])[order],
    )  # fmt: skip
    time = np.concatenate([own.time, solution.measurement.time[np.array(extra, dtype=np.int64)]])[order]
    fix = np.concatenate([own.fix, np.full(count, -1)])[order]
    place = int(np.flatnonzero(order == first)[0])
    return Corrections(joined, time, fix, own.notes), replace(solution.alignment, event=place)


def _states(run: Solution, order: Integers, samples: Integers) -> Floats:
    """Return the forward states at samples, (n, 10): those after an event at its sample, propagated between events."""
    track, events = run.track, run.corrections.events
    n = int(run.tables.first[6])
    space, no_track = workspace(n), empty_track(0, n)
    states = np.zeros((samples.size, 10))
    at = events.at[order]
    for k, e in enumerate(order.tolist()):
        begin = int(at[k])
        states[begin - samples[0]] = track.state[e, :10]
        end = int(at[k + 1]) if k + 1 < order.size else begin
        marks = np.arange(begin + 2, end + 1)  # numbers of samples up to each sample between the two events
        if not marks.size:
            continue
        part = np.zeros((marks.size, 10))
        kernel.run(
            track.state[e].copy(), track.axes[e].copy(), flat(track.covariance[e]), run.measurement.samples, events, run.rules,
            run.tables, space, begin + 1, int(e) + 1, -1, ALL,
            Marks(marks, False, part, np.zeros((marks.size, NAVIGATION, NAVIGATION))), no_track,
        )  # fmt: skip
        states[begin + 1 - samples[0] : end - samples[0]] = part
    return states


def _moved(states: Floats, change: Floats, sigma: Floats) -> NavigationTrack:
    """Return states after changes of position (m), velocity (m/s) and attitude (rad), (n, 9), are added."""
    position = states[:, :3] + change[:, :3] / ned_scale(states[:, 0], states[:, 2])
    # The difference of attitudes is minus the error that is removed: C_true = (I + [phi x]) C.
    half = -change[:, 6:9] / 2
    w, v = states[:, QUATERNION], states[:, QUATERNION + 1 : QUATERNION + 4]
    scalar = w - (half * v).sum(axis=1)
    turned = np.column_stack([scalar, v + w[:, None] * half + np.cross(half, v)])
    quaternion = turned / np.linalg.norm(turned, axis=1, keepdims=True)
    return NavigationTrack(position, states[:, VELOCITY : VELOCITY + 3] + change[:, 3:6], quaternion, sigma)
