"""Receivers and navigation solutions of telemetry logs."""

import math

import numpy as np
import pytest

from imuwb.notes import ids
from imuwb.readers.flight import tlog_streams
from tests.readers.flight.mavlink_writer import FIX, STEP, T, at, fixes, numbered, since_start, solution, system_time
from tests.readers.repairs import repairs


@pytest.mark.parametrize("name", tlog_streams.RECEIVERS)
@pytest.mark.parametrize("version", [1, 2])
def test_a_fix_in_si(tlog_of, name, version):
    name = {24: "GPS_RAW_INT", 124: "GPS2_RAW"}[name]
    told = {
        "vel": 1000,
        "cog": 3000,
        "fix_type": 5,
        "alt_ellipsoid": 535_125,
        "h_acc": 1500,
        "v_acc": 2500,
        "vel_acc": 300,
    }
    log = tlog_of(*fixes(name=name, version=version, **told))
    (gnss,) = log.gnss
    assert (gnss.name, gnss.origin.frame, gnss.origin.epoch) == (name, "NED", "unix")
    height, sigma = (535.125, [1.5, 1.5, 2.5]) if version == 2 else (488.0, None)
    expected = [math.radians(47.3977420), math.radians(8.5455940), height]
    np.testing.assert_allclose(gnss.position, [expected] * 4, rtol=1e-14)
    velocity = [10 * math.cos(math.radians(30)), 10 * math.sin(math.radians(30)), np.nan]
    np.testing.assert_allclose(gnss.velocity, [velocity] * 4, rtol=1e-14)
    assert gnss.fix_type.tolist() == [5] * 4
    assert (gnss.position_sigma is None) == (gnss.velocity_sigma is None) == (version == 1)
    if sigma:
        np.testing.assert_allclose(gnss.position_sigma, [sigma] * 4, rtol=1e-14)
        np.testing.assert_allclose(gnss.velocity_sigma, [[0.3] * 3] * 4, rtol=1e-14)
    assert ("above_sea" in ids(log.notes)) == (version == 1)


@pytest.mark.parametrize("unknown", ["vel", "cog"])
def test_speed_or_course_that_is_unknown_is_no_velocity(tlog_of, unknown):
    known = [at(i, "GPS_RAW_INT", **{**FIX, "vel": 100, "cog": 0}) for i in range(3)]
    odd = at(3, "GPS_RAW_INT", **{**FIX, "vel": 100, "cog": 0, unknown: 65_535})
    (gnss,) = tlog_of(*known, odd).gnss
    assert np.isfinite(gnss.velocity[:, :2]).tolist() == [[True, True]] * 3 + [[False, False]]
    assert np.isnan(gnss.velocity[:, 2]).all()
    assert gnss.velocity[0, :2].tolist() == [1, 0]


def test_sigmas_that_are_unknown_are_none_of_zero(tlog_of):
    accuracy = [{"h_acc": 1000, "v_acc": 2000, "vel_acc": 100}, {"h_acc": 1000}, {"v_acc": 2000}, {"vel_acc": 100}]
    (gnss,) = tlog_of(*(at(i, "GPS_RAW_INT", **{**FIX, **told}) for i, told in enumerate(accuracy))).gnss
    none = np.nan
    np.testing.assert_allclose(gnss.position_sigma, [[1, 1, 2], [1, 1, none], [none, none, 2], [none] * 3])
    np.testing.assert_allclose(gnss.velocity_sigma[:, 0], [0.1, none, none, 0.1])


def test_rows_before_a_fix_are_left_out_and_counted(tlog_of):
    clock = [at(i, "ATTITUDE") for i in range(9)]
    (gnss,) = tlog_of(*clock, *fixes(3, lat=0, lon=0), *fixes(4, 3), *fixes(1, 7, lat=0), *fixes(1, 8, lon=0)).gnss
    assert since_start(gnss) == [3, 4, 5, 6, 7, 8]
    assert repairs(gnss) == {"no_position": 3}


@pytest.mark.parametrize("bad", [{"lat": 900_000_001}, {"lon": -1_800_000_001}, {"alt": 100_000_000}])
def test_positions_that_cannot_be_are_left_out(tlog_of, bad):
    (gnss,) = tlog_of(*fixes(3), *fixes(1, 3, **bad)).gnss
    assert since_start(gnss) == [0, 1, 2]


def test_a_receiver_that_never_had_a_fix_is_noted_with_its_name_and_count(tlog_of):
    log = tlog_of(*numbered(3), *fixes(7, lat=0, lon=0))
    assert log.gnss == ()
    assert any(note.id == "no_position" and "GPS_RAW_INT: all 7 " in note for note in log.notes)


