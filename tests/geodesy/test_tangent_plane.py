"""The tangent plane against an independent conversion, near and far."""

import numpy as np
import pytest

from imuwb.geodesy import displaced
from imuwb.geodesy.tangent_plane import ned_of, position_of, turn_between
from tests import ecef

ORIGIN = np.array([0.79, -2.1, 120.0])


@pytest.mark.parametrize("extent", [1.0, 1e3, 1e5])
def test_there_and_back(extent):
    ned = np.random.default_rng(1).normal(size=(50, 3)) * [extent, extent, min(extent, 1e3)]
    assert ned_of(position_of(ned, ORIGIN), ORIGIN) == pytest.approx(ned, abs=1e-6)


def test_distances_are_those_of_space():
    positions = ORIGIN + np.random.default_rng(2).normal(size=(20, 3)) * [1e-2, 1e-2, 500]
    own = ecef.cartesian(positions) - ecef.cartesian(ORIGIN)
    assert ned_of(positions, ORIGIN) == pytest.approx(own @ ecef.local_axes(*ORIGIN[:2]), abs=1e-6)


def test_near_the_origin_it_is_the_displacement():
    ned = np.array([[30.0, -40.0, 2.0]])
    assert position_of(ned, ORIGIN) * [6.4e6, 6.4e6, 1] == pytest.approx(
        displaced(ORIGIN, ned) * [6.4e6, 6.4e6, 1], abs=1e-4
    )


def test_north_turns_with_the_meridians():
    east = position_of(np.array([[0.0, 50_000.0, 0.0]]), ORIGIN)
    turn = turn_between(east, ORIGIN)[0]
    assert np.arctan2(turn[1, 0], turn[0, 0]) == pytest.approx((east[0, 1] - ORIGIN[1]) * np.sin(ORIGIN[0]), rel=0.02)
