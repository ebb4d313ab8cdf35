import numpy as np
import pytest
import pywt
from scipy import signal

from imuwb.identification import find_lines, fit_wavelet_variance, wavelet_variance
from imuwb.identification.wavelet.variance import _expectations, _responses
from imuwb.stochastic import FlickerNoise, GaussMarkov, Quantization, RandomWalk, RateRamp, Sinusoid, WhiteNoise

DT = 0.01
UNITS = [Quantization(1.0), WhiteNoise(1.0), FlickerNoise(1.0), RandomWalk(1.0)]


def filters(levels):
    """The maximal-overlap wavelet filters of Daubechies' four taps, from PyWavelets' own."""
    low, high = (np.array(taps) / np.sqrt(2) for taps in (pywt.Wavelet("db2").rec_lo, pywt.Wavelet("db2").rec_hi))
    found, smooth = [], np.ones(1)
    for j in range(levels):
        spread = np.zeros(3 * 2**j + 1)
        spread[:: 2**j] = high
        found.append(np.convolve(smooth, spread))
        spread[:: 2**j] = low
        smooth = np.convolve(smooth, spread)
    return found


def test_equals_the_filters_of_pywavelets():
    values = GaussMarkov(1.0, 0.3).sample(20_000, DT, np.random.default_rng(0)) + 9.81
    found = wavelet_variance(values, DT)
    for level, taps in enumerate(filters(found.scale.size)):
        inner = signal.convolve(values - values.mean(), taps, "valid")
        assert found.terms[level] == inner.size
        # beyond level 3 some of many are kept that hang together
        tolerance = 1e-9 if level < 3 else 0.02 if level < 8 else 0.1
        assert found.variance[level] == pytest.approx(np.mean(inner**2), rel=tolerance)
    np.testing.assert_array_equal(found.scale, DT * 2.0 ** np.arange(1, found.scale.size + 1))


def test_is_blind_to_a_straight_line():
    values = WhiteNoise(1.0).sample(4096, DT, np.random.default_rng(0))
    plain = wavelet_variance(values, DT)
    sloping = wavelet_variance(values + RateRamp(5.0).sample(4096, DT, np.random.default_rng(0)) + 3, DT)
    np.testing.assert_allclose(sloping.variance, plain.variance, rtol=1e-7)


