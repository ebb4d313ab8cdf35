"""Starts of slow vehicles: a spread of starts, the course over a straight baseline, the log's own heading, a stated one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from imuwb.errors import MissingDataError
from imuwb.log import ImuStream, Triad
from imuwb.navigation import FilterModel, Settings
from imuwb.navigation.corrections import Corrections
from imuwb.navigation.tables import FIX, Events
from imuwb.notes import ids
from imuwb.replay import find_start, given_start, prepare
from imuwb.replay.starts.straight_course import straight_course
from imuwb.simulation import MotionNoise, Receiver, drive
from imuwb.simulation.legs import Leg
from imuwb.simulation.profile import profile
from imuwb.simulation.route import Route

from .. import made  # noqa: TID252 - tests are no package that has a name

YAW = 130.0  #: deg, by which the IMU is turned in the vehicle
RECEIVER = Receiver(rate=2.0, position_sigma=(0.5, 0.5, 1.0), velocity_sigma=(0.1, 0.1, 0.15))


def robot(seed=1, seconds=90.0, speed=1.2, *, straight=False):
    """Return the route of a robot that stands for 12 s, then drives slowly with stops and turns."""
    rng = np.random.default_rng(seed)
    legs = [Leg(12.0, 0.0, 0.0)]
    while sum(leg.duration for leg in legs) < seconds:
        stops = not straight and len(legs) % 4 == 0
        legs.append(Leg(6.0, 0.0 if stops else speed, 0.0 if straight or stops else rng.normal(0, 1)))
    return Route("robot", seconds, profile(legs, [], rng))


def turned(log, yaw):
    """Return a log whose IMU is turned about the vertical in the vehicle."""
    turn, imu = Rotation.from_euler("Z", -yaw, degrees=True), log.imus[0]
    triads = [Triad(t.time, turn.apply(np.array(t.value))) for t in (imu.angular_rate, imu.specific_force)]
    return replace(log, imus=(ImuStream(imu.name, *triads, imu.temperature, imu.origin),))


def logged(route, seed=1, yaw=YAW):
    noise = MotionNoise(white=(1e-3, 2e-2))
    log = drive(made.error_model(), route, seed, rate=25.0, receiver=RECEIVER, motion_noise=noise)
    return replace(turned(log, yaw), references=())


def model(**settings):
    return FilterModel("known", made.error_model(), settings=Settings(**settings))


def heading_at(route, time, yaw=YAW):
    return np.degrees(route.state(np.array([time])).attitude[0, 2]) + yaw


def apart(one, other):
    return abs((one - other + 180) % 360 - 180)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_spread_of_starts_finds_the_heading_however_the_imu_is_turned(seed):
    route = robot(seed)
    found = find_start(logged(route, seed), model())
    assert ids((found.note,)) == ("heading-searched",)
    assert found.sigma < 15
    assert apart(found.heading, heading_at(route, found.time)) < 3 * found.sigma
    assert 5 < found.time < 13  # the end of the standstill, whose mean gives the gyros' bias
    prepared = prepare(logged(route, seed), found.applied_to(model()))
    assert prepared.start_time == pytest.approx(found.time, abs=1.0)  # the search takes a fix a second
    assert prepared.alignment.standstill is not None


def test_a_steady_motion_shows_no_heading_and_the_course_is_taken():
    """Without acceleration every heading is as likely; the vehicle is assumed to move ahead."""
    route = robot(3, 60.0, straight=True)
    log = logged(route, 3, yaw=0.0)
    log = replace(log, gnss=(made.gnss_of(log, slice(60, None)),))  # it has sped up before
    found = find_start(log, model(), source="course")
    assert ids((found.note,)) == ("heading-of-course",)
    assert apart(found.heading, heading_at(route, found.time, 0.0)) < 3 * found.sigma
    assert 10 <= found.sigma < 20
    assert found.applied_to(model()).settings.tilt == pytest.approx(3.0)  # it starts in motion
    vague = find_start(log, model())
    assert ids((vague.note,)) == ("heading-of-course",)
    assert apart(vague.heading, heading_at(route, found.time, 0.0)) < 3 * vague.sigma


def test_a_fast_vehicle_needs_no_search():
    town = made.town(120)
    assert find_start(town.log, town.model) is None


def test_the_logs_own_heading():
    town = made.town(120)
    found = find_start(town.log, town.model, source="log")
    assert ids((found.note,)) == ("heading-of-log",)
    truth = town.log.references[0]
    time = (truth.time - town.log.zero) / 1e9
    own = np.degrees(truth.attitude[np.argmin(np.abs(time - found.time)), 2])
    assert apart(found.heading, own) < 1.0
    with pytest.raises(MissingDataError, match="no attitude .* --heading DEG"):
        find_start(replace(town.log, references=()), town.model, source="log")


def test_a_vehicle_that_stands_needs_a_stated_heading():
    route = robot(1, 40.0, 0.0)
    log = logged(route)
    with pytest.raises(MissingDataError, match="--heading"):
        find_start(log, model())
    for source in ("search", "course"):
        with pytest.raises(MissingDataError, match="--heading DEG"):
            find_start(log, model(), source=source)
    start = given_start(75.0, 4.0)
    alignment = prepare(log, start.applied_to(model())).alignment
    assert np.degrees(alignment.euler[2]) == pytest.approx(75.0)
    assert np.degrees(np.sqrt(alignment.covariance[8, 8])) == pytest.approx(4.0)


# The course over a straight baseline, in closed form


def fixes(north_east, sigma=0.5, step=1.0):
    """Return fixes at some places, m from a point."""
    n = len(north_east)
    place = np.array([0.8, 0.2, 300.0])
    meridian, transverse = made.radii(place[0])
    value = np.zeros((n, 6))
    value[:, :3] = place
    value[:, 0] += north_east[:, 0] / (meridian + 300)
    value[:, 1] += north_east[:, 1] / ((transverse + 300) * np.cos(place[0]))
    variance = np.tile([sigma**2] * 3 + [0.0] * 3, (n, 1))
    at = np.arange(n)
    return Corrections(Events(at, np.full(n, FIX), np.zeros(n), value, variance), at * step, at)


@pytest.mark.parametrize(
    ("speed", "sigma", "span"), [(1.0, 0.5, 5.0), (1.0, 1.0, 10.0), (0.5, 1.0, 20.0), (0.05, 0.5, None)]
)
def test_a_course_takes_the_shortest_baseline_that_is_clear(speed, sigma, span):
    """Eight sigmas, at least 2 m, in 5, 10, 20 or 40 s."""
    t = np.arange(60.0)[:, None]
    found = straight_course(fixes(speed * t * [np.cos(2.0), np.sin(2.0)], sigma))
    if span is None:
        assert found is None
        return
    assert found.span == span
    assert found.course == pytest.approx(np.degrees(2.0), abs=0.01)
    angle = np.degrees(np.sqrt(2) * sigma / (speed * span))
    assert found.sigma == pytest.approx(np.hypot(angle, 10.0), rel=0.01)


def test_a_bend_is_no_baseline():
    angle = np.arange(60.0) / 3.0
    circle = 6.0 * np.stack([np.sin(angle), 1 - np.cos(angle)], axis=1)
    straight = 2.0 * np.arange(20.0)[:, None] * [0.0, -1.0] + circle[-1]
    found = straight_course(fixes(np.concatenate([circle, straight[1:]])))
    assert found.time > 58
    assert found.course == pytest.approx(270.0, abs=2 * found.sigma)


def test_few_fixes_have_no_course():
    assert straight_course(fixes(np.zeros((2, 2)))) is None
