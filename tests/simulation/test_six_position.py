import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.simulation import Site, Tolerances, preset, six_position, specimen
from imuwb.simulation.six_position import spread
from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, Sum, WhiteNoise, shown

IDEAL = ImuErrorModel("ideal", {})


def mean(log):
    imu = log.imu()
    return imu.angular_rate.value.mean(axis=0), imu.specific_force.value.mean(axis=0)


def test_each_face_is_up_once_and_feels_gravity():
    made = six_position(IDEAL, 1, seconds=2, rate=50, site=Site(9.8))
    assert list(made.logs) == ["up_x", "down_x", "up_y", "down_y", "up_z", "down_z"]
    for name, log in made.logs.items():
        way, axis = name.split("_")
        expected = np.zeros(3)
        expected["xyz".index(axis)] = 9.8 if way == "up" else -9.8
        np.testing.assert_allclose(log.imu().specific_force.value, np.tile(expected, (100, 1)), atol=1e-12)
        np.testing.assert_allclose(log.imu().angular_rate.value, 0, atol=1e-12)


def test_the_truth_is_what_the_samples_show():
    model = specimen(preset("mpu-6050"), 3, Tolerances())
    made = six_position(model, 3, seconds=40, rate=50)
    gyro, accel = shown(made.truth, (np.zeros((1, 3)), np.array([[0.0, 0.0, 9.80665]])), None)
    found = mean(made.logs["up_z"])
    np.testing.assert_allclose(found[0], gyro[0], atol=5 * 9e-5 / 40**0.5)
    np.testing.assert_allclose(found[1], accel[0], atol=5 * 0.004 / 40**0.5)


def test_faces_tilt_by_the_misplacement_that_is_said():
    tilts = []
    for seed in range(60):
        made = six_position(IDEAL, seed, seconds=1, rate=20, misplacement=0.01, site=Site(1.0))
        for log in made.logs.values():
            f = log.imu().specific_force.value[0]
            assert np.linalg.norm(f) == pytest.approx(1.0)
            tilts += sorted(np.abs(f))[:2]
    assert np.sqrt(np.mean(np.square(tilts))) == pytest.approx(0.01, rel=0.08)


def test_the_earth_turns_where_a_latitude_is_given():
    made = six_position(IDEAL, 2, seconds=1, rate=20, site=Site(9.8, np.radians(30)))
    for name, log in made.logs.items():
        rate = log.imu().angular_rate.value[0]
        assert np.linalg.norm(rate) == pytest.approx(7.292115e-5)
        along = rate["xyz".index(name[-1])] * (1 if name.startswith("up") else -1)
        assert along == pytest.approx(7.292115e-5 / 2)


def test_one_log_holds_all_positions_and_turns_that_fit_together():
    made = six_position(IDEAL, 4, seconds=3, rate=100, one_log=True, site=Site(1.0))
    (log,) = made.logs.values()
    force, rate = log.imu().specific_force.value, log.imu().angular_rate.value
    assert len(force) == 6 * 300 + 5 * 300
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), 1.0)
    # Up turns in the body as the gyros say: du/dt = -rate x up.
    step = np.diff(force, axis=0) * 100
    middle = (force[1:] + force[:-1]) / 2
    turned = -np.cross((rate[1:] + rate[:-1]) / 2, middle)
    np.testing.assert_allclose(step, turned, atol=0.02)
    assert np.linalg.norm(rate, axis=1).max() > 0.5


def test_many_positions_go_everywhere_and_their_attitudes_are_told():
    made = six_position(IDEAL, 1, positions=20, seconds=1, rate=20, site=Site(1.0))
    roll, pitch = made.attitudes.T
    told = np.stack([np.sin(pitch), -np.sin(roll) * np.cos(pitch), -np.cos(roll) * np.cos(pitch)], axis=1)
    seen = np.stack([log.imu().specific_force.value[0] for log in made.logs.values()])
    np.testing.assert_allclose(told, seen, atol=1e-12)
    ups = spread(20)
    np.testing.assert_allclose(ups.T @ ups / 20, np.eye(3) / 3, atol=0.03)


def test_the_same_seed_gives_the_same_samples():
    model = specimen(preset("mpu-6050"), 3, Tolerances())
    a, b, c = (six_position(model, s, seconds=1, rate=20).logs["up_x"].imu() for s in (1, 1, 2))
    np.testing.assert_array_equal(a.specific_force.value, b.specific_force.value)
    assert not np.array_equal(a.specific_force.value, c.specific_force.value)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"positions": 7}, "7 positions .* 6"),
        ({"positions": 101}, "101 positions"),
        ({"misplacement": 1.0}, "misplacement is 57"),
        ({"seconds": 0.0}, "0 s at 50 Hz .* 0 samples"),
        ({"seconds": float("nan")}, "nan samples"),
        ({"rate": 0.1, "seconds": 1000.0}, "at 0.1 Hz"),
        ({"seconds": 1e9}, "samples"),
    ],
)
def test_settings_that_cannot_be(settings, message):
    with pytest.raises(UsageError, match=message):
        six_position(IDEAL, 1, **{"seconds": 1, "rate": 50, **settings})


def test_a_specimen_draws_within_its_tolerances_and_turns_constants_into_biases():
    drawn = [specimen(preset("mpu-6050"), seed, Tolerances()) for seed in range(60)]
    for axis in ("gyro_y", "accel_z"):
        axes = [m.axes[axis] for m in drawn]
        scale = np.array([a.scale_factor for a in axes])
        assert np.abs(scale).max() < 0.03
        assert scale.std() == pytest.approx(0.03 / 3**0.5, rel=0.25)
        assert all(not any(isinstance(t, Constant) for t in a.processes.terms) for a in axes)
        sigma = next(t.sigma for t in preset("mpu-6050").axes[axis].processes.terms if isinstance(t, Constant))
        assert np.std([a.bias for a in axes]) == pytest.approx(sigma, rel=0.3)
    assert specimen(preset("mpu-6050"), 5, Tolerances()) == drawn[5]


def test_a_model_of_ones_own_is_the_truth_but_for_its_turn_on_bias():
    own = AxisModel(Sum((WhiteNoise(1e-3), Constant(0.1))), scale_factor=0.01, bias=2.0)
    found = specimen(ImuErrorModel("own", {"accel_x": own}), 1, None).axes["accel_x"]
    assert found.scale_factor == 0.01
    assert found.processes == Sum((WhiteNoise(1e-3),))
    assert 0 < abs(found.bias - 2.0) < 0.5
