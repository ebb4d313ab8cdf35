"""A real car: its receiver as it is, and with less."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.joining import joined
from imuwb.log import AXES
from imuwb.navigation import FilterModel, Installation
from imuwb.readers import read
from imuwb.replay import prepare, run
from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, RandomWalk, Sum, WhiteNoise

MOUNTING, LEVER = (180.0, -6.79, 185.35), (0.0, -0.05, 0.0)  # by the author of the drive


@pytest.fixture(scope="module")
def car(shared):
    folder = shared / "drive"
    return joined(read(folder / "derived_imu_si_gpst.csv.gz"), read(folder / "gnss_1934_sf.pos"))


@pytest.fixture(scope="module")
def model():
    noise = {"gyro": (2e-3, 2e-5, 3e-3), "accel": (1e-2, 1e-3, 0.1)}
    axes = {}
    for axis in AXES:
        white, walk, bias = noise[axis[:-2]]
        axes[axis] = AxisModel(Sum((WhiteNoise(white), RandomWalk(walk), Constant(bias))))
    return FilterModel("car", ImuErrorModel("car", axes), installation=Installation(mounting=MOUNTING, lever_arm=LEVER))


def with_receiver(car, **changes):
    return replace(car, gnss=(replace(car.gnss[0], **changes),))


def courses(car, prepared):
    """Return the start's course and the receiver's own, rad, and its velocity at that time."""
    own = car.gnss[0].velocity[prepared.corrections.fix[prepared.alignment.event]]
    return prepared.alignment.euler[2], np.arctan2(own[1], own[0]), own


@pytest.mark.parametrize("sigmas", [True, False])
def test_positions_alone_start_a_filter(car, model, sigmas):
    other = {} if sigmas else {"position_sigma": None}
    prepared = prepare(with_receiver(car, velocity=None, velocity_sigma=None, **other), model)
    start = prepared.alignment
    heading, course, own = courses(car, prepared)
    sigma = np.sqrt(np.diag(start.covariance))
    assert prepared.start_time < 45  # the car leaves at 38 s
    assert abs(np.angle(np.exp(1j * (heading - course)))) < 3 * sigma[8]
    assert (np.abs(start.velocity - own)[:2] < 3 * sigma[3:5] + 0.1).all()
    assert sigma[3] < (0.1 if sigmas else 1.5)
    solution = run(model, prepared)
    rows = solution.corrections.fix[solution.events]
    off = np.linalg.norm(solution.velocity[:, :2] - car.gnss[0].velocity[rows, :2], axis=1)
    assert np.median(off) < (0.15 if sigmas else 0.5)


def test_without_the_velocity_down_the_rest_is_used(car, model):
    gnss = car.gnss[0]
    flat = np.where([True, True, False], gnss.velocity, np.nan)
    whole, part = prepare(car, model), prepare(with_receiver(car, velocity=flat), model)
    assert part.alignment.event == whole.alignment.event
    assert part.alignment.velocity[:2] == pytest.approx(whole.alignment.velocity[:2], abs=1e-6)
    solution = run(model, part)
    assert np.nanmin(solution.fix_dof[:, 1]) == np.nanmax(solution.fix_dof[:, 1]) == 2
    velocity = np.isfinite(solution.track.innovation[part.alignment.event + 1 :, 3:])
    assert velocity[:, :2].all()
    assert not velocity[:, 2].any()
