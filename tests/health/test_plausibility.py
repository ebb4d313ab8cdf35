"""A gravity or a rate that a still IMU cannot measure."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.health import check
from imuwb.log import SECOND, GnssStream

from .records import G, faults, log_of, motion, still


@pytest.mark.parametrize(("gravity", "severity", "follows"), [(9.3, "warning", "-52 mg"), (3.4, "fault", "units")])
def test_a_gravity_that_cannot_be_is_told(gravity, severity, follows):
    gyro, accel = still()
    (fault,) = faults(gyro, accel + np.array([0, 0, G - gravity]))
    assert (fault.stream, fault.kind, fault.severity) == ("/imu accelerometers", "gravity", severity)
    assert f"{gravity} m/s²" in fault.what
    assert follows in fault.consequence
    assert (fault.start, fault.length) == (0, pytest.approx(59.99))


@pytest.mark.parametrize("gravity", [9.78, 9.832])
def test_the_gravity_of_equator_and_pole_is_none(gravity):
    gyro, accel = still()
    assert faults(gyro, accel + np.array([0, 0, G - gravity])) == []


def test_a_tilted_imu_feels_one_gravity_too():
    gyro, accel = still()
    assert faults(gyro, accel - [0, 0, -G] + G * np.array([0.6, 0, -0.8])) == []


def test_a_gyro_bias_of_minus_0_4_is_told():
    gyro, accel = still()
    (bias,) = faults(gyro - [0, 0.4, 0], accel)
    assert (bias.stream, bias.kind, bias.severity) == ("/imu gyros", "rate", "warning")
    assert "-22.9 deg/s" in bias.what


def test_gravity_is_judged_where_the_imu_is_still():
    gyro, accel = still()
    moving = motion(3)
    moving[:4000] = 0
    accel[4000:, 2] += 5
    assert faults(gyro + moving[:, :3], accel + 3 * moving[:, 3:], "gravity") == []
    (fault,) = faults(gyro + moving[:, :3], accel + 3 * moving[:, 3:] + [0, 0, 0.5], "gravity")
    assert fault.length == pytest.approx(40, abs=2)


def fallen(accel, lag=0.0):
    """Return an acceleration without its mean, as a program that subtracts gravity writes it."""
    return accel - accel.mean(axis=0) + lag


@pytest.mark.parametrize("moves", [False, True])
def test_an_acceleration_without_gravity_is_no_specific_force(moves):
    gyro, accel = still()
    shaken = 0.7 * motion(3)[:, 3:] if moves else 0
    found = faults(gyro + 0.3 * motion(4)[:, :3] * moves, fallen(accel) + shaken)
    (fault,) = (f for f in found if f.severity == "fault")
    assert (fault.stream, fault.kind) == ("/imu accelerometers", "no gravity")
    assert "gravity is missing" in fault.what
    assert "unit" not in fault.consequence


@pytest.mark.parametrize("size", [0.049, 0.3, 1.2, 2.0])
def test_small_forces_of_any_size_get_no_unit(size):
    gyro, accel = still()
    (fault,) = faults(gyro, fallen(accel, np.array([0, 0, -size])), "no gravity")
    assert "unit" not in fault.consequence


@pytest.mark.parametrize(("size", "unit"), [(1.0, "g"), (1000.0, "mg"), (980.0, "cm/s²")])
def test_one_gravity_at_rest_in_another_unit_is_told_with_the_unit(size, unit):
    gyro, accel = still()
    (fault,) = faults(gyro, accel * size / G)
    assert (fault.kind, fault.severity) == ("gravity", "fault")
    assert fault.consequence.endswith(f"likely {unit}")


@pytest.mark.parametrize(
    ("factor", "found"), [(1, []), (1.4, []), (1.7, ["gravity"]), (0.5, ["gravity"]), (100, ["gravity"])]
)
def test_an_imu_that_never_rests_feels_about_one_gravity(factor, found):
    gyro, accel = still()
    moved = motion(3)
    log = received(log_of(gyro + moved[:, :3], (accel + moved[:, 3:]) * factor), np.tile([20.0, 0, 0], (61, 1)))
    assert [f.kind for f in check(log).faults if f.severity == "fault"] == found


def received(log, velocity):
    """Return a log with a receiver that states a velocity each second."""
    gnss = GnssStream("/fix", np.arange(61) * SECOND, np.tile([0.8, 0.2, 0], (61, 1)), velocity)
    return replace(log, gnss=(gnss,))


def test_where_a_receiver_accelerates_a_larger_force_is_plausible():
    turns = 2 * np.pi * np.arange(61) / 30
    circle = 95 * np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)  # 20 m/s² towards the middle
    log = log_of(still()[0], 2.2 * still()[1])
    for velocity, kinds in ((circle, []), (95 + 0 * circle, ["gravity"])):
        assert [f.kind for f in check(received(log, velocity)).faults if f.severity == "fault"] == kinds


def test_gravity_is_one_though_the_imu_turns_slowly():
    gyro, accel = still()
    angle = np.linspace(0, 2 * np.pi, len(accel))[:, None]
    turned = accel + G * np.array([0, 0, 1]) + G * (np.sin(angle) * [1, 0, 0] - np.cos(angle) * [0, 0, 1])
    assert not [f for f in faults(gyro, turned) if f.severity == "fault"]
