import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.simulation import Site, rate_table
from imuwb.stochastic import ImuErrorModel

IDEAL = ImuErrorModel("ideal", {})
RATES = np.radians([100.0, 10.0])


def test_the_staircase_goes_both_ways_about_each_axis():
    made = rate_table(IDEAL, 1, RATES, seconds=2, rate=50, site=Site(9.8))
    assert list(made.logs) == ["rate_x", "rate_y", "rate_z"]
    for axis, log in enumerate(made.logs.values()):
        rate = np.degrees(log.imu().angular_rate.value)
        np.testing.assert_allclose(np.delete(rate, axis, axis=1), 0, atol=1e-12)
        for level in (0, 10, 100, -10, -100):
            assert np.isclose(rate[:, axis], level).sum() >= 95
        assert rate[:, axis].max() == pytest.approx(100)
        steps = np.diff(rate[:, axis])
        assert np.abs(steps).max() < 5  # a ramp, no jump
        up = np.zeros(3)
        up[axis] = 9.8
        np.testing.assert_allclose(log.imu().specific_force.value, np.tile(up, (len(rate), 1)))


def test_one_axis_alone():
    assert list(rate_table(IDEAL, 1, RATES, axes="z", seconds=1, rate=50).logs) == ["rate_z"]


def test_a_mounting_that_is_off_turns_the_other_gyros():
    rate = rate_table(IDEAL, 1, RATES, seconds=1, rate=50, misplacement=0.02).logs["rate_x"].imu().angular_rate.value
    fast = rate[np.argmax(np.linalg.norm(rate, axis=1))]
    assert 0 < np.linalg.norm(fast[1:]) / np.linalg.norm(fast) < 0.1


def test_the_earths_horizontal_rate_goes_round_with_the_table():
    made = rate_table(IDEAL, 1, [np.radians(36.0)], axes="z", seconds=10, rate=50, site=Site(9.8, np.radians(60)))
    rate = made.logs["rate_z"].imu().angular_rate.value
    still = rate[:500]
    assert np.linalg.norm(still[0]) == pytest.approx(7.292115e-5)
    assert still[0, 2] == pytest.approx(7.292115e-5 * np.sin(np.radians(60)))
    turning = rate[np.isclose(rate[:, 2], np.radians(36), atol=1e-3)]  # one turn
    np.testing.assert_allclose(np.linalg.norm(turning[:, :2], axis=1), 7.292115e-5 / 2, rtol=1e-6)
    np.testing.assert_allclose(turning[:, :2].mean(axis=0), 0, atol=2e-6)


@pytest.mark.parametrize(
    ("rates", "settings", "message"),
    [
        ([], {}, "rates are none"),
        ([0.0], {}, "rates are 0 deg/s"),
        ([1e4], {}, "at most 20000"),
        (RATES, {"axes": "xq"}, "axis is 'xq'"),
        (RATES, {"axes": "xx"}, "axis is 'xx'"),
        (RATES, {"misplacement": -1.0}, "misplacement"),
        (RATES, {"seconds": 0.0}, "are 0 samples"),
    ],
)
def test_settings_that_cannot_be(rates, settings, message):
    with pytest.raises(UsageError, match=message):
        rate_table(IDEAL, 1, rates, **{"seconds": 1, "rate": 50, **settings})
