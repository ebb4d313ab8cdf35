"""The limits of the simulator's settings, from both sides."""

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.simulation import Odometer, Receiver, Temperature, mixed_route, planned_outages, rate_table, set_points
from imuwb.simulation.bench import check_misplacement, check_size
from imuwb.simulation.drive import _check
from imuwb.simulation.six_position import six_position
from imuwb.simulation.vibration import vibration
from imuwb.stochastic import ImuErrorModel

IDEAL = ImuErrorModel("ideal", {})
RNG = np.random.default_rng(0)


def table(count):
    return rate_table(IDEAL, 0, np.linspace(0.01, 0.02, count), axes="z", seconds=1, rate=16)


@pytest.mark.parametrize(
    ("make", "allowed", "refused"),
    [
        (lambda x: vibration(200, 100.0, x, RNG), 100.0, 100.1), (lambda x: vibration(200, x, 1.0, RNG), 60.0, 59.9),
        (lambda x: six_position(IDEAL, 0, positions=x, seconds=1, rate=20), 100, 101),
        (lambda x: six_position(IDEAL, 0, positions=x, seconds=1, rate=20), 9, 8), (table, 50, 51),
        (lambda x: check_size(x, 6, 1.0), 16, 15), (lambda x: check_size(1.0, 6, x), 1e5, 1.1e5),
        (check_misplacement, 0.2, 0.21), (check_misplacement, 0.0, -0.01),
        (lambda x: Temperature(((0.0, x),)), -273.0, -273.2), (lambda x: Temperature(((0.0, x),)), 999.0, 1001.0),
        (lambda x: Temperature(((0.0, 900.0),), rise=x), 99.0, 101.0), (lambda x: Receiver(rate=x), 1000.0, 1000.1),
        (lambda x: Receiver(latency=x), 60.0, 60.1), (lambda x: Receiver(lever_arm=(0, x, 0)), -1000.0, -1000.1),
        (lambda x: Receiver(velocity_sigma=(0, x, 0)), 0.0, -0.1), (lambda x: Odometer(scale_error=x), -1.0, -1.1),
        (lambda x: Odometer(step=x), 100.0, 100.1), (lambda x: Odometer(rate=x), 1000.0, 1000.1),
        (lambda x: set_points(0, x, 1), 199, 200), (lambda x: set_points(0, 0.01, x), 0.001, 0.0009),
        (mixed_route, 90.0, 89.9), (planned_outages, "turin-1", "turin-3"),
        (lambda x: _check(mixed_route(90), x, 1.0), 20.0, 19.9), (lambda x: _check(mixed_route(90), x, 1.0), 1e4, 1.01e4),
        (lambda x: _check(mixed_route(90), 100.0, x), 100.0, 100.1),
    ],
)  # fmt: skip
def test_the_last_value_that_is_allowed_and_the_first_that_is_not(make, allowed, refused):
    make(allowed)
    with pytest.raises(UsageError):
        make(refused)
