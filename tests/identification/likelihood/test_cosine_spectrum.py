import numpy as np
import pytest
from scipy import fft, linalg, special

from imuwb.identification.likelihood.cosine_spectrum import FEWEST, LOW, cosine_spectrum
from imuwb.stochastic import FlickerNoise, GaussMarkov, Quantization, RandomWalk, Sum, WhiteNoise

N, DT = 4096, 0.02
INDEX = np.arange(1, LOW + 1)


def cosines(n=N):
    return np.sqrt(2 / n) * np.cos(np.pi * np.outer(INDEX, np.arange(n) + 0.5) / n)


def brute(autocovariance):
    """Cosine matrix times the covariance of averaged samples, both written out."""
    matrix = cosines()
    return DT * matrix @ linalg.matmul_toeplitz(autocovariance, matrix.T)


def averaged_flicker(lag):
    """-ln|t|/pi averaged over two samples: half the second difference of t² ln|t|, but for a constant."""
    return -(
        special.xlogy((lag + 1) ** 2, lag + 1)
        + special.xlogy((lag - 1) ** 2, np.abs(lag - 1))
        - 2 * special.xlogy(lag**2, lag)
    ) / (2 * np.pi)


def averaged_gauss_markov(lag, a):
    apart = 2 * (np.cosh(a) - 1) / a**2 * np.exp(-a * lag)
    return np.where(lag == 0, 2 * (a + np.expm1(-a)) / a**2, apart)


def relative_error(found, expected):
    scale = np.sqrt(np.diag(expected))
    return (np.abs(found - expected) / np.outer(scale, scale)).max()


@pytest.fixture(scope="module")
def spectrum():
    return cosine_spectrum(np.random.default_rng(0).standard_normal(N), DT)


def test_covariance_under_flicker_is_that_of_a_brute_force_matrix(spectrum):
    expected = brute(averaged_flicker(np.arange(float(N)))) * 0.3**2
    assert relative_error(spectrum.covariance(FlickerNoise(0.3)), expected) < 2e-3


@pytest.mark.parametrize("correlation_time", [0.2, 5.0, 300.0])
def test_covariance_under_gauss_markov_is_that_of_a_brute_force_matrix(spectrum, correlation_time):
    expected = brute(averaged_gauss_markov(np.arange(float(N)), DT / correlation_time)) * 0.3**2
    assert relative_error(spectrum.covariance(GaussMarkov(0.3, correlation_time)), expected) < 2e-3


def test_covariance_under_quantization_is_exact(spectrum):
    autocovariance = np.zeros(N)
    autocovariance[:2] = 2, -1
    expected = brute(autocovariance) * (0.3 / DT) ** 2
    assert relative_error(spectrum.covariance(Quantization(0.3)), expected) < 1e-8


def test_white_noise_and_an_averaged_walk_leave_the_coefficients_independent(spectrum):
    matrix = cosines()
    np.testing.assert_allclose(spectrum.covariance(WhiteNoise(0.3)), 0.3**2 * matrix @ matrix.T, atol=1e-12)
    n = N // 4
    short, matrix, place = cosine_spectrum(np.arange(float(n)), DT), cosines(n), np.arange(n)
    walk = DT * (np.minimum.outer(place, place) + np.where(np.eye(n, dtype=bool), 1 / 3, 1 / 2))
    assert relative_error(short.covariance(RandomWalk(1.0)), DT * matrix @ walk @ matrix.T) < 1e-3


