import numpy as np
import pytest

from imuwb.conditioning import design_lowpass
from imuwb.errors import MissingDataError
from imuwb_plugins import bandwidth


def condition(log, cutoff=10.0, **options):
    return bandwidth.condition(log, bandwidth.Parameters(cutoff, **options))


@pytest.fixture(scope="module")
def noise():
    return np.random.default_rng(1).standard_normal((3000, 3))


@pytest.mark.parametrize("kind", ["butterworth", "moving-average"])
def test_what_is_seen_is_late_by_the_declared_delay(make_log, kind):
    t = np.arange(3000) / 100
    found, _ = condition(make_log(np.sin(2 * np.pi * 0.3 * t)), kind=kind)
    (made,) = found.conditioning
    triad = found.imu().angular_rate
    expected = np.sin(2 * np.pi * 0.3 * (triad.time / 1e9 - made.delay))
    np.testing.assert_allclose(triad.value[:, 0], expected, rtol=0, atol=2e-3)
    assert (made.name, made.causal, found.causal) == ("bandwidth", True, True)
    assert made.delay > 0


def test_a_tone_at_the_cutoff_is_3_db_lower(make_log):
    t = np.arange(3000) / 100
    found, _ = condition(make_log(np.sin(2 * np.pi * 10 * t)))
    assert np.std(found.imu().angular_rate.value) == pytest.approx(0.5, rel=2e-3)  # of √½, √½


def test_the_begin_of_each_part_is_left_out_until_it_has_settled(make_log, gap, noise):
    keep = gap(3000, 1000, 1300)
    found, applied = condition(make_log(noise, keep=keep))
    settling = applied.filters["gyro"].settling
    time = make_log(noise).imu().angular_rate.time
    kept = np.r_[settling:1000, 1300 + settling : 3000]
    np.testing.assert_array_equal(found.imu().angular_rate.time, time[kept])
    alone = condition(make_log(noise[1300:]))[0].imu().angular_rate.value
    np.testing.assert_array_equal(found.imu().angular_rate.value[1000 - settling :], alone)


def test_each_sensor_has_a_filter_for_its_rate(make_log, noise):
    found, applied = condition(make_log(noise, noise, accel_rate=50.0))
    assert applied.filters["gyro"].delay == pytest.approx(design_lowpass(100, 10).delay, rel=1e-6)
    assert found.conditioning[0].delay == max(f.delay for f in applied.filters.values())
    assert len(found.imu().specific_force) == 3000 - applied.filters["accel"].settling


@pytest.mark.parametrize("kind", ["butterworth", "moving-average"])
def test_the_band_ends_where_a_hundredth_of_the_power_is_lost(make_log, noise, kind):
    found, applied = condition(make_log(noise, noise, accel_rate=50.0), kind=kind)
    band = found.conditioning[0].band
    assert band == found.band == min(f.band for f in applied.filters.values())
    for lowpass in applied.filters.values():
        f = np.linspace(0, lowpass.band, 500)
        power = np.abs(lowpass.response(f)) ** 2
        assert power.min() == pytest.approx(0.99, abs=1e-3)
        assert np.abs(lowpass.response(np.array([1.05 * lowpass.band]))[0]) ** 2 < 0.99


def test_a_cutoff_that_only_one_sensor_can_have_is_told(make_log, noise):
    with pytest.raises(ValueError, match="20 Hz at a rate of 25 Hz"):
        condition(make_log(noise, noise, accel_rate=25.0), 20.0)


def test_nothing_left_is_missing_data(make_log, noise):
    with pytest.raises(MissingDataError, match="no part between gaps"):
        condition(make_log(noise[:20]), 0.5)


@pytest.mark.parametrize("cutoff", [0, -3, float("nan")])
def test_a_cutoff_is_positive(cutoff):
    with pytest.raises(ValueError, match="cutoff is"):
        bandwidth.Parameters(cutoff)


def test_the_magnitude_is_shown(make_log, noise, shown):
    _, applied = condition(make_log(noise))
    bandwidth.draw(applied, shown)
    curve = shown.figures[0].curves[0]
    assert np.interp(10, curve.x, curve.y) == pytest.approx(-3.01, abs=0.02)
