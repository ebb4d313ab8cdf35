import numpy as np
import pytest

from imuwb.conditioning import design_kaiser
from imuwb.errors import MissingDataError
from imuwb_plugins import kaiser

BANDS = {"f_pass": 14.0, "f_stop": 18.0}


def condition(log, **options):
    return kaiser.condition(log, kaiser.Parameters(**options))


@pytest.fixture(scope="module")
def noise():
    return np.random.default_rng(1).standard_normal((1000, 3))


def test_a_sine_keeps_its_phase(make_log):
    t = np.arange(1000) / 100
    sine = np.sin(2 * np.pi * 5 * t + 1)
    found, applied = condition(make_log(sine), **BANDS)
    half = applied.filters["gyro"].taps.size // 2
    triad = found.imu().angular_rate
    np.testing.assert_allclose(triad.value[:, 0], sine[half:-half], rtol=0, atol=2e-5)
    np.testing.assert_array_equal(triad.time, make_log(sine).imu().angular_rate.time[half:-half])
    (made,) = found.conditioning
    assert (made.causal, made.delay, made.band) == (False, 0.0, 14.0)


def test_the_causal_filter_is_the_other_one_late_by_its_delay(make_log, noise):
    log = make_log(noise, noise)
    now, _ = condition(log, **BANDS)
    late, applied = condition(log, **BANDS, causal=True)
    (made,) = late.conditioning
    assert (made.causal, late.causal) == (True, True)
    assert made.delay == pytest.approx((applied.filters["gyro"].taps.size - 1) / 2 / 100)
    for sensor in ("angular_rate", "specific_force"):
        a, b = getattr(now.imu(), sensor), getattr(late.imu(), sensor)
        np.testing.assert_array_equal(a.value, b.value)
        np.testing.assert_allclose((b.time - a.time) / 1e9, made.delay, rtol=0, atol=2e-9)


def test_the_causal_filter_knows_no_later_sample(make_log, noise):
    changed = noise.copy()
    changed[600:] += 10
    was, now = (condition(make_log(v), **BANDS, causal=True)[0].imu().angular_rate for v in (noise, changed))
    before = was.time < make_log(noise).imu().angular_rate.time[600]
    np.testing.assert_allclose(now.value[before], was.value[before], rtol=0, atol=1e-12)
    assert not np.allclose(now.value[~before], was.value[~before])


def test_cutoff_and_width_are_the_same_filter(make_log, noise):
    edges, _ = condition(make_log(noise), **BANDS)
    middle, _ = condition(make_log(noise), fc=16.0, width=4.0)
    np.testing.assert_array_equal(edges.imu().angular_rate.value, middle.imu().angular_rate.value)
    assert edges.conditioning == middle.conditioning
    assert kaiser.Parameters(fc=16.0).bands == (14.0, 18.0)  # 4 Hz, where no width is given


@pytest.mark.parametrize("width", [4.0, 2.0])
def test_edges_and_a_width_contradict_each_other(width):
    with pytest.raises(ValueError, match=f"width is {width} Hz; .* only with fc"):
        kaiser.Parameters(**BANDS, width=width)


def test_each_sensor_has_a_filter_for_its_rate(make_log, noise):
    log = make_log(noise, np.tile(noise, (2, 1)), accel_rate=200.0)
    found, applied = condition(log, **BANDS, causal=True)
    assert {s: k.rate for s, k in applied.filters.items()} == pytest.approx({"gyro": 100, "accel": 200})
    np.testing.assert_allclose(applied.filters["accel"].taps, design_kaiser(200, 14, 18).taps, rtol=0, atol=1e-9)
    assert found.conditioning[0].delay == max(k.delay for k in applied.filters.values())
    assert (
        f"gyro {applied.filters['gyro'].taps.size}, accel {applied.filters['accel'].taps.size}"
        in found.conditioning[0].note
    )


def test_parts_between_gaps_stay_apart_and_short_ones_go(make_log, gap, noise):
    keep = gap(1000, 400, 410) & gap(1000, 500, 520)
    found, applied = condition(make_log(noise, keep=keep), **BANDS)
    half = applied.filters["gyro"].taps.size // 2
    whole = condition(make_log(noise[:400]), **BANDS)[0].imu().angular_rate.value
    triad = found.imu().angular_rate
    assert len(triad) == (400 - 2 * half) + (480 - 2 * half)
    np.testing.assert_allclose(triad.value[: 400 - 2 * half], whole, rtol=0, atol=1e-12)


def test_nothing_left_is_missing_data(make_log, noise):
    with pytest.raises(MissingDataError, match="171 samples"):
        condition(make_log(noise[:150]), **BANDS)


@pytest.mark.parametrize(
    "given", [{}, {**BANDS, "fc": 16.0}, {"f_pass": 14.0}, {"f_stop": 18.0}, {"f_pass": 1.0, "fc": 16.0}]
)
def test_bands_are_given_once(given):
    with pytest.raises(ValueError, match="either f_pass and f_stop, or fc"):
        kaiser.Parameters(**given)


@pytest.mark.parametrize(
    "bands", [{"f_pass": 40.0, "f_stop": 51.0}, {"fc": 49.0}, {"fc": 1.0, "width": 2.0}, {"f_pass": 5.0, "f_stop": 4.0}]
)
def test_bands_beyond_the_logs_rate_are_told(make_log, noise, bands):
    with pytest.raises(ValueError, match="half the rate"):
        condition(make_log(noise), **bands)


def test_magnitude_and_phase_are_shown(make_log, noise, shown):
    _, applied = condition(make_log(noise), **BANDS)
    kaiser.draw(applied, shown)
    magnitude, phase = shown.figures
    f, decibel = magnitude.curves[0].x, magnitude.curves[0].y
    assert np.abs(decibel[f <= 14]).max() < 1e-3
    assert decibel[f >= 18].max() <= -100
    assert (magnitude.y_scale, phase.y_scale) == ("linear", "linear")
    slope = np.polyfit(f[f < 14], phase.curves[0].y[f < 14], 1)[0]
    assert slope == pytest.approx(-2 * np.pi * applied.filters["gyro"].delay, rel=1e-6)


def test_the_phase_ends_where_the_magnitude_is_that_of_rounding(make_log, noise):
    _, applied = condition(make_log(noise), **BANDS)
    np.testing.assert_array_equal(np.isnan(applied.phase), applied.magnitude <= -100)
    assert (applied.frequency[0], applied.frequency[-1]) == (0, pytest.approx(50))
    assert np.isnan(applied.phase).any()