def test_trend_is_the_transform_of_a_ramp(spectrum):
    ramp = (np.arange(N) - (N - 1) / 2) * DT
    expected = fft.dct(ramp, type=2, norm="ortho")[INDEX] * np.sqrt(DT)
    np.testing.assert_allclose(spectrum.trend(), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_nothing_of_a_record_but_its_line_is_lost():
    values = np.random.default_rng(1).standard_normal(5000).cumsum() + 7
    found = cosine_spectrum(values, DT)
    time = np.arange(values.size) * DT
    slope, level = np.polyfit(time, values, 1)
    rest = values - slope * time - level
    assert found.ramp == pytest.approx(slope, rel=1e-9)
    assert np.sum(found.low**2) + np.sum(found.power * found.count) == pytest.approx(np.sum(rest**2) * DT, rel=1e-9)
    assert found.low.size + found.count.sum() == values.size - 1
    np.testing.assert_array_equal(found.first[1:], found.last[:-1] + 1)
    assert (found.first[0], found.last[-1]) == (LOW + 1, values.size - 1)
    np.testing.assert_array_equal(found.count, found.last - found.first + 1)


def test_a_bin_has_the_mean_density_of_its_coefficients(spectrum):
    process = FlickerNoise(0.3) + RandomWalk(0.1) + Quantization(0.01)
    every = process.power_spectral_density(np.arange(1, N) / (2 * N * DT), DT)
    expected = [every[a - 1 : b].mean() for a, b in zip(spectrum.first, spectrum.last, strict=True)]
    np.testing.assert_allclose(spectrum.density(process), expected, rtol=1e-4)


@pytest.mark.parametrize(
    "process", [WhiteNoise(0.3), RandomWalk(0.2), FlickerNoise(0.3), GaussMarkov(0.5, 1.0)], ids=repr
)
def test_coefficients_scatter_as_their_covariance_and_density_say(process):
    found = [cosine_spectrum(process.sample(N, DT, np.random.default_rng(seed)), DT) for seed in range(100)]
    one = found[0]
    free = one.index % 2 == 0  # a straight line holds no even cosine, so none is lost with it
    root = np.linalg.cholesky(one.covariance(process)[np.ix_(free, free)])
    white = np.linalg.solve(root, np.array([f.low[free] for f in found]).T)
    assert np.mean(white**2) == pytest.approx(1, abs=4.5 * np.sqrt(2 / white.size))
    ratio = np.array([f.power for f in found]).mean(axis=0) / one.density(process)
    assert (np.abs(ratio - 1) < 4.5 * np.sqrt(2 / (one.count * len(found))) + 2e-3).all()


def test_what_is_left_out_does_not_touch_the_rest():
    quiet = np.random.default_rng(2).standard_normal(2**15)
    at = np.arange(quiet.size) * DT
    half = 20 / (2 * quiet.size * DT)
    loud = quiet + np.sin(2 * np.pi * 4.0 * at)
    a, b, whole = (
        cosine_spectrum(loud, DT, [(4.0, half)]), cosine_spectrum(quiet, DT, [(4.0, half)]), cosine_spectrum(loud, DT)
    )  # fmt: skip
    assert 40 <= whole.count.sum() - a.count.sum() <= 43
    assert a.low.size == LOW
    assert (whole.power / b.power.mean()).max() > 20
    far = np.abs(np.log(a.frequency / 4.0)) > 0.1
    assert np.median(a.power / b.power) == pytest.approx(1, abs=0.01)
    np.testing.assert_allclose(a.power[far], b.power[far], rtol=0.3)


def test_a_slow_line_leaves_out_the_lowest_coefficients():
    values = np.random.default_rng(2).standard_normal(2**12)
    step = 1 / (2 * values.size * DT)
    whole, found = cosine_spectrum(values, DT), cosine_spectrum(values, DT, [(20 * step, 5 * step)])
    assert found.index.tolist() == [*range(1, 15), *range(26, LOW + 1)]
    np.testing.assert_array_equal(found.low, whole.low[found.index - 1])
    assert found.covariance(FlickerNoise(1.0)).shape == (found.index.size, found.index.size)
    np.testing.assert_array_equal(found.trend(), whole.trend()[found.index - 1])
    np.testing.assert_array_equal(found.power, whole.power)


def test_the_density_of_nothing_is_nothing(spectrum):
    assert not spectrum.density(Sum(())).any()


def test_short_records_are_refused():
    with pytest.raises(ValueError, match=f"at least {FEWEST}"):
        cosine_spectrum(np.zeros(FEWEST - 1), DT)
