import numpy as np
import pytest

from imuwb.health import check
from imuwb_plugins import bias


@pytest.fixture(scope="module")
def values():
    return np.random.default_rng(1).normal((1.0, -2.0, 9.8), 1.0, (500, 3))


def condition(log, **options):
    return bias.condition(log, bias.Parameters(**options))


def test_the_mean_of_the_record_is_taken_off_and_told(make_log, values):
    found, taken = condition(make_log(values, 2 * values))
    np.testing.assert_allclose(found.imu().angular_rate.value, values - values.mean(axis=0), rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.imu().specific_force.value.mean(axis=0), 0, atol=1e-12)
    assert taken == {
        "gyro": pytest.approx(list(values.mean(axis=0))), "accel": pytest.approx(list(2 * values.mean(axis=0)))
    }  # fmt: skip
    (made,) = found.conditioning
    assert (made.name, made.causal, made.parameters) == ("bias", False, "seconds=all,sensors=both")


def test_the_mean_of_the_first_seconds_is_causal(make_log, values):
    found, taken = condition(make_log(values), seconds=2)
    np.testing.assert_allclose(found.imu().angular_rate.value, values - values[:200].mean(axis=0), rtol=0, atol=1e-12)
    assert taken["gyro"] == pytest.approx(list(values[:200].mean(axis=0)))
    (made,) = found.conditioning
    assert (made.causal, made.delay, made.parameters) == (True, 0.0, "seconds=2,sensors=both")


@pytest.mark.parametrize(("seconds", "causal"), [(4.9, True), (5.0, False), (1e9, False)])
def test_a_mean_of_all_there_is_is_not_causal_however_it_is_asked_for(make_log, values, seconds, causal):
    found, _ = condition(make_log(values), seconds=seconds)  # of 4.99 s
    assert found.causal is causal
    assert found.band == np.inf


@pytest.mark.parametrize(("sensors", "left"), [("gyro", "specific_force"), ("accel", "angular_rate")])
def test_one_sensor_alone(make_log, values, sensors, left):
    log = make_log(values, values)
    found, taken = condition(log, sensors=sensors)
    assert getattr(found.imu(), left) is getattr(log.imu(), left)
    assert list(taken) == [sensors]


def test_the_logs_own_arrays_stay_as_they_are(make_log, values):
    log = make_log(values)
    condition(log)
    np.testing.assert_array_equal(log.imu().angular_rate.value, values)


def test_seconds_shorter_than_a_sample_take_the_first(make_log, values):
    _, taken = condition(make_log(values), seconds=1e-6)
    assert taken["gyro"] == pytest.approx(list(values[0]))


@pytest.mark.parametrize("seconds", [0, -1, float("nan")])
def test_seconds_are_positive(seconds):
    with pytest.raises(ValueError, match="seconds is"):
        bias.Parameters(seconds)


@pytest.mark.parametrize("samples", [False, True])
@pytest.mark.parametrize(("sensors", "missed"), [("both", False), ("gyro", True)])
def test_gravity_that_was_taken_off_is_not_missed(make_log, samples, sensors, missed):
    white = np.random.default_rng(2).normal(0, 0.01, (2, 6000, 3))
    log, _ = condition(make_log(white[0], white[1]), sensors=sensors)  # gravity is missing before
    found = {fault.kind for fault in check(log, samples=samples).faults}
    assert ("no gravity" in found) is missed
