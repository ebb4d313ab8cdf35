"""The errors that a simulated sensor really has, from the truth in its log."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.log import AXES, ImuStream, Triad
from imuwb.replay import prepare, true_errors

from .. import made  # noqa: TID252 - tests are no package that has a name


def test_constant_errors_are_found_again():
    town = made.town(240, 3, model=made.error_model(white=(1e-6, 1e-5), turn_on=(0.0, 0.0)))
    errors = np.array([1e-3, -2e-3, 5e-4, 0.02, -0.03, 0.05])
    imu = town.log.imus[0]
    triads = [
        Triad(t.time, t.value + errors[rows])
        for t, rows in ((imu.angular_rate, slice(3)), (imu.specific_force, slice(3, 6)))
    ]
    log = replace(town.log, imus=(ImuStream(imu.name, *triads, imu.temperature, imu.origin),))
    time, found = true_errors(prepare(log, town.model))
    assert found.shape == (time.size, len(AXES))
    assert (np.diff(time) > 0).all()
    # over 2 s a gyro's error tilts by up to 4 mrad: 20 mm/s² of gravity in the mean of a window
    # a car that turns within a window mixes x and y
    assert found[:, :3] == pytest.approx(np.tile(errors[:3], (time.size, 1)), abs=1e-4)
    assert found[:, 3:] == pytest.approx(np.tile(errors[3:], (time.size, 1)), abs=0.025)


def test_a_log_without_truth_has_none():
    town = made.town(240, 3)
    assert true_errors(prepare(replace(town.log, references=()), town.model)) is None
