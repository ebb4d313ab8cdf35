"""The Earth: the WGS 84 ellipsoid and its gravity; and attitudes relative to north, east and down."""

from imuwb.geodesy.attitude import (
    euler_of_quaternion,
    euler_of_rotation,
    quaternion_of_rotation,
    rotation_of_euler,
    rotation_of_quaternion,
    swapped_axes,
)
from imuwb.geodesy.earth import EARTH_RATE, displaced, gravity, ned_scale, radii_of_curvature

__all__ = [
    "EARTH_RATE", "displaced", "euler_of_quaternion", "euler_of_rotation", "gravity", "ned_scale",
    "quaternion_of_rotation", "radii_of_curvature", "rotation_of_euler", "rotation_of_quaternion", "swapped_axes",
]  # fmt: skip
