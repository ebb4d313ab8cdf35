import numpy as np
import pytest

from imuwb.identification import allan, equivalent_degrees_of_freedom
from imuwb.identification.allan_variance.moments import moments
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, WhiteNoise

UNITS = [Quantization(1.0), WhiteNoise(1.0), FlickerNoise(1.0), RandomWalk(1.0)]


def covariance_by_matrices(process_covariance, factors, n):
    """2 tr(A Σ B Σ) with the quadratic forms written out: the oracle of the lag sums."""
    forms = []
    for m in factors:
        rows = n + 1 - 2 * m
        d = np.zeros((rows, n + 1))
        for k in range(rows):
            d[k, k], d[k, k + m], d[k, k + 2 * m] = 1, -2, 1
        forms.append(d)
    out = np.zeros((len(factors), len(factors)))
    for i, a in enumerate(forms):
        for j, b in enumerate(forms):
            cross = a @ process_covariance @ b.T
            out[i, j] = 2 * np.sum(cross**2) / (a.shape[0] * b.shape[0] * 4 * factors[i] ** 2 * factors[j] ** 2)
    return out


@pytest.mark.parametrize("which", range(4))
def test_covariance_equals_the_matrix_form(which):
    n, factors = 60, (1, 2, 5, 11, 29)
    t = np.arange(n + 1.0)
    lag = np.abs(t[:, None] - t[None, :])
    with np.errstate(divide="ignore", invalid="ignore"):
        kernels = [
            (lag == 0) * 1.0, -lag / 2, np.where(lag > 0, lag**2 * np.log(lag), 0) / (2 * np.pi), lag**3 / 12,
        ]  # fmt: skip
    expected = covariance_by_matrices(kernels[which], factors, n)
    found = moments(factors, n).covariance(np.eye(4)[which], 0.0, 1.0)
    np.testing.assert_allclose(found, expected, rtol=1e-6)


@pytest.mark.slow
def test_ramp_adds_its_cross_terms():
    n, factors, ramp = 50, (1, 3, 20), 0.3
    rng = np.random.default_rng(0)
    draws = np.array(
        [allan(rng.standard_normal(n) + ramp * np.arange(n), 1.0, list(factors)).deviation ** 2 for _ in range(4000)]
    )
    found = moments(factors, n).covariance(np.array([0, 1.0, 0, 0]), ramp, 1.0)
    np.testing.assert_allclose(np.cov(draws.T), found, rtol=0.12, atol=0.02 * found.max())


@pytest.mark.slow
@pytest.mark.parametrize(("m", "n"), [(1, 400), (7, 400), (100, 400), (190, 400)])
@pytest.mark.parametrize(("exponent", "process"), [(2, UNITS[0]), (0, UNITS[1]), (-1, UNITS[2]), (-2, UNITS[3])])
def test_degrees_of_freedom_are_those_of_samples(m, n, exponent, process):
    rng = np.random.default_rng(m)
    variances = np.array([allan(process.sample(n, 1.0, rng), 1.0, [m]).deviation[0] ** 2 for _ in range(1500)])
    edf = 2 * variances.mean() ** 2 / variances.var()
    # The relative error of a variance of 1500 draws of chi-square with few degrees is large: its kurtosis is 12/edf.
    error = np.sqrt((2 + 12 / edf) / 1500)
    assert equivalent_degrees_of_freedom(m, n, exponent) == pytest.approx(edf, rel=4 * error)


@pytest.mark.parametrize("exponent", [2, 1, 0, -1, -2])
@pytest.mark.parametrize("m", [1, 3])
def test_short_averaging_times_of_long_records_scale_with_the_length(m, exponent):
    # Where rounding would show: a million lags at which the covariance is all but 0.
    short, long = (equivalent_degrees_of_freedom(m, n, exponent) for n in (2000, 2_000_000))
    assert long == pytest.approx(1000 * short, rel=5e-3)


def test_long_records_agree_with_short_ones_scaled():
    # For white, flicker and random-walk noise only n/m matters once m is large.
    for exponent in (0, -1, -2):
        small = equivalent_degrees_of_freedom(200, 2000, exponent)
        large = equivalent_degrees_of_freedom(200_000, 2_000_000, exponent)
        assert large == pytest.approx(small, rel=5e-3)
