"""How an IMU sits in a vehicle: level from gravity while it stands, heading from how it speeds up and turns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import euler_of_rotation, rotation_of_euler
from imuwb.log import SECOND
from imuwb.navigation.alignment import standing
from imuwb.navigation.filter_model import Installation
from imuwb.navigation.measurement import measurement
from imuwb.replay.replay import receiver_of
from imuwb.statistics.distributions import normal_limit

if TYPE_CHECKING:
    from imuwb.log import Log

STILL = 5.0  #: s that tell the level
SLOW = 2.0  #: m/s, below which a course tells nothing
WINDOW = 1.0  #: s, over which accelerations are taken
LEAST = 20  #: windows
LEAST_PUSH = 0.3  #: m/s², rms of the accelerations that tell the heading


@dataclass(frozen=True, slots=True)
class Mounting:
    """Roll, pitch and heading that turn vectors from the vehicle's axes to the IMU's, as ``Installation`` has them."""

    angles: tuple[float, float, float]  #: deg
    heading_half_width: (
        float  #: deg, of the heading's interval; roll and pitch are as level as the places where it stood
    )


def estimate_mounting(log: Log, receiver: str | None, level: float) -> Mounting:
    """Return how the IMU sits, from the log itself.

    While the vehicle stands, gravity tells roll and pitch. In motion, the specific force that is left in the plane is the
    vehicle's own acceleration, ahead and across, as the receiver tells it: both as complex numbers differ by the heading.

    Args:
        log: an IMU and a receiver with velocities.
        receiver: its name; None: the first.
        level: of the interval.

    Raises:
        MissingDataError: no velocities, no stillness, too little acceleration.
    """
    gnss = receiver_of(log, receiver) if log.gnss else None
    if gnss is None or gnss.velocity is None:
        message = (
            f"{log.provenance.path}: the mounting can be estimated only with a receiver's velocities; give --mounting"
        )
        raise MissingDataError(message)
    moves = measurement(log, log.imu(), Installation())
    rows = np.zeros(moves.time.size, dtype=bool)
    for begin, end in standing(moves, log, gnss):
        rows |= (moves.time > begin) & (moves.time <= end)
    if rows.sum() * moves.interval < STILL:
        message = f"{log.provenance.path}: the vehicle never stands for {STILL:g} s: its level cannot be told; give --mounting"
        raise MissingDataError(message)
    force = moves.samples.velocity[rows].sum(axis=0) / moves.samples.interval[rows].sum()
    roll = float(np.arctan2(-force[1], -force[2]))
    pitch = float(np.arctan2(force[0], np.hypot(force[1], force[2])))
    flat = rotation_of_euler(np.array([roll, pitch, 0.0]))
    time = (gnss.time - (log.zero or 0)) / SECOND
    speed = np.hypot(gnss.velocity[:, 0], gnss.velocity[:, 1])
    known = np.isfinite(speed)
    time, speed = time[known], speed[known]
    course = np.unwrap(np.arctan2(gnss.velocity[known, 1], gnss.velocity[known, 0]))
    edges = np.arange(max(time[0], moves.time[0]) + WINDOW, min(time[-1], moves.time[-1]) - WINDOW, WINDOW)
    pushed = np.cumsum(moves.samples.velocity @ flat.T, axis=0)
    measured = (
        np.diff(np.stack([np.interp(edges, moves.time, pushed[:, i]) for i in range(2)], axis=1), axis=0) / WINDOW
    )
    at_edges = np.interp(edges, time, speed)
    middle = (at_edges[1:] + at_edges[:-1]) / 2
    across = middle * np.diff(np.interp(edges, time, course)) / WINDOW
    told = np.diff(at_edges) / WINDOW + 1j * across
    seen = measured[:, 0] + 1j * measured[:, 1]
    good = (at_edges[1:] > SLOW) & (at_edges[:-1] > SLOW) & (np.abs(told) < 10) & (np.abs(seen) < 10)  # noqa: PLR2004 - m/s²
    told, seen = told[good], seen[good]
    if told.size < LEAST or np.sqrt((np.abs(told) ** 2).mean()) < LEAST_PUSH:
        message = (
            f"{log.provenance.path}: the vehicle speeds up and turns too little to tell the mounting; give --mounting"
        )
        raise MissingDataError(message)
    turn = np.vdot(told, seen - seen.mean()) / np.vdot(told, told).real
    rest = np.abs(seen - seen.mean() - turn * told)
    sigma = float(np.sqrt((rest**2).mean() / 2 / (np.abs(told) ** 2).sum()) / np.abs(turn))
    # What is seen at an angle lies, in the vehicle, that angle back.
    whole = rotation_of_euler(np.array([0.0, 0.0, -float(np.angle(turn))])) @ flat
    a, b, c = (float(np.degrees(x)) for x in euler_of_rotation(whole.T))
    return Mounting((a, b, c), float(np.degrees(normal_limit(level) * sigma)))
