import numpy as np
import pytest

from imuwb.conditioning import denoise, denoise_causally
from imuwb_plugins import wavelet


@pytest.fixture(scope="module")
def noise():
    return np.random.default_rng(1).standard_normal((2001, 3))


def condition(log, **options):
    return wavelet.condition(log, wavelet.Parameters(**options))


def test_each_axis_is_denoised_by_itself_and_keeps_its_times(make_log, noise):
    log = make_log(noise, 5 * noise + 9.8)
    found, _ = condition(log, levels="3", wavelet="sym4", threshold="universal", shrinkage="hard")
    for k in range(3):
        expected = denoise(np.ascontiguousarray(noise[:, k]), 3, "sym4", "universal", "hard").values
        np.testing.assert_array_equal(found.imu().angular_rate.value[:, k], expected)
        expected = denoise(np.ascontiguousarray(5 * noise[:, k] + 9.8), 3, "sym4", "universal", "hard").values
        np.testing.assert_array_equal(found.imu().specific_force.value[:, k], expected)
    np.testing.assert_array_equal(found.imu().angular_rate.time, log.imu().angular_rate.time)


def test_without_a_threshold_the_log_stays_as_it_is(make_log, noise):
    found, _ = condition(make_log(noise), levels="5", threshold="none")
    np.testing.assert_allclose(found.imu().angular_rate.value, noise, rtol=0, atol=1e-12)


def test_six_levels_are_for_six_axes(make_log, noise):
    log = make_log(noise, noise)
    found, applied = condition(log, levels=(1, 2, 3, 4, 5, 0))
    assert [c.level for c in applied.axes.values()] == [1, 2, 3, 4, 5, 0]
    assert [c.band for c in applied.axes.values()] == pytest.approx([25, 12.5, 6.25, 3.125, 1.5625, 50])
    np.testing.assert_array_equal(found.imu().specific_force.value[:, 2], noise[:, 2])
    np.testing.assert_array_equal(
        found.imu().specific_force.value[:, 0], denoise(np.ascontiguousarray(noise[:, 0]), 4).values
    )
    assert found.conditioning[0].note == "levels: gyro_x 1, gyro_y 2, gyro_z 3, accel_x 4, accel_y 5, accel_z 0"


def test_auto_keeps_the_band_that_motion_has_at_each_rate(make_log, noise):
    log = make_log(noise, noise, accel_rate=25.0)
    _, applied = condition(log, motion_band="3")
    assert (applied.axes["gyro_x"].level, applied.axes["accel_x"].level) == (4, 2)
    assert min(c.band for c in applied.axes.values()) >= 3


def test_a_measured_band_is_that_of_the_motion(make_log):
    rate, n = 100.0, 20_000
    rng = np.random.default_rng(2)
    t = np.arange(n) / rate
    moving = np.where(t < 150, np.sin(2 * np.pi * 4 * t), 0)[:, None] + 1e-3 * rng.standard_normal((n, 3))
    _, applied = condition(make_log(moving), motion_band="measured")
    assert {c.level for c in applied.axes.values()} == {3}


def test_a_causal_log_says_so_and_how_late_it_is(make_log, noise):
    log = make_log(noise, noise, accel_rate=20.0)
    found, _ = condition(log, levels="2", causal=True, hop=5)
    (made,) = found.conditioning
    assert (made.name, made.causal, found.causal) == ("wavelet", True, True)
    assert made.delay == pytest.approx(4 / 20)
    np.testing.assert_array_equal(
        found.imu().angular_rate.value[:, 1], denoise_causally(np.ascontiguousarray(noise[:, 1]), 2, hop=5).values
    )


def test_a_whole_record_is_not_causal(make_log, noise):
    found, _ = condition(make_log(noise), levels="2")
    (made,) = found.conditioning
    assert (made.causal, made.delay, found.causal) == (False, 0.0, False)
    assert made.parameters.startswith(
        "levels=2,motion_band=5,wavelet=db4,threshold=sure,scale=level,shrinkage=soft,causal=false"
    )


def test_parts_between_gaps_know_nothing_of_each_other(make_log, gap, noise):
    keep = gap(len(noise), 700, 900)
    other = noise.copy()
    other[900:] *= 7
    one, two = (condition(make_log(v, keep=keep), levels="4")[0].imu().angular_rate for v in (noise, other))
    np.testing.assert_array_equal(one.value[:700], two.value[:700])
    np.testing.assert_array_equal(one.value[:700, 0], denoise(np.ascontiguousarray(noise[:700, 0]), 4).values)
    assert len(one) == keep.sum()


def test_a_part_too_short_for_the_level_is_told(make_log, gap, noise):
    with pytest.raises(ValueError, match="level is 6"):
        condition(make_log(noise, keep=gap(len(noise), 100, 150)), levels="6")


@pytest.mark.parametrize(
    ("wrong", "named"),
    [({"levels": "3,4"}, "levels is 3/4"), ({"levels": "31"}, "levels is 31"), ({"levels": "-1"}, "levels is -1"),
     ({"levels": "x"}, "levels"), ({"motion_band": "0"}, "motion_band is 0"), ({"motion_band": "nan"}, "motion_band"),
     ({"motion_band": "fast"}, "motion_band"), ({"hop": 0}, "hop is 0")],
)  # fmt: skip
def test_wrong_parameters_say_why(wrong, named):
    with pytest.raises(ValueError, match=named):
        wavelet.Parameters(**wrong)


def test_levels_limits_and_thresholds_are_shown(make_log, noise, shown):
    _, applied = condition(make_log(noise, noise), levels="2")
    wavelet.draw(applied, shown)
    (table,) = shown.tables
    assert [row[0] for row in table.rows] == ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"]
    assert table.rows[0][1:3] == ("2", "12.5 Hz")
    assert "deg/s" in table.rows[0][3]
    assert "not causal" in table.title


def test_the_band_is_that_of_the_deepest_level(make_log, noise):
    found, applied = condition(make_log(noise, noise), levels=(1, 2, 3, 0, 2, 1))
    assert found.band == applied.axes["gyro_z"].band == pytest.approx(100 / 2**4)
    nothing, _ = condition(make_log(noise), levels="0")
    assert nothing.conditioning[0].band is None
    assert "nothing is removed" in nothing.conditioning[0].note
    assert "nothing is removed" not in found.conditioning[0].note


def test_the_quietest_fiftieth_of_the_seconds_is_the_sensors_noise(make_log, monkeypatch):
    from imuwb_plugins.wavelet import apply

    seen = []
    monkeypatch.setattr(apply, "measured_band", lambda *given: seen.append(given[-1]) or 5.0)
    seconds = np.arange(1.0, 102.0)
    values = np.repeat(seconds, 100) * np.resize([1.0, -1.0], 10_100)  # each second has its number as its scatter
    condition(make_log(values), motion_band="measured")
    assert seen == pytest.approx([3.0 / 10] * 3)  # 0, 1, ... 100 %: the third of 101 seconds; over the root of 100 Hz


@pytest.mark.parametrize(("samples", "kept"), [(15, False), (16, True)])
def test_parts_of_sixteen_samples_are_kept(make_log, gap, noise, samples, kept):
    keep = gap(len(noise), 1000, len(noise) - samples)
    triad = condition(make_log(noise, keep=keep), levels="1")[0].imu().angular_rate
    assert len(triad) == 1000 + samples * kept
