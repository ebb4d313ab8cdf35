import itertools

import numpy as np
import pytest
import pywt

from imuwb.conditioning import band_limit, denoise, denoise_causally, level_of_band, measured_band
from imuwb.conditioning.wavelet import sure_threshold, threshold


@pytest.fixture(scope="module")
def walk():
    rng = np.random.default_rng(11)
    return rng.standard_normal(4001).cumsum() * 0.05 + rng.standard_normal(4001)


@pytest.mark.parametrize("wavelet", ["haar", "db4", "sym8", "coif3", "bior2.2"])
@pytest.mark.parametrize(("level", "n"), [(1, 4000), (1, 4001), (3, 997), (5, 1000), (6, 4001), (0, 7)])
def test_without_a_threshold_a_series_is_rebuilt(walk, wavelet, level, n):
    given = walk[:n].copy()
    found = denoise(given, level, wavelet, "none")
    assert found.values.shape == (n,)
    np.testing.assert_allclose(found.values, given, rtol=0, atol=1e-12 * np.abs(given).max())
    assert found.thresholds == (0.0,) * level
    np.testing.assert_array_equal(given, walk[:n])


@pytest.mark.parametrize(("level", "hop"), [(1, 1), (3, 8), (4, 5)])
def test_without_a_threshold_a_sliding_window_rebuilds_it_too(walk, level, hop):
    found = denoise_causally(walk, level, "db4", "none", hop=hop)
    np.testing.assert_allclose(found.values, walk, rtol=0, atol=1e-11)


@pytest.mark.parametrize(("n", "size", "seed"), list(itertools.product([1, 2, 3, 50, 401], [0.0, 0.5, 4.0], [0, 1])))
def test_sure_is_the_least_risk_of_all_candidates(n, size, seed):
    rng = np.random.default_rng(seed)
    x = rng.standard_normal(n) + size * (rng.random(n) < 0.2) * rng.standard_normal(n) * 3

    def risk(t):
        return n - 2 * np.count_nonzero(np.abs(x) <= t) + np.sum(np.minimum(x**2, t**2))

    least = min(risk(t) for t in np.abs(x))
    found = sure_threshold(np.sort(np.abs(x)))
    assert found in np.abs(x)
    assert risk(found) == pytest.approx(least, rel=1e-12, abs=1e-9)


@pytest.mark.parametrize("n", [40, 41])
def test_rules_are_those_of_the_books(n):
    x = np.random.default_rng(n).standard_normal(n) * 0.02
    x[:5] *= 30
    sigma = np.median(np.abs(x)) / 0.6745
    assert threshold(x, "universal") == pytest.approx(sigma * np.sqrt(2 * np.log(n)), rel=1e-12)
    assert threshold(x, "bayes") == pytest.approx(sigma**2 / np.sqrt(np.mean(x**2) - sigma**2), rel=1e-12)
    assert threshold(x, "sure") == pytest.approx(sigma * sure_threshold(np.sort(np.abs(x / sigma))), rel=1e-12)
    assert (threshold(x, "all"), threshold(x, "none")) == (np.inf, 0.0)


def test_bayes_takes_all_where_noise_explains_all():
    x = np.tile([1.0, -1.0], 20)
    assert threshold(x, "bayes") == 1.0


@pytest.mark.parametrize("rule", ["sure", "universal", "bayes"])
def test_details_that_are_mostly_zero_have_no_noise(rule):
    assert threshold(np.r_[np.zeros(30), 5.0], rule) == 0.0


@pytest.mark.parametrize("shrinkage", ["soft", "hard"])
@pytest.mark.parametrize("rule", ["universal", "bayes"])
def test_every_level_is_shrunk_by_its_own_threshold(walk, shrinkage, rule):
    approximation, *details = pywt.wavedec(walk, "db4", level=4)
    limits = []
    for detail in details:  # coarsest first
        sigma = np.median(np.abs(detail)) / 0.6745
        limits.append(
            sigma * np.sqrt(2 * np.log(detail.size))
            if rule == "universal"
            else sigma**2 / np.sqrt(np.mean(detail**2) - sigma**2)
            if np.mean(detail**2) > sigma**2
            else np.abs(detail).max()
        )

    def shrink(d, t):
        return np.where(np.abs(d) <= t, 0.0, d if shrinkage == "hard" else np.sign(d) * (np.abs(d) - t))

    shrunk = [shrink(d, t) for d, t in zip(details, limits, strict=True)]
    found = denoise(walk, 4, "db4", rule, shrinkage)
    np.testing.assert_allclose(found.thresholds, limits[::-1], rtol=1e-12)
    np.testing.assert_allclose(
        found.values, pywt.waverec([approximation, *shrunk], "db4")[: walk.size], rtol=0, atol=1e-12
    )


