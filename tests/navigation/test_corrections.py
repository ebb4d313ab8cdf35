"""Which fixes and speeds correct a filter, and at which samples."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.log import Scalars
from imuwb.navigation.corrections import LEAST_SIGMA, corrections_of, raised
from imuwb.navigation.filter_model import Aids, FilterModel, Installation, Settings
from imuwb.navigation.measurement import measurement_of
from imuwb.navigation.tables import FIX, SPEED, STILL, STRAIGHT
from imuwb.notes import ids
from imuwb.simulation import Odometer, Receiver, drive, mixed_route

from . import drives

MODEL = FilterModel("m", drives.plain())
ROUTE = mixed_route(240, 6)
LEVER = (1.4, -0.6, -1.1)


@pytest.fixture(scope="module")
def town():
    return drive(MODEL.error_model, ROUTE, 2, odometer=Odometer())


@pytest.fixture(scope="module")
def measurement(town):
    return measurement_of(town, town.imu(), Installation())


def taken(town, measurement, model=MODEL, still=None, **changes):
    return corrections_of(
        town, replace(town.gnss[0], **changes), measurement, np.zeros((0, 2)) if still is None else still, model
    )


def array(town, name):
    return np.array(getattr(town.gnss[0], name))


# Fixes


def test_fixes_come_as_they_are_at_the_nearest_sample(town, measurement):
    found, gnss = taken(town, measurement), town.gnss[0]
    assert (found.events.kind == FIX).all()
    assert np.array_equal(found.fix[-239:], np.arange(1, len(gnss)))  # the first is at the IMU's first sample
    assert found.events.value[:, :3] == pytest.approx(gnss.position[found.fix])
    sigma = np.hstack([gnss.position_sigma, gnss.velocity_sigma])
    assert found.events.variance == pytest.approx(sigma[found.fix] ** 2)
    assert np.abs(found.events.late).max() < 1e-6
    assert measurement.time[found.events.at] == pytest.approx(found.fix, abs=1e-6)
    assert found.notes == ()


def test_spaced_fixes_are_the_same_whatever_their_delay():
    """Likelihoods of two delays can be compared only if they count the same fixes."""
    log = drive(MODEL.error_model, ROUTE, 2, receiver=Receiver(rate=10.0))
    samples = measurement_of(log, log.imu(), Installation())
    used = [
        set(
            taken(
                log, samples, replace(MODEL, installation=Installation(gnss_delay=d), settings=Settings(spacing=1.0))
            ).fix
        )
        for d in (0.0, 0.1337, -0.25)
    ]
    assert all(len(a ^ b) <= 1 for a in used for b in used)  # the end of the log may cut one off
    rows = np.array(sorted(used[0]))
    assert set(np.diff(rows)) == {10}
    assert "spaced-fixes" in ids(taken(log, samples, replace(MODEL, settings=Settings(spacing=1.0))).notes)


@pytest.mark.parametrize("delay", [0.1337, -0.004])
def test_a_delay_is_taken_off_and_what_is_left_is_told(town, measurement, delay):
    model = replace(MODEL, installation=Installation(gnss_delay=delay))
    found = taken(town, measurement, model)
    own = town.seconds(town.gnss[0].time)[found.fix] - delay
    assert measurement.time[found.events.at] + found.events.late == pytest.approx(own, abs=1e-9)
    assert np.abs(found.events.late).max() <= 0.005 + 1e-9


def test_held_duplicates_are_left_out_only_while_moving(town, measurement):
    position, velocity = array(town, "position"), array(town, "velocity")
    for row in (100, 101, 150, 20):  # the last: it stands still
        position[row], velocity[row] = position[row - 1], velocity[row - 1]
    velocity[19:21] = 0
    found = taken(town, measurement, position=position, velocity=velocity)
    assert not np.isin([100, 101, 150], found.fix).any()
    assert np.isin([99, 102, 20], found.fix).all()
    assert ids(found.notes) == ("repeated-fixes",)
    assert "/gnss/fix: 3 fixes" in found.notes[0]


def test_wild_and_missing_velocities_leave_the_position(town, measurement):
    velocity = array(town, "velocity")
    velocity[50, 0], velocity[60], velocity[70, 2] = 427.0, np.nan, np.nan
    found = taken(town, measurement, velocity=velocity)
    used = found.events.variance > 0
    assert used[found.fix == 50].tolist() == [[True] * 3 + [False] * 3]
    assert used[found.fix == 60].tolist() == [[True] * 3 + [False] * 3]
    assert used[found.fix == 70].tolist() == [[True] * 5 + [False]]
    assert np.isfinite(found.events.value).all()
    assert ids(found.notes) == ("no-velocity-down", "impossible-velocities")
    assert " for 1 of " in found.notes[0]
    assert "/gnss/fix: 1 velocities above 350 m/s" in found.notes[1]


def test_a_repeated_fix_is_known_without_its_velocity_down(town, measurement):
    position, velocity = array(town, "position"), array(town, "velocity")
    velocity[:, 2] = np.nan
    position[100], velocity[100] = position[99], velocity[99]
    found = taken(town, measurement, position=position, velocity=velocity)
    assert 100 not in found.fix
    assert ids(found.notes) == ("repeated-fixes", "no-velocity-down")


@pytest.mark.parametrize(("speed", "used"), [(349.0, True), (351.0, False)])
def test_an_impossible_velocity_is_above_350_m_s(town, measurement, speed, used):
    velocity = array(town, "velocity")
    velocity[50, 1] = -speed
    found = taken(town, measurement, velocity=velocity)
    assert (found.events.variance[found.fix == 50, 3:] > 0).tolist() == [[used] * 3]
    assert ids(found.notes) == (() if used else ("impossible-velocities",))


@pytest.mark.parametrize(("speed", "left_out"), [(0.9, False), (1.1, True)])
def test_a_repeated_fix_moves_faster_than_a_metre_a_second(town, measurement, speed, left_out):
    position, velocity = array(town, "position"), array(town, "velocity")
    velocity[99:101] = speed, 0.0, 0.0
    position[100] = position[99]
    found = taken(town, measurement, position=position, velocity=velocity)
    assert (100 not in found.fix) == left_out


def test_a_receiver_without_velocity_or_sigmas_says_so(town, measurement):
    found = taken(town, measurement, velocity=None, velocity_sigma=None)
    assert not found.events.variance[:, 3:].any()
    assert ids(found.notes) == ("no-velocities",)
    settings = Settings(position_sigma=(2.0, 7.0), velocity_sigma=(0.2, 0.4), sigma_scale=(9.0, 9.0))
    found = taken(town, measurement, replace(MODEL, settings=settings), position_sigma=None, velocity_sigma=None)
    assert np.sqrt(found.events.variance[5]) == pytest.approx([2, 2, 7, 0.2, 0.2, 0.4])
    assert ids(found.notes) == ("default-position-sigmas", "default-velocity-sigmas")
    assert "2 m (horizontal) and 7 m " in found.notes[0]
    assert "0.2 m/s (horizontal) and 0.4 m/s " in found.notes[1]


def test_sigmas_are_scaled_and_never_too_small(town, measurement):
    sigma = array(town, "position_sigma")
    sigma[30], sigma[31], sigma[32, 1] = 1e-4, 0.0, np.nan
    found = taken(town, measurement, replace(MODEL, settings=Settings(sigma_scale=(2.0, 2.0))), position_sigma=sigma)
    got = dict(zip(found.fix, np.sqrt(found.events.variance), strict=True))
    assert got[29][:3] == pytest.approx([4, 4, 7])
    assert got[30][:3] == pytest.approx([LEAST_SIGMA[0]] * 3)
    assert got[31][:3] == pytest.approx([2.5, 2.5, 5.0])
    assert got[32][:3] == pytest.approx([4, 2.5, 7])
    assert got[40][3:] == pytest.approx([0.2, 0.2, 0.3])


def test_flat_fixes_are_left_out(town, measurement):
    kinds = np.full(len(town.gnss[0]), 3)
    kinds[[10, 11, 90]] = [1, 2, 0]
    found = taken(town, measurement, fix_type=kinds)
    assert not np.isin([10, 11, 90], found.fix).any()
    assert ids(found.notes) == ("flat-fixes",)
    assert "/gnss/fix: 3 fixes" in found.notes[0]


def test_too_few_fixes_are_refused_with_both_times(town, measurement):
    gnss = town.gnss[0]
    few = replace(
        gnss, time=gnss.time[:200] + 239_500_000_000 - 195_000_000_000, position=gnss.position[:200], velocity=None,
        position_sigma=None, velocity_sigma=None, fix_type=None,
    )  # fmt: skip
    far = replace(few, time=few.time + 192_000_000_000)
    assert corrections_of(town, few, measurement, np.zeros((0, 2)), MODEL).fix.size > 100
    with pytest.raises(MissingDataError, match=r"4 usable fixes of /gnss/fix lie within the IMU's time \(-?0\.0 s to 240\.0 s; "
                       r"the fixes: 236\.5 s to 435\.5 s\); a filter needs 5"):  # fmt: skip
        corrections_of(town, far, measurement, np.zeros((0, 2)), MODEL)
    never = replace(gnss, time=gnss.time + 10**12)
    with pytest.raises(MissingDataError, match=r"--gnss-shift -1000\.\d"):
        corrections_of(town, never, measurement, np.zeros((0, 2)), MODEL)


# Aids


def test_aids_come_each_second_in_order(town, measurement):
    model = replace(MODEL, aids=Aids(straight=0.2, still=0.05, speed=0.1))
    found = taken(town, measurement, model, still=np.array([[10.2, 20.7]]))
    kind = found.events.kind
    assert (np.diff(found.events.at) >= 0).all()
    assert found.time[kind == STILL] == pytest.approx(np.arange(11.0, 21.0))
    assert np.diff(found.time[kind == STRAIGHT]) == pytest.approx(1.0)
    assert np.diff(found.time[kind == SPEED]) == pytest.approx(1.0, abs=0.11)
    speeds = town.speeds[0]
    at = town.seconds(speeds.time)
    expected = np.interp(found.time[kind == SPEED], at, speeds.value)
    assert found.events.value[kind == SPEED, 0] == pytest.approx(expected, abs=1e-9)
    widths = {STILL: (0.05, 3), STRAIGHT: (0.2, 2), SPEED: (0.1, 1)}
    for k, (sigma, count) in widths.items():
        variance = found.events.variance[kind == k]
        assert variance[:, :count] == pytest.approx(sigma**2)
        assert not variance[:, count:].any()
    assert (found.fix[kind != FIX] == -1).all()


def test_without_an_odometer_there_is_no_speed(town, measurement):
    model = replace(MODEL, aids=Aids(speed=0.1))
    assert (taken(replace(town, speeds=()), measurement, model).events.kind == FIX).all()
    short = replace(town, speeds=(Scalars("v", town.speeds[0].time[:25], town.speeds[0].value[:25]),))
    assert (taken(short, measurement, model).events.kind == SPEED).sum() == 3


def test_stated_sigmas_replace_the_receivers_and_are_scaled(town, measurement):
    settings = Settings(sigma_stated=(0.5, 0.2), sigma_scale=(3.0, 2.0))
    found = taken(town, measurement, replace(MODEL, settings=settings))
    assert np.sqrt(found.events.variance[0]) == pytest.approx([1.5, 1.5, 3.0, 0.4, 0.4, 0.4])


def test_a_floor_adds_variance_to_what_is_measured_only(town, measurement):
    velocity = array(town, "velocity")
    velocity[5] = np.nan
    found = taken(town, measurement, velocity=velocity)
    more = raised(found, (0.3, 0.05)).events.variance - found.events.variance
    known = found.events.variance > 0
    expected = np.tile(np.square([0.3, 0.3, 0.6, 0.05, 0.05, 0.05]), (len(more), 1))
    assert more == pytest.approx(np.where(known, expected, 0.0))
    assert not known.all()
