"""Navigation on the Earth: arrays in, arrays out."""

from imuwb.navigation.earth import displaced, radii_of_curvature

__all__ = ["displaced", "radii_of_curvature"]
