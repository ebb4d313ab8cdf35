"""Sensors that are slower than the rows of their log."""

import numpy as np
import pytest

from .records import N, faults, still


@pytest.mark.parametrize(("rows", "rate"), [(2, "50 Hz"), (4, "25 Hz")])
def test_rows_that_repeat_the_values_before_at_new_times_are_found(rows, rate):
    held = [np.repeat(values, rows, axis=0)[:N] for values in still()]
    found = faults(*held, "held rows")
    assert [f.stream for f in found] == ["/imu gyros", "/imu accelerometers"]
    assert all(f.severity == "warning" and f"about {rate}" in f.consequence for f in found)


def test_one_sensor_that_is_held_is_named():
    gyro, accel = still()
    (found,) = faults(gyro, np.repeat(accel, 2, axis=0)[:N], "held rows")
    assert found.stream == "/imu accelerometers"


@pytest.mark.parametrize("step", [0.001, 0.01, 0.02, 0.03])
def test_a_coarse_sensor_is_not_held(step):
    gyro, accel = (np.round(values / step) * step for values in still())
    assert faults(gyro, accel, "held rows") == []