def test_hard_shrinkage_keeps_a_peak_that_soft_shrinkage_lowers():
    x = np.random.default_rng(3).standard_normal(1024) * 0.1
    x[500] += 20
    soft, hard = (denoise(x, 3, "haar", "universal", kind).values[500] for kind in ("soft", "hard"))
    assert hard == pytest.approx(20, abs=0.5)
    assert soft < hard - 0.2


@pytest.mark.parametrize("level", [1, 3, 5])
def test_without_any_detail_slow_tones_stay_and_fast_ones_go(level):
    rate, n = 100.0, 8192
    t = np.arange(n) / rate
    limit = band_limit(rate, level)
    slow, fast = np.sin(2 * np.pi * limit / 4 * t), np.sin(2 * np.pi * min(4 * limit, 0.45 * rate) * t)
    inner = slice(2000, -2000)
    assert np.std((denoise(slow, level, "db8", "all").values - slow)[inner]) < 0.02
    assert np.std(denoise(fast, level, "db8", "all").values[inner]) < 0.02


def test_sure_lowers_the_error_of_a_noisy_signal():
    rng = np.random.default_rng(5)
    t = np.linspace(0, 1, 4096)
    signal = np.sin(8 * np.pi * t) + (t > 0.4)
    noisy = signal + 0.3 * rng.standard_normal(t.size)
    for kind in ("soft", "hard"):
        assert np.std(denoise(noisy, 6, "db4", "universal", kind).values - signal) < 0.1
    assert np.std(denoise(noisy, 6).values - signal) < 0.07


def test_white_noise_loses_nearly_all_its_details():
    x = np.random.default_rng(6).standard_normal(1 << 15)
    assert np.var(denoise(x, 5).values) == pytest.approx(2**-5, rel=0.2)


@pytest.mark.parametrize(("level", "hop", "wavelet"), [(1, 1, "haar"), (2, 1, "db4"), (3, 8, "db4"), (3, 7, "sym5")])
@pytest.mark.parametrize("n", [600, 601])
def test_a_later_sample_changes_nothing_earlier_than_a_hop(level, hop, wavelet, n):
    x = np.random.default_rng(7).standard_normal(n)
    was = denoise_causally(x, level, wavelet, hop=hop).values
    for at in (1, 20, 63, 127, 128, 129, 200, 333, n - 20, n - 1):
        changed = x.copy()
        changed[at:] = 100 * np.random.default_rng(at).standard_normal(n - at)
        now = denoise_causally(changed, level, wavelet, hop=hop).values
        first = max(at - hop + 1, 0)
        np.testing.assert_array_equal(now[:first], was[:first])
        assert not np.array_equal(now[first:], was[first:])


def test_a_whole_record_does_look_ahead():
    x = np.random.default_rng(7).standard_normal(600)
    changed = x.copy()
    changed[300] = 100
    assert not np.array_equal(denoise(x, 3).values[:290], denoise(changed, 3).values[:290])


def test_the_newest_value_is_that_of_its_window(walk):
    level, hop = 3, 4
    length = 16 * 2**level
    found = denoise_causally(walk, level, hop=hop).values
    for end in (length, length + hop, length + 50 * hop, walk.size):
        window = denoise(walk[end - length : end], level).values
        np.testing.assert_allclose(found[end - hop : end], window[-hop:], rtol=0, atol=1e-12)


def test_a_sliding_window_in_batches_is_the_same(walk, monkeypatch):
    whole = denoise_causally(walk, 2).values
    monkeypatch.setattr("imuwb.conditioning.wavelet.BATCH", 1000)
    np.testing.assert_array_equal(denoise_causally(walk, 2).values, whole)


