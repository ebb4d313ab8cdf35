"""Noise at changing temperature against its covariance, written out on a fine grid of times."""

import numpy as np
import pytest

from imuwb.simulation.thermal_noise import thermal_noise
from imuwb.stochastic import (
    Autoregressive,
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    Quantization,
    RandomWalk,
    RateRamp,
    Sinusoid,
    Sum,
    WhiteNoise,
)

DT, N, FINE = 0.5, 40, 40  #: s, samples, steps of the grid within a sample
CELSIUS = np.concatenate([np.linspace(0.0, 20.0, 25), np.linspace(20.0, 8.0, 15)])
SHARE = CELSIUS / 20.0
RECORDS = 2500


def axis(cold, hot, warm=20.0):
    return AxisModel(Sum((cold,)), thermal=((0.0, Sum((cold,))), (warm, Sum((hot,)))))


def records(cold, hot, count=RECORDS, warm=20.0):
    rng = np.random.default_rng(5)
    model = axis(cold, hot, warm)
    return np.stack([thermal_noise(model, SHARE * warm, DT, rng) for _ in range(count)])


def between(low, high):
    return low + (high - low) * SHARE


def averages(fine):
    """Return the covariance of a sample's averages of that at the grid's times."""
    return fine.reshape(N, FINE, N, FINE).mean(axis=(1, 3))


def whiteness(found, covariance):
    """Return how far whitened records are from white noise: sigmas of each sample's power, and of neighbours' products."""
    white = np.linalg.solve(np.linalg.cholesky(covariance), found.T)
    power = ((white**2).mean(axis=1) - 1) * np.sqrt(len(found) / 2)
    products = (white[1:] * white[:-1]).mean(axis=1) * np.sqrt(len(found))
    return power, products


def assert_follows(found, covariance):
    for off in whiteness(found, covariance):
        assert np.abs(off).max() < 4.5
        assert abs(off.mean() * np.sqrt(off.size)) < 4.5


def test_white_noise():
    assert_follows(records(WhiteNoise(1.0), WhiteNoise(3.0)), np.diag(between(1.0, 3.0) ** 2) / DT)


def test_quantization():
    q = between(1.0, 3.0)
    shape = 2 * np.eye(N) - np.eye(N, k=1) - np.eye(N, k=-1)
    assert_follows(records(Quantization(1.0), Quantization(3.0)), np.outer(q, q) * shape / DT**2)


def test_a_random_walk_goes_on():
    k = np.repeat(between(1.0, 4.0), FINE)
    power = np.cumsum(k**2 * DT / FINE) - k**2 * DT / FINE / 2
    at = np.arange(N * FINE)
    fine = power[np.minimum(at[:, None], at)]
    assert_follows(records(RandomWalk(1.0), RandomWalk(4.0)), averages(fine))


@pytest.mark.slow
@pytest.mark.parametrize(("short", "long"), [(3.0, 0.8), (3.0, 3.0), (0.8, 3.0)])
def test_a_gauss_markov_process_keeps_its_state(short, long):
    rate = np.repeat(1 / between(short, long), FINE) * DT / FINE
    passed = np.cumsum(rate) - rate / 2
    sigma = between(1.0, 4.0)
    fine = np.exp(-np.abs(passed[:, None] - passed))
    covariance = np.outer(sigma, sigma) * averages(fine)
    assert_follows(records(GaussMarkov(1.0, short), GaussMarkov(4.0, long)), covariance)


def test_a_long_gauss_markov_process_hardly_moves():
    found = records(GaussMarkov(1.0, 1e6), GaussMarkov(1.0, 2e6), 400)
    steps = np.diff(found, axis=1)
    wanted = 2 / 3 * 2 * DT / between(1e6, 2e6)  # of averages of what is nearly a walk
    assert (steps**2).mean() == pytest.approx(wanted.mean(), rel=0.05)
    assert found[:, 0].var() == pytest.approx(1.0, rel=0.35)


