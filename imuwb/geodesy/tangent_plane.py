"""North, east and down from an origin, in Cartesian coordinates: exact for tracks of any length (Groves, 2.4.3)."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy.earth import ECCENTRICITY_SQUARED, EQUATORIAL_RADIUS, POLAR_RADIUS, radii_of_curvature


def _cartesian(position: Floats) -> Floats:
    """Return earth-centred, earth-fixed coordinates, (n, 3) m, of latitude rad, longitude rad, height m."""
    latitude, longitude, height = np.moveaxis(position, -1, 0)
    _, transverse = radii_of_curvature(latitude)
    across = (transverse + height) * np.cos(latitude)
    along = (transverse * (1 - ECCENTRICITY_SQUARED) + height) * np.sin(latitude)
    return np.stack([across * np.cos(longitude), across * np.sin(longitude), along], axis=-1)


def geodetic(point: Floats) -> Floats:
    """Return latitude rad, longitude rad and height m, (n, 3), of earth-centred coordinates (Bowring 1976)."""
    x, y, z = np.moveaxis(point, -1, 0)
    across = np.hypot(x, y)
    reduced = np.arctan2(z * EQUATORIAL_RADIUS, across * POLAR_RADIUS)
    second = (EQUATORIAL_RADIUS / POLAR_RADIUS) ** 2 - 1
    latitude = np.arctan2(
        z + second * POLAR_RADIUS * np.sin(reduced) ** 3,
        across - ECCENTRICITY_SQUARED * EQUATORIAL_RADIUS * np.cos(reduced) ** 3,
    )
    squared = np.sin(latitude) ** 2
    surface = EQUATORIAL_RADIUS * np.sqrt(1 - ECCENTRICITY_SQUARED * squared)
    height = across * np.cos(latitude) + z * np.sin(latitude) - surface
    return np.stack([latitude, np.arctan2(y, x), height], axis=-1)


def _axes(origin: Floats) -> Floats:
    """Return the matrix whose columns are north, east and down of an origin in earth-centred coordinates."""
    (sl, so), (cl, co) = np.sin(origin[:2]), np.cos(origin[:2])
    return np.array([[-sl * co, -so, -cl * co], [-sl * so, co, -cl * so], [cl, 0.0, -sl]])


def ned_of(position: Floats, origin: Floats) -> Floats:
    """Return positions as metres north, east and down of an origin, along its own axes.

    Args:
        position: (n, 3) latitude rad, longitude rad, height m.
        origin: (3,) likewise.

    Returns:
        (n, 3) m
    """
    return (_cartesian(position) - _cartesian(origin)) @ _axes(origin)


def position_of(ned: Floats, origin: Floats) -> Floats:
    """Return the positions of points north, east and down of an origin, along its own axes: the inverse of ``ned_of``.

    Args:
        ned: (n, 3) m.
        origin: (3,) latitude rad, longitude rad, height m.

    Returns:
        (n, 3) latitude rad, longitude rad, height m.
    """
    return geodetic(_cartesian(origin) + ned @ _axes(origin).T)


def turn_between(position: Floats, origin: Floats) -> Floats:
    """Return the matrices that turn vectors along an origin's axes into those of other places.

    Args:
        position: (n, 3) latitude rad, longitude rad, height m.
        origin: (3,) likewise.

    Returns:
        (n, 3, 3)
    """
    return np.stack([_axes(p).T for p in position]) @ _axes(origin)
