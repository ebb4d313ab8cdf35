import numpy as np
import pytest
from scipy import signal

from imuwb.identification import allan, equivalent_degrees_of_freedom, stationarity
from imuwb.stochastic import FlickerNoise, GaussMarkov, WhiteNoise

DT = 0.01


def white(n=2**14, seed=0):
    return np.random.default_rng(seed).standard_normal(n)


@pytest.mark.slow
def test_steady_noise_is_seldom_refused():
    process = WhiteNoise(0.005) + FlickerNoise(0.004)
    found = [stationarity(process.sample(2**14, DT, np.random.default_rng(seed)), DT) for seed in range(150)]
    assert sum(not one.stationary for one in found) <= 6  # 1.5 expected at 1 %
    assert np.mean([one.smallest < 0.1 for one in found]) < 0.2
    assert all(one.smallest == min(one.probability.min() * one.probability.size, 1) for one in found)


@pytest.mark.slow
def test_probabilities_are_even_at_each_averaging_time():
    p = np.array([stationarity(white(2**13, seed), DT).probability[:5] for seed in range(200)])
    assert np.abs(p.mean(axis=0) - 0.5).max() < 4.5 / np.sqrt(12 * 200)
    assert np.mean(p < 0.1) == pytest.approx(0.1, abs=0.04)


def test_a_step_of_a_fifth_half_way_is_found():
    for seed in range(10):
        values = white(2**14, seed)
        values[2**13 :] *= 1.2
        found = stationarity(values, DT)
        assert not found.stationary
        assert found.smallest < 1e-6
        assert found.worst_time <= 8 * DT
        assert (found.worst_ratio > 1) == (found.worst_part >= 6)
        early, late = found.deviation[:6, 0].mean(), found.deviation[6:, 0].mean()
        assert late / early == pytest.approx(1.2, abs=0.06)


def test_the_part_that_stands_out_is_named():
    values = white(12_000)
    values[7000:8000] *= 1.5
    found = stationarity(values, DT)
    assert found.worst_part == 7
    assert found.start[7] == pytest.approx(70.0)
    assert found.length == pytest.approx(10.0)
    assert found.worst_ratio == pytest.approx(1.5, abs=0.15)


def test_noise_that_changes_its_colour_is_found_where_it_does():
    rng = np.random.default_rng(0)
    steady = white(48_000)
    drift = GaussMarkov(0.3, 5.0).sample(24_000, DT, rng)
    steady[24_000:] += drift
    found = stationarity(steady, DT)
    assert not found.stationary
    assert found.worst_time > 0.1
    assert found.probability[0] > 1e-3


def test_parts_have_the_allan_deviation():
    values = white(3000)
    found = stationarity(values, DT, 3)
    for part in range(3):
        curve = allan(values[part * 1000 : (part + 1) * 1000], DT, list(found.averaging_time))
        np.testing.assert_allclose(found.deviation[part], curve.deviation, rtol=0.1)
        # The first four are not thinned. Their squares are added in single precision: a rounding of 6e-8 in each of 1,000 sums.
        np.testing.assert_allclose(found.deviation[part][:4], curve.deviation[:4], rtol=1e-5)
    assert found.deviation.shape == (3, found.averaging_time.size)


def test_the_unit_and_a_bias_do_not_matter():
    values = white()
    plain, other = stationarity(values, DT), stationarity(values * 1e-6 + 9.81, DT)
    np.testing.assert_allclose(other.probability, plain.probability, rtol=1e-3)


@pytest.mark.parametrize(
    ("values", "parts", "reason"),
    [
        (np.arange(1000.0), 1, "at least 2"),
        (np.arange(700.0), 12, "parts of 58 samples"),
        (np.full(5000, 2.0), 12, "constant"),
    ],
)
def test_what_cannot_be_tested_is_refused_with_the_reason(values, parts, reason):
    with pytest.raises(ValueError, match=reason):
        stationarity(values, DT, parts)


def test_parts_are_compared_down_to_fifteen_degrees_of_freedom():
    longest = round(stationarity(white(12_000), DT).averaging_time[-1] / DT)
    assert equivalent_degrees_of_freedom(longest, 1000, 0) >= 15 > equivalent_degrees_of_freedom(2 * longest, 1000, 0)


def test_after_a_filter_steady_noise_is_seldom_refused_either():
    """Neighbouring samples are then alike, so a part has fewer degrees of freedom than a power law gives it."""
    low_pass = signal.butter(2, 0.02, output="sos")
    steady = [stationarity(signal.sosfilt(low_pass, white(13_000, seed))[1000:], DT).stationary for seed in range(30)]
    assert sum(steady) >= 28
