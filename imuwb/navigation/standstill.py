"""When an IMU stands still."""

from functools import lru_cache

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.log import SECOND, GnssStream, Log
from imuwb.navigation.measurement import Measurement
from imuwb.navigation.travel import SLOW, TURNING, displaced

QUIET = 4.0  #: ratio of the scatter of a still second, at most, to that of the quietest tenth of all seconds


def standstills(measurement: Measurement, log: Log, gnss: GnssStream | None) -> Floats:
    """Return when the IMU stands still.

    A second is still if the scatter of both triads is small, if the receiver, where it reports velocities, is slow, and if the
    odometer stands. Without velocities, the positions must not move: a robot on a smooth floor shakes less than its engine.

    Returns:
        (s, 2) begin and end, s from the log's start.
    """
    count = _samples(measurement)
    still = _quiet(measurement).copy()
    blocks = still.size
    if not blocks:
        return np.zeros((0, 2))
    begin = measurement.time[: blocks * count : count] - measurement.interval
    if gnss is not None and gnss.velocity is not None:
        speed = np.hypot(gnss.velocity[:, 0], gnss.velocity[:, 1])
        known = np.isfinite(speed)
        if known.any():
            time = (gnss.time - (log.zero or 0)) / SECOND
            still &= np.interp(begin + 0.5, time[known], speed[known]) < SLOW
    elif gnss is not None and len(gnss) > 1:
        still &= ~displaced(begin + 0.5, (gnss.time - (log.zero or 0)) / SECOND, gnss)
    for odometer in log.speeds:
        moving = (odometer.time[np.abs(odometer.value) > TURNING] - (log.zero or 0)) / SECOND
        still &= np.searchsorted(moving, begin) == np.searchsorted(moving, begin + count * measurement.interval)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(np.int8)))
    ends = np.append(begin, begin[-1] + count * measurement.interval)
    return np.stack([ends[edges[::2]], ends[edges[1::2]]], axis=1)


def _samples(measurement: Measurement) -> int:
    """Return the number of samples in a second."""
    return max(1, round(1 / measurement.interval))


@lru_cache(maxsize=1)  # a start and the filters look for standstills in the same samples
def _quiet(measurement: Measurement) -> Booleans:
    """Return in which seconds the scatter of both triads is small."""
    count = _samples(measurement)
    blocks = measurement.time.size // count
    still = np.ones(blocks, dtype=bool)
    for increments in (measurement.samples.angle, measurement.samples.velocity) if blocks else ():
        scatter = np.sqrt(increments[: blocks * count].reshape(blocks, count, 3).var(axis=1).sum(axis=1))
        still &= scatter <= QUIET * np.quantile(scatter, 0.1)
    return still
