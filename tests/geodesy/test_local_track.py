"""Rigid fits of tracks against rotations and shifts that are known."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from imuwb.geodesy.local_track import rigid_fit


@pytest.mark.parametrize("angles", [(0, 0, 30), (180, 0, 90), (91, -2, 200)])
def test_a_turned_and_shifted_track_is_found(angles):
    rng = np.random.default_rng(1)
    points = rng.normal(size=(200, 3)) * [100, 40, 2]
    turn, shift = Rotation.from_euler("xyz", angles, degrees=True).as_matrix(), np.array([5.0, -7.0, 1.0])
    fit = rigid_fit(points, points @ turn.T + shift + rng.normal(scale=0.1, size=points.shape))
    assert fit.rotation == pytest.approx(turn, abs=0.02)
    assert fit.shift == pytest.approx(shift, abs=0.05)
    assert fit.rms == pytest.approx(0.1 * np.sqrt(3), rel=0.15)
    assert fit.width == pytest.approx(40, rel=0.15)


def test_a_mirror_is_no_rotation():
    points = np.random.default_rng(2).normal(size=(50, 3)) * [10, 5, 3]
    fit = rigid_fit(points, points * [1, 1, -1])
    assert np.linalg.det(fit.rotation) == pytest.approx(1)
    assert fit.rms > 3


def test_a_straight_track_has_no_width():
    line = np.outer(np.arange(100.0), [1, 2, 0])
    assert rigid_fit(line, line).width < 1e-9
