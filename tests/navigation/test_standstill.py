"""When an IMU stands still: quiet samples, and a receiver and wheels that do not move."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.log import GnssStream, Scalars
from imuwb.navigation.filter_model import Installation
from imuwb.navigation.measurement import Measurement, measurement_of
from imuwb.navigation.standstill import standstills
from imuwb.navigation.tables import Samples
from imuwb.simulation import drive, mixed_route

from . import drives

HZ, PLACE = 100, np.array([0.8, 0.2, 300.0])
ROUTE = mixed_route(240, 6)


def test_standing_is_found_where_the_car_stands():
    town = drive(drives.plain(), ROUTE, 2)
    found = standstills(measurement_of(town, town.imu(), Installation()), town, town.gnss[0])
    t = np.arange(0.5, 239, 1.0)
    expected = ROUTE.speed(t) == 0
    got = ((t[:, None] > found[:, 0]) & (t[:, None] < found[:, 1])).any(axis=1)
    assert (got & ~expected).sum() <= 2  # the second in which it starts
    assert (got & expected).sum() > 0.8 * expected.sum()


def scattered(scale):
    """Return 40 s of white noise; second k is scale[k] times as large."""
    rng = np.random.default_rng(3)
    noise = rng.standard_normal((40, HZ, 3))
    noise /= np.sqrt(noise.var(axis=1, keepdims=True).sum(axis=2, keepdims=True))
    noise = (noise * np.asarray(scale)[:, None, None]).reshape(-1, 3)
    n = noise.shape[0]
    samples = Samples(np.full(n, 1 / HZ), noise, noise, np.zeros(n, np.int64))
    return Measurement(np.arange(1, n + 1) / HZ, 1 / HZ, samples, (None,), np.zeros((0, 2)), None)


def test_a_still_second_scatters_up_to_four_times_as_the_quietest():
    scale = np.ones(40)
    scale[10:20], scale[30:] = 4.1, 3.9
    found = standstills(scattered(scale), SimpleNamespace(zero=0, speeds=()), None)
    assert found == pytest.approx(np.array([[0.0, 10.0], [20.0, 40.0]]))


def test_a_receiver_that_moves_is_not_still():
    speed = np.zeros((40, 3))
    speed[5:10, 1], speed[20:25, 0] = 0.6, 0.4
    gnss = GnssStream("g", (np.arange(40) * 1e9).astype(np.int64), np.zeros((40, 3)), velocity=speed)
    found = standstills(scattered(np.ones(40)), SimpleNamespace(zero=0, speeds=()), gnss)
    assert found == pytest.approx(np.array([[0.0, 5.0], [9.0, 40.0]]))


def test_a_log_shorter_than_a_second_has_no_standstill():
    measurement = scattered(np.ones(40))
    short = replace(measurement, time=measurement.time[:50], samples=Samples(*(x[:50] for x in measurement.samples)))
    assert standstills(short, SimpleNamespace(zero=0, speeds=()), None).shape == (0, 2)


def moving_robot(speed, sigma, velocity=None):
    """Return a receiver of a robot that drives north from 20 s on, once a second."""
    t = np.arange(40.0)
    position = np.tile(PLACE, (40, 1))
    position[:, 0] += speed * np.maximum(t - 20, 0) / drives.scale(PLACE)[0]
    return GnssStream("g", (t * 1e9).astype(np.int64), position, velocity, np.full((40, 3), sigma))


@pytest.mark.parametrize(("speed", "sigma", "ends"), [(1.0, 0.5, 18), (1.0, 5.0, 40), (0.0, 0.5, 40)])
def test_without_velocities_positions_that_move_are_no_standstill(speed, sigma, ends):
    """Within five seconds before and after, a displacement of more than 4 sqrt(2) sigmas counts."""
    found = standstills(scattered(np.ones(40)), SimpleNamespace(zero=0, speeds=()), moving_robot(speed, sigma))
    assert found[0] == pytest.approx([0.0, ends], abs=1.0)


def test_wheels_that_turn_are_no_standstill():
    speed = np.zeros(400)
    speed[105:200] = -0.3
    odometer = Scalars("odometer", (np.arange(400) * 1e8).astype(np.int64), speed)
    found = standstills(scattered(np.ones(40)), SimpleNamespace(zero=0, speeds=(odometer,)), None)
    assert found == pytest.approx(np.array([[0.0, 10.0], [20.0, 40.0]]))
