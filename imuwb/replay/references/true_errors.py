"""The true errors of the sensors, from a log with the true motion."""

from itertools import pairwise

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy.attitude import rotation_of_euler, rotation_of_quaternion
from imuwb.log import SECOND
from imuwb.navigation.strapdown import QUATERNION, VELOCITY, mechanize, navigation_state
from imuwb.replay.prepared import Prepared

WINDOW = 2.0  #: s, between two true states
MEAN = 30.0  #: s, over which the errors are averaged against white noise


def true_errors(prepared: Prepared) -> tuple[Floats, Floats] | None:
    """Return the errors of gyros and accelerometers, averaged over half a minute; None for a log without a true attitude.

    The mechanization runs from each true state to the next one with the measured increments. Its errors of attitude and
    velocity at the end, over the time between, are the mean errors of the sensors.

    Returns:
        (k,) s from the log's start, and (k, 6) rad/s and m/s², ``gyro_x`` ... ``accel_z``, in the vehicle's axes.
    """
    log, measurement = prepared.log, prepared.measurement
    truth = next((r for r in log.references if r.attitude is not None and r.velocity is not None), None)
    if truth is None or truth.attitude is None or truth.velocity is None:
        return None
    time = (truth.time - (log.zero or 0)) / SECOND
    at = np.searchsorted(measurement.time, time - measurement.interval / 2)
    inside = (at < measurement.time.size - 1) & (
        np.abs(measurement.time[np.minimum(at, measurement.time.size - 1)] - time) < measurement.interval / 10
    )
    rows = np.flatnonzero(inside)
    if rows.size < 2:  # noqa: PLR2004 - a window has two ends
        return None
    step = max(1, round(WINDOW / float(np.median(np.diff(time[rows])))))
    ends = rows[::step]
    samples, errors, middle = measurement.samples, [], []
    for a, b in pairwise(ends):
        part = slice(int(at[a]) + 1, int(at[b]) + 1)
        span = float(samples.interval[part].sum())
        if not 0.5 * WINDOW < span < 2 * WINDOW:
            continue
        start = navigation_state(truth.position[a], truth.velocity[a], truth.attitude[a])
        last = mechanize(start, samples.interval[part], samples.angle[part], samples.velocity[part])[-1]
        true = rotation_of_euler(truth.attitude[b])
        turn = true.T @ rotation_of_quaternion(last[QUATERNION : QUATERNION + 4])
        angle = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
        push = true.T @ (last[VELOCITY : VELOCITY + 3] - truth.velocity[b])
        errors.append(np.concatenate([angle, push]) / span)
        middle.append((time[a] + time[b]) / 2)
    width = max(1, round(MEAN / WINDOW))
    if len(errors) < width:
        return None
    summed = np.cumsum(np.vstack([np.zeros(6), *errors]), axis=0)
    centre = np.convolve(middle, np.full(width, 1 / width), "valid")
    return centre, (summed[width:] - summed[:-width]) / width
