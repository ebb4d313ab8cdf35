"""The mounting of an IMU in a vehicle: roll and pitch from gravity in standstills, heading from accelerations and turns."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Complexes, Floats
from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import euler_of_rotation, rotation_of_euler
from imuwb.log import SECOND, GnssStream, Log
from imuwb.navigation.filter_model import Installation
from imuwb.navigation.measurement import Measurement, measurement_of
from imuwb.navigation.standstill import standstills
from imuwb.replay.prepared import receiver_of
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_limit

STILL = 5.0  #: s of standstills that roll and pitch need
SLOW = 2.0  #: m/s; at a lower speed the course is unknown
WINDOW = 1.0  #: s, over which accelerations are averaged
LEAST = 20  #: fewest windows that the heading needs
LEAST_ACCELERATION = 0.3  #: m/s², rms that the heading needs
LARGEST_ACCELERATION = 10.0  #: m/s²; larger ones are errors


@dataclass(frozen=True, slots=True)
class Mounting:
    """Roll, pitch and heading that turn vectors from the vehicle's axes to the IMU's, as ``Installation`` has them."""

    angles: tuple[float, float, float]  #: deg; roll and pitch assume that the vehicle stands still on level ground
    heading: Estimate  #: deg

    def __str__(self) -> str:
        """Return the angles in a line."""
        roll, pitch, _ = self.angles
        return f"Mounting: roll {roll:.2f}, pitch {pitch:.2f} deg, heading {self.heading}"


def estimate_mounting(log: Log, receiver: str | None, level: float) -> Mounting:
    """Return the mounting of the first IMU, from the log itself.

    In a standstill, gravity gives roll and pitch. In motion, the horizontal specific force is the vehicle's acceleration,
    forward and to the right. The receiver gives the same acceleration. As complex numbers, the two differ by the heading.

    Args:
        log: an IMU, and a receiver with velocities.
        receiver: its name; None: the best one.
        level: of the heading's interval.

    Raises:
        MissingDataError: no velocities, no standstill, or too little acceleration.
    """
    gnss = receiver_of(log, receiver) if log.gnss else None
    if gnss is None or gnss.velocity is None or not np.isfinite(gnss.velocity[:, :2]).all(axis=1).any():
        raise MissingDataError(
            f"{log.provenance.path}: a receiver with velocities is needed to estimate the mounting; give the angles with --mounting"
        )
    measurement = measurement_of(log, log.imu(), Installation())
    level_rotation = _level(log, gnss, measurement)
    true, measured = _accelerations(log, gnss, measurement, level_rotation)
    if true.size < LEAST or np.sqrt((np.abs(true) ** 2).mean()) < LEAST_ACCELERATION:
        raise MissingDataError(
            f"{log.provenance.path}: the accelerations are too small to estimate the mounting: {LEAST} seconds with "
            f"{LEAST_ACCELERATION:g} m/s² (rms) are needed; give the angles with --mounting"
        )
    centred = measured - measured.mean()
    turn = np.vdot(true, centred) / np.vdot(true, true).real
    rest = np.abs(centred - turn * true)
    sigma = float(np.sqrt((rest**2).mean() / 2 / (np.abs(true) ** 2).sum()) / np.abs(turn))
    # The IMU measures a vector turned by the angle of ``turn``; this rotation turns it back to the vehicle's axes.
    whole = rotation_of_euler(np.array([0.0, 0.0, -float(np.angle(turn))])) @ level_rotation
    roll, pitch, heading = (float(np.degrees(x)) for x in euler_of_rotation(whole.T))
    sigma = float(np.degrees(sigma))
    half = normal_limit(level) * sigma
    return Mounting((roll, pitch, heading), Estimate(heading, heading - half, heading + half, sigma, "deg"))


def _level(log: Log, gnss: GnssStream, measurement: Measurement) -> Floats:
    """Return the rotation that levels the IMU's axes, from the specific force in standstills."""
    rows = np.zeros(measurement.time.size, dtype=bool)
    for begin, end in standstills(measurement, log, gnss):
        rows |= (measurement.time > begin) & (measurement.time <= end)
    if rows.sum() * measurement.interval < STILL:
        raise MissingDataError(
            f"{log.provenance.path}: {STILL:g} s of standstill are needed to estimate the mounting; give the angles with --mounting"
        )
    force = measurement.samples.velocity[rows].sum(axis=0) / measurement.samples.interval[rows].sum()
    roll = float(np.arctan2(-force[1], -force[2]))
    pitch = float(np.arctan2(force[0], np.hypot(force[1], force[2])))
    return rotation_of_euler(np.array([roll, pitch, 0.0]))


def _accelerations(
    log: Log, gnss: GnssStream, measurement: Measurement, level_rotation: Floats
) -> tuple[Complexes, Complexes]:
    """Return the accelerations from receiver and IMU, (k,) and (k,) m/s²: forward + i right, in windows of motion."""
    velocity = np.zeros((len(gnss), 3)) if gnss.velocity is None else gnss.velocity
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    known = np.isfinite(speed)
    time, speed = ((gnss.time - (log.zero or 0)) / SECOND)[known], speed[known]
    course = np.unwrap(np.arctan2(velocity[known, 1], velocity[known, 0]))
    own = measurement.time
    edges = np.arange(max(time[0], own[0]) + WINDOW, min(time[-1], own[-1]) - WINDOW, WINDOW)
    pushed = np.cumsum(measurement.samples.velocity @ level_rotation.T, axis=0)
    ahead, across = (np.diff(np.interp(edges, own, pushed[:, i])) / WINDOW for i in range(2))
    measured = ahead + 1j * across
    at_edges = np.interp(edges, time, speed)
    middle = (at_edges[1:] + at_edges[:-1]) / 2
    true = np.diff(at_edges) / WINDOW + 1j * middle * np.diff(np.interp(edges, time, course)) / WINDOW
    good = (at_edges[1:] > SLOW) & (at_edges[:-1] > SLOW)
    good &= (np.abs(true) < LARGEST_ACCELERATION) & (np.abs(measured) < LARGEST_ACCELERATION)
    return true[good], measured[good]