@pytest.mark.slow
def test_expectations_are_integrals_of_the_densities():
    levels = 7
    size = 2**18
    f = np.arange(1, size // 2 + 1) / size
    f = np.concatenate([np.geomspace(1e-9, f[0] / 2, 4000), f[:-1]])
    for level, taps in enumerate(filters(levels)):
        _, response = signal.freqz(taps, worN=2 * np.pi * f)
        gain = np.abs(response) ** 2
        if level < 3:
            gain[f < 1e-4] = 0  # what rounding leaves of a zero of second order
        for t, process in enumerate(UNITS):
            weighted = 2 * gain * process.power_spectral_density(f, 1.0)
            assert _expectations(levels)[level, t] == pytest.approx(np.trapezoid(weighted, f), rel=2e-3)


def test_gains_are_those_of_the_filters():
    f, width, gains = _responses(6)
    assert width.sum() == pytest.approx(0.5 - 2.0**-10, rel=1e-9)
    for taps, gain in zip(filters(6), gains, strict=True):
        np.testing.assert_allclose(np.abs(signal.freqz(taps, worN=2 * np.pi * f)[1]) ** 2, gain, atol=1e-10)


@pytest.mark.parametrize("place", range(4), ids=["Q", "N", "B", "K"])
def test_simulated_processes_have_the_expected_variances(place):
    draws = np.array([
        wavelet_variance(UNITS[place].sample(4096, 1.0, np.random.default_rng(seed)), 1.0).variance
        for seed in range(60)
    ])  # fmt: skip
    expected = _expectations(draws.shape[1])[:, place]
    error = draws.std(axis=0) / 60**0.5
    assert (np.abs(draws.mean(axis=0) - expected) < 4 * error).all()
    assert error[0] < 0.01 * expected[0]


def test_flicker_repeats_itself_from_scale_to_scale():
    flicker = _expectations(12)[:, 2]
    assert flicker[8] == flicker[11]
    assert flicker[7] == pytest.approx(flicker[8], rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    "truth", [{"N": 0.005, "B": 0.01}, {"Q": 2e-4, "N": 0.005, "K": 0.03}, {"N": 0.005, "B": 0.01, "K": 0.02}], ids=repr
)
def test_the_sum_is_found_within_its_intervals(truth):
    make = {"Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk}
    process = sum(make[letter](size) for letter, size in truth.items())
    inside, values = [], []
    for seed in range(25):
        fit = fit_wavelet_variance(wavelet_variance(process.sample(2**15, DT, np.random.default_rng(seed)), DT))
        inside += [(fit.coefficients[x].lower or 0) < size < fit.coefficients[x].upper for x, size in truth.items()]
        values.append(fit.coefficients["N"].value)
        for letter in set("QNBK") - set(truth):
            assert fit.coefficients[letter].upper > 0
    assert np.mean(inside) > 0.86
    assert np.median(values) == pytest.approx(0.005, rel=0.01)


def test_terms_that_are_not_there_get_a_limit():
    fits = [
        fit_wavelet_variance(wavelet_variance(WhiteNoise(0.005).sample(2**14, DT, np.random.default_rng(seed)), DT))
        for seed in range(12)
    ]
    absent = [fit.coefficients[letter] for fit in fits for letter in "QBK"]
    assert sum(c.value is None for c in absent) >= 14
    assert all(c.upper > 0 for c in absent)
    assert all((c.lower is None) == (c.value is None) for c in absent)
    assert [type(term) for term in fits[0].processes.terms][:2].count(WhiteNoise) == 1


def test_after_a_filter_the_shortest_scales_are_left_out():
    values = WhiteNoise(0.005).sample(2**16, DT, np.random.default_rng(1))
    fit = fit_wavelet_variance(wavelet_variance(signal.lfilter(*signal.butter(2, 8.0, fs=1 / DT), values)[1000:], DT))
    assert fit.shortest >= 4 * DT
    assert fit.coefficients["N"].value == pytest.approx(0.005, rel=0.05)
    assert fit_wavelet_variance(wavelet_variance(values, DT)).shortest == 2 * DT


def test_a_line_is_taken_off_the_scales_it_is_in():
    quiet = (WhiteNoise(0.005) + FlickerNoise(0.01)).sample(2**16, DT, np.random.default_rng(4))
    loud = quiet + Sinusoid(0.02, 2.3).sample(2**16, DT, np.random.default_rng(5))
    lines = find_lines(loud, DT)
    plain, without, with_line = (
        fit_wavelet_variance(wavelet_variance(values, DT), taken)
        for values, taken in ((quiet, ()), (loud, ()), (loud, lines))
    )
    for letter in "NB":
        assert with_line.coefficients[letter].value == pytest.approx(plain.coefficients[letter].value, rel=0.05)
    assert with_line.shortest == 2 * DT
    assert with_line.probability > 1e-3
    assert without.shortest > 2 * DT or without.probability < 1e-3


def test_the_sum_explains_what_it_made():
    process = WhiteNoise(0.005) + FlickerNoise(0.01)
    found = [
        fit_wavelet_variance(wavelet_variance(process.sample(2**14, DT, np.random.default_rng(seed)), DT))
        for seed in range(25)
    ]
    assert np.median([fit.probability for fit in found]) == pytest.approx(0.5, abs=0.25)
    assert np.median([fit.misfit for fit in found]) == pytest.approx(1, abs=0.4)


def test_what_has_no_wavelet_variance_is_refused_with_the_reason():
    with pytest.raises(ValueError, match="63 samples are too few"):
        wavelet_variance(np.arange(63.0), DT)
    with pytest.raises(ValueError, match="variance of 0"):
        fit_wavelet_variance(wavelet_variance(np.zeros(4096), DT))
