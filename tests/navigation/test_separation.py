"""The smoothed trajectory at the rate of the IMU: against the smoother at the fixes, the truth, and its own sigmas."""

from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.geodesy import euler_of_quaternion, ned_scale
from imuwb.navigation import separation
from imuwb.navigation.smoother import smoothed
from imuwb.replay import prepare, run
from tests.replay import made

GAP = (150.0, 180.0)


@pytest.fixture(scope="module")
def drive():
    town = made.town(300, 1, seed=2)
    seconds = made.seconds_of(town.log.gnss[0])
    log = made.with_gnss(town.log, (seconds <= GAP[0]) | (seconds > GAP[1]))
    prepared = prepare(log, town.model)
    solution = run(town.model, prepared, smooth=True)
    return SimpleNamespace(log=log, solution=solution, found=separation(solution))


def errors(drive, track):
    """Return the times of the truth, s, and a track's errors there, (k, 3) m NED."""
    truth, found = drive.log.references[0], drive.found
    time = (truth.time - drive.log.zero) / 1e9
    at = np.searchsorted(found.time, time - 1e-6).clip(0, found.time.size - 1)
    rows = np.abs(found.time[at] - time) < 1e-3
    scale = ned_scale(truth.position[rows, 0], truth.position[rows, 2])
    return time[rows], (track.position[at[rows]] - truth.position[rows]) * scale, at[rows]


def test_every_sample_from_the_start_has_a_row(drive):
    found, measurement = drive.found, drive.solution.measurement
    assert np.diff(found.time) == pytest.approx(measurement.interval)
    assert found.time[-1] == pytest.approx(measurement.time[-1])


def test_at_the_fixes_it_is_the_smoother(drive):
    own, found = smoothed(drive.solution), drive.found
    at = np.searchsorted(found.time, own.time - 1e-6)
    scale = ned_scale(own.position[:, 0], own.position[:, 2])
    assert np.abs((found.smoothed.position[at] - own.position) * scale).max() < 0.02
    assert np.abs(found.smoothed.velocity[at] - own.velocity).max() < 0.01
    turned = euler_of_quaternion(found.smoothed.quaternion[at]) - own.euler
    assert np.abs(np.angle(np.exp(1j * turned))).max() < 1e-3
    assert found.smoothed.sigma[at] == pytest.approx(own.sigma[:, :9], rel=0.05)


def test_at_the_fixes_forward_is_the_filter(drive):
    own, found = drive.solution, drive.found
    at = np.searchsorted(found.time, own.time - 1e-6)
    scale = ned_scale(own.position[:, 0], own.position[:, 2])
    assert np.abs((found.forward.position[at] - own.position) * scale).max() < 0.01
    assert found.forward.sigma[at] == pytest.approx(own.sigma[:, :9], rel=0.02)


def test_in_the_gap_the_smoothed_track_is_nearer_to_the_truth(drive):
    time, forward, at = errors(drive, drive.found.forward)
    _, both, _ = errors(drive, drive.found.smoothed)
    _, backward, _ = errors(drive, drive.found.backward)
    gap = (time > GAP[0]) & (time < GAP[1])
    rms = [np.sqrt(np.square(e[gap, :2]).sum(axis=1).mean()) for e in (forward, both, backward)]
    assert rms[1] < 0.3 * rms[0]
    assert rms[1] < rms[2]
    ratio = both[gap, :2] / drive.found.smoothed.sigma[at[gap], :2]
    assert 0.3 < np.sqrt(np.square(ratio).mean()) < 1.7


def test_forward_and_backward_weighted_give_the_smoothed(drive):
    found = drive.found
    part = slice(2000, 9000)
    scale = ned_scale(found.forward.position[part, 0], found.forward.position[part, 2])
    f, b = (1 / t.sigma[part, :3] ** 2 for t in (found.forward, found.backward))
    base = found.smoothed.position[part]
    ahead, behind = ((t.position[part] - base) * scale for t in (found.forward, found.backward))
    known = np.isfinite(b)
    assert np.abs((f * ahead + b * behind) / (f + b))[known].max() < 1e-6
    assert (1 / np.sqrt(f + b))[known] == pytest.approx(found.smoothed.sigma[part, :3][known], rel=1e-6)


def test_no_step_between_samples(drive):
    found = drive.found
    step = np.diff(found.smoothed.position, axis=0) * ned_scale(*found.smoothed.position[1:, [0, 2]].T)
    mean = (found.smoothed.velocity[1:] + found.smoothed.velocity[:-1]) / 2 * drive.solution.measurement.interval
    assert np.abs(step - mean).max() < 0.02


def test_the_end_has_no_backward_solution(drive):
    assert np.isnan(drive.found.backward.position[-1]).all()
    assert np.isfinite(drive.found.smoothed.position).all()
    assert 0.7 < drive.found.inside95() <= 1.0
