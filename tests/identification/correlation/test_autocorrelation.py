import numpy as np
import pytest

from imuwb.identification import autocorrelation
from imuwb.identification.correlation import autocorrelation as correlations
from imuwb.stochastic import FlickerNoise, GaussMarkov, RandomWalk, Sinusoid, WhiteNoise

DT = 0.1


def found(process, n=2**14, seed=0, **options):
    return autocorrelation(process.sample(n, DT, np.random.default_rng(seed)), DT, **options)


@pytest.mark.parametrize("n", [16, 1001, 4096])
def test_equals_the_sum_over_lags(n):
    values = GaussMarkov(1.0, 1.0).sample(n, DT, np.random.default_rng(n)) + 9.81
    centered = values - values.mean()
    curve = autocorrelation(values, DT, n * DT)
    full = np.correlate(centered, centered, "full")[n - 1 :]
    lags = np.rint(curve.lag / DT).astype(int)
    np.testing.assert_allclose(curve.value, full[lags] / full[0], atol=1e-12)
    assert curve.variance == pytest.approx(values.var())
    assert curve.value[0] == 1
    assert np.abs(curve.value).max() <= 1 + 1e-12


def test_pieces_give_the_sum_over_the_whole_record(monkeypatch):
    monkeypatch.setattr(correlations, "SHORTEST_PIECE", 10)
    values = GaussMarkov(1.0, 1.0).sample(997, DT, np.random.default_rng(0)) + 9.81
    centered = values - values.mean()
    full = np.correlate(centered, centered, "full")[996:]
    np.testing.assert_allclose(autocorrelation(values, DT, 2.3).value, full[:24] / full[0], atol=1e-13)


def test_the_lags_end_where_they_are_asked_to():
    values = np.random.default_rng(0).standard_normal(5000)
    assert autocorrelation(values, DT).lag[-1] == pytest.approx(50.0)
    assert autocorrelation(values, DT, 7.0).lag.tolist() == pytest.approx((np.arange(71) * DT).tolist())
    assert autocorrelation(values, DT, 1e9).lag[-1] == pytest.approx(4999 * DT)


def test_of_many_lags_some_are_kept_the_short_ones_all():
    values = np.random.default_rng(0).standard_normal(200_000)
    curve = autocorrelation(values, 1.0)
    assert 1500 < curve.lag.size < 2600
    assert curve.lag[:500].tolist() == list(range(500))
    assert curve.lag[-1] == 20_000
    assert (np.diff(curve.lag) >= 1).all()
    assert np.diff(curve.lag).max() < 100


@pytest.mark.parametrize("level", [0.95, 0.99])
def test_white_noise_stays_within_the_band_as_often_as_its_level(level):
    curves = [found(WhiteNoise(1.0), 2048, seed, longest=5.0, level=level) for seed in range(40)]
    inside = np.mean([np.abs(curve.value[1:]) < curve.band for curve in curves])
    assert inside == pytest.approx(level, abs=0.015)


def test_where_it_falls_to_one_eth_is_a_line_between_lags():
    curve = found(GaussMarkov(1.0, 5.0), 2**16)
    at = float(np.interp(curve.falls_to, curve.lag, curve.value))
    assert at == pytest.approx(np.exp(-1), abs=1e-9)
    assert curve.falls_to == pytest.approx(5.0, rel=0.2)
    assert (curve.value[curve.lag < curve.falls_to] > np.exp(-1)).all()
    assert found(GaussMarkov(1.0, 5.0), 2**16, longest=1.0).falls_to is None


@pytest.mark.slow
def test_intervals_of_gauss_markov_contain_the_truth():
    fits = [found(GaussMarkov(0.3, 2.0), 2**13, seed).gauss_markov for seed in range(60)]
    for name, truth in (("sigma", 0.3), ("Tc", 2.0)):
        assert 52 <= sum(truth in getattr(f, name) for f in fits) <= 60
        assert np.median([getattr(f, name).value for f in fits]) == pytest.approx(truth, rel=0.05)
    assert sum(f.tenable for f in fits) >= 57
    assert fits[0].process() == GaussMarkov(fits[0].sigma.value, fits[0].Tc.value)


@pytest.mark.parametrize("correlation_time", [0.1, 30.0])
def test_short_and_long_correlation_times_are_found(correlation_time):
    for seed in range(5):
        fit = found(GaussMarkov(1.0, correlation_time), 2**15, seed).gauss_markov
        assert fit.probability > 1e-3
        assert fit.Tc.value == pytest.approx(correlation_time, rel=0.5)


@pytest.mark.parametrize(
    "process", [GaussMarkov(1.0, 5.0) + WhiteNoise(0.3), WhiteNoise(0.1) + RandomWalk(0.1), FlickerNoise(1.0)], ids=repr
)
def test_first_order_is_not_tenable_for_other_noise(process):
    assert not any(found(process, 2**14, seed).gauss_markov.tenable for seed in range(5))


def test_white_noise_is_gauss_markov_of_no_correlation_time():
    for seed in range(10):
        fit = found(WhiteNoise(1.0), 2**13, seed).gauss_markov
        assert fit.Tc.value < DT
        assert fit.probability > 1e-3
        assert 2 * fit.sigma.value**2 * fit.Tc.value == pytest.approx(1.0, rel=0.1)


def test_a_walk_has_a_correlation_time_that_nobody_knows():
    time = found(RandomWalk(1.0), 2**12).gauss_markov.Tc
    assert time.upper > 2**12 * DT
    assert time.upper / time.lower > 10
    assert not found(GaussMarkov(0.3, 2.0), 2**12).gauss_markov.vague
    assert found(WhiteNoise(1.0), 2**12).gauss_markov.vague


def test_a_sine_correlates_as_a_cosine():
    curve = found(Sinusoid(1.0, 0.5), 2**14, longest=10.0)
    np.testing.assert_allclose(curve.value, np.cos(2 * np.pi * 0.5 * curve.lag), atol=0.02)


def test_a_short_record_has_a_curve_but_no_process():
    assert autocorrelation(np.random.default_rng(0).standard_normal(200), DT).gauss_markov is None


@pytest.mark.parametrize("values", [np.arange(15.0), np.full(100, 2.0), np.zeros(0)])
def test_what_has_no_autocorrelation_is_refused_with_the_reason(values):
    with pytest.raises(ValueError, match="no autocorrelation"):
        autocorrelation(values, DT)


def test_a_long_record_s_correlation_is_that_of_full_precision():
    values = GaussMarkov(1e-5, 5.0).sample(1_100_000, 0.01, np.random.default_rng(3)) + 9.8
    found = autocorrelation(values, 0.01, 20.0)
    centered = values - values.mean()
    for k in (0, 1, 10, 500, 2000):
        direct = float(centered[: values.size - k] @ centered[k:]) / float(centered @ centered)
        at = int(np.argmin(np.abs(found.lag - k * 0.01)))
        assert found.value[at] == pytest.approx(direct, abs=3e-6)
    assert found.variance == pytest.approx(centered.var(), rel=1e-12)
