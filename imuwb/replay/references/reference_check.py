"""Whether a reference can judge: its positions against its own velocities, and against the fixes.

A reference with steps between its solutions, or a smoothed run of a filter that has diverged, has an error of its own that its
sigmas do not show. The positions and the velocities of a reference are two statements on the same motion. Over an outage their
discrepancy is d(t) = displacement since the start minus the integral of the velocity; its extent

    w = sqrt((max d_north - min d_north)² + (max d_east - min d_east)²)

is 0 for a reference that is right, whatever the motion. A receiver's velocities may be older than its positions by a constant time;
this lag is estimated, and is no contradiction. w²/4 for each axis is added to the covariance of a score, as if the
reference were uniformly in error within its discrepancy. Where w exceeds the drift that is to be measured, the outage is not scored.
"""

from collections.abc import Sequence

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.geodesy.earth import ned_scale
from imuwb.replay.prepared import Prepared
from imuwb.replay.references.reference import GAP, ReferenceTrack
from imuwb.replay.scoring.scores import Scores

FASTER = 2.0, 10.0  #: a run that is faster than this many times the fixes, and this much more, m/s, is implausible
TOP = 0.99  #: quantile of speeds that counts as the top speed
FAR = (
    5.0,
    10.0,
)  #: sigmas of the fixes, and m, between a reference and the fixes (median), above which they contradict each other
ELSEWHERE = 10_000.0  #: m, median; no receiver errs by so much: the reference is of another place
FROM_FIXES = ("smoothed", "own", "estimate")  #: kinds of references that follow from the fixes
FINE = 0.1  #: s; points of a reference that are closer are left out when an extent is looked for
BASELINE = 1.0  #: s, least time between two fixes whose displacement is a speed
ROUNDS, OUTLYING = 3, 4.0  #: rounds of the estimate of a lag, and residuals, in medians, that do not count
LONGEST_LAG = 1.0  #: s; what would need a longer one is no lag
NEARLY_ALL = 0.9  #: share of the outages; a reference that is refused in more of them is refused as a whole


def discrepancy(track: ReferenceTrack, start: Floats, time: Floats) -> Floats:
    """Return the extent of displacement minus integral of the velocity, m, from the start of an outage to each mark.

    The integral is the trapezoid with its correction for accelerations at the ends (Euler and Maclaurin), and the velocities are
    those without their lag.

    Args:
        track: the reference; without velocities of its own, the result is 0.
        start: (s,) s from the log's start.
        time: (s, L) likewise, rising.

    Returns:
        (s, L); nan where the outage lies outside the reference, or in a gap of it.
    """
    if not track.velocity_stated:
        return np.zeros(time.shape)
    at = track.time
    excess = _excess(track) - velocity_lag(track) * np.diff(track.velocity[:, :2], axis=0)
    off = np.concatenate([np.zeros((1, 2)), np.cumsum(excess, axis=0)])
    gaps = np.concatenate([[0], np.cumsum(np.diff(at) > GAP)])
    thin = np.arange(0, at.size, max(1, int(FINE / max(float(np.median(np.diff(at))), 1e-6))))
    thin = np.unique(np.append(thin, at.size - 1))
    at, off, gaps = at[thin], off[thin], gaps[thin]
    found = np.full(time.shape, np.nan)
    for i, (begin, ends) in enumerate(zip(start, time, strict=True)):
        if begin < at[0] or ends[-1] > at[-1]:
            continue
        first, last = (int(np.searchsorted(at, t)) for t in (begin, ends[-1]))
        if gaps[min(last, at.size - 1)] > gaps[max(first - 1, 0)]:
            continue
        moments = np.union1d(np.concatenate([[begin], ends]), at[first:last])
        path = np.stack([np.interp(moments, at, off[:, k]) for k in range(2)], axis=1)
        extent = np.maximum.accumulate(path, axis=0) - np.minimum.accumulate(path, axis=0)
        found[i] = np.hypot(*extent.T)[np.searchsorted(moments, ends)]
    return found


def _excess(track: ReferenceTrack) -> Floats:
    """Return displacement minus integral of the velocity between neighbours, (n - 1, 2) m."""
    scale = ned_scale(track.position[:, 0], track.position[:, 2])[:, :2]
    step, v = np.diff(track.time)[:, None], track.velocity[:, :2]
    moved = np.diff(track.position[:, :2], axis=0) * (scale[1:] + scale[:-1]) / 2
    acceleration = np.gradient(v, track.time, axis=0)
    return moved - (v[1:] + v[:-1]) / 2 * step + np.diff(acceleration, axis=0) * step**2 / 12


