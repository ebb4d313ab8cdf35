"""The course over ground of a slow vehicle, from positions over a longer, straight baseline."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy.earth import ned_scale
from imuwb.navigation.corrections import Corrections

SPANS = (5.0, 10.0, 20.0, 40.0)  #: s, the baselines that are tried in this order
CLEAR = 8.0  #: sigmas of a position; a shorter baseline does not give a course
SHORTEST = 2.0  #: m
BENT = 0.15  #: share of a baseline; a track that is further from the straight line is a bend
WITHIN = (0.25, 0.5, 0.75)  #: shares of a baseline at which the track must be near the straight line
WIDER = 1.5  #: ratio of a baseline with missing fixes to the wanted one, at most
CRAB = 10.0  #: deg, sigma of the angle between a vehicle's course and its heading


@dataclass(frozen=True, slots=True)
class StraightCourse:
    """A course over ground in the middle of a straight baseline."""

    time: float  #: s from the log's start, in the middle
    course: float  #: deg
    sigma: float  #: deg, of a heading that is taken from this course
    length: float  #: m, of the baseline
    span: float  #: s, of the baseline


def straight_course(corrections: Corrections, after: float = -np.inf) -> StraightCourse | None:
    """Return the first course that is clear, over the shortest baseline that gives one; None if there is none.

    In the middle of an arc, the course is that of its chord. The sigma contains that of the positions, the bend of the track,
    and ``CRAB``.

    Args:
        corrections: the log's fixes.
        after: s from the log's start; the middle of the baseline must be later.
    """
    rows = np.flatnonzero((corrections.fix >= 0) & (corrections.events.variance[:, :2] > 0).all(axis=1))
    if rows.size < 3:  # noqa: PLR2004 - a baseline has two ends and a middle
        return None
    time, position = corrections.time[rows], corrections.events.value[rows, :3]
    north_east = ((position - position[0]) * ned_scale(position[0, 0], position[0, 2]))[:, :2]
    sigma = np.sqrt(corrections.events.variance[rows, :2].max(axis=1))
    for span in SPANS:
        found = _first(time, north_east, sigma, span, after)
        if found is not None:
            return found
    return None


def _first(time: Floats, north_east: Floats, sigma: Floats, span: float, after: float) -> StraightCourse | None:
    begin = np.arange(time.size)
    within = [np.searchsorted(time, time + span * share) for share in WITHIN]
    end = np.searchsorted(time, time + span)
    kept = end < time.size
    begin, end, within = begin[kept], end[kept], np.stack([row[kept] for row in within])
    middle = within[len(WITHIN) // 2]
    chord = north_east[end] - north_east[begin]
    length = np.hypot(chord[:, 0], chord[:, 1])
    parts = north_east[within] - north_east[begin]
    spread = np.maximum(sigma[begin], sigma[end])
    with np.errstate(divide="ignore", invalid="ignore"):
        bend = np.abs(chord[:, 0] * parts[..., 1] - chord[:, 1] * parts[..., 0]).max(axis=0) / length
        clear = (length > np.maximum(CLEAR * spread, SHORTEST)) & (bend < BENT * length)
    clear &= (time[end] - time[begin] < WIDER * span) & (middle > begin) & (middle < end) & (time[middle] > after)
    rows = np.flatnonzero(clear)
    if not rows.size:
        return None
    k = rows[0]
    angle = np.hypot(np.sqrt(2) * spread[k], bend[k]) / length[k]
    return StraightCourse(
        float(time[middle[k]]), float(np.degrees(np.arctan2(chord[k, 1], chord[k, 0])) % 360),
        float(np.hypot(np.degrees(angle), CRAB)), float(length[k]), float(time[end[k]] - time[begin[k]]),
    )  # fmt: skip
