"""Gyros in another unit are found by gravity, courses, orientations and the Earth; motions of many kinds raise no alarm."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from imuwb.geodesy import EARTH_RATE
from imuwb.health import check
from imuwb.health.motion import Segment
from imuwb.health.turning import turning_faults
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Orientation, Provenance, Reference, Triad

RATE, G, DEG = 50, 9.80665, 180 / np.pi
RIGHT, DEGREES, RADIANS = 1.0, DEG, 1 / DEG  #: in rad/s, in deg/s taken as rad/s, in rad/s taken as deg/s


def smooth(rng, n, least, most, columns=3):
    """Return a motion of size 1 between two frequencies, Hz."""
    spectrum = np.fft.rfft(rng.standard_normal((n, columns)), axis=0)
    f = np.fft.rfftfreq(n, 1 / RATE)
    spectrum[(f < least) | (f > most)] = 0
    moved = np.fft.irfft(spectrum, n, axis=0)
    return moved / moved.std(axis=0)


def log_of(rng, rate, force, factor=1.0, **streams):
    """Return a log of an IMU with the noise and the bias of a simple sensor."""
    time = np.arange(len(rate)) * (SECOND // RATE)
    gyro = rate + 0.003 * rng.standard_normal(rate.shape) + 0.01 * rng.standard_normal(3)
    accel = force + 0.03 * rng.standard_normal(force.shape)
    imu = ImuStream("/imu", Triad(time, gyro * factor), Triad(time, accel))
    return Log(Provenance("made.csv", "csv", "", 0), (imu,), zero=0, **streams)


def turned(rate):
    """Return the attitudes of a body, C_b_n, that turns at a rate in its own axes."""
    steps = Rotation.from_rotvec(rate / RATE).as_matrix()
    attitude = np.empty_like(steps)
    attitude[0] = np.eye(3)
    for k in range(1, len(steps)):
        attitude[k] = attitude[k - 1] @ steps[k - 1]
    return attitude


def by_hand(seed, size, factor=1.0, orientation=False, n=60 * RATE):
    """Return a log of an IMU that is turned by hand, with accelerations of 0.5 m/s²."""
    rng = np.random.default_rng(seed)
    rate = size * smooth(rng, n, 0.05, 0.7)
    attitude = turned(rate)
    force = np.einsum("nji,nj->ni", attitude, 0.3 * smooth(rng, n, 0.3, 2) - [0, 0, G])
    log = log_of(rng, rate, force, factor)
    if not orientation:
        return log
    quaternion = Rotation.from_matrix(attitude).as_quat()[:, [3, 0, 1, 2]]
    return replace(log, orientations=(Orientation("/imu", log.imus[0].angular_rate.time, quaternion),))


def laid_over(seed, factor=1.0, seconds=10):
    """Return a log of an IMU at rest that is slowly turned on its side, once."""
    rng = np.random.default_rng(seed)
    rate = np.zeros((90 * RATE, 3))
    rate[40 * RATE : (40 + seconds) * RATE, 0] = np.pi / 2 / seconds
    force = np.einsum("nji,j->ni", turned(rate), [0, 0, -G])
    return log_of(rng, rate, force, factor)


def drive(seed, factor=1.0, pitching=0.005, stated=False, n=200 * RATE):
    """Return a log of a car: bends, brakes, a body that pitches and rolls a little with them, and a receiver."""
    rng = np.random.default_rng(seed)
    yaw, acceleration = 0.15 * smooth(rng, n, 0, 0.08, 1)[:, 0], 1.0 * smooth(rng, n, 0.01, 0.2, 1)[:, 0]
    speed = np.maximum(14 + np.cumsum(acceleration) / RATE, 4)
    acceleration = np.gradient(speed) * RATE
    lateral = speed * yaw
    tilt = pitching * np.stack([-lateral, acceleration], axis=1) + 0.003 * smooth(rng, n, 1, 3, 2)
    rate = np.column_stack([np.gradient(tilt, axis=0) * RATE, yaw])
    force = np.stack([acceleration + G * tilt[:, 1], lateral - G * tilt[:, 0], np.full(n, -G)], axis=1)
    course = np.cumsum(yaw) / RATE
    rows = np.arange(0, n, RATE // 5)
    velocity = np.stack([speed * np.cos(course), speed * np.sin(course), 0 * speed], axis=1)[rows]
    noise = rng.standard_normal(velocity.shape) * 0.1
    gnss = GnssStream("/fix", rows * (SECOND // RATE), np.tile([0.8, 0.2, 0.0], (rows.size, 1)), velocity + noise)
    gnss = replace(gnss, velocity_sigma=np.full(velocity.shape, 0.1)) if stated else gnss
    return log_of(rng, rate, force, factor, gnss=(gnss,))


def found(log, segments=()):
    return [(f.kind, f.severity, f.consequence.rpartition("=")[2]) for f in turning_faults(log, log.imus[0], segments)]


FAULTS = {RIGHT: [], DEGREES: [("rate unit", "fault", "deg/s")], RADIANS: [("rate unit", "fault", "rad/s")]}


@pytest.mark.parametrize("factor", FAULTS)
@pytest.mark.parametrize("seconds", [3, 6, 10])
@pytest.mark.parametrize("seed", range(3))
def test_one_slow_turn_shows_the_unit(seed, seconds, factor):
    assert found(laid_over(seed, factor, seconds)) == FAULTS[factor]


@pytest.mark.parametrize("factor", FAULTS)
@pytest.mark.parametrize(("seed", "size"), [(0, 0.2), (1, 0.5), (2, 1.0)])
def test_gravity_shows_the_unit_of_an_imu_that_is_turned(seed, size, factor):
    assert found(by_hand(seed, size, factor)) == FAULTS[factor]


@pytest.mark.parametrize("factor", FAULTS)
@pytest.mark.parametrize("stated", [False, True])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_course_shows_the_unit_of_a_vehicle(seed, stated, factor):
    assert found(drive(seed, factor, stated=stated)) == FAULTS[factor]


@pytest.mark.parametrize("factor", FAULTS)
def test_the_heading_of_a_trajectory_shows_the_unit(factor):
    log = drive(4, factor)
    velocity = log.gnss[0].velocity
    attitude = np.stack([0 * velocity[:, 0], 0 * velocity[:, 0], np.arctan2(velocity[:, 1], velocity[:, 0])], axis=1)
    track = Reference("truth", log.gnss[0].time, log.gnss[0].position, attitude=attitude)
    assert found(replace(log, gnss=(), references=(track,))) == FAULTS[factor]


def shifted(log, seconds):
    return replace(log, gnss=tuple(replace(g, time=g.time + round(seconds * SECOND)) for g in log.gnss))


@pytest.mark.parametrize("seconds", [-18.0, 1.5, 27.0])
@pytest.mark.parametrize("factor", [RIGHT, DEGREES])
def test_a_clock_that_is_off_shows_in_the_turns(seconds, factor):
    (fault,) = (f for f in check(shifted(drive(0, factor), seconds), lines=False).faults if f.kind == "clock offset")
    assert (fault.stream, fault.severity) == ("/fix", "fault")
    assert float(fault.consequence.split()[-1]) == pytest.approx(-seconds, abs=0.3)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("seconds", [0.0, 0.3])
def test_a_small_delay_is_no_offset_of_the_clock(seed, seconds):
    assert not found(shifted(drive(seed), seconds))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_the_courses_of_another_drive_show_no_offset(seed):
    assert not found(replace(drive(seed), gnss=drive(seed + 100).gnss))


@pytest.mark.parametrize("factor", FAULTS)
def test_the_imu_s_own_orientation_shows_its_unit(factor):
    log = by_hand(3, 0.3, factor, orientation=True)
    upside = Triad(log.imus[0].specific_force.time, np.tile([0.0, 0.0, -G], (len(log.imus[0].specific_force), 1)))
    blind = replace(log, imus=(replace(log.imus[0], specific_force=upside),))  # gravity shows nothing
    assert found(blind) == FAULTS[factor]


@pytest.mark.parametrize("factor", FAULTS)
def test_the_earth_shows_the_unit_of_a_fine_gyro_at_rest(factor):
    rng, latitude, n = np.random.default_rng(0), 0.8, 300 * RATE
    earth = EARTH_RATE * np.array([np.cos(latitude), 0, -np.sin(latitude)])
    time = np.arange(n) * (SECOND // RATE)
    gyro = Triad(time, factor * (earth + 1e-5 * rng.standard_normal((n, 3))))
    accel = Triad(time, np.tile([0.0, 0.0, -G], (n, 1)))
    gnss = GnssStream("/fix", time[::RATE], np.tile([latitude, 0.2, 0.0], (300, 1)))
    log = Log(Provenance("made.csv", "csv", "", 0), (ImuStream("/imu", gyro, accel),), gnss=(gnss,))
    assert found(log, (Segment(0.0, 300.0, moving=False),)) == FAULTS[factor]
    assert found(replace(log, gnss=()), (Segment(0.0, 300.0, moving=False),)) == []  # a bias may be as large


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_drives_without_a_course_raise_no_alarm(seed):
    # A body that pitches by 1 degree for 3 m/s², as on soft springs, or on hard ones: the specific force tilts far more.
    log = replace(drive(seed, pitching=(0.006, 0.0018, 0.0005)[seed % 3], n=60 * RATE), gnss=())
    assert found(log) == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_a_multirotor_whose_specific_force_stays_along_its_axis_raises_no_alarm(seed):
    rng, n = np.random.default_rng(seed), 60 * RATE
    rate = 1.0 * smooth(rng, n, 0.1, 1)
    drag = 0.3 * smooth(rng, n, 0, 0.3) * [1, 1, 0]
    assert found(log_of(rng, rate, drag - [0, 0, G] + 0.3 * smooth(rng, n, 0.1, 2) * [0, 0, 1])) == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_a_rest_raises_no_alarm(seed):
    rng, n = np.random.default_rng(seed), 60 * RATE
    assert found(log_of(rng, np.zeros((n, 3)), np.tile([0, 0, -G], (n, 1)))) == []


def test_a_gap_spoils_no_turn():
    log = by_hand(1, 0.5)
    keep = np.abs(np.arange(60 * RATE) - 1000) > 150
    imu = log.imus[0]
    parts = (Triad(t.time[keep], t.value[keep]) for t in (imu.angular_rate, imu.specific_force))
    assert found(replace(log, imus=(ImuStream("/imu", *parts),))) == []


@pytest.mark.slow
def test_the_turns_of_real_drives_agree(shared):
    from imuwb.readers import ReadOptions, read

    fix = read(shared / "drive" / "gnss_1934_sf.pos")
    log = replace(read(shared / "drive" / "derived_imu_si_gpst.csv.gz"), gnss=fix.gnss)
    imu = log.imus[0]
    assert found(log) == []
    wrong = replace(imu, angular_rate=Triad(imu.angular_rate.time, imu.angular_rate.value * DEGREES))
    assert found(replace(log, imus=(wrong,))) == FAULTS[DEGREES]
    robot = read(shared / "mcap" / "husky_test1_ros2cdr_zstd.mcap", ReadOptions())
    assert found(robot) == []
