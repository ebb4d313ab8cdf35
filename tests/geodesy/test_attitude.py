"""Attitudes against scipy's rotations."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from imuwb.geodesy import (
    euler_of_quaternion,
    euler_of_rotation,
    quaternion_of_rotation,
    rotation_of_euler,
    rotation_of_quaternion,
)

EULER = np.random.default_rng(5).uniform([-3.1, -1.5, -3.1], [3.1, 1.5, 3.1], (50, 3))
#: turns of half a circle and none, where components of the quaternion are zero
CORNERS = np.array([[0, 0, 0], [np.pi, 0, 0], [0, 0, np.pi], [np.pi, 0, np.pi], [0, np.pi / 2, 0], [np.pi / 2, 0, 0]])


def test_rotations_of_angles():
    expected = Rotation.from_euler("ZYX", EULER[:, ::-1]).as_matrix()
    assert rotation_of_euler(EULER) == pytest.approx(expected, abs=1e-12)
    assert euler_of_rotation(expected) == pytest.approx(EULER, abs=1e-12)


@pytest.mark.parametrize("euler", [*EULER[:10], *CORNERS], ids=str)
def test_quaternions(euler):
    rotation = rotation_of_euler(euler)
    quaternion = quaternion_of_rotation(rotation)
    assert np.linalg.norm(quaternion) == pytest.approx(1.0)
    assert quaternion[np.argmax(np.abs(quaternion))] > 0
    assert rotation_of_quaternion(quaternion) == pytest.approx(rotation, abs=1e-12)
    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    assert abs(quaternion @ [w, x, y, z]) == pytest.approx(1.0)


def test_angles_of_quaternions():
    quaternions = np.stack([quaternion_of_rotation(r) for r in rotation_of_euler(EULER)])
    assert euler_of_quaternion(quaternions) == pytest.approx(EULER, abs=1e-10)
