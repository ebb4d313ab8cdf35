"""FLU relative to east-north-up (REP 103) and FRD relative to north-east-down."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from imuwb.geodesy import euler_of_quaternion, swapped_axes

ENU = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1.0]])
FLU = np.diag([1.0, -1.0, -1.0])


def rotation(quaternion):
    return Rotation.from_quat(quaternion, scalar_first=True).as_matrix()


@pytest.mark.parametrize("body", [True, False])
def test_axes_are_swapped_on_both_sides(body):
    rows = Rotation.random(20, rng=1).as_quat(scalar_first=True)
    expected = ENU @ rotation(rows) @ (FLU if body else np.eye(3))
    assert rotation(swapped_axes(rows, body=body)) == pytest.approx(expected, abs=1e-12)
    again = swapped_axes(swapped_axes(rows, body=body), body=body)
    assert np.abs((again * rows).sum(axis=1)) == pytest.approx(1.0)


@pytest.mark.parametrize(("yaw", "heading"), [(0, 90), (90, 0), (180, -90), (60, 30)])
def test_yaw_zero_is_east(yaw, heading):
    quaternion = Rotation.from_euler("ZYX", [yaw, 0, 0], degrees=True).as_quat(scalar_first=True)
    assert np.degrees(euler_of_quaternion(swapped_axes(quaternion))) == pytest.approx([0, 0, heading], abs=1e-9)
