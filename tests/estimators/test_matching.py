"""What stands for slow errors that a tool has no place for: against closed forms, and against drawn noise."""

import math

import numpy as np
import pytest

from imuwb.estimators.growth import averaged, predicted_variance, remembered, true_variance, walk_variance
from imuwb.estimators.matching import as_gauss_markov, as_walk
from imuwb.stochastic import FLICKER_LEVEL, FlickerNoise, GaussMarkov, RandomWalk, Sum, WhiteNoise

N, T = 1e-3, 60.0


@pytest.mark.parametrize("times", [1, 2, 3])
def test_a_filter_whose_model_is_the_truth_predicts_the_truth(times):
    k = 2e-5
    slow = Sum((RandomWalk(k),))
    assert true_variance(slow, N, k, T, times) == pytest.approx(predicted_variance(N, k, T, times), rel=1e-3)


@pytest.mark.parametrize(("times", "c"), [(1, 0.8825), (2, 0.2080), (3, 0.02324)])
def test_flicker_drifts_as_its_closed_form_and_as_its_samples(times, c):
    """4 ln 2/π for one integration (exact); the others by drawn flicker noise, 600 records of twice the horizon."""
    weights = averaged(1.0, times, 1.0)
    found = weights.variance(Sum((FlickerNoise(1.0),)))
    assert found == pytest.approx(c, rel=1e-3)
    if times == 1:
        assert found == pytest.approx(4 * math.log(2) / math.pi, rel=1e-4)
    rng = np.random.default_rng(5)
    half = 60
    left = 1 - np.arange(half + 1) / half
    ahead = (left[:-1] ** times - left[1:] ** times) / math.factorial(times)
    before = np.full(half, -1 / half / math.factorial(times))
    drawn = [FlickerNoise(1.0).sample(2 * half, 1 / half, rng) @ np.concatenate([before, ahead]) for _ in range(600)]
    assert np.var(drawn) == pytest.approx(found, rel=5 * math.sqrt(2 / 600))


def test_the_memory_of_a_filter_forgets_exponentially():
    weights = remembered(T, 1, 30.0)
    middle = (weights.edges[1:] + weights.edges[:-1]) / 2
    past = middle < 0
    assert weights.weights.sum() == pytest.approx(0, abs=1e-9 * T)
    density = -weights.weights[past] / np.diff(weights.edges)[past] / T
    near = middle[past] > -100
    assert density[near] == pytest.approx(np.exp(middle[past][near] / 30) / 30, rel=2e-2)


@pytest.mark.parametrize(
    ("processes", "k"), [((RandomWalk(3e-6), RandomWalk(4e-6)), 5e-6), ((WhiteNoise(N), RandomWalk(2e-5)), 2e-5)]
)
def test_a_random_walk_stays_what_it_is(processes, k):
    match = as_walk(Sum(processes), N, T, 2)
    assert match is not None
    assert match.process == RandomWalk(pytest.approx(k))
    assert match.exact


def test_a_slow_gauss_markov_process_is_a_walk_of_its_drive():
    match = as_walk(Sum((GaussMarkov(1e-3, 1e5),)), N, T, 2)
    assert match is not None
    assert pytest.approx(1e-3 * math.sqrt(2 / 1e5), rel=1e-2) == match.process.K
    assert match.ratios == pytest.approx((1, 1, 1), abs=1e-2)


@pytest.mark.parametrize("beta", [0.3, 3.0])
def test_the_walk_for_flicker_makes_the_filters_own_sigma_true(beta):
    b = beta * N / math.sqrt(T)
    slow = Sum((FlickerNoise(b),))
    match = as_walk(slow, N, T, 3)
    assert match is not None
    assert not match.exact
    k = match.process.K
    assert predicted_variance(N, k, T, 3) == pytest.approx(true_variance(slow, N, k, T, 3), rel=1e-4)
    assert match.ratios[2] == pytest.approx(1, abs=1e-4)


def test_without_white_noise_the_walk_reaches_the_flat_level_of_flicker_at_the_horizon():
    match = as_walk(Sum((FlickerNoise(1e-4),)), None, T, 1)
    assert match is not None
    assert pytest.approx((FLICKER_LEVEL * 1e-4) ** 2, rel=1e-3) == match.process.K**2 * T / 3


def test_a_gauss_markov_process_stays_what_it_is_and_a_walk_becomes_a_long_one():
    own = as_gauss_markov(Sum((WhiteNoise(N), GaussMarkov(3e-4, 500.0))), T, 2)
    assert own is not None
    assert (own.process, own.exact) == (GaussMarkov(3e-4, 500.0), True)
    long = as_gauss_markov(Sum((RandomWalk(1e-5),)), T, 2)
    assert long is not None
    assert long.process.sigma * math.sqrt(2 / long.process.Tc) == pytest.approx(1e-5, rel=1e-2)
    assert walk_variance(1e-5, T, 2) > 0


@pytest.mark.parametrize("times", [2, 3])
def test_the_gauss_markov_process_for_flicker_drifts_like_it_from_a_third_of_the_horizon_on(times):
    slow = Sum((FlickerNoise(1e-4), RandomWalk(1e-6)))
    match = as_gauss_markov(slow, T, times)
    assert match is not None
    for t in (T / 3, T):
        drifts = [averaged(t, times, t).variance(s) for s in (Sum((match.process,)), slow)]
        assert drifts[0] == pytest.approx(drifts[1], rel=1e-3)


def test_no_slow_error_is_no_process():
    assert as_walk(Sum((WhiteNoise(N),)), N, T, 2) is None
    assert as_gauss_markov(Sum(()), T, 2) is None
