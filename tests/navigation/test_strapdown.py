"""Mechanization against the truth of drives, against closed forms of turning, and in another frame."""

import math

import numpy as np
import pytest

from imuwb.geodesy.attitude import euler_of_quaternion
from imuwb.navigation.strapdown import SIZE, mechanize, navigation_state
from imuwb.simulation import mixed_route, planned_route

from .. import ecef  # noqa: TID252 - tests are no package that has a name
from . import drives


@pytest.fixture(scope="module")
def town():
    return planned_route("turin-1")


def off(track, truth):
    """Return the largest distance, m, and difference of velocity, m/s, to the truth."""
    by = [(t[:3] - p) * drives.scale(p) for t, p in zip(track[::50], truth.position[1::50], strict=True)]
    return np.linalg.norm(by, axis=1).max(), np.abs(track[:, 3:6] - truth.velocity[1:]).max()


# Drives


@pytest.mark.slow
def test_a_drive_of_ten_minutes_ends_within_a_centimetre(town):
    motion = drives.increments(town, 600)
    place, speed = off(drives.went(motion), motion.truth)
    assert place < 0.01
    assert speed < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("rate", [50, 100])
def test_a_step_errs_with_a_higher_power_than_its_square(town, rate):
    motion = drives.increments(town, 600, rate)
    assert off(drives.went(motion), motion.truth)[0] < 1e-4 * (100 / rate) ** 3


@pytest.mark.slow
def test_errors_fall_at_least_with_the_square_of_the_step():
    route, found = mixed_route(300), []
    for rate in (50, 100, 200):
        motion = drives.increments(route, 290, rate)
        found.append(off(drives.went(motion), motion.truth)[0])
    assert found[0] > 3.8 * found[1] > 3.8**2 * found[2]


@pytest.mark.slow
def test_attitude_follows_the_truth(town):
    motion = drives.increments(town, 600)
    found = euler_of_quaternion(drives.went(motion)[:, 6:])
    apart = np.angle(np.exp(1j * (found - motion.euler)))
    assert np.abs(apart).max() < 2e-8


@pytest.mark.parametrize("latitude", [-60.0, 0.5, 45.0, 80.0])
def test_another_frame_leads_to_the_same_place(latitude):
    """Random but smooth motion, at speeds and turns that a car has not."""
    rng = np.random.default_rng(5)
    phase, pace = rng.uniform(0, 6, (2, 6, 3)), rng.uniform(0.2, 2.0, (6, 3))

    def inertial(t):
        waves = np.sin(pace * t[:, None, None] + phase[0]).reshape(t.size, 3, 2, 3)
        omega = waves[:, :, 0].mean(axis=1) * [0.3, 0.3, 0.6]
        return omega, waves[:, :, 1].mean(axis=1) * 4 + [0, 0, -9.8]

    rate, seconds = 200, 60
    nodes, weights = np.polynomial.legendre.leggauss(5)
    at = (np.arange(seconds * rate)[:, None] + (nodes + 1) / 2) / rate
    omega, force = (np.einsum("j,ijk->ik", weights / 2, x.reshape(-1, 5, 3)) / rate for x in inertial(at.ravel()))
    start = (np.array([math.radians(latitude), 0.12, 300.0]), np.array([20.0, -10.0, 1.0]), np.array([0.1, -0.2, 2.0]))
    track = mechanize(navigation_state(*start), np.full(rate * seconds, 1 / rate), omega, force)
    _, position, velocity, attitude = ecef.strapdown(inertial, 0.0, seconds, *start)
    place, axes = track[-1, :3], ecef.local_axes(*track[-1, :2])
    assert np.linalg.norm(ecef.cartesian(place) - position[-1]) < 0.03
    assert np.abs(axes @ track[-1, 3:6] - velocity[-1]).max() < 2e-3
    assert np.abs(axes @ drives.rotation(track[-1, 6:]) - attitude[-1]).max() < 1e-6


# Turning alone


def coning(times, half=0.0175, turn=1.6):
    """Return quaternions (n, 4) of coning, and the increments of angle on the turning earth, by fine quadrature."""

    def quaternion(t):
        c, s = math.cos(half / 2), math.sin(half / 2)
        return np.stack([np.full_like(t, c), s * np.cos(turn * t), s * np.sin(turn * t), 0 * t], axis=-1)

    def rate(t):  # 2 q* dq/dt
        s = math.sin(half)
        own = np.stack([-s * np.sin(turn * t), s * np.cos(turn * t), np.full_like(t, -2 * math.sin(half / 2) ** 2)], -1)
        return turn * own + np.array([drives.rotation(q).T @ still for q in quaternion(t)])

    still = drives.earth(CONING_PLACE, np.zeros(3))[0]
    nodes, weights = np.polynomial.legendre.leggauss(6)
    h = np.diff(times)
    at = times[:-1, None] + h[:, None] * (nodes + 1) / 2
    return quaternion(times), np.einsum("j,ijk->ik", weights / 2, rate(at.ravel()).reshape(*at.shape, 3)) * h[:, None]


