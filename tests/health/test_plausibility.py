"""A gravity or a rate that a still IMU cannot measure."""

import numpy as np
import pytest

from .records import G, faults, motion, still


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
