"""The WGS 84 ellipsoid (NIMA TR8350.2; Groves, 2.4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

EQUATORIAL_RADIUS = 6_378_137.0  #: m
FLATTENING = 1 / 298.257223563
ECCENTRICITY_SQUARED = FLATTENING * (2 - FLATTENING)


def radii_of_curvature(latitude: Floats) -> tuple[Floats, Floats]:
    """Return the meridian and the transverse radius of curvature, m (Groves, eq. 2.105 and 2.106).

    Args:
        latitude: (n,) rad.
    """
    squared = 1 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2
    transverse = EQUATORIAL_RADIUS / np.sqrt(squared)
    return transverse * (1 - ECCENTRICITY_SQUARED) / squared, transverse


def displaced(origin: Floats, ned: Floats) -> Floats:
    """Return positions that lie some metres north, east and down of an origin, to first order in the distance.

    Args:
        origin: (3,) or (n, 3) latitude rad, longitude rad, height m.
        ned: (n, 3) m; within 10 km the error stays below a metre or two.

    Returns:
        (n, 3) latitude rad, longitude rad, height m.
    """
    latitude, longitude, height = np.moveaxis(np.broadcast_to(origin, ned.shape), -1, 0)
    meridian, transverse = radii_of_curvature(latitude)
    north = latitude + ned[:, 0] / (meridian + height)
    east = longitude + ned[:, 1] / ((transverse + height) * np.cos(latitude))
    return np.stack([north, east, height - ned[:, 2]], axis=1)
