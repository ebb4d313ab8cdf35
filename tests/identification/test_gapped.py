import numpy as np
import pytest

from imuwb.identification import allan
from imuwb.identification.gapped import bridged, variogram
from imuwb.stochastic import FlickerNoise, RandomWalk, WhiteNoise

NOISE = WhiteNoise(1.0) + FlickerNoise(0.3) + RandomWalk(0.01)


def thinned(n, seed, share=0.05, process=NOISE):
    rng = np.random.default_rng(seed)
    values = process.sample(n, 1.0, rng)
    place = np.flatnonzero(rng.random(n) >= share)
    place = place[place >= place[0]]
    return values[place], place - place[0]


def test_variogram_is_the_double_loop_over_pairs():
    values, place = thinned(300, 0, 0.3)
    half, pairs = variogram(values + 9.81, place)
    apart = place[None, :] - place[:, None]
    squares = (values[None, :] - values[:, None]) ** 2 / 2
    for lag in (0, 1, 2, 17, 150, int(place[-1])):
        chosen = apart == lag
        assert pairs[lag] == chosen.sum()
        assert half[lag] == pytest.approx(squares[chosen].mean(), rel=1e-9, abs=1e-12)
    assert half.size == place[-1] + 1


def test_a_lag_without_pairs_has_none():
    half, pairs = variogram(np.array([1.0, 2.0, 4.0]), np.array([0, 1, 5]))
    assert pairs.tolist() == [3, 1, 0, 0, 1, 1]
    np.testing.assert_allclose(half, [0, 0.5, 0, 0, 2, 4.5], atol=1e-12)


@pytest.mark.parametrize("process", [WhiteNoise(1.0), FlickerNoise(1.0), RandomWalk(0.1)], ids=repr)
def test_nothing_is_biased_by_samples_missing_at_random(process):
    factors = 2 ** np.arange(9)
    draws, shares = zip(*(bridged(*thinned(2048, seed, process=process), factors) for seed in range(40)), strict=True)
    expected = process.allan_variance(factors.astype(float), 1.0)
    error = np.std(draws, axis=0) / 40**0.5
    assert (np.abs(np.mean(draws, axis=0) - expected) < 4 * error).all()
    assert (error < 0.2 * expected).all()
    assert np.mean(shares, axis=0) == pytest.approx(0.9, abs=0.05)


def test_with_nothing_missing_it_agrees_with_the_allan_variance_within_its_scatter():
    factors = 2 ** np.arange(8)
    ratios = []
    for seed in range(40):
        values = NOISE.sample(2048, 1.0, np.random.default_rng(seed))
        variance, share = bridged(values, np.arange(2048), factors)
        assert (share == 1).all()
        curve = allan(values, 1.0, list(factors.astype(float)))
        ratios.append(variance / curve.deviation**2)
        assert (np.abs(ratios[-1] - 1) < 4 * np.sqrt(2 / curve.degrees_of_freedom)).all()
    error = np.std(ratios, axis=0) / 40**0.5
    assert (np.abs(np.mean(ratios, axis=0) - 1) < 4 * error + 1e-9).all()


def test_the_weights_are_those_of_a_haar_window():
    """E of the Allan variance of any series with stationary increments, as a quadratic form of its variogram."""
    values, place = thinned(120, 3, 0.0)
    half, _ = variogram(values, place)
    for m in (1, 3, 10):
        window = np.repeat([1.0, -1.0], m) / m
        lags = np.abs(np.subtract.outer(np.arange(2 * m), np.arange(2 * m)))
        expected = -window @ half[lags] @ window / 2
        assert bridged(values, place, np.array([m]))[0][0] == pytest.approx(expected, rel=1e-9)


def test_averaging_times_whose_lags_have_too_few_pairs_are_unknown():
    values = np.random.default_rng(0).standard_normal(400)
    place = np.concatenate([np.arange(200), np.arange(200) + 5000])
    variance, share = bridged(values, place, np.array([1, 32, 92, 93, 128, 5000]))
    assert np.isfinite(variance).tolist() == [True, True, True, False, False, False]
    assert (share[:3] > 0).all()
    assert not share[3:].any()
