import numpy as np
import pytest
from scipy import integrate, stats

from imuwb.identification.lssa import Constituents, Noise, adjust, least_squares_spectrum, significance
from imuwb.identification.lssa.significance import _both, _neighbours, record_limit, record_probability

DT = 0.01
RARE = 1e-4
RECORDS = 300


def spectra(count, noise, n=256, oversampling=2):
    time = np.arange(n) * DT
    for seed in range(count):
        values = np.random.default_rng(seed).standard_normal(n)
        yield least_squares_spectrum(adjust(time, values, Constituents("linear"), noise), oversampling=oversampling)


@pytest.mark.slow
def test_the_share_of_white_noise_has_its_beta_distribution():
    shares = np.array([s.share[[19, 40]] for s in spectra(300, Noise(), 64)])
    assert stats.kstest(shares.ravel(), stats.beta(1, (62 - 2) / 2).cdf).pvalue > RARE
    # and not that of one degree of freedom more or less, in a record so short
    assert stats.kstest(shares.ravel(), stats.beta(1, 20).cdf).pvalue < RARE


@pytest.mark.slow
@pytest.mark.parametrize("noise", [Noise(), Noise("local")])
def test_noise_exceeds_its_levels_as_often_as_said(noise):
    looked = above = records = 0
    for spectrum in spectra(RECORDS, noise):
        found = significance(spectrum, 0.9)
        seen = found.exceedance > 0
        looked += int(seen[::2].sum())  # those between are not independent
        above += int((found.exceedance[::2] > found.one).sum())
        records += bool((found.exceedance > found.record).any())
    assert above / looked == pytest.approx(0.1, abs=0.007)
    assert RARE < stats.binom.cdf(records, RECORDS, 0.1) < 1 - RARE


@pytest.mark.parametrize("oversampling", [2, 8])
def test_the_records_limit_is_that_of_correlated_exceedances(oversampling):
    rng = np.random.default_rng(2)
    count, n = 100, 2000
    m = oversampling * count
    # Fourier sums of white noise at more frequencies than it has
    sums = np.fft.fft(rng.standard_normal((n, count)) + 1j * rng.standard_normal((n, count)), m, axis=1)
    highest = (np.abs(sums) ** 2 / (2 * count)).max(axis=1)
    together = float(np.abs(np.mean(np.exp(2j * np.pi * np.arange(count) / m))))
    for alpha in (0.2, 0.05, 0.01):
        limit = record_limit(alpha, m, together)
        assert RARE < stats.binom.cdf(int((highest > limit).sum()), n, alpha) < 1 - RARE
        assert record_probability(limit, m, together) == pytest.approx(alpha, rel=1e-6)


def test_the_limit_of_independent_frequencies():
    # independent frequencies: 1 - (1 - exp(-u))^m
    assert record_limit(0.01, 100, 0.0) == pytest.approx(-np.log(-np.expm1(np.log(0.99) / 100)), abs=0.002)


def test_critical_percent_is_pagiatakis():
    (spectrum,) = spectra(1, Noise(), 256)
    found = significance(spectrum, 0.99)
    one, record = found.share_limit(spectrum.adjusted.freedom)
    assert one == pytest.approx(1 - 0.01 ** (2 / (256 - 2 - 2)), rel=1e-12)
    assert record > one


@pytest.mark.parametrize("noise", [Noise(), Noise("local"), Noise("random-walk")])
def test_limits_that_are_drawn_are_those_of_verdicts(noise):
    time = np.arange(200) * DT
    values = np.random.default_rng(3).standard_normal(200) + np.cos(2 * np.pi * 11 * time)
    spectrum = least_squares_spectrum(adjust(time, values, Constituents(), noise))
    found = significance(spectrum, 0.9)
    told = found.exceedance > 0
    for level in (found.one, found.record, 0.3):
        assert np.array_equal((spectrum.density > found.limit(spectrum, level))[told], (found.exceedance > level)[told])
    assert (found.exceedance > found.record).any()


def test_a_band_too_low_for_neighbours_shows_nothing():
    (spectrum,) = spectra(1, Noise("local"), 256)
    low = least_squares_spectrum(spectrum.adjusted, highest=1.0)
    found = significance(low, 0.99)
    assert not found.exceedance.any()
    assert np.isfinite(found.record)


@pytest.mark.parametrize("oversampling", [1, 3])
def test_local_noise_is_the_mean_of_fifty_neighbours_on_each_side_without_the_nearest_two(oversampling):
    rows = 140
    reduction = np.random.default_rng(9).exponential(size=rows * oversampling)
    mean, count = _neighbours(reduction, oversampling)
    table = reduction.reshape(rows, oversampling)
    for row in range(rows):
        reach = min(50, row // 2)
        around = [*range(row - 2 - reach, row - 2), *range(row + 3, row + 3 + reach)]
        inside = [r for r in around if 0 <= r < rows]
        wanted = len(inside) if row >= 6 else 0  # six cycles of a line
        assert count.reshape(rows, oversampling)[row] == pytest.approx(wanted)
        if wanted:
            assert mean.reshape(rows, oversampling)[row] == pytest.approx(table[inside].mean(axis=0))


@pytest.mark.parametrize(("u", "together"), [(2.0, 0.5), (6.0, 0.9), (12.0, 0.99)])
def test_two_neighbours_reach_a_limit_as_the_integral_says(u, together):
    rho = together**2
    tail = stats.ncx2.sf
    by_quadrature, _ = integrate.quad(
        lambda x: np.exp(-x) * tail(2 * u / (1 - rho), 2, 2 * rho * x / (1 - rho)), u, u + 60, epsabs=0, epsrel=1e-9
    )
    assert _both(u, together) == pytest.approx(by_quadrature, rel=1e-4)