@pytest.mark.parametrize("wrong", [{"wavelet": "nope"}, {"wavelet": "morl"}, {"level": -1}, {"level": 11}])
@pytest.mark.parametrize("how", [denoise, denoise_causally])
def test_what_cannot_be_decomposed_is_said(wrong, how):
    with pytest.raises(ValueError, match=r"wavelet '|level is -?1+; for 1000 samples and db4 it must be 0 to 7"):
        how(np.zeros(1000), **{"level": 3, **wrong})


@pytest.mark.parametrize(("band", "level"), [(5, 3), (6.25, 3), (6.3, 2), (25, 1), (26, 0), (80, 0), (0.01, 12)])
def test_levels_keep_the_band(band, level):
    assert level_of_band(100.0, band) == level
    assert band_limit(100.0, level + 1) < band
    if level:
        assert band_limit(100.0, level) >= band


def test_quinchias_limits():
    assert [band_limit(100.0, k) for k in (3, 6, 7)] == [6.25, 0.78125, 0.390625]


@pytest.mark.parametrize("highest", [2.0, 10.0])
def test_the_band_of_motion_is_measured_above_the_noise(highest):
    rate, n, noise = 100.0, 60_000, 0.001
    rng = np.random.default_rng(8)
    spectrum = np.fft.rfft(rng.standard_normal(n))
    spectrum[np.fft.rfftfreq(n, 1 / rate) > highest] = 0
    motion = np.fft.irfft(spectrum, n)
    x = motion + rng.standard_normal(n) * noise * rate**0.5
    assert measured_band(x, rate, noise) == pytest.approx(highest, rel=0.05)


def test_a_record_without_motion_has_the_narrowest_band():
    x = np.random.default_rng(9).standard_normal(10_000)
    assert measured_band(x, 100.0, 100.0) == pytest.approx(100 / 4096)


@pytest.mark.slow
def test_four_standard_errors_above_the_noise_are_motion():
    rate, n = 100.0, 1 << 20
    rng = np.random.default_rng(8)
    noise = rng.standard_normal(n) * rate**0.5  # N = 1
    assert measured_band(noise, rate, 1.0) < 0.1
    spectrum = np.fft.rfft(rng.standard_normal(n) * rate**0.5)
    spectrum[np.fft.rfftfreq(n, 1 / rate) > 10] = 0
    slow = np.fft.irfft(spectrum, n)
    # 511 segments: a standard error is 1/22.6 of the noise.
    assert measured_band(noise + (5 / 22.6) ** 0.5 * slow, rate, 1.0) == pytest.approx(9.86, abs=0.1)


def test_the_sigma_of_the_noise_is_each_levels_the_finest_levels_or_one():
    x = np.cumsum(np.random.default_rng(7).standard_normal(4096)) * 1e-3
    own, first, none = (
        denoise(x, 3, "db4", "universal", "soft", scale).thresholds for scale in ("level", "first", "none")
    )
    sizes = [d.size for d in pywt.wavedec(x, "db4", level=3)[:0:-1]]
    assert first == pytest.approx([own[0] / np.sqrt(np.log(sizes[0])) * np.sqrt(np.log(n)) for n in sizes])
    assert none == pytest.approx([np.sqrt(2 * np.log(n)) for n in sizes])
    assert own[2] > 2 * first[2]  # a walk is larger at slow levels
    causal = denoise_causally(x, 3, scale="first", hop=128).values
    window = slice(1536 - 16 * 8, 1536)
    assert causal[1530] == pytest.approx(denoise(x[window], 3, scale="first").values[-6])


def test_quinchias_table_2_is_what_a_low_pass_leaves_of_any_noise():
    """AR(3) of gyro x in table 2: -2.564, 2.131, -0.567. With a sigma of 1 rad/s every detail of a gyro is removed."""
    from imuwb.identification import burg
    from imuwb.stochastic import FlickerNoise, WhiteNoise

    drawn = (WhiteNoise(7.04e-4) + FlickerNoise(2.16e-4)).sample(1 << 18, 0.01, np.random.default_rng(2))
    quiet = denoise(drawn, 7, scale="none").values
    np.testing.assert_array_equal(quiet, denoise(drawn, 7, rule="all").values)
    assert burg(quiet, 3).alpha[3] == pytest.approx([-2.564, 2.131, -0.567], abs=0.01)
    assert burg(denoise(drawn, 7).values, 3).alpha[3][0] > -2.2
