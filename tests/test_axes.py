"""The axes of an IMU as even series."""

import numpy as np
import pytest

from imuwb.axes import axes_of, for_each, gap_notes, rates
from imuwb.log import ImuStream, Triad
from imuwb.notes import ids

SECOND = 1_000_000_000


def imu(rows):
    """Return an IMU of 100 Hz (gyro) and 50 Hz (accelerometer), of which only these gyro rows are there."""
    rows = np.asarray(rows)
    gyro = Triad(rows * (SECOND // 100), np.stack([rows, 2.0 * rows, -rows], axis=1))
    accel = Triad(np.arange(50) * (SECOND // 50), np.ones((50, 3)))
    return ImuStream("imu", gyro, accel)


@pytest.mark.parametrize(
    ("missing", "expected"),
    [([], (0, 100)), ([9], (10, 100)), ([9, 29, 89], (30, 89)), ([60, 70], (0, 60)), ([50], (0, 50))],
)
def test_the_longest_part_without_gaps(missing, expected):
    axis = axes_of(imu(np.delete(np.arange(100), missing)))["gyro_y"]
    assert axis.longest.tolist() == (2.0 * np.arange(*expected)).tolist()
    assert axis.longest.flags.c_contiguous


def test_sensors_keep_their_own_clocks():
    axes = axes_of(imu(np.arange(100)))
    assert list(axes) == ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"]
    assert rates(axes) == pytest.approx({"gyro": 100.0, "accel": 50.0})
    assert axes["accel_z"].sensor == "accel"


def test_gaps_are_noted_of_the_sensor_that_has_them():
    notes = gap_notes(axes_of(imu(np.delete(np.arange(100), [9, 29]))), "the spectrum")
    assert ids(notes) == ("gaps",)
    assert notes[0].startswith("gyro: 2 gaps; the spectrum ")


def test_each_axis_is_given_to_the_function():
    found = for_each(axes_of(imu(np.arange(100))), lambda axis: (axis.name, axis.values[1]))
    assert found["gyro_z"] == ("gyro_z", -1.0)
    assert list(found) == [name for name, _ in found.values()]


def test_an_axis_prints_itself_in_a_line():
    axis = axes_of(imu(np.delete(np.arange(100), [9, 29])))["gyro_y"]
    assert str(axis) == repr(axis)
    assert str(axis).startswith("gyro_y: 98 samples, 100 Hz, 2 gaps")
