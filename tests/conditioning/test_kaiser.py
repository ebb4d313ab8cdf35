import itertools

import numpy as np
import pytest
from scipy import signal

from imuwb.conditioning import design_kaiser, filtered

DESIGNS = [
    (rate, f_pass * rate, (f_pass + width) * rate, a_stop, a_pass)
    for rate, f_pass, width, (a_stop, a_pass) in itertools.product(
        [1.0, 100.0, 2000.0],
        [0.01, 0.14, 0.4],
        [0.02, 0.09],
        [(20, 1.0), (60, 0.05), (60, 3.0), (100, 1e-4), (30, 1e-3)],
    )
]


@pytest.mark.parametrize(("rate", "f_pass", "f_stop", "a_stop", "a_pass"), DESIGNS)
def test_attenuation_and_ripple_are_kept(rate, f_pass, f_stop, a_stop, a_pass):
    kaiser = design_kaiser(rate, f_pass, f_stop, a_stop, a_pass)
    taps = kaiser.taps
    # The gain of symmetric taps, by its own sum of cosines, on a grid that has nothing of the design's.
    half = taps.size // 2
    size = 1 << int(np.ceil(np.log2(61 * taps.size)))
    spectrum = np.fft.rfft(taps, size)
    f = np.arange(spectrum.size) * rate / size
    stop = np.r_[np.abs(spectrum)[f >= f_stop], abs(signal.freqz(taps, worN=[f_stop], fs=rate)[1])]
    inside = np.r_[np.abs(spectrum)[f <= f_pass], abs(signal.freqz(taps, worN=[f_pass], fs=rate)[1])]
    assert 20 * np.log10(stop.max()) <= -a_stop
    assert 20 * np.log10(inside.max() / inside.min()) <= a_pass * (1 + 1e-6)
    assert taps.sum() == pytest.approx(1, abs=1e-12)
    np.testing.assert_allclose(taps, taps[::-1], rtol=0, atol=1e-16)
    assert taps.size == 2 * half + 1
    assert kaiser.delay == pytest.approx(half / rate)


def test_no_filter_is_much_longer_than_kaisers_estimate():
    for rate, f_pass, f_stop, a_stop, a_pass in DESIGNS:
        taps = design_kaiser(rate, f_pass, f_stop, a_stop, a_pass).taps.size
        ripple = 10 ** (a_pass / 20)
        delta = min((ripple - 1) / (ripple + 1), 10 ** (-a_stop / 20))
        estimate, _ = signal.kaiserord(max(-20 * np.log10(delta), 8.0), 2 * (f_stop - f_pass) / rate)
        assert taps <= 1.25 * estimate + 8


def test_el_diastys_filter():
    kaiser = design_kaiser(100.0, 14.0, 18.0, 100.0)
    assert (kaiser.cutoff, kaiser.f_pass, kaiser.f_stop) == (16.0, 14.0, 18.0)
    gain = 20 * np.log10(np.abs(kaiser.response(np.array([0.0, 14.0, 16.0, 18.0, 20.0, 35.0]))))
    assert gain[:2] == pytest.approx([0, 0], abs=1e-4)
    assert gain[2] == pytest.approx(-6.02, abs=0.05)
    assert (gain[3:] <= -100).all()
    # 100 dB: beta 0.1102 (A - 8.7), about (A - 7.95)/(2.285 dw) taps
    hundred = design_kaiser(100.0, 14.0, 18.0, 100.0, 0.1)
    assert hundred.beta == pytest.approx(0.1102 * (100 - 8.7))
    assert hundred.taps.size == pytest.approx((100 - 7.95) / (2.285 * 2 * np.pi * 4 / 100), abs=4)


def test_a_sine_passes_with_its_phase_and_another_does_not():
    rate, kaiser = 100.0, design_kaiser(100.0, 14.0, 18.0)
    half = kaiser.taps.size // 2
    t = np.arange(3000) / rate
    for f in (0.5, 5.0, 13.9):
        sine = np.sin(2 * np.pi * f * t + 0.3)
        np.testing.assert_allclose(filtered(sine, kaiser.taps), sine[half:-half], rtol=0, atol=2e-5)
    for f in (18.1, 30.0, 49.0):
        assert np.abs(filtered(np.sin(2 * np.pi * f * t), kaiser.taps)).max() < 1.1e-5


def test_the_response_has_the_phase_of_the_delay():
    kaiser = design_kaiser(50.0, 4.0, 6.0, 60.0)
    f = np.linspace(0, 3.9, 40)
    delayed = np.exp(-2j * np.pi * f * kaiser.delay)
    np.testing.assert_allclose(kaiser.response(f), delayed, rtol=0, atol=2e-3)


def test_filtering_is_the_convolution_where_the_filter_lies_on_samples():
    x = np.random.default_rng(0).standard_normal((700, 3))
    taps = np.random.default_rng(1).standard_normal(41)
    found = filtered(x, taps)
    assert found.shape == (660, 3)
    for k in range(3):
        np.testing.assert_allclose(found[:, k], np.convolve(x[:, k], taps, "valid"), rtol=0, atol=1e-11)
    np.testing.assert_allclose(filtered(x[:, 1], taps), found[:, 1], rtol=0, atol=1e-12)
    assert filtered(x[:41], taps).shape == (1, 3)


def test_the_autocorrelation_is_that_of_filtered_white_noise():
    kaiser = design_kaiser(100.0, 14.0, 18.0, 60.0, 0.01)
    x = filtered(np.random.default_rng(2).standard_normal(400_000), kaiser.taps)
    x -= x.mean()
    measured = [float(x[: x.size - k] @ x[k:]) / float(x @ x) for k in range(41)]
    np.testing.assert_allclose(kaiser.autocorrelation(40), measured, rtol=0, atol=0.012)
    assert kaiser.autocorrelation(0) == pytest.approx([1.0])
    long = kaiser.autocorrelation(500)
    assert long.size == 501
    assert not long[kaiser.taps.size :].any()


@pytest.mark.parametrize(
    "wrong",
    [(100, 0, 5), (100, 5, 5), (100, 8, 5), (100, 5, 50.1), (100, -1, 5), (100, 4, 5, 0), (100, 4, 5, 60, 0),
     (100, float("nan"), 5), (100, 4, float("nan"))],
)  # fmt: skip
def test_bands_that_cannot_be_are_told_with_the_rule(wrong):
    with pytest.raises(ValueError, match="0 < f_pass < f_stop <= 50 Hz"):
        design_kaiser(*wrong)


def test_a_filter_that_would_be_too_long_is_refused():
    with pytest.raises(ValueError, match=r"taps; widen the transition from 1 to 1\.0001 Hz"):
        design_kaiser(100, 1, 1.0001)


def test_attenuations_go_to_200_db():
    assert design_kaiser(100, 10, 30, 199.0).taps.size > 1
    with pytest.raises(ValueError, match="200 dB"):
        design_kaiser(100, 10, 30, 201.0)
