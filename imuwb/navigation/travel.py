"""When the receivers and odometers of a log show that the vehicle travels, whatever its IMU feels.

A vehicle that travels evenly may shake its IMU no more than a bench does. Velocities are judged by their median over some seconds,
so that single spikes do not count, and against their stated sigma and their own scatter, so that the noise of a simple receiver
at rest does not count either.
"""

from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.geodesy.earth import ned_scale
from imuwb.log import GnssStream, Log, Reference
from imuwb.sampling import runs
from imuwb.statistics.running import running_median

WINDOW = 5.0  #: s over which the median of a velocity is taken; positions are compared over twice as much
SLOW, CLIMB = 0.5, 1.0  #: m/s; a slower velocity, or vertical velocity, does not show that the vehicle travels
UNSURE = 1.0  #: m/s; the same for a velocity without a sigma
TURNING = 0.1  #: m/s; above this speed the wheels turn
SIGMAS = 4.0  #: sigmas of a velocity or of a displacement, beyond which it is no error
CORRELATED = 3.0  #: times the scatter over √n; the error of a mean of n velocities, whose errors are correlated
CONSISTENT = 1.4826 / 6**0.5  #: sigma of normal values over the median of their second differences
USUAL = 2.5  #: m, sigma of a position without a sigma
FIX_2D = 2  #: as in ``GnssStream``
FEWEST = 3  #: rows of a window

Located = GnssStream | Reference


def travels(log: Log) -> Floats:
    """Return the spans in which a receiver, an odometer or a trajectory shows that the vehicle travels.

    Trajectories of the vehicle's own filter count only in a log without receivers and odometers.

    Returns:
        (k, 2) begin and end, s from the log's start, rising; they do not overlap.
    """
    spans: list[tuple[float, float]] = []
    for gnss in log.gnss:
        spans += _of_rows(*_moves(gnss, log.seconds(gnss.time)))
    for odometer in log.speeds:
        size = _size(log.seconds(odometer.time))
        spans += _of_rows(log.seconds(odometer.time), np.abs(_median(odometer.value, size)) > TURNING)
    for track in log.references:
        if not track.origin.by_filter or not (log.gnss or log.speeds):
            spans += _of_rows(*_moves(track, log.seconds(track.time)))
    return np.array(list(_merged(spans)), np.float64).reshape(-1, 2)


def displaced(middle: Floats, time: Floats, track: Located) -> Booleans:
    """Return around which times the positions move by more than their sigmas explain.

    Args:
        middle: (m,) s.
        time: (n,) s of the positions.
        track: (n,) positions.
    """
    sigma = USUAL
    if track.position_sigma is not None and np.isfinite(track.position_sigma[:, :2]).any():
        sigma = float(np.nanmedian(track.position_sigma[:, :2]))
    north_east = ((track.position - track.position[0]) * ned_scale(track.position[0, 0], track.position[0, 2]))[:, :2]
    ends = [
        np.stack([np.interp(middle + side, time, north_east[:, i]) for i in range(2)]) for side in (-WINDOW, WINDOW)
    ]
    return np.hypot(*(ends[1] - ends[0])) > max(SIGMAS * np.sqrt(2) * sigma, SLOW)


def _moves(track: Located, time: Floats) -> tuple[Floats, Booleans]:
    """Return the times of a receiver or a trajectory at which its motion is known, and whether it moves then."""
    fixed = np.ones(time.size, dtype=bool)
    if isinstance(track, GnssStream) and track.fix_type is not None:
        fixed = track.fix_type >= FIX_2D
    velocity = np.full((time.size, 3), np.nan) if track.velocity is None else track.velocity
    known = fixed & np.isfinite(velocity[:, :2]).all(axis=1)
    if np.count_nonzero(known) >= FEWEST:
        stated = track.velocity_sigma
        sigma = np.full((time.size, 3), np.nan) if stated is None else stated
        return time[known], _fast(velocity[known], sigma[known], _size(time[known]))
    return time[fixed], displaced(time[fixed], time, track)


def _fast(velocity: Floats, sigma: Floats, size: int) -> Booleans:
    """Return the rows whose velocity, as a median over ``size`` rows, is no error of the receiver."""
    velocity, sigma = np.nan_to_num(velocity), np.nan_to_num(sigma)
    usual = np.stack([_median(column, size) for column in velocity.T], axis=1)
    scatter = CONSISTENT * np.median(np.abs(np.diff(velocity, 2, axis=0)), axis=0) * CORRELATED / np.sqrt(size)
    stated = np.stack([_median(column, size) for column in sigma.T], axis=1)
    error = SIGMAS * np.maximum(stated, scatter)
    least = np.where(stated[:, :2].any(axis=1), SLOW, UNSURE)
    level = np.linalg.norm(usual[:, :2], axis=1) > np.maximum(least, np.linalg.norm(error[:, :2], axis=1))
    return level | (np.abs(usual[:, 2]) > np.maximum(CLIMB, error[:, 2]))


def _size(time: Floats) -> int:
    """Return the number of rows in a window; it is odd."""
    step = float(np.median(np.diff(time))) if time.size > 1 else WINDOW
    return max(FEWEST, int(WINDOW / max(step, 1e-6)) // 2 * 2 + 1)


def _median(values: Floats, size: int) -> Floats:
    """Return the median of the ``size`` rows around each row."""
    return running_median(values, min(size, values.size | 1), "mirror")


def _of_rows(time: Floats, moving: Booleans) -> Iterator[tuple[float, float]]:
    """Yield the spans of the rows that move; a row stands for half a step, at most half a window, on each side."""
    if time.size < FEWEST:
        return
    half = min(float(np.median(np.diff(time))), WINDOW) / 2
    broken = np.append(True, np.diff(time) > WINDOW)  # no span goes on where the rows are missing
    first, length = runs(moving)
    for start, stop in zip(first, first + length, strict=True):
        edges = [start, *(start + 1 + np.flatnonzero(broken[start + 1 : stop])), stop]
        for a, b in pairwise(edges):
            if b - a < _size(time):  # a shorter travel would not show in a median, so it is an error
                continue
            yield float(time[a]) - half, float(time[b - 1]) + half


def _merged(spans: Iterable[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """Yield spans in order, those that touch as one."""
    begin = end = float("-inf")
    for start, stop in sorted(spans):
        if start > end:
            if end > begin:
                yield begin, end
            begin = start
        end = max(end, stop)
    if end > begin:
        yield begin, end
