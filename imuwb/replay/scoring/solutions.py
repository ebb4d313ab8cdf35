"""Solutions that another engine has computed, scored in the outages of a replay or over the whole run."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.log import SECOND, GnssStream, Reference
from imuwb.navigation.outages import Drift
from imuwb.replay.outages import Outage
from imuwb.replay.references.reference import ReferenceTrack, given_track, own_track
from imuwb.replay.references.reference_check import discrepancy
from imuwb.replay.replay import Replay
from imuwb.replay.scoring.overlap import without_overlap
from imuwb.replay.scoring.scores import Scores, scores

ROUNDING = 1e-3  #: s; a fix that is this much later still precedes an outage
EACH = 1.0  #: s between two scores of a whole run
BLOCK = (
    60.0  #: s, span over which the errors of a whole run count as one; also the time that its scores are listed under
)


def overlapping(replay: Replay) -> bool:
    """Return whether any two outages of a replay overlap, so that no single run can lack the fixes of all."""
    outages = [outage for of_duration in replay.outages.values() for outage in of_duration]
    kept = without_overlap([o.start for o in outages], np.array([o.duration for o in outages]))
    return kept.size < len(outages)


def fixes_outside(gnss: GnssStream, zero: int, outages: Sequence[Outage], delay: float = 0.0) -> GnssStream:
    """Return a receiver without the fixes within some outages: after the start, up to the end.

    Args:
        gnss: the receiver.
        zero: ns, start of the log.
        outages: on the clock of the IMU.
        delay: s, by which the stamps of the fixes are late.
    """
    time = (gnss.time - zero) / SECOND - delay
    kept = np.ones(time.size, dtype=bool)
    for outage in outages:
        kept &= (time <= outage.start + ROUNDING) | (time > outage.start + outage.duration + ROUNDING)
    return rows_of(gnss, kept)


def rows_of(gnss: GnssStream, kept: Booleans) -> GnssStream:
    """Return some of the fixes of a receiver."""
    names = ("time", "position", "velocity", "position_sigma", "velocity_sigma", "fix_type")
    values = {name: getattr(gnss, name) for name in names}
    return replace(gnss, **{name: None if x is None else x[kept] for name, x in values.items()})


def solution_scores(replay: Replay, solution: Reference, duration: float, rows: Integers) -> Scores:
    """Return the errors of a solution in some outages of a duration; without sigmas, the covariance and the NEES are nan.

    Args:
        replay: the replay.
        solution: on the log's clock, of the IMU.
        duration: s.
        rows: (k,) the outages, among those of this duration.
    """
    first = next(iter(replay.runs.values())).outages[duration]
    drift = _drift(replay, solution, first.drift.start[rows], first.drift.elapsed, first.drift.time[rows])
    extent = first.scores.discrepancy
    return _scored(drift, replay.reference, solution, None if extent is None else extent[rows])


def whole_run_scores(replay: Replay, solution: Reference | None, name: str = "") -> Scores:
    """Return the errors of a solution over the whole run, once a second after the filters have settled.

    Args:
        replay: the replay.
        solution: on the log's clock, of the IMU; None: a filter of the replay.
        name: of this filter.
    """
    run = next(iter(replay.runs.values())) if solution is not None else replay.runs[name]
    settled = replay.prepared.start_time + run.solution.model.settings.settling
    time = np.arange(settled, replay.prepared.measurement.time[-1], EACH)
    extent = np.zeros((time.size, 1))
    if replay.reference.kind != "own":
        extent = discrepancy(replay.reference, time - EACH, time[:, None])
    if solution is None:
        own = own_track(run.solution)
        drift = _of_track(own, time, np.array([BLOCK]), time[:, None])
        found = scores(drift, replay.reference, extent)
    else:
        found = _scored(
            _drift(replay, solution, time, np.array([BLOCK]), time[:, None]), replay.reference, solution, extent
        )
    return found.of(np.flatnonzero(np.isfinite(found.horizontal[:, -1])), BLOCK)


def _drift(replay: Replay, solution: Reference, start: Floats, elapsed: Floats, time: Floats) -> Drift:
    return _of_track(given_track(replay.prepared.log, solution), start, elapsed, time)


def _of_track(track: ReferenceTrack, start: Floats, elapsed: Floats, time: Floats) -> Drift:
    """Return a track at the marks of outages as the drift of a filter."""
    position, velocity, heading, sigma = track.at(time)
    count, length = time.shape
    level = np.zeros_like(heading)
    quaternion = np.stack(
        [np.cos(heading / 2), level, level, np.sin(heading / 2)], axis=-1
    )  # only the heading is scored
    covariance = np.zeros((count, length, 9, 9))
    covariance[..., [0, 1, 2], [0, 1, 2]] = sigma**2
    sound = np.asarray(np.isfinite(position).all(axis=(1, 2)))
    zeros = np.zeros((count, length), np.int64)
    state = np.concatenate([np.nan_to_num(position), velocity, quaternion], axis=-1)
    return Drift(np.zeros(count, np.int64), start, elapsed, zeros, time, state, covariance, sound)


def _scored(drift: Drift, reference: ReferenceTrack, solution: Reference, extent: Floats | None) -> Scores:
    found = scores(drift, reference, extent)
    if solution.position_sigma is None:
        return replace(found, covariance=np.full_like(found.covariance, np.nan))
    return found
