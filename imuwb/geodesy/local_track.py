"""A trajectory in a Cartesian frame whose place on the Earth is not stated, and the rigid fit that places it."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats, Integers


@dataclass(frozen=True, eq=False, slots=True)
class LocalTrack:
    """A trajectory in a right-handed Cartesian frame: that of its first pose, or any other."""

    name: str
    time: Integers  #: (n,) ns, rising
    position: Floats  #: (n, 3) m
    rotation: Floats | None = None  #: (n, 3, 3) turns vectors from the body to the frame
    velocity: Floats | None = None  #: (n, 3) m/s, along the axes of the frame
    position_sigma: Floats | None = None  #: (n, 3) m, along the axes of the frame

    def __repr__(self) -> str:
        """Return name and rows in a line."""
        return f"{self.name}: {self.time.size} poses in a frame of their own"


@dataclass(frozen=True, eq=False, slots=True)
class RigidFit:
    """A rotation and a shift that bring points nearest to others."""

    rotation: Floats  #: (3, 3)
    shift: Floats  #: (3,) m: rotation @ point + shift
    rms: float  #: m, of the distances that remain, in three dimensions
    width: float  #: m, root mean square of the points across their longest direction; near 0: the rotation about it is unknown


def rigid_fit(points: Floats, others: Floats) -> RigidFit:
    """Return the rotation and the shift that bring points nearest to others in the sense of least squares (Kabsch 1976).

    Args:
        points: (n, 3) m, three or more.
        others: (n, 3) m, the points to which they belong.
    """
    middle, other = points.mean(axis=0), others.mean(axis=0)
    left, _, right = np.linalg.svd((points - middle).T @ (others - other))
    proper = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    rotation = (left @ proper @ right).T
    shift = other - rotation @ middle
    rms = float(np.sqrt(np.square(points @ rotation.T + shift - others).sum(axis=1).mean()))
    spread = np.linalg.svd(points - middle, compute_uv=False) / np.sqrt(len(points))
    return RigidFit(rotation, shift, rms, float(spread[1]))