def turned_off(steps, expected):
    """Return by how much, rad, an attitude is wrong after coning in some steps, for the lengths that the algorithm is given."""
    truth, angle = coning(np.concatenate([[0.0], np.cumsum(steps)]))
    state = navigation_state(CONING_PLACE, np.zeros(3), np.zeros(3))
    state[6:10] = truth[0]
    if expected is not steps:  # the earth turns by the true step
        angle = angle - drives.earth(CONING_PLACE, np.zeros(3))[0] * (steps - expected)[:, None]
    force = np.array([drives.rotation(q).T @ [0, 0, -9.8] * h for q, h in zip(truth[1:], expected, strict=True)])
    track = mechanize(state, expected, angle, force)
    turn = [drives.rotation(truth[1:][k]) @ drives.rotation(track[k, 6:]).T for k in (0, -1)]
    first, last = ((x - x.T) / 2 for x in turn)
    return np.linalg.norm(last - first) / math.sqrt(2)  # the first step has none before it


CONING_PLACE = np.array([0.7, 0.1, 0.0])


def test_coning_with_uneven_steps_needs_the_uneven_weight():
    """Steps of 20 and 60 ms by turns: weighed by their own lengths, or as if they were even."""
    uneven, even = np.tile([0.02, 0.06], 125), np.full(250, 0.04)
    right, naive = turned_off(uneven, uneven), turned_off(uneven, even)
    assert right < 1e-8
    assert naive > 100 * right


def test_turning_about_one_axis_is_exact():
    n, h = 1000, 0.01
    angle = np.tile([0.0, 0.0, 0.05], (n, 1))  # 5 rad/s: eight turns
    still = drives.earth(np.array([0.5, 0.0, 0.0]), np.zeros(3))[0]
    turn = 0.05 * np.arange(n)
    c, s = np.cos(turn), np.sin(turn)
    angle += h * np.stack([c * still[0], -s * still[0], np.full(n, still[2])], axis=1)
    force = np.tile([0.0, 0.0, -9.79 * h], (n, 1))
    track = mechanize(navigation_state(np.array([0.5, 0, 0]), np.zeros(3), np.zeros(3)), np.full(n, h), angle, force)
    heading = euler_of_quaternion(track[:, 6:])[:, 2]
    assert np.abs(np.angle(np.exp(1j * (heading - 0.05 * np.arange(1, n + 1))))).max() < 1e-6
    assert np.abs(np.linalg.norm(track[:, 6:], axis=1) - 1).max() < 1e-15


# Rest and fall


@pytest.mark.parametrize("latitude", [-89.0, -45.0, 0.0, 30.0, 89.0])
def test_what_stands_on_the_turning_earth_stays_there(latitude):
    place = np.array([math.radians(latitude), 1.0, 100.0])
    still, axes = drives.earth(place, np.zeros(3))[0], ecef.local_axes(*place[:2])
    force = -axes.T @ np.array(ecef._gravity(*ecef.cartesian(place)))  # noqa: SLF001 - the oracle's own
    n, h = 6000, 0.01
    track = mechanize(
        navigation_state(place, np.zeros(3), np.zeros(3)), np.full(n, h), np.tile(still * h, (n, 1)),
        np.tile(force * h, (n, 1)),
    )  # fmt: skip
    assert np.abs((track[-1, :3] - place) * drives.scale(place)).max() < 1e-5
    assert np.abs(track[-1, 3:6]).max() < 1e-6


def test_what_falls_freely_falls_as_gravity_says():
    n, h, g = 200, 0.01, 9.780325
    start = navigation_state(np.array([0.0, 0.0, 1000.0]), np.zeros(3), np.zeros(3))
    track = mechanize(start, np.full(n, h), np.zeros((n, 3)), np.zeros((n, 3)))
    assert 1000 - track[-1, 2] == pytest.approx(g * 2**2 / 2, rel=4e-4)  # 3e-4 less of it at 1 km
    # A fall of two seconds leads east: omega g t³ / 3.
    assert track[-1, 1] * ecef.A == pytest.approx(7.292e-5 * g * 8 / 3, rel=1e-3)


def test_a_start_is_left_as_it_was_and_goes_on_where_it_stopped():
    motion = drives.increments(mixed_route(120), 110)
    assert motion.start.shape == (SIZE,)
    before = motion.start.copy()
    whole = drives.went(motion)
    assert np.array_equal(motion.start, before)
    half = drives.went(motion, h=motion.h[:5000], angle=motion.angle[:5000], push=motion.push[:5000])
    assert np.array_equal(whole[:5000], half)