@pytest.mark.slow
@pytest.mark.parametrize(("cold", "hot"), [((-0.9,), (0.3,)), ((-1.6, 0.7), (-0.4, 0.1)), ((), ())])
def test_an_ar_set_changes_while_its_past_goes_on(cold, hot):
    sets = Autoregressive(cold, 1.0, DT), Autoregressive(hot, 3.0, DT)
    found = records(*sets, count=800, warm=2.0)
    p = len(cold)
    # the whole record is a linear map of p past values and N draws; sets are held over a quarter of a degree
    from_all = np.zeros((N + p, p + N))
    from_all[:p, :p] = np.eye(p)
    edges = np.flatnonzero(np.diff(np.floor(SHARE * 2.0 / 0.25))) + 1
    held = np.concatenate([np.full(piece.size, piece.mean()) for piece in np.split(SHARE, edges)])
    for k in range(N):
        alpha = [(1 - held[k]) * a + held[k] * b for a, b in zip(cold, hot, strict=True)]
        from_all[k + p] = -sum((a * from_all[k + p - 1 - i] for i, a in enumerate(alpha)), np.zeros(p + N))
        from_all[k + p, p + k] = 1 + 2 * held[k]
    before = np.eye(p + N)
    lags = np.arange(p)
    before[:p, :p] = sets[0].autocovariance(np.abs(lags[:, None] - lags) * DT) if p else np.zeros((0, 0))
    assert_follows(found, (from_all @ before @ from_all.T)[p:, p:])


def test_a_constant_is_drawn_once():
    found = records(Constant(1.0), Constant(3.0), 300)
    drawn = found / between(1.0, 3.0)
    assert np.ptp(drawn, axis=1).max() < 1e-12
    assert drawn[:, 0].var() == pytest.approx(1.0, rel=0.35)


def test_flicker_noise_is_that_of_one_temperature_times_its_level():
    rng = np.random.default_rng(1)
    found = thermal_noise(axis(FlickerNoise(1.0), FlickerNoise(3.0)), CELSIUS, DT, rng)
    unit = FlickerNoise(1.0).sample(N, DT, np.random.default_rng(1))
    assert found == pytest.approx(unit * between(1.0, 3.0))


def test_a_ramp_rises_by_its_slopes():
    found = records(RateRamp(1.0), RateRamp(3.0), 1)[0]
    slopes = np.repeat(between(1.0, 3.0), FINE) * DT / FINE
    assert found == pytest.approx((np.cumsum(slopes) - slopes / 2).reshape(N, FINE).mean(axis=1))


def test_a_lines_phase_goes_on():
    found = records(Sinusoid(1.0, 0.2), Sinusoid(3.0, 0.4), 1)[0]
    turns = np.repeat(between(0.2, 0.4), FINE) * DT / FINE
    phase = 2 * np.pi * (np.cumsum(turns) - turns / 2)
    parts = np.stack([np.cos(phase), np.sin(phase)], axis=1).reshape(N, FINE, 2).mean(axis=1)
    amplitudes, *_ = np.linalg.lstsq(parts * between(1.0, 3.0)[:, None], found, rcond=None)
    assert np.hypot(*amplitudes) == pytest.approx(1.0, rel=1e-3)
    assert parts @ amplitudes * between(1.0, 3.0) == pytest.approx(found, abs=2e-3)


def test_terms_add_up():
    both = Sum((WhiteNoise(1.0), RandomWalk(1.0))), Sum((WhiteNoise(2.0), RandomWalk(4.0)))
    rng = np.random.default_rng(2)
    total = thermal_noise(AxisModel(both[0], thermal=((0.0, both[0]), (20.0, both[1]))), CELSIUS, DT, rng)
    rng = np.random.default_rng(2)
    each = [thermal_noise(axis(a, b), CELSIUS, DT, rng) for a, b in zip(both[0].terms, both[1].terms, strict=True)]
    assert total == pytest.approx(sum(each))


def test_a_process_without_a_rule_is_named():
    class Other(WhiteNoise):
        pass

    with pytest.raises(ValueError, match="Other.*no rule"):
        thermal_noise(axis(Other(1.0), Other(2.0)), CELSIUS, DT, np.random.default_rng(0))


def test_an_ar_set_of_another_step_is_refused():
    one = Autoregressive((-0.5,), 1.0, 0.1)
    with pytest.raises(ValueError, match="valid at its own step"):
        thermal_noise(axis(one, one), CELSIUS, DT, np.random.default_rng(0))
