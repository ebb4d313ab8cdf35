"""What a sensor's errors really are, where a log knows the truth: measured less what the true motion asks for."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from imuwb.geodesy.attitude import rotation_of_euler, rotation_of_quaternion
from imuwb.log import SECOND
from imuwb.navigation.strapdown import QUATERNION, VELOCITY, mechanize, navigation_state

if TYPE_CHECKING:
    from imuwb.log import Floats
    from imuwb.replay.replay import Prepared

WINDOW = 2.0  #: s, over which a sensor's increments are carried on from the truth to the truth
MEAN = 30.0  #: s, over which windows are averaged: what white noise is left then


def true_errors(prepared: Prepared) -> tuple[Floats, Floats] | None:
    """Return the errors of gyros and accelerometers, averaged over half a minute; None where the log has no truth with attitude.

    From each true state the measured increments are carried on for a short while; how far attitude and velocity then are from
    the next true state, by time, is the mean error of the sensors meanwhile.

    Returns:
        (k,) s from the log's start, and (k, 6) rad/s and m/s², ``gyro_x`` ... ``accel_z``, in the vehicle's axes.
    """
    log, moves = prepared.log, prepared.moves
    truth = next((r for r in log.references if r.attitude is not None and r.velocity is not None), None)
    if truth is None or truth.attitude is None or truth.velocity is None:
        return None
    time = (truth.time - (log.zero or 0)) / SECOND
    at = np.searchsorted(moves.time, time - moves.interval / 2)
    inside = (at < moves.time.size - 1) & (
        np.abs(moves.time[np.minimum(at, moves.time.size - 1)] - time) < moves.interval / 10
    )
    rows = np.flatnonzero(inside)
    if rows.size < 2:  # noqa: PLR2004 - a window has two ends
        return None
    step = max(1, round(WINDOW / float(np.median(np.diff(time[rows])))))
    ends = rows[::step]
    samples, found, middle = moves.samples, [], []
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
        found.append(np.concatenate([angle, push]) / span)
        middle.append((time[a] + time[b]) / 2)
    width = max(1, round(MEAN / WINDOW))
    if len(found) < width:
        return None
    summed = np.cumsum(np.vstack([np.zeros(6), *found]), axis=0)
    centre = np.convolve(middle, np.full(width, 1 / width), "valid")
    return centre, (summed[width:] - summed[:-width]) / width
