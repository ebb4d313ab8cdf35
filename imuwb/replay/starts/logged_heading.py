"""The heading that an IMU states itself, and how it differs from gravity and from the course over ground."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.geodesy import rotation_of_euler, rotation_of_quaternion
from imuwb.log import SECOND, ImuStream, Log, Orientation
from imuwb.navigation.corrections import Corrections
from imuwb.replay.starts.straight_course import CRAB, StraightCourse, straight_course
from imuwb.selection import joined_name

COMPASS = 10.0  #: deg, sigma of a heading whose sigma is not stated: a magnetometer in a vehicle
NEAR = 0.5  #: s; an attitude is used at times that are this near to one of its rows
TILTED = 20.0  #: deg; an attitude whose vertical differs more from that of the accelerometers is not one of these axes
STEADY = 30.0  #: deg; headings whose difference from the course scatters more have no common zero
COURSES = 100  #: baselines that are compared, at most
FEWEST = 3  #: baselines from which a difference is judged
CLEAR = 3.0  #: sigmas of a difference that contradicts the course


@dataclass(frozen=True, slots=True)
class LoggedHeading:
    """A heading of the vehicle that its IMU states."""

    name: str  #: of the orientation
    time: float  #: s from the log's start, of the first fix with an attitude
    heading: float  #: deg
    sigma: float  #: deg
    stated: bool  #: whether the IMU states the sigma
    courses: int  #: number of straight baselines with a course
    difference: float  #: deg, median of heading minus course; nan without courses
    scatter: float  #: deg, standard deviation of these differences

    @property
    def contradicted(self) -> bool:
        """Whether the headings clearly differ from the courses over ground."""
        return self.courses >= FEWEST and abs(self.difference) > CLEAR * float(np.hypot(self.sigma, CRAB))

    @property
    def aligned(self) -> tuple[float, float] | None:
        """The heading, turned so that it agrees with the courses, and its sigma, deg; None unless they differ by a steady angle."""
        if not self.contradicted or self.scatter > STEADY:
            return None
        return (self.heading - self.difference) % 360, float(np.hypot(self.scatter, CRAB))


def logged_heading(log: Log, corrections: Corrections, mounting: tuple[float, float, float]) -> LoggedHeading | None:
    """Return the heading that the first IMU states at the first fix; None without an attitude that agrees with gravity.

    Args:
        log: an IMU, perhaps with its orientation.
        corrections: the log's fixes.
        mounting: deg; roll, pitch and heading that turn vectors from the vehicle's axes to the IMU's.
    """
    imu = log.imu()
    zero, turn = log.zero or 0, rotation_of_euler(np.radians(mounting))
    fixes = corrections.time[corrections.fix >= 0]
    for orientation in (o for o in log.orientations if len(o) and _of_imu(o, imu)):
        time = (orientation.time - zero) / SECOND
        row, near = _nearest(time, fixes)
        rotation = rotation_of_quaternion(orientation.quaternion)
        if not near.any() or _tilt(orientation, rotation, imu) > TILTED:
            continue
        vehicle = rotation @ turn
        heading = np.degrees(np.arctan2(vehicle[:, 1, 0], vehicle[:, 0, 0]))
        at = int(row[near][0])
        own = np.nan if orientation.sigma is None else float(np.degrees(orientation.sigma[at, 2]))
        stated = bool(np.isfinite(own))
        differences = _differences(time, heading, corrections, float(fixes[near][0]))
        difference, scatter = _middle(differences)
        return LoggedHeading(
            orientation.name, float(fixes[near][0]), float(heading[at] % 360), own if stated else COMPASS, stated,
            differences.size, difference, scatter,
        )  # fmt: skip
    return None


def _of_imu(orientation: Orientation, imu: ImuStream) -> bool:
    """Return whether an orientation is that of an IMU, of one of its parts, or of one of its two topics."""
    return orientation.name in (imu.name, *imu.name.split("+")) or joined_name(orientation.name) == imu.name


def _nearest(time: Floats, wanted: Floats) -> tuple[Integers, Booleans]:
    """Return the row nearest to each wanted time, and whether it is near."""
    after = np.clip(np.searchsorted(time, wanted), 0, time.size - 1)
    before = np.maximum(after - 1, 0)
    row = np.where(np.abs(time[before] - wanted) < np.abs(time[after] - wanted), before, after)
    return row, np.abs(time[row] - wanted) <= NEAR


def _tilt(orientation: Orientation, rotation: Floats, imu: ImuStream) -> float:
    """Return the angle between the mean specific force, turned by the attitude, and up, deg."""
    force = imu.specific_force
    if force is None or not len(force):
        return 0.0
    row, near = _nearest(force.time / SECOND, orientation.time / SECOND)
    if not near.any():
        return 0.0
    mean = np.einsum("nij,nj->i", rotation[near], force.value[row[near]])
    return float(np.degrees(np.arccos(np.clip(-mean[2] / np.linalg.norm(mean), -1, 1))))


def _differences(time: Floats, heading: Floats, corrections: Corrections, first: float) -> Floats:
    """Return heading minus course over straight baselines, deg, from a time on."""
    found: list[StraightCourse] = []
    while len(found) < COURSES and (course := straight_course(corrections, first)) is not None and course.time > first:
        found.append(course)
        first = course.time + course.span / 2
    row, near = _nearest(time, np.array([course.time for course in found]))
    courses = np.array([course.course for course in found])
    return (heading[row] - courses + 180)[near] % 360 - 180


def _middle(angles: Floats) -> tuple[float, float]:
    """Return the median and the standard deviation of angles around their mean direction, deg."""
    if not angles.size:
        return float("nan"), float("nan")
    mean = np.degrees(np.angle(np.exp(1j * np.radians(angles)).mean()))
    rest = (angles - mean + 180) % 360 - 180
    return float((mean + np.median(rest) + 180) % 360 - 180), float(rest.std())