def velocity_lag(track: ReferenceTrack) -> float:
    """Return the time by which the velocities of a reference are older than its positions, s.

    A lag adds lag times the change of the velocity to the displacement over its integral. Least squares over neighbours,
    twice without those that are far off: steps of the positions are no lag.
    """
    excess, change = _excess(track), np.diff(track.velocity[:, :2], axis=0)
    kept = np.diff(track.time) <= GAP
    lag = 0.0
    for _ in range(ROUNDS):
        power = float(np.square(change[kept]).sum())
        if power == 0:
            return 0.0
        lag = float((excess[kept] * change[kept]).sum()) / power
        left = np.hypot(*(excess - lag * change).T)
        kept = (np.diff(track.time) <= GAP) & (left <= OUTLYING * np.median(left))
    return lag if abs(lag) <= LONGEST_LAG else 0.0


def contradiction(track: ReferenceTrack, prepared: Prepared) -> str | None:
    """Return how a reference contradicts the fixes of the log, or None.

    A reference that follows from these fixes (``FROM_FIXES``) cannot judge then; for truth the fixes may be what is wrong.
    """
    fixes = prepared.corrections.fix >= 0
    time, rows = prepared.fix_time, prepared.corrections.fix[fixes]
    inside = (time >= track.time[0]) & (time <= track.time[-1])
    if inside.sum() < 2:  # noqa: PLR2004 - a displacement has two ends
        return None
    time, position = time[inside], prepared.gnss.position[rows[inside]]
    scale = ned_scale(position[:, 0], position[:, 2])
    fastest = _top_speed(time, position[:, :2] * scale[:, :2].mean(axis=0))
    own = float(np.quantile(np.hypot(track.velocity[:, 0], track.velocity[:, 1]), TOP))
    if own > FASTER[0] * fastest + FASTER[1]:
        return f"it runs at up to {own * 3.6:.0f} km/h, while the fixes move at up to {fastest * 3.6:.0f} km/h"
    known = _distances(track, prepared)
    variance = prepared.corrections.events.variance[fixes][inside, 0]
    far = max(FAR[0] * float(np.sqrt(np.median(variance))), FAR[1])
    if known.size and np.median(known) > far:
        return f"it lies {np.median(known):.0f} m from the fixes (median), and {far:.0f} m could be explained"
    return None


def elsewhere(track: ReferenceTrack, prepared: Prepared) -> str | None:
    """Return that a reference lies far from all fixes, or None: whatever its kind, it cannot judge then."""
    known = _distances(track, prepared)
    if not known.size or np.median(known) <= ELSEWHERE:
        return None
    return (
        f"it lies {np.median(known) / 1000:.0f} km from the fixes (median): it is of another place, or its latitude and longitude "
        "are exchanged or have another unit"
    )


def _distances(track: ReferenceTrack, prepared: Prepared) -> Floats:
    """Return the horizontal distances between a reference and the fixes within it, m."""
    position = prepared.gnss.position[prepared.corrections.fix[prepared.corrections.fix >= 0]]
    apart = (track.at(prepared.fix_time)[0] - position) * ned_scale(position[:, 0], position[:, 2])
    distance = np.hypot(*apart[:, :2].T)
    return distance[np.isfinite(distance)]


def _top_speed(time: Floats, place: Floats) -> float:
    """Return the top speed of fixes, m/s, by their displacements over a second or more."""
    after = np.searchsorted(time, time + BASELINE)
    first = np.flatnonzero(after < time.size)
    if not first.size:
        return 0.0
    gone = np.linalg.norm(place[after[first]] - place[first], axis=1) / (time[after[first]] - time[first])
    return float(np.quantile(gone, TOP))


def yardsticks(extent: Floats, own: Sequence[Scores]) -> Booleans:
    """Return in which outages the reference's discrepancy is not larger than the drift, so that it can judge, (s,).

    The drift is that of the best filter against its own run over all fixes, so that the reference has no part in it, and its
    median over all outages. The drift of a single outage would not do: outages in which the filters are good by chance
    would be left out, and the filters would look worse than they are.

    Args:
        extent: (s,) m, the discrepancy at the end of each outage; nan: unknown.
        own: scores of each filter in the same outages, of one duration, against its own run.
    """
    ends = [s.horizontal[:, -1] for s in own]
    known = [float(np.median(end[np.isfinite(end)])) for end in ends if np.isfinite(end).any()]
    return ~(extent > min(known)) if known else np.ones(extent.size, dtype=bool)
