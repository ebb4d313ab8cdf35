"""What of a receiver's fixes corrects a filter, where it is placed, and where the filter starts."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.log import Scalars
from imuwb.navigation.alignment import align, standing
from imuwb.navigation.events import LEAST_SIGMA, corrections
from imuwb.navigation.filter_model import Aids, FilterModel, Installation, Settings
from imuwb.navigation.measurement import measurement
from imuwb.navigation.tables import FIX, SPEED, STILL, STRAIGHT
from imuwb.simulation import Odometer, Receiver, drive, mixed_route
from imuwb.stochastic import ImuErrorModel

from . import drives

MODEL = FilterModel("m", drives.plain())
ROUTE = mixed_route(240, 6)
LEVER = (1.4, -0.6, -1.1)


@pytest.fixture(scope="module")
def town():
    return drive(MODEL.error_model, ROUTE, 2, odometer=Odometer())


@pytest.fixture(scope="module")
def moves(town):
    return measurement(town, town.imu(), Installation())


def taken(town, moves, model=MODEL, still=None, **changes):
    return corrections(
        town, replace(town.gnss[0], **changes), moves, np.zeros((0, 2)) if still is None else still, model
    )


def array(town, name):
    return np.array(getattr(town.gnss[0], name))


# Fixes


def test_fixes_come_as_they_are_at_the_nearest_sample(town, moves):
    found, gnss = taken(town, moves), town.gnss[0]
    assert (found.events.kind == FIX).all()
    assert np.array_equal(found.fix[-239:], np.arange(1, len(gnss)))  # the first is at the IMU's first sample
    assert found.events.value[:, :3] == pytest.approx(gnss.position[found.fix])
    sigma = np.hstack([gnss.position_sigma, gnss.velocity_sigma])
    assert found.events.variance == pytest.approx(sigma[found.fix] ** 2)
    assert np.abs(found.events.late).max() < 1e-6
    assert moves.time[found.events.at] == pytest.approx(found.fix, abs=1e-6)
    assert found.notes == ()


@pytest.mark.parametrize("delay", [0.1337, -0.004])
def test_a_delay_is_taken_off_and_what_is_left_is_told(town, moves, delay):
    model = replace(MODEL, installation=Installation(gnss_delay=delay))
    found = taken(town, moves, model)
    own = town.seconds(town.gnss[0].time)[found.fix] - delay
    assert moves.time[found.events.at] + found.events.late == pytest.approx(own, abs=1e-9)
    assert np.abs(found.events.late).max() <= 0.005 + 1e-9


def test_held_duplicates_are_left_out_only_while_moving(town, moves):
    position, velocity = array(town, "position"), array(town, "velocity")
    for row in (100, 101, 150, 20):  # the last: it stands still
        position[row], velocity[row] = position[row - 1], velocity[row - 1]
    velocity[19:21] = 0
    found = taken(town, moves, position=position, velocity=velocity)
    assert not np.isin([100, 101, 150], found.fix).any()
    assert np.isin([99, 102, 20], found.fix).all()
    assert found.notes == ("/gnss/fix: 3 fixes that repeat the one before while moving are not used",)


def test_wild_and_missing_velocities_leave_the_position(town, moves):
    velocity = array(town, "velocity")
    velocity[50, 0], velocity[60], velocity[70, 2] = 427.0, np.nan, np.nan
    found = taken(town, moves, velocity=velocity)
    used = found.events.variance > 0
    assert used[found.fix == 50].tolist() == [[True] * 3 + [False] * 3]
    assert used[found.fix == 60].tolist() == [[True] * 3 + [False] * 3]
    assert used[found.fix == 70].tolist() == [[True] * 5 + [False]]
    assert np.isfinite(found.events.value).all()
    assert found.notes == ("/gnss/fix: 1 velocities above 350 m/s are not used",)


def test_a_receiver_without_velocity_or_sigmas_says_so(town, moves):
    found = taken(town, moves, velocity=None, velocity_sigma=None)
    assert not found.events.variance[:, 3:].any()
    assert found.notes == ("/gnss/fix has no velocity: positions alone correct the filter",)
    settings = Settings(position_sigma=(2.0, 7.0), velocity_sigma=(0.2, 0.4), sigma_scale=9.0)
    found = taken(town, moves, replace(MODEL, settings=settings), position_sigma=None, velocity_sigma=None)
    assert np.sqrt(found.events.variance[5]) == pytest.approx([2, 2, 7, 0.2, 0.2, 0.4])
    assert found.notes == (
        "/gnss/fix claims no sigmas of position: (2.0, 7.0) m are taken",
        "/gnss/fix claims no sigmas of velocity: (0.2, 0.4) m/s are taken",
    )


def test_sigmas_are_scaled_and_never_too_small(town, moves):
    sigma = array(town, "position_sigma")
    sigma[30], sigma[31], sigma[32, 1] = 1e-4, 0.0, np.nan
    found = taken(town, moves, replace(MODEL, settings=Settings(sigma_scale=2.0)), position_sigma=sigma)
    got = dict(zip(found.fix, np.sqrt(found.events.variance), strict=True))
    assert got[29][:3] == pytest.approx([4, 4, 7])
    assert got[30][:3] == pytest.approx([LEAST_SIGMA[0]] * 3)
    assert got[31][:3] == pytest.approx([2.5, 2.5, 5.0])
    assert got[32][:3] == pytest.approx([4, 2.5, 7])
    assert got[40][3:] == pytest.approx([0.2, 0.2, 0.3])


def test_flat_fixes_are_left_out(town, moves):
    kinds = np.full(len(town.gnss[0]), 3)
    kinds[[10, 11, 90]] = [1, 2, 0]
    found = taken(town, moves, fix_type=kinds)
    assert not np.isin([10, 11, 90], found.fix).any()
    assert found.notes == ("/gnss/fix: 3 fixes of less than three dimensions are not used",)


def test_too_few_fixes_are_refused_with_both_times(town, moves):
    gnss = town.gnss[0]
    few = replace(
        gnss, time=gnss.time[:200] + 239_500_000_000 - 195_000_000_000, position=gnss.position[:200], velocity=None,
        position_sigma=None, velocity_sigma=None, fix_type=None,
    )  # fmt: skip
    far = replace(few, time=few.time + 192_000_000_000)
    assert corrections(town, few, moves, np.zeros((0, 2)), MODEL).fix.size > 100
    with pytest.raises(MissingDataError, match=r"4 usable fixes of /gnss/fix lie within the IMU's time \(-?0\.0 s to 240\.0 s; "
                       r"the fixes: 236\.5 s to 435\.5 s\); a filter needs 5"):  # fmt: skip
        corrections(town, far, moves, np.zeros((0, 2)), MODEL)


# Aids


def test_aids_come_each_second_in_order(town, moves):
    model = replace(MODEL, aids=Aids(straight=0.2, still=0.05, speed=0.1))
    found = taken(town, moves, model, still=np.array([[10.2, 20.7]]))
    kind = found.events.kind
    assert (np.diff(found.events.at) >= 0).all()
    assert found.time[kind == STILL] == pytest.approx(np.arange(11.0, 21.0))
    assert np.diff(found.time[kind == STRAIGHT]) == pytest.approx(1.0)
    assert np.diff(found.time[kind == SPEED]) == pytest.approx(1.0, abs=0.11)
    speeds = town.speeds[0]
    at = town.seconds(speeds.time)
    told = np.interp(found.time[kind == SPEED], at, speeds.value)
    assert found.events.value[kind == SPEED, 0] == pytest.approx(told, abs=1e-9)
    widths = {STILL: (0.05, 3), STRAIGHT: (0.2, 2), SPEED: (0.1, 1)}
    for k, (sigma, count) in widths.items():
        variance = found.events.variance[kind == k]
        assert variance[:, :count] == pytest.approx(sigma**2)
        assert not variance[:, count:].any()
    assert (found.fix[kind != FIX] == -1).all()


def test_without_an_odometer_there_is_no_speed(town, moves):
    model = replace(MODEL, aids=Aids(speed=0.1))
    assert (taken(replace(town, speeds=()), moves, model).events.kind == FIX).all()
    short = replace(town, speeds=(Scalars("v", town.speeds[0].time[:25], town.speeds[0].value[:25]),))
    assert (taken(short, moves, model).events.kind == SPEED).sum() == 3


# Standing still, and the start


def test_standing_is_found_where_the_car_stands(town, moves):
    found = standing(moves, town, town.gnss[0])
    t = np.arange(0.5, 239, 1.0)
    told = ROUTE.speed(t) == 0
    got = ((t[:, None] > found[:, 0]) & (t[:, None] < found[:, 1])).any(axis=1)
    assert (got & ~told).sum() <= 2  # the second in which it starts
    assert (got & told).sum() > 0.8 * told.sum()


@pytest.mark.parametrize("seed", range(4))
def test_the_start_is_true_within_its_sigmas(seed):
    receiver = Receiver(rate=5.0, lever_arm=LEVER)
    route = mixed_route(150, seed)
    made = drives.prepared(
        replace(MODEL, installation=Installation(lever_arm=LEVER)),
        log=drive(MODEL.error_model, route, seed, receiver=receiver),
    )
    start = made.start
    truth = route.state(made.moves.time[start.sample - 1 : start.sample])
    told = np.concatenate([truth.position[0], truth.velocity[0]])
    sigma = np.sqrt(np.diag(start.covariance))
    assert np.abs((start.position - told[:3]) * drives.scale(told[:3]) / sigma[:3]).max() < 4
    assert np.abs((start.velocity - told[3:]) / sigma[3:6]).max() < 4
    turn = rotation_of_euler(truth.attitude[0]) @ rotation_of_euler(start.euler).T
    phi = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    assert np.abs(phi / sigma[6:9]).max() < 3.5
    assert np.degrees(np.abs(phi[:2])).max() < 2.5
    # Standing tells the gyros' mean error, the earth's turn within.
    begin, end = start.standing
    assert end - begin > 5 * drives.HZ
    assert not route.speed(made.moves.time[begin:end] - 1).any()
    ideal = drive(ImuErrorModel("ideal", {}), route, seed).imus[0].angular_rate.value
    bias = (made.log.imus[0].angular_rate.value - ideal)[begin:end].mean(axis=0)
    assert start.gyro_bias == pytest.approx(bias, abs=1e-4)
    assert "gyro biases from" in start.note


def test_a_mounting_error_is_in_the_level(town):
    model = replace(MODEL, installation=Installation(mounting=(0.0, 0.0, 180.0)))
    moves = measurement(town, town.imu(), model.installation)
    found = corrections(town, town.gnss[0], moves, np.zeros((0, 2)), model)
    plain = align(measurement(town, town.imu(), Installation()), found, np.zeros((0, 2)), MODEL)
    turned = align(moves, found, np.zeros((0, 2)), model)
    assert turned.euler[2] == plain.euler[2]  # from the receiver
    assert turned.standing is None
    assert "gyro biases unknown" in turned.note
    assert turned.gyro_bias.tolist() == [0, 0, 0]


def test_no_motion_means_no_heading(town, moves):
    slow = taken(town, moves, velocity=array(town, "velocity") * 0.01)
    with pytest.raises(
        MissingDataError,
        match=r"never moves faster than 3 m/s for two fixes \(its median speed is 0\.\d+ m/s\): heading",
    ):
        align(moves, slow, np.zeros((0, 2)), MODEL)


def test_without_velocities_positions_tell_the_start(town, moves):
    found = taken(town, moves, velocity=None, velocity_sigma=None)
    start = align(moves, found, np.zeros((0, 2)), MODEL)
    told = align(moves, taken(town, moves), np.zeros((0, 2)), MODEL, found.time[start.event] - 0.05)
    assert told.event == start.event
    sigma = np.sqrt(np.diag(start.covariance))
    assert np.abs((start.velocity - told.velocity)[:2] / sigma[3:5]).max() < 4
    off = np.angle(np.exp(1j * (start.euler - told.euler)))
    assert np.abs(off / sigma[[6, 7, 8]]).max() < 4
    assert sigma[8] > np.sqrt(told.covariance[8, 8])  # positions tell it worse
    assert sigma[3] > 5 * np.sqrt(told.covariance[3, 3])


def test_without_velocities_and_far_apart_there_is_no_heading(town, moves):
    gnss = town.gnss[0]
    some = replace(
        gnss, velocity=None, velocity_sigma=None,
        **{n: getattr(gnss, n)[::15] for n in ("time", "position", "position_sigma", "fix_type") if getattr(gnss, n) is not None},
    )  # fmt: skip
    found = corrections(town, some, moves, np.zeros((0, 2)), MODEL)
    with pytest.raises(
        MissingDataError, match="no fix has a velocity, nor do positions follow each other: the heading"
    ):
        align(moves, found, np.zeros((0, 2)), MODEL)


def test_a_start_can_be_asked_for_later(town, moves):
    found = taken(town, moves)
    first, later = (align(moves, found, np.zeros((0, 2)), MODEL, after) for after in (-np.inf, 150.0))
    assert found.time[later.event] > 150 > found.time[first.event]
    assert later.sample == found.events.at[later.event] + 1


def test_a_start_too_late_is_said_to_be_that(town, moves):
    with pytest.raises(MissingDataError) as caught:
        align(moves, taken(town, moves), np.zeros((0, 2)), MODEL, after=239.0)
    assert "never moves faster" not in str(caught.value)
