"""The WGS 84 ellipsoid (NIMA TR8350.2; Groves, 2.4)."""

import numpy as np

from imuwb.arrays import Floats

EQUATORIAL_RADIUS = 6_378_137.0  #: m
FLATTENING = 1 / 298.257223563
ECCENTRICITY_SQUARED = FLATTENING * (2 - FLATTENING)
EARTH_RATE = 7.292_115e-5  #: rad/s
GRAVITATIONAL_CONSTANT = 3.986_004_418e14  #: m³/s², of the Earth
GRAVITY_AT_EQUATOR = 9.780_325_335_9  #: m/s², on the ellipsoid
SOMIGLIANA = 0.001_931_852_652_41  #: coefficient of sin² latitude in Somigliana's formula of gravity
POLAR_RADIUS = EQUATORIAL_RADIUS * (1 - FLATTENING)
#: ratio of centrifugal acceleration to gravitation at the equator
CENTRIFUGAL_RATIO = EARTH_RATE**2 * EQUATORIAL_RADIUS**2 * POLAR_RADIUS / GRAVITATIONAL_CONSTANT


def radii_of_curvature(latitude: Floats) -> tuple[Floats, Floats]:
    """Return the meridian and the transverse radius of curvature, m (Groves, eq. 2.105 and 2.106).

    Args:
        latitude: (...,) rad.
    """
    squared = 1 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2
    transverse = EQUATORIAL_RADIUS / np.sqrt(squared)
    return transverse * (1 - ECCENTRICITY_SQUARED) / squared, transverse


def ned_scale(latitude: Floats, height: Floats) -> Floats:
    """Return the factors that turn small differences of latitude, longitude and height into metres north, east and down.

    Args:
        latitude: (...,) rad.
        height: (...,) m.

    Returns:
        (..., 3) m/rad, m/rad, and -1.
    """
    meridian, transverse = radii_of_curvature(latitude)
    return np.stack([meridian + height, (transverse + height) * np.cos(latitude), -np.ones_like(meridian)], axis=-1)


def gravity(latitude: Floats, height: Floats) -> Floats:
    """Return the gravity of the ellipsoid along the down axis, m/s² (Groves, eq. 2.134 and 2.139).

    Args:
        latitude: (...,) rad.
        height: (...,) m.
    """
    squared = np.sin(latitude) ** 2
    surface = GRAVITY_AT_EQUATOR * (1 + SOMIGLIANA * squared) / np.sqrt(1 - ECCENTRICITY_SQUARED * squared)
    linear = 2 * (1 + FLATTENING * (1 - 2 * squared) + CENTRIFUGAL_RATIO) / EQUATORIAL_RADIUS
    return surface * (1 - linear * height + 3 * (height / EQUATORIAL_RADIUS) ** 2)


def displaced(origin: Floats, ned: Floats) -> Floats:
    """Return the positions that lie some metres north, east and down of an origin, to second order in the distance.

    Args:
        origin: (3,) or (n, 3) latitude rad, longitude rad, height m.
        ned: (n, 3) m, in the plane that touches the ellipsoid at the origin.

    Returns:
        (n, 3) latitude rad, longitude rad, height m.
    """
    latitude, longitude, height = np.moveaxis(np.broadcast_to(origin, ned.shape), -1, 0)
    meridian, transverse = radii_of_curvature(latitude)
    to_north, to_east = ned[:, 0] / (meridian + height), ned[:, 1] / (transverse + height)
    # A straight line east leaves the parallel, and a plane leaves the ellipsoid upwards.
    north = latitude + to_north - np.tan(latitude) * to_east**2 * (transverse + height) / (meridian + height) / 2
    east = longitude + to_east / np.cos(latitude) * (1 + np.tan(latitude) * to_north)
    up = (ned[:, 0] * to_north + ned[:, 1] * to_east) / 2
    return np.stack([north, east, height - ned[:, 2] + up], axis=1)
