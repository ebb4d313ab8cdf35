"""Noise in motion: its densities, when it acts, and what it adds to a drive."""

from itertools import pairwise

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.simulation import MotionNoise, drive, mixed_route, preset
from imuwb.stochastic import ImuErrorModel, RandomWalk, WhiteNoise

IDEAL = ImuErrorModel("ideal", {})
N, RATE = 1 << 17, 100.0
SIGMAS = 5  #: a right simulator fails one of a million such checks


def allan_variance(values, cells):
    """Return the Allan variance of (n, axes) without overlap, its mean over the axes, and its relative sigma at most."""
    means = values[: values.shape[0] // cells * cells].reshape(-1, cells, values.shape[1]).mean(axis=1)
    steps = np.diff(means, axis=0) ** 2 / 2
    return steps.mean(), np.sqrt(
        4 / steps.size
    )  # neighbours share a cell: at most twice the variance of independent steps


@pytest.mark.parametrize("cells", [1, 10, 100, 2000])
@pytest.mark.parametrize(
    ("white", "walk"), [((1e-3, 1e-2), (0, 0)), ((0, 0), (2e-5, 3e-4)), ((1e-3, 2e-2), (1e-3, 5e-3))]
)
def test_densities_are_as_stated(white, walk, cells):
    noise = MotionNoise(white, walk, "always")
    found = noise.sample(np.zeros(N, bool), 1 / RATE, np.random.default_rng(4))
    for values, n, k in zip(found, white, walk, strict=True):
        model = WhiteNoise(n) + RandomWalk(k)
        (expected,) = model.allan_variance(np.array([cells / RATE]), 1 / RATE)
        if not expected:
            assert not values.any()
            continue
        variance, relative = allan_variance(values, cells)
        if not n and cells == 1:
            expected = k**2 / RATE / 3  # exact for averages
        assert variance == pytest.approx(expected, rel=SIGMAS * relative)


def test_axes_are_independent():
    values = np.hstack(MotionNoise((1.0, 1.0), when="always").sample(np.ones(N, bool), 1.0, np.random.default_rng(5)))
    assert np.abs(np.corrcoef(values.T) - np.eye(6)).max() < SIGMAS / np.sqrt(N)


def test_while_the_vehicle_stands_white_noise_is_absent_and_the_walk_rests():
    moving = np.zeros(3000, bool)
    moving[1000:2000] = True
    rates, forces = MotionNoise((1e-3, 0.0), (0.0, 1e-2)).sample(moving, 0.01, np.random.default_rng(0))
    assert (rates.any(axis=1) == moving).all()
    assert not forces[:1000].any()
    assert np.ptp(forces[2001:], axis=0) == pytest.approx(0, abs=1e-15)
    assert forces[-1].all()


def test_a_drive_has_the_noise_in_addition_to_that_of_the_sensor():
    route, model = mixed_route(200, 2), preset("mpu-6050")
    noise = MotionNoise((2e-3, 3e-2), (2e-5, 3e-4))
    calm, shaken = (drive(model, route, 3, motion_noise=m) for m in (None, noise))
    moving = route.speed(np.arange(20_000) / 100) > 0.1
    for triad, density in (("angular_rate", 2e-3), ("specific_force", 3e-2)):
        error = getattr(shaken.imus[0], triad).value - getattr(calm.imus[0], triad).value
        assert not error[~moving][:6000].any()
        found = np.diff(error[moving], axis=0)  # without the walk
        assert (found**2).mean() / 2 == pytest.approx(density**2 * 100, rel=SIGMAS * np.sqrt(3 / found.size))
    for name in ("position", "velocity", "position_sigma"):
        assert np.array_equal(getattr(shaken.gnss[0], name), getattr(calm.gnss[0], name))
    assert np.array_equal(shaken.references[0].position, calm.references[0].position)
    assert shaken.provenance.hash != calm.provenance.hash


def test_seeds_decide():
    route = mixed_route(100)
    logs = [drive(IDEAL, route, seed, motion_noise=MotionNoise(when="always")) for seed in (1, 1, 2)]
    values = [log.imus[0].angular_rate.value for log in logs]
    assert [np.array_equal(a, b) for a, b in pairwise(values)] == [True, False]


@pytest.mark.parametrize(
    "values",
    [{"white": (-1e-3, 0)}, {"white": (0, np.nan)}, {"walk": (0, 2)}, {"walk": (np.inf, 0)}, {"when": "often"}],
)
def test_what_cannot_be_is_refused(values):
    with pytest.raises(UsageError):
        MotionNoise(**values)
