"""The heading that an IMU states itself: in the vehicle's axes, against gravity, and against the course over ground."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.geodesy import quaternion_of_rotation, rotation_of_euler
from imuwb.log import ImuStream, Orientation, Triad
from imuwb.navigation import FilterModel, Installation, Settings
from imuwb.notes import ids
from imuwb.readers import read
from imuwb.replay import find_start
from imuwb.replay.starts import start as starts
from imuwb.simulation import Receiver, drive
from imuwb.simulation.legs import Leg
from imuwb.simulation.profile import profile
from imuwb.simulation.route import Route
from tests.recordings import recording

from .. import made  # noqa: TID252 - tests are no package that has a name

MOUNTING = (100.0, 20.0, -50.0)  #: deg
SIGMA = 4.0  #: deg


@pytest.fixture(scope="module")
def route():
    rng = np.random.default_rng(4)
    legs = [Leg(12.0, 0.0, 0.0), *(Leg(6.0, 1.5, rng.normal(0, 1)) for _ in range(18))]
    return Route("robot", 110.0, profile(legs, [], rng))


@pytest.fixture(scope="module")
def plain(route):
    receiver = Receiver(rate=2.0, position_sigma=(0.5, 0.5, 1.0), velocity_sigma=(0.1, 0.1, 0.15))
    return replace(drive(made.error_model(), route, 1, rate=25.0, receiver=receiver), references=())


def mounted(log, route, *, offset=0.0, roll=0.0, sigma=SIGMA, angles=MOUNTING):
    """Return a log whose IMU is turned in the vehicle and states its orientation, with an offset of its heading and roll, deg."""
    turn, imu = rotation_of_euler(np.radians(angles)), log.imus[0]
    triads = [Triad(t.time, t.value @ turn.T) for t in (imu.angular_rate, imu.specific_force)]
    time = imu.angular_rate.time[::2]
    euler = route.state((time - log.zero) / 1e9).attitude + np.radians([roll, 0.0, offset])
    quaternion = np.stack([quaternion_of_rotation(row) for row in rotation_of_euler(euler) @ turn.T])
    sigmas = None if sigma is None else np.radians(np.full((time.size, 3), sigma))
    orientation = Orientation(imu.name, time, quaternion, sigmas)
    return replace(log, imus=(ImuStream(imu.name, *triads, None, imu.origin),), orientations=(orientation,))


def model(mounting=MOUNTING):
    return FilterModel("known", made.error_model(), settings=Settings(), installation=Installation(mounting=mounting))


def apart(one, other):
    return abs((one - other + 180) % 360 - 180)


def heading_at(route, time):
    return np.degrees(route.state(np.array([time])).attitude[0, 2])


@pytest.mark.parametrize(("sigma", "expected"), [(SIGMA, SIGMA), (None, 10.0), (np.nan, 10.0)])
def test_the_heading_is_that_of_the_vehicle(plain, route, sigma, expected):
    found = find_start(mounted(plain, route, sigma=sigma), model(), source="log")
    assert ids((found.note,)) == ("heading-of-orientation",)
    assert apart(found.heading, heading_at(route, found.time)) < 0.5
    assert found.sigma == pytest.approx(expected)


def test_a_trajectory_comes_before_an_orientation():
    town = made.town(120)
    time = town.log.imus[0].angular_rate.time
    level = Orientation(town.log.imus[0].name, time, np.tile([1.0, 0, 0, 0], (time.size, 1)))
    found = find_start(replace(town.log, orientations=(level,)), town.model, source="log")
    assert ids((found.note,)) == ("heading-of-log",)


def test_an_attitude_that_contradicts_gravity_is_not_used(plain, route):
    with pytest.raises(MissingDataError, match="--heading DEG"):
        find_start(mounted(plain, route, roll=40.0), model(), source="log")
    assert find_start(mounted(plain, route, roll=5.0), model(), source="log").sigma == pytest.approx(SIGMA)


def test_the_orientation_of_another_imu_is_not_used(plain, route):
    log = mounted(plain, route)
    other = replace(log.orientations[0], name="/other")
    with pytest.raises(MissingDataError, match="--heading DEG"):
        find_start(replace(log, orientations=(other,)), model(), source="log")


def test_a_yaw_from_another_zero_is_turned_to_the_courses(plain, route):
    found = find_start(mounted(plain, route, offset=100.0), model(), source="log")
    assert apart(found.heading, heading_at(route, found.time)) < 10.0
    assert 10 <= found.sigma < 20


def test_auto_takes_the_orientation_before_the_course_if_they_agree(plain, route, monkeypatch):
    monkeypatch.setattr(starts, "_searched", lambda *_: None)
    good, wrong = (find_start(mounted(plain, route, offset=offset), model()) for offset in (0.0, 100.0))
    assert ids((good.note, wrong.note)) == ("heading-of-orientation", "heading-of-course")
    assert apart(wrong.heading, heading_at(route, wrong.time)) < 2 * wrong.sigma


def test_the_yaw_of_the_husky_counts_from_magnetic_north():
    """Its mounting is that of the launch file of robot_localization's test 1.

    Zero at magnetic north, 14.7 deg west of true north in Cambridge, Massachusetts, makes the heading 104.7 deg too large.
    """
    log = read(recording("data", "mcap", "robot_localization_test1.bag"))
    husky = model((0.0, -90.0, -90.0))
    gnss = log.gnss[0]
    parts = starts.corrections_of(log, gnss, *_measured(log, gnss, husky), husky)
    found = starts.logged_heading(log, parts, husky.installation.mounting)
    assert found.courses > 40
    assert found.difference == pytest.approx(104.7, abs=5.0)
    assert 10 < found.scatter < 20
    assert found.sigma == pytest.approx(2.005, abs=0.001)
    turned, course = (find_start(log, husky, source=source) for source in ("log", "course"))
    assert apart(turned.heading, course.heading) < 20
    assert ids((find_start(log, husky, source="log").note,)) == ("heading-of-orientation",)


def _measured(log, gnss, husky):
    measurement = starts.measurement_of(log, log.imu(), husky.installation)
    return measurement, starts.standstills(measurement, log, gnss)
