from dataclasses import replace

import numpy as np
import pytest

from imuwb.identification.temperature.bias import RecordMean, biases, difference_variance, size_of
from imuwb.statistics import Coefficient
from imuwb.stochastic import FlickerNoise, RandomWalk, Sum, WhiteNoise

DT = 1.0


def mean_at(celsius, value, k, *, rising=None, log=0):
    return RecordMean(celsius, value, 1000.0 * k + 500, 1000.0, rising, log)


def test_differences_of_neighbours_are_twice_the_allan_variance():
    for process in (WhiteNoise(2.0), FlickerNoise(3.0), RandomWalk(0.5)):
        expected = 2 * process.allan_variance(np.array([100.0]), 1e-3)[0]
        assert difference_variance(Sum((process,)), 100.0, 100.0) == pytest.approx(expected, rel=1e-4)


def test_differences_of_means_far_apart_are_as_samples_have_them():
    rng = np.random.default_rng(1)
    slow = Sum((FlickerNoise(1.0), RandomWalk(0.05)))
    found = []
    for _ in range(300):
        means = slow.sample(1000, DT, rng).reshape(10, 100).mean(axis=1)
        found.append(means[7] - means[0])
    assert np.mean(np.square(found)) == pytest.approx(difference_variance(slow, 100.0, 700.0), rel=0.35)


def test_a_walk_between_set_points_is_no_dependence():
    rng = np.random.default_rng(2)
    slow = Sum((RandomWalk(0.05),))
    statistics = []
    for _ in range(200):
        x = slow.sample(6000, DT, rng).reshape(6, 1000).mean(axis=1)
        means = [[mean_at(10.0 * k, v, k)] for k, v in enumerate(x)]
        statistics.append(biases(means, [1e-9] * 6, slow).heterogeneity())
    assert np.mean(statistics) == pytest.approx(5, abs=0.9)  # chi-square(5): standard error 0.22
    assert np.mean(np.array(statistics) > 11.07) < 0.13


def test_white_means_scatter_about_one_value_as_their_errors_say():
    values = np.random.default_rng(3).standard_normal(5)
    found = biases([[mean_at(t, v, t)] for t, v in enumerate(values)], [1000**0.5] * 5, Sum())
    assert found.heterogeneity() == pytest.approx(float(np.sum((values - values.mean()) ** 2)))
    assert [b.estimate.sigma for b in found.at] == pytest.approx([(1 - 1 / 5) ** 0.5] * 5)


def test_rising_less_falling_has_an_interval_that_counts_the_walk():
    slow = Sum((RandomWalk(0.01),))
    means = [
        [mean_at(0.0, 1.0, 0, rising=True), mean_at(0.0, 0.4, 9, rising=False)],
        [mean_at(10.0, 2.0, 1, rising=True)],
    ]
    found = biases(means, [0.1, 0.1], slow)
    (loop,) = found.hysteresis
    half = 1.96 * (2 * 0.1**2 / 1000 + 0.01**2 * (9000 - 1000 / 3)) ** 0.5
    assert (loop.difference.value, loop.difference.upper - loop.difference.value) == (
        pytest.approx(0.6),
        pytest.approx(half, rel=1e-3),
    )
    assert found.at[0].estimate.value == pytest.approx(0.7)
    still = biases(means, [0.1, 0.1], Sum()).hysteresis[0].difference
    assert still.upper - still.value == pytest.approx(1.96 * (2 * 0.1**2 / 1000) ** 0.5, rel=1e-3)
    assert found.turn_on is None


def test_logs_at_one_temperature_tell_the_turn_on_bias():
    rng = np.random.default_rng(4)
    means = [[mean_at(t, float(v), t, log=10 * t + k) for k, v in enumerate(rng.normal(0, 3, 20))] for t in range(3)]
    found = biases(means, [0.1] * 3, Sum())
    assert found.turn_on == pytest.approx(3, rel=0.25)
    # of the mean of twenty logs, less the mean of three temperatures
    apart = biases([[replace(m, log=100 * t + m.log) for m in here] for t, here in enumerate(means)], [0.1] * 3, Sum())
    assert apart.at[0].estimate.sigma == pytest.approx(apart.turn_on * (1 / 20 * 2 / 3) ** 0.5, rel=0.02)
    noisy = biases(means, [3 * 1000**0.5] * 3, Sum())  # noise explains the scatter
    assert noisy.turn_on < 1
    assert found.heterogeneity() < 14  # chi-square(2), 1 of 1000


def test_a_slow_process_counts_as_identified_else_with_its_smallest_limit():
    here, everywhere = Coefficient(None, None, 2.0), Coefficient(None, None, 1.0)
    assert size_of(here, everywhere) == 1.0
    assert size_of(here, Coefficient(1.5, 1.0, 3.0)) == 1.5
    assert size_of(Coefficient(4.0, 3.0, 5.0), everywhere) == 4.0
    assert size_of(Coefficient(4.0, 0.0, 5.0), everywhere) == 1.0  # its interval begins at 0
