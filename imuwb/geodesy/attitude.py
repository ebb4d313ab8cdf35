"""Attitudes: Euler angles, rotation matrices and quaternions of the body relative to north-east-down (Groves, 2.2).

A quaternion is (w, x, y, z) and turns body vectors into the navigation frame, as C_b_n does.
"""

import numpy as np

from imuwb.arrays import Floats


def rotation_of_euler(euler: Floats) -> Floats:
    """Return C_b_n of roll, pitch and heading (Groves, eq. 2.24; Quinchia, eq. 25).

    Args:
        euler: (..., 3) rad.

    Returns:
        (..., 3, 3)
    """
    roll, pitch, heading = np.moveaxis(np.asarray(euler, dtype=np.float64), -1, 0)
    sr, cr, sp, cp, sh, ch = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch), np.sin(heading), np.cos(heading)
    rows = [
        [cp * ch, -cr * sh + sr * sp * ch, sr * sh + cr * sp * ch],
        [cp * sh, cr * ch + sr * sp * sh, -sr * ch + cr * sp * sh],
        [-sp, sr * cp, cr * cp],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def euler_of_rotation(rotation: Floats) -> Floats:
    """Return roll, pitch and heading of C_b_n, rad; heading in (-pi, pi].

    Args:
        rotation: (..., 3, 3)
    """
    roll = np.arctan2(rotation[..., 2, 1], rotation[..., 2, 2])
    pitch = -np.arcsin(np.clip(rotation[..., 2, 0], -1, 1))
    heading = np.arctan2(rotation[..., 1, 0], rotation[..., 0, 0])
    return np.stack([roll, pitch, heading], axis=-1)


def quaternion_of_rotation(rotation: Floats) -> Floats:
    """Return the quaternion of C_b_n whose largest component is positive.

    Args:
        rotation: (3, 3)
    """
    # The quaternion is the eigenvector of this matrix's largest eigenvalue, also where a component is small (Bar-Itzhack 2000).
    (a, b, c), (d, e, f), (g, h, i) = rotation
    k = np.array([
        [a + e + i, h - f, c - g, d - b],
        [h - f, a - e - i, b + d, c + g],
        [c - g, b + d, e - a - i, f + h],
        [d - b, c + g, f + h, i - a - e],
    ])  # fmt: skip
    quaternion = np.linalg.eigh(k)[1][:, -1]
    return quaternion * np.sign(quaternion[np.argmax(np.abs(quaternion))])


def rotation_of_quaternion(quaternion: Floats) -> Floats:
    """Return C_b_n of quaternions.

    Args:
        quaternion: (..., 4), of length one.

    Returns:
        (..., 3, 3)
    """
    w, x, y, z = np.moveaxis(np.asarray(quaternion, dtype=np.float64), -1, 0)
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def swapped_axes(quaternion: Floats, *, body: bool = True) -> Floats:
    """Return the quaternion of FRD relative to NED for one of FLU relative to east-north-up (REP 103), or the reverse.

    Args:
        quaternion: (..., 4), of length one.
        body: whether the axes of the body change too, from FLU to FRD or the reverse.
    """
    w, x, y, z = np.moveaxis(np.asarray(quaternion, dtype=np.float64), -1, 0)
    if body:  # half a turn about the forward axis
        w, x, y, z = -x, w, z, -y
    # half a turn about the line between east and north
    return np.stack([-x - y, w + z, w - z, y - x], axis=-1) / np.sqrt(2)


def euler_of_quaternion(quaternion: Floats) -> Floats:
    """Return roll, pitch and heading of quaternions, rad; heading in (-pi, pi].

    Args:
        quaternion: (..., 4), of length one.
    """
    return euler_of_rotation(rotation_of_quaternion(quaternion))
