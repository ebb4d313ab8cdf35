"""Where a filter starts: standstills, the first fix that is fast, level and heading, and the lever arm."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.navigation.alignment import align
from imuwb.navigation.corrections import Corrections, corrections_of
from imuwb.navigation.filter_model import FilterModel, Installation, Settings
from imuwb.navigation.fix_velocities import CLIMB, JERK, fix_velocities, velocities_of_positions
from imuwb.navigation.measurement import Measurement, measurement_of
from imuwb.navigation.tables import FIX, Events, Samples
from imuwb.notes import ids
from imuwb.simulation import Receiver, drive, mixed_route
from imuwb.stochastic import ImuErrorModel

from . import drives

MODEL = FilterModel("m", drives.plain())
ROUTE = mixed_route(240, 6)
LEVER = (1.4, -0.6, -1.1)
NO_STILLS = np.zeros((0, 2))


@pytest.fixture(scope="module")
def town():
    return drive(MODEL.error_model, ROUTE, 2)


@pytest.fixture(scope="module")
def measurement(town):
    return measurement_of(town, town.imu(), Installation())


def taken(town, measurement, **changes):
    return corrections_of(town, replace(town.gnss[0], **changes), measurement, NO_STILLS, MODEL)


# Drives


@pytest.mark.parametrize("seed", range(4))
def test_the_start_is_true_within_its_sigmas(seed):
    receiver = Receiver(rate=5.0, lever_arm=LEVER)
    route = mixed_route(150, seed)
    made = drives.prepared(
        replace(MODEL, installation=Installation(lever_arm=LEVER)),
        log=drive(MODEL.error_model, route, seed, receiver=receiver),
    )
    start = made.alignment
    truth = route.state(made.measurement.time[start.sample - 1 : start.sample])
    expected = np.concatenate([truth.position[0], truth.velocity[0]])
    sigma = np.sqrt(np.diag(start.covariance))
    assert np.abs((start.position - expected[:3]) * drives.scale(expected[:3]) / sigma[:3]).max() < 4
    assert np.abs((start.velocity - expected[3:]) / sigma[3:6]).max() < 4
    turn = rotation_of_euler(truth.attitude[0]) @ rotation_of_euler(start.euler).T
    phi = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    assert np.abs(phi / sigma[6:9]).max() < 3.5
    assert np.degrees(np.abs(phi[:2])).max() < 2.5
    # A standstill gives the gyros' mean error, with the Earth's rate.
    begin, end = start.standstill
    assert end - begin > 5 * drives.HZ
    assert not route.speed(made.measurement.time[begin:end] - 1).any()
    ideal = drive(ImuErrorModel("ideal", {}), route, seed).imus[0].angular_rate.value
    bias = (made.log.imus[0].angular_rate.value - ideal)[begin:end].mean(axis=0)
    assert start.gyro_bias == pytest.approx(bias, abs=1e-4)
    assert ids((start.note,)) == ("alignment-after-standstill",)


def test_a_mounting_error_is_in_the_level(town):
    model = replace(MODEL, installation=Installation(mounting=(0.0, 0.0, 180.0)))
    measurement = measurement_of(town, town.imu(), model.installation)
    found = corrections_of(town, town.gnss[0], measurement, NO_STILLS, model)
    plain = align(measurement_of(town, town.imu(), Installation()), found, NO_STILLS, MODEL)
    turned = align(measurement, found, NO_STILLS, model)
    assert turned.euler[2] == plain.euler[2]  # from the receiver
    assert turned.standstill is None
    assert ids((turned.note,)) == ("alignment",)
    assert turned.gyro_bias.tolist() == [0, 0, 0]


def test_no_motion_means_no_heading(town, measurement):
    slow = taken(town, measurement, velocity=town.gnss[0].velocity * 0.01)
    with pytest.raises(
        MissingDataError,
        match=r"3 m/s for two fixes \(its median speed is 0\.\d+ m/s\)",
    ):
        align(measurement, slow, NO_STILLS, MODEL)


def test_without_velocities_positions_tell_the_start(town, measurement):
    found = taken(town, measurement, velocity=None, velocity_sigma=None)
    start = align(measurement, found, NO_STILLS, MODEL)
    expected = align(measurement, taken(town, measurement), NO_STILLS, MODEL, found.time[start.event] - 0.05)
    assert expected.event == start.event
    sigma = np.sqrt(np.diag(start.covariance))
    assert np.abs((start.velocity - expected.velocity)[:2] / sigma[3:5]).max() < 4
    off = np.angle(np.exp(1j * (start.euler - expected.euler)))
    assert np.abs(off / sigma[[6, 7, 8]]).max() < 4
    assert sigma[8] > np.sqrt(expected.covariance[8, 8])  # positions give a worse heading
    assert sigma[3] > 5 * np.sqrt(expected.covariance[3, 3])


def test_without_velocities_and_far_apart_there_is_no_heading(town, measurement):
    gnss = town.gnss[0]
    some = replace(
        gnss, velocity=None, velocity_sigma=None,
        **{n: getattr(gnss, n)[::15] for n in ("time", "position", "position_sigma", "fix_type") if getattr(gnss, n) is not None},
    )  # fmt: skip
    found = corrections_of(town, some, measurement, NO_STILLS, MODEL)
    with pytest.raises(MissingDataError, match="no fix has a velocity"):
        align(measurement, found, NO_STILLS, MODEL)


def test_a_start_can_be_asked_for_later(town, measurement):
    found = taken(town, measurement)
    first, later = (align(measurement, found, NO_STILLS, MODEL, after) for after in (-np.inf, 150.0))
    assert found.time[later.event] > 150 > found.time[first.event]
    assert later.sample == found.events.at[later.event] + 1


def test_a_start_too_late_has_an_error_of_its_own(town, measurement):
    with pytest.raises(MissingDataError) as caught:
        align(measurement, taken(town, measurement), NO_STILLS, MODEL, after=239.0)
    assert "after 239.0 s" in str(caught.value)


# Closed forms: a body that turns and accelerates evenly, with an antenna that has a lever arm


RATE, HZ, PLACE = 0.3, 100, np.array([0.8, 0.2, 300.0])
ACCELERATION, SPEED, HEADING = 1.5, 12.0, 0.4  #: m/s² ahead, m/s at 10 s, rad
FORWARD = np.array([np.cos(HEADING), np.sin(HEADING), 0.0])


def flat(speed=SPEED, *, sigma=0.1, still=0.0, euler=(0.0, 0.0), step=1.0, count=20, velocity_sigma=True, slow=False):
    """Return an IMU that turns about down with 0.3 rad/s and accelerates ahead, and exact fixes around 10 s.

    ``still``: rad/s, the gyros' output in the first eight seconds, before the turn begins; ``slow``: the fixes before 10 s are.
    """
    n = 20 * HZ
    time = np.arange(1, n + 1) / HZ
    rotation = rotation_of_euler(np.array([*euler, HEADING]))
    force = rotation.T @ (ACCELERATION * FORWARD - [0, 0, float(drives_gravity())])
    angle = np.tile([0.0, 0.0, RATE], (n, 1)) + still
    angle[time <= 8] = still
    samples = Samples(np.full(n, 1 / HZ), angle / HZ, np.tile(force, (n, 1)) / HZ, np.zeros(n, np.int64))
    measurement = Measurement(time, 1 / HZ, samples, (None,), np.zeros((0, 2)), None)
    at = np.arange(1, count) * step
    value = np.zeros((at.size, 6))
    value[:, :3] = PLACE
    value[:, 3:] = (speed + ACCELERATION * (at - 10))[:, None] * FORWARD
    if slow:
        value[at < 10, 3:] = 0.3 * FORWARD
    variance = np.full((at.size, 6), sigma**2)
    if not velocity_sigma:
        variance[:, 3:] = 0.0
    sample = np.rint(at * HZ).astype(np.int64) - 1
    events = Events(sample, np.full(at.size, FIX), np.zeros(at.size), value, variance)
    return SimpleNamespace(
        measurement=measurement, corrections=Corrections(events, at, np.arange(at.size)), value=value
    )


def drives_gravity():
    from imuwb.geodesy import gravity

    return gravity(PLACE[:1], PLACE[2:])[0]


def aligned(made, stills=NO_STILLS, after=9.5, settings=None, **installation):
    model = replace(MODEL, installation=Installation(**installation), settings=settings or Settings())
    return align(made.measurement, made.corrections, stills, model, after)


def test_the_imu_turns_around_the_antenna():
    """The antenna's velocity is the IMU's and omega x lever: at the right, a turn to the right slows it down."""
    made = flat()
    start = aligned(made, lever_arm=(0.0, 2.0, 0.0))
    assert start.velocity == pytest.approx(SPEED * FORWARD + RATE * 2.0 * FORWARD, abs=1e-9)
    off = (start.position - PLACE) * drives.scale(PLACE)
    right = np.array([-np.sin(HEADING), np.cos(HEADING), 0.0])
    assert off == pytest.approx(-2.0 * right, abs=1e-5)


def test_the_gyros_bias_is_not_part_of_the_turn():
    bias = 0.02
    made = flat(still=bias)
    start = aligned(made, np.array([[1.0, 7.0]]), lever_arm=(0.0, 2.0, 0.0))
    assert start.gyro_bias == pytest.approx([bias] * 3)
    assert start.standstill == (100, 700)
    assert start.velocity[:2] == pytest.approx((SPEED + RATE * 2.0) * FORWARD[:2], abs=1e-6)
    short = aligned(made, np.array([[1.0, 5.9]]), lever_arm=(0.0, 2.0, 0.0))
    assert short.standstill is None
    assert aligned(made, np.array([[1.0, 6.0]])).standstill == (100, 600)
    for begin, end in ((11.0, 19.0), (2.0, 10.5)):  # a standstill ends before the start
        assert aligned(made, np.array([[begin, end]])).standstill is None


@pytest.mark.parametrize("euler", [(0.0, 0.0), (0.1, -0.07), (-0.3, 0.2)])
def test_level_and_heading_are_exact_without_errors(euler):
    start = aligned(flat(euler=euler))
    assert start.euler == pytest.approx([*euler, HEADING], abs=1e-9)
    assert start.event == 9
    assert start.sample == 10 * HZ


def test_a_late_fix_and_an_older_velocity_are_moved_to_the_sample():
    made = flat()
    late = np.full(made.corrections.events.at.size, 0.004)
    events = made.corrections.events._replace(late=late)
    start = aligned(SimpleNamespace(measurement=made.measurement, corrections=replace(made.corrections, events=events)))
    off = (start.position - PLACE) * drives.scale(PLACE)
    assert off == pytest.approx(-0.004 * SPEED * FORWARD, abs=1e-5)
    older = aligned(made, velocity_delay=0.2)
    assert older.velocity == pytest.approx((SPEED + 0.2 * ACCELERATION) * FORWARD, abs=1e-9)


def test_sigmas_of_the_alignment():
    sigma = 0.2
    covariance = aligned(flat(sigma=sigma)).covariance
    assert np.count_nonzero(covariance - np.diag(np.diagonal(covariance))) == 0
    tilt = np.hypot(np.radians(1.0), sigma / 1.0 / drives_gravity())
    heading = np.hypot(np.radians(3.0), sigma / SPEED)
    assert np.sqrt(np.diagonal(covariance)) == pytest.approx([*[sigma] * 6, tilt, tilt, heading])
    usual = aligned(flat(sigma=sigma, velocity_sigma=False))
    assert np.sqrt(np.diagonal(usual.covariance)[3:5]) == pytest.approx([0.15, 0.15])


@pytest.mark.parametrize(
    ("speed", "sigma", "starts"),
    [(3.1, 0.1, 10.0), (2.9, 0.1, 11.0), (3.1, 1.05, 11.0), (3.1, 1.0, 10.0)],
)
def test_a_start_is_faster_than_the_setting_and_three_sigmas(speed, sigma, starts):
    made = flat(speed, sigma=sigma, slow=True)
    assert made.corrections.time[aligned(made, after=-np.inf).event] == starts


@pytest.mark.parametrize(("change", "starts"), [(8.2, 10.0), (8.4, 11.0)])
def test_a_spike_is_no_start(change, starts):
    """Within 8 m/s² and three sigmas of 0.1 m/s, the next velocity agrees."""
    made = flat()
    made.value[9, 3:] = made.value[10, 3:] + change * np.array([FORWARD[0], FORWARD[1], 0.0])
    assert made.corrections.time[aligned(made).event] == starts


def test_a_start_has_a_second_of_samples_around_it():
    made = flat(40.0)
    assert made.corrections.time[aligned(made, after=16.5).event] == 17.0  # the next fix counts too, at 18 s
    with pytest.raises(MissingDataError, match=r"after 17\.0 s"):
        aligned(made, after=17.0)
    assert made.corrections.time[aligned(made, after=0.0).event] == 2.0


def positions_only(step, sigma=1.0):
    """Return a drive ahead with 15 m/s whose fixes have no velocities."""
    made = flat(step=step, count=round(19 / step))
    time = made.corrections.time
    made.value[:, 3:] = 0.0
    made.value[:, :3] = PLACE + 15.0 * (time - 10)[:, None] * FORWARD / drives.scale(PLACE)
    variance = np.tile([sigma**2] * 3 + [0] * 3, (time.size, 1))
    events = made.corrections.events._replace(variance=variance)
    return SimpleNamespace(measurement=made.measurement, corrections=replace(made.corrections, events=events))


@pytest.mark.parametrize(
    ("step", "sigma", "span"), [(1.0, 1.0, 2.0), (0.5, 1.0, 3.0), (0.1, 2.5, 4.0), (0.1, 0.01, 0.6)]
)
def test_positions_give_a_velocity_over_a_baseline_that_their_sigma_justifies(step, sigma, span):
    """Of all even numbers of steps, the span is next to the one with the least error of positions and jerk together."""
    start = aligned(positions_only(step, sigma))
    assert start.velocity[:2] == pytest.approx(15.0 * FORWARD[:2], abs=1e-3)
    expected = np.hypot(np.sqrt(2) * sigma / span, JERK * span**2 / 24)
    assert np.sqrt(start.covariance[3, 3]) == pytest.approx(expected, rel=1e-6)
    others = 2 * step * np.arange(1, 1 + int(2.4 / step))
    assert expected < 1.1 * np.hypot(np.sqrt(2) * sigma / others, JERK * others**2 / 24).min()


def test_an_acceleration_and_uneven_fixes_leave_the_velocity_right():
    """A parabola through three positions has the true slope whatever the times between them."""
    made = positions_only(0.1)
    rows = np.sort(np.random.default_rng(0).choice(np.arange(180), 90, replace=False))
    time = made.corrections.time[rows]
    ned = (12.0 * (time - 10) + (time - 10) ** 2)[:, None] * FORWARD
    value = np.zeros((rows.size, 6))
    value[:, :3] = PLACE + ned / drives.scale(PLACE)
    events = Events(*(x[rows] for x in made.corrections.events))._replace(value=value)
    found = velocities_of_positions(Corrections(events, time, np.arange(rows.size)), np.arange(rows.size))
    expected = (12.0 + 2 * (found.time - 10))[:, None] * FORWARD
    assert found.time.size > 60
    assert found.value == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize(("step", "known"), [(2.4, True), (2.6, False)])
def test_positions_within_five_seconds_give_a_velocity(step, known):
    made = positions_only(step)
    if known:
        assert aligned(made).velocity[:2] == pytest.approx(15.0 * FORWARD[:2], abs=1e-2)
    else:
        with pytest.raises(MissingDataError, match="no fix has a velocity"):
            aligned(made)


def test_a_velocity_down_that_is_not_reported_comes_from_the_positions(town, measurement):
    gnss = town.gnss[0]
    flat_only = np.where([True, True, False], gnss.velocity, np.nan)
    whole = align(measurement, taken(town, measurement), NO_STILLS, MODEL)
    start = align(measurement, taken(town, measurement, velocity=flat_only), NO_STILLS, MODEL)
    assert start.event == whole.event
    assert start.velocity[:2] == pytest.approx(whole.velocity[:2], abs=1e-12)
    sigma = np.sqrt(start.covariance[5, 5])
    assert np.sqrt(whole.covariance[5, 5]) < sigma
    assert abs(start.velocity[2] - whole.velocity[2]) < 4 * sigma


def test_a_velocity_down_that_nothing_gives_is_zero_with_a_wide_sigma():
    made = flat(step=1.0)
    variance = made.corrections.events.variance.copy()
    variance[:, 5] = 0.0
    variance[:, :3] = 1.0
    apart = flat(step=1.0, count=20)
    rows = np.arange(0, 19, 6)
    events = Events(*(x[rows] for x in apart.corrections.events._replace(variance=variance)))
    corrections = Corrections(events, apart.corrections.time[rows], np.arange(rows.size))
    found = fix_velocities(corrections, Settings())
    assert found.value[:, 2].tolist() == [0.0] * rows.size
    assert found.sigma[:, 2].tolist() == [CLIMB] * rows.size


# Starts with a heading that is known


def known(made, stills=NO_STILLS, time=0.0, heading=100.0, sigma=7.0):
    settings = Settings(known_start=(time, heading, sigma))
    return align(made.measurement, made.corrections, stills, replace(MODEL, settings=settings))


def test_a_known_heading_starts_at_the_first_fix_at_any_speed():
    made = flat(0.2)
    start = known(made)
    assert made.corrections.time[start.event] == 2.0
    assert np.degrees(start.euler[2]) == pytest.approx(100.0)
    assert np.sqrt(start.covariance[8, 8]) == pytest.approx(np.radians(7.0))
    assert made.corrections.time[known(made, time=5.5).event] == 6.0


def test_a_known_heading_in_a_standstill_starts_at_its_end():
    made = flat(0.2, still=0.02)
    start = known(made, np.array([[0.5, 8.5]]))
    assert made.corrections.time[start.event] == 7.0  # a second of samples around it is still, too
    assert start.gyro_bias == pytest.approx([0.02] * 3)
    assert start.standstill == (50, 700)


def test_a_known_start_after_the_last_fix_is_refused():
    with pytest.raises(MissingDataError, match=r"no fix after 25\.0 s"):
        known(flat(), time=25.0)
