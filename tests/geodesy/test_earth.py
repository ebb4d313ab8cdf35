"""The ellipsoid against published figures, and displacements against vectors in space."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from imuwb.geodesy.earth import displaced, gravity, ned_scale, radii_of_curvature

A, B = 6_378_137.0, 6_356_752.314245  #: m, semi-axes of WGS 84 (NIMA TR8350.2)
E2 = 1 - (B / A) ** 2
DEGREES = st.floats(-80, 80)


def ecef(latitude, longitude, height):
    """Return a place in space, m."""
    n = A**2 / math.hypot(A * math.cos(latitude), B * math.sin(latitude))
    flat = (n + height) * math.cos(latitude)
    return np.array(
        [flat * math.cos(longitude), flat * math.sin(longitude), ((B / A) ** 2 * n + height) * math.sin(latitude)]
    )


def geodetic(place):
    """Return latitude, longitude and height by iteration."""
    x, y, z = place
    flat = math.hypot(x, y)
    latitude = math.atan2(z, flat * (1 - E2))
    for _ in range(20):
        n = A / math.sqrt(1 - E2 * math.sin(latitude) ** 2)
        latitude = math.atan2(z + E2 * n * math.sin(latitude), flat)
    height = flat * math.cos(latitude) + z * math.sin(latitude) - A * math.sqrt(1 - E2 * math.sin(latitude) ** 2)
    return latitude, math.atan2(y, x), height


def axes(latitude, longitude):
    """Return the directions of north, east and down in space, as rows."""
    s, c, sl, cl = math.sin(latitude), math.cos(latitude), math.sin(longitude), math.cos(longitude)
    return np.array([[-s * cl, -s * sl, c], [-sl, cl, 0], [-c * cl, -c * sl, -s]])


def apart(origin, ned):
    """Return by how much, (north, east, down) m, a displacement is wrong against the vector in space."""
    found = displaced(np.array(origin), np.array([ned]))[0]
    vector = ecef(*origin) + axes(origin[0], origin[1]).T @ np.array(ned)
    expected = geodetic(vector)
    meridian, transverse = (float(r[0]) for r in radii_of_curvature(np.array([expected[0]])))
    turn = (found[1] - expected[1] + math.pi) % (2 * math.pi) - math.pi
    return np.array(
        [(found[0] - expected[0]) * meridian, turn * transverse * math.cos(expected[0]), expected[2] - found[2]]
    )


@pytest.mark.parametrize(
    ("latitude", "meridian", "transverse"),
    [
        (0, 6_335_439.327, 6_378_137.000),  # a(1 - e²) and a
        (90, 6_399_593.626, 6_399_593.626),  # a²/b, the polar radius of curvature
        (-90, 6_399_593.626, 6_399_593.626),
        (45, 6_367_381.816, 6_388_838.290),
    ],
)
def test_radii_are_those_published(latitude, meridian, transverse):
    found = radii_of_curvature(np.radians([float(latitude)]))
    np.testing.assert_allclose(np.ravel(found), [meridian, transverse], atol=2e-3)


@given(DEGREES)
def test_radii_are_those_of_neighbouring_places_in_space(degrees):
    latitude, step = math.radians(degrees), 1e-5
    meridian, transverse = (float(r[0]) for r in radii_of_curvature(np.array([latitude])))
    north = np.linalg.norm(ecef(latitude + step, 0, 0) - ecef(latitude - step, 0, 0)) / (2 * step)
    east = np.linalg.norm(ecef(latitude, step, 0) - ecef(latitude, -step, 0)) / (2 * step * math.cos(latitude))
    assert north == pytest.approx(meridian, rel=1e-9)
    assert east == pytest.approx(transverse, rel=1e-9)


def test_the_circumference_of_a_meridian_is_that_published():
    latitude = np.linspace(0, np.pi / 2, 20_001)
    meridian, _ = radii_of_curvature(latitude)
    assert np.trapezoid(meridian, latitude) == pytest.approx(10_001_965.729, abs=0.01)  # m, equator to pole


@given(DEGREES, st.floats(-179, 179), st.floats(-100, 9000), st.tuples(*[st.floats(-100, 100)] * 3))
def test_near_by_a_displacement_is_the_vector_in_space(latitude, longitude, height, ned):
    origin = (math.radians(latitude), math.radians(longitude), height)
    # The ground falls off, and a parallel bends: d²/2R, the latter times the latitude's tangent.
    curved = (ned[0] ** 2 + ned[1] ** 2) / 2 / 6.33e6
    error = np.abs(apart(origin, ned))
    bend = max(1, abs(math.tan(origin[0])))
    assert error[2] <= curved * 1.02 + 1e-6
    assert error[:2].max() <= 2.5 * curved * bend + 2e-5 * abs(ned[2]) + 1e-6


@pytest.mark.parametrize("latitude", [-45, 0, 30, 47.3])
@pytest.mark.parametrize("course", range(0, 360, 45))
def test_within_5_km_the_error_on_the_ground_stays_below_5_metres(latitude, course):
    north, east = (5000 * f(math.radians(course)) for f in (math.cos, math.sin))
    assert np.hypot(*apart((math.radians(latitude), 0.15, 450.0), (north, east, 0.0))[:2]) < 5


@pytest.mark.parametrize("latitude", [45, 60])
def test_within_10_km_the_error_stays_below_a_metre_or_two(latitude):
    assert np.abs(apart((math.radians(latitude), 0.15, 0.0), (0.0, 10_000.0, 0.0))[:2]).max() < 2.0


def test_one_origin_serves_many_and_each_may_have_its_own():
    ned = np.array([[0.0, 0.0, 0.0], [100.0, -50.0, 7.0], [0.0, 10.0, -3.0]])
    origin = np.array([0.8, 0.15, 450.0])
    one, each = displaced(origin, ned), displaced(np.stack([origin] * 3), ned)
    np.testing.assert_array_equal(one, each)
    np.testing.assert_array_equal(one[0], origin)
    np.testing.assert_allclose(one[:, 2], [450.0, 443.0, 453.0], atol=2e-3)  # a plane leaves the ellipsoid
    assert one[1, 0] > origin[0]
    assert one[1, 1] < origin[1]


@given(DEGREES, st.floats(-100, 9000))
def test_the_scale_is_that_of_neighbouring_places_in_space(degrees, height):
    latitude, step = math.radians(degrees), 1e-5
    found = ned_scale(np.array([latitude]), np.array([height]))[0]
    north = np.linalg.norm(ecef(latitude + step, 0, height) - ecef(latitude - step, 0, height)) / (2 * step)
    east = np.linalg.norm(ecef(latitude, step, height) - ecef(latitude, -step, height)) / (2 * step)
    assert found == pytest.approx([north, east, -1.0], rel=1e-9)


@pytest.mark.parametrize(
    ("degrees", "height", "expected"),
    [(0, 0, 9.780_325_3), (90, 0, 9.832_184_9), (45, 0, 9.806_197_8), (45, 1000, 9.803_112_0)],
)
def test_gravity_is_that_published(degrees, height, expected):
    """NIMA TR8350.2: gravity at the equator and at the poles; the free-air gradient is 0.308 577 mGal/m at 45 degrees."""
    found = gravity(np.radians([float(degrees)]), np.array([float(height)]))[0]
    assert found == pytest.approx(expected, abs=2e-6)
