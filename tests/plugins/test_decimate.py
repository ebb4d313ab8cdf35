import numpy as np
import pytest

from imuwb.conditioning import design_kaiser
from imuwb.errors import MissingDataError
from imuwb_plugins import decimate


def condition(log, **options):
    return decimate.condition(log, decimate.Parameters(**options))


@pytest.fixture(scope="module")
def noise():
    return np.random.default_rng(1).standard_normal((4000, 3))


def tone(f, n=4000, rate=100):
    return np.sin(2 * np.pi * f * np.arange(n) / rate)


def test_a_tone_above_the_new_nyquist_frequency_vanishes(make_log):
    found, rates = condition(make_log(tone(13)), rate=20)
    assert rates == pytest.approx({"gyro": 20})
    assert np.abs(found.imu().angular_rate.value).max() < 1e-4


def test_without_the_filter_it_folds_down(make_log):
    found, _ = condition(make_log(tone(13)), rate=20, anti_alias=False)
    triad = found.imu().angular_rate
    folded = -np.sin(2 * np.pi * 7 * triad.time / 1e9)  # 13 - 20
    np.testing.assert_allclose(triad.value[:, 0], folded, rtol=0, atol=1e-9)


def test_a_tone_that_is_kept_is_kept_in_its_place(make_log):
    found, _ = condition(make_log(tone(5)), factor=5)
    triad = found.imu().angular_rate
    np.testing.assert_allclose(triad.value[:, 0], np.sin(2 * np.pi * 5 * triad.time / 1e9), rtol=0, atol=3e-5)


def test_a_causal_filter_is_late_by_the_declared_delay(make_log):
    found, _ = condition(make_log(tone(5)), factor=5, causal=True)
    triad, (made,) = found.imu().angular_rate, found.conditioning
    assert (made.causal, made.delay) == (True, pytest.approx(design_kaiser(100, 8, 10).delay))
    expected = np.sin(2 * np.pi * 5 * (triad.time / 1e9 - made.delay))
    np.testing.assert_allclose(triad.value[:, 0], expected, rtol=0, atol=3e-5)


@pytest.mark.parametrize(
    "options", [{"rate": 20}, {"factor": 5}, {"rate": 20, "causal": True}, {"factor": 3, "anti_alias": False}]
)
def test_times_are_some_of_the_logs_own_evenly_spaced(make_log, gap, noise, options):
    log = make_log(noise, noise, keep=gap(4000, 1501, 1777))
    found, rates = condition(log, **options)
    for old, new in zip(
        (log.imu().angular_rate, log.imu().specific_force),
        (found.imu().angular_rate, found.imu().specific_force),
        strict=True,
    ):
        assert np.isin(new.time, old.time).all()
        steps = np.diff(new.time)
        assert np.count_nonzero(steps != round(1e9 / rates["gyro"])) == 1  # the gap


def test_without_the_filter_samples_are_left_out_and_nothing_else(make_log, noise):
    found, _ = condition(make_log(noise), factor=7, anti_alias=False)
    np.testing.assert_array_equal(found.imu().angular_rate.value, noise[::7])
    (made,) = found.conditioning
    assert (made.causal, made.delay, made.band) == (True, 0.0, None)


def test_the_band_ends_where_the_filter_begins(make_log, noise):
    found, _ = condition(make_log(noise, noise, accel_rate=50.0), factor=5)
    assert found.conditioning[0].band == pytest.approx(4)  # of 10 Hz, the accelerometers'
    assert condition(make_log(noise), rate=100)[0].band == np.inf


def test_the_same_rate_leaves_the_log_as_it_is(make_log, noise):
    found, _ = condition(make_log(noise), rate=100)
    np.testing.assert_array_equal(found.imu().angular_rate.value, noise)


def test_a_factor_goes_for_sensors_of_two_rates(make_log, noise):
    found, rates = condition(make_log(noise, noise, accel_rate=50.0), factor=5)
    assert rates == pytest.approx({"gyro": 20, "accel": 10})
    assert found.conditioning[0].causal is False


def test_one_rate_for_both_sensors(make_log, noise):
    found, rates = condition(make_log(noise, noise, accel_rate=50.0), rate=10, anti_alias=False)
    assert rates == pytest.approx({"gyro": 10, "accel": 10})
    assert (len(found.imu().angular_rate), len(found.imu().specific_force)) == (400, 800)


@pytest.mark.parametrize("rate", [30, 99, 101, 200])
def test_a_rate_that_is_no_whole_fraction_is_told(make_log, noise, rate):
    with pytest.raises(ValueError, match="rate of 100 Hz"):
        condition(make_log(noise), rate=rate)


@pytest.mark.parametrize(
    "given", [{}, {"rate": 20.0, "factor": 5}, {"rate": 0.0}, {"factor": 0}, {"rate": -1.0}, {"factor": -2}]
)
def test_rate_or_factor_is_given(given):
    with pytest.raises(ValueError, match="rate|factor"):
        decimate.Parameters(**given)


def test_nothing_left_is_missing_data(make_log, noise):
    with pytest.raises(MissingDataError, match="no part between gaps"):
        condition(make_log(noise), factor=100)


@pytest.mark.parametrize(("off", "held"), [(0.0008, True), (0.0012, False)])
def test_the_rate_may_miss_a_whole_fraction_by_a_thousandth(make_log, noise, off, held):
    if held:
        assert condition(make_log(noise), rate=100 / 4 * (1 + off))[1] == pytest.approx({"gyro": 25})
    else:
        with pytest.raises(ValueError, match="rate of 100 Hz"):
            condition(make_log(noise), rate=100 / 4 * (1 + off))