def test_a_fix_since_power_up_is_dated_by_the_boot_clock(tlog_of):
    (gnss,) = tlog_of(system_time(T + 3600 * 10**6), *(at(i, "ATTITUDE") for i in range(4)), *fixes()).gnss
    assert since_start(gnss) == [36_000, 36_001, 36_002, 36_003]
    assert repairs(gnss) == {}


def test_a_fix_may_tell_unix_time(tlog_of):
    (gnss,) = tlog_of(*(at(i, "GPS_RAW_INT", **FIX, time_usec=T + STEP * (i + 2)) for i in range(4))).gnss
    assert since_start(gnss) == [2, 3, 4, 5]


@pytest.mark.parametrize("stuck", [0, 1_000_000, T, 2**64 - 1])
def test_a_frozen_time_of_fixes_is_not_used(tlog_of, stuck):
    (gnss,) = tlog_of(*fixes(6, time_usec=stuck)).gnss
    assert since_start(gnss) == [0, 1, 2, 3, 4, 5]
    assert repairs(gnss) == {"fix_time_frozen": 6}


def test_one_fix_whose_time_is_far_off_gets_the_recorders(tlog_of):
    rows = [at(i, "GPS_RAW_INT", **FIX, time_usec=T + STEP * i + 61 * 10**6 * (i == 2)) for i in range(5)]
    (gnss,) = tlog_of(*rows).gnss
    assert since_start(gnss) == [0, 1, 2, 3, 4]
    assert repairs(gnss) == {"fix_time_wrong": 1}


def test_two_receivers_are_two_streams(tlog_of):
    log = tlog_of(*fixes(), *fixes(3, name="GPS2_RAW"))
    assert {gnss.name: len(gnss) for gnss in log.gnss} == {"GPS_RAW_INT": 4, "GPS2_RAW": 3}


def test_a_solution_in_si_is_a_reference(tlog_of):
    (reference,) = tlog_of(*(solution(i, vx=100, vy=-250, vz=5) for i in range(3))).references
    assert reference.name == "GLOBAL_POSITION_INT"
    np.testing.assert_allclose(
        reference.position, [[math.radians(47.397742), math.radians(-8.545594), 488.5]] * 3, rtol=1e-14
    )
    np.testing.assert_allclose(reference.velocity, [[1, -2.5, 0.05]] * 3, rtol=1e-14)
    assert reference.attitude is None
    assert since_start(reference) == [0, 1, 2]


def test_attitude_is_interpolated_also_through_the_turn(tlog_of):
    angles = [at(2 * i, "ATTITUDE", roll=0.1 * i, pitch=-0.2, yaw=math.remainder(0.4 * i, math.tau)) for i in range(20)]
    (reference,) = tlog_of(*angles, *(solution(i) for i in range(38))).references
    expected = [[0.05 * i, -0.2, 0.2 * i] for i in range(38)]
    wrong = np.angle(np.exp(1j * (reference.attitude - expected)))
    assert np.abs(wrong).max() < 1e-6


def test_attitude_is_that_of_the_moment_by_the_recorders_clock(tlog_of):
    rows = [at(i, "ATTITUDE", yaw=0.1 * i) + solution(i) for i in range(10)]
    (reference,) = tlog_of(system_time(T + 3600 * 10**6), *rows, time_source="log").references
    assert since_start(reference) == list(range(10))
    assert reference.attitude[:, 2] == pytest.approx(0.1 * np.arange(10), abs=1e-6)


def test_an_attitude_that_is_no_number_costs_no_more_than_its_neighbours(tlog_of):
    rows = [at(i, "ATTITUDE", yaw=math.nan if i == 4 else 0.1 * i) + solution(i) for i in range(20)]
    (reference,) = tlog_of(*rows).references
    assert {0, 1, 2, 10, 15, 19} <= set(since_start(reference))


def test_a_solution_of_nothing_is_none(tlog_of):
    log = tlog_of(*(solution(i, lat=0 if i < 3 else 1, lon=0) for i in range(6)))
    assert since_start(log.references[0]) == [3, 4, 5]
    assert tlog_of(*(solution(i, lat=0, lon=0) for i in range(6))).references == ()


def test_rows_of_a_solution_without_a_position_are_counted(tlog_of):
    log = tlog_of(*(solution(i, lat=0 if i < 3 else 1, lon=0) for i in range(6)))
    assert repairs(log.references[0]) == {"no_position": 3}
    assert any(note.id == "no_position" and note.endswith("(3)") for note in log.notes)
