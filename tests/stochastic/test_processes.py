from itertools import pairwise

import numpy as np
import pytest
from scipy import integrate, linalg

from imuwb.identification import allan
from imuwb.stochastic import (
    Autoregressive,
    Constant,
    FiniteOrder,
    FlickerNoise,
    GaussMarkov,
    Quantization,
    RandomWalk,
    RateRamp,
    Sinusoid,
    Stationary,
    Sum,
    WhiteNoise,
)

DT = 0.1
SPECTRAL = [
    WhiteNoise(0.3), Quantization(0.02), FlickerNoise(0.5), RandomWalk(0.05), GaussMarkov(1.0, 3.0),
    GaussMarkov(1.0, 0.05), Autoregressive((-0.9,), 1.0, DT), Autoregressive((-1.5, 0.9, -0.2), 1.0, DT),
]  # fmt: skip
ids = repr


@pytest.mark.parametrize("process", SPECTRAL, ids=ids)
def test_spectrum_and_allan_variance_are_one_statement(process):
    """Allan variance at m dt = integral over the sampled spectrum (Percival; Haar transfer function of m samples)."""
    for m in (1, 2, 5, 16):

        def weighted(f, m=m):
            x = np.pi * f * DT
            transfer = 2 * np.sin(m * x) ** 4 / (m * np.sin(x)) ** 2
            return 2 * process.power_spectral_density(np.array([f]), DT)[0] * transfer

        points = np.unique(np.concatenate([np.geomspace(1e-7, 0.5 / DT, 60), np.arange(1, m + 1) / (2 * m * DT)]))
        total = sum(integrate.quad(weighted, a, b, limit=200)[0] for a, b in pairwise(points))
        expected = process.allan_variance(np.array([m * DT]), DT)[0]
        assert total == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("process", SPECTRAL, ids=ids)
def test_samples_have_the_allan_variance(process):
    factors = np.array([1, 3, 10])
    draws = [
        allan(process.sample(3000, DT, np.random.default_rng(seed)), DT, list(factors * DT)).deviation ** 2
        for seed in range(60)
    ]
    ratio = np.mean(draws, axis=0) / process.allan_variance(factors * DT, DT)
    error = np.std(draws, axis=0) / np.mean(draws, axis=0) / np.sqrt(60)
    assert (np.abs(ratio - 1) < 4.5 * error).all()


@pytest.mark.slow
@pytest.mark.parametrize("process", [p for p in SPECTRAL if isinstance(p, Stationary)], ids=ids)
def test_samples_start_stationary(process):
    first = np.array([process.sample(20, DT, np.random.default_rng(seed)) for seed in range(3000)])
    spread = first.var(axis=0)
    assert (np.abs(spread / spread.mean() - 1) < 5 * np.sqrt(2 / 3000)).all()


def test_gauss_markov_peaks_where_the_books_say():
    tau = np.geomspace(0.1, 100, 20_001)
    curve = np.sqrt(GaussMarkov(2.0, 5.0).allan_variance(tau, DT))
    assert curve.max() == pytest.approx(0.6174 * 2.0, rel=1e-4)
    assert tau[curve.argmax()] == pytest.approx(1.893 * 5.0, rel=1e-3)


def test_gauss_markov_is_white_noise_at_long_times_and_a_walk_at_short_ones():
    process = GaussMarkov(0.5, 2.0)
    long, short = np.array([1e6]), np.array([1e-6])
    assert process.allan_variance(long, DT) == pytest.approx(2 * 0.25 * 2.0 / long, rel=1e-5)
    assert process.allan_variance(short, DT) == pytest.approx(2 * 0.25 / 2.0 * short / 3, rel=1e-5)


def test_densities_go_over_into_the_formulas_of_ieee():
    f, dt = np.array([0.01, 0.1]), 1e-3
    np.testing.assert_allclose(FlickerNoise(3.0).power_spectral_density(f, dt), 9 / (2 * np.pi * f), rtol=1e-5)
    np.testing.assert_allclose(RandomWalk(3.0).power_spectral_density(f, dt), 9 / (2 * np.pi * f) ** 2, rtol=1e-5)
    gauss_markov = 2 * 9 * 4.0 / (1 + (2 * np.pi * f * 4.0) ** 2)
    np.testing.assert_allclose(GaussMarkov(3.0, 4.0).power_spectral_density(f, dt), gauss_markov, rtol=1e-5)


def test_a_sum_is_the_sum_of_its_terms():
    whole = WhiteNoise(0.3) + FlickerNoise(0.5) + RandomWalk(0.1)
    tau = np.array([0.1, 1.0, 10.0])
    assert [type(term) for term in whole.terms] == [WhiteNoise, FlickerNoise, RandomWalk]
    np.testing.assert_allclose(whole.allan_variance(tau, DT), sum(t.allan_variance(tau, DT) for t in whole.terms))
    np.testing.assert_allclose(
        whole.power_spectral_density(tau / 3, DT), sum(t.power_spectral_density(tau / 3, DT) for t in whole.terms)
    )
    assert whole == Sum((WhiteNoise(0.3), FlickerNoise(0.5), RandomWalk(0.1)))
    assert WhiteNoise(1.0) + whole == Sum((WhiteNoise(1.0), *whole.terms))


def test_a_sum_knows_what_its_terms_can():
    assert (WhiteNoise(1) + RandomWalk(1)).is_finite_order
    assert not (WhiteNoise(1) + FlickerNoise(1)).is_finite_order
    assert Sum((GaussMarkov(1, 1),)).is_stationary
    assert not (GaussMarkov(1, 1) + RandomWalk(1)).is_stationary
    assert sum([WhiteNoise(1.0), RandomWalk(2.0)]) == WhiteNoise(1) + RandomWalk(2)


@pytest.mark.parametrize("a", [1e-10, 1e-6, 1e-3, 9e-3, 1.1e-2, 0.5, 3.0])
def test_gauss_markov_density_is_the_sum_of_its_aliases(a):
    process = GaussMarkov(1.0, 1 / a)
    f = np.array([1e-3, 0.1, 0.3, 0.5])
    folded = f[:, None] + np.arange(-20_000, 20_001)
    aliases = 2 * process.Tc / (1 + (2 * np.pi * folded * process.Tc) ** 2) * np.sinc(folded) ** 2
    np.testing.assert_allclose(process.power_spectral_density(f, 1.0), aliases.sum(axis=1), rtol=1e-8)


def test_a_sum_says_what_its_terms_cannot():
    with pytest.raises(TypeError, match="not stationary"):
        (WhiteNoise(1.0) + RandomWalk(1.0)).autocovariance(np.zeros(1))
    with pytest.raises(TypeError, match="approximation"):
        (WhiteNoise(1.0) + FlickerNoise(1.0)).discretize(DT)
    with pytest.raises(TypeError, match="^3 is"):
        WhiteNoise(1.0) + 3


@pytest.mark.parametrize(
    "process",
    [GaussMarkov(0.7, 2.0), Autoregressive((-0.5, 0.3), 0.2, DT), Quantization(0.1), Constant(3.0), Sinusoid(1.0, 0.3)],
    ids=ids,
)
def test_state_spaces_start_in_their_stationary_state(process):
    space = process.discretize(DT)
    residual = space.A @ space.P0 @ space.A.T + space.Q - space.P0
    np.testing.assert_allclose(residual, 0, atol=1e-12 * max(1.0, np.abs(space.P0).max()))


@pytest.mark.parametrize(
    "process", [GaussMarkov(0.7, 2.0), Autoregressive((-0.5, 0.3), 0.2, DT), Sinusoid(1.0, 0.3)], ids=ids
)
def test_state_spaces_have_the_autocovariance(process):
    space = process.discretize(DT)
    for lag in (0, 1, 7):
        found = space.c @ np.linalg.matrix_power(space.A, lag) @ space.P0 @ space.c
        assert found == pytest.approx(process.autocovariance(np.array([lag * DT]))[0], rel=1e-9)


def test_sum_discretizes_block_by_block():
    whole = WhiteNoise(0.3) + GaussMarkov(0.7, 2.0) + RandomWalk(0.1) + RateRamp(0.2)
    space = whole.discretize(DT)
    assert isinstance(whole, FiniteOrder)
    assert space.order == 4
    assert pytest.approx(0.09 / DT) == space.R
    assert space.c.tolist() == [1, 1, 1, 0]
    blocks = [term.discretize(DT).A for term in whole.terms[1:]]
    np.testing.assert_array_equal(space.A, linalg.block_diag(*blocks))


def test_flicker_is_approximated_within_its_band():
    flicker = FlickerNoise(2.0)
    band = (1e-3, 1.0)
    f = np.geomspace(*band, 500)
    errors = []
    for states in (2, 4, 6):
        near = flicker.approximate(band, states, DT)
        density = sum(2 * t.sigma**2 * t.Tc / (1 + (2 * np.pi * f * t.Tc) ** 2) for t in near.processes.terms)
        worst = np.abs(density / (4 / (2 * np.pi * f)) - 1).max()
        assert worst == pytest.approx(near.largest_error, rel=0.05)
        errors.append(near.largest_error)
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.15
    with pytest.raises(ValueError, match="band"):
        flicker.approximate((1.0, 100.0), 3, DT)


def test_unstable_ar_sets_are_refused_with_their_pole():
    # Quinchia, table 2, accelerometer x as printed.
    with pytest.raises(ValueError, match=r"pole of magnitude 1\.04"):
        Autoregressive((-2.582, 2.166, -0.585), 1.0, DT)
    for two in ((-2.0, 1.0), (0.0, -1.0, 0.0, 0.0)):  # 1 twice; 1 and -1
        with pytest.raises(ValueError, match="pole of magnitude 1"):
            Autoregressive(two, 1.0, DT)


def test_a_pole_at_1_sums_a_stable_process():
    rng = np.random.default_rng(0)
    walk, tau = Autoregressive((-1.0,), 0.2, DT), np.array([1.0, 7.0, 40.0]) * DT
    same = walk.beta0**2 * (2 * tau / DT + DT / tau) / 6  # of a walk's samples at instants: K² tau/3 for long averages
    np.testing.assert_allclose(walk.allan_variance(tau, DT), same)
    np.testing.assert_allclose(
        walk.sample(100, DT, np.random.default_rng(3)), 0.2 * np.cumsum(np.random.default_rng(3).standard_normal(100))
    )
    assert walk.resampled(4) == Autoregressive((-1.0,), 0.4, 4 * DT)
    slow = Autoregressive((-2.564, 2.131, -0.567), 1.0, DT)
    x = slow.sample(200_000, DT, rng)
    for m in (1, 5, 50):
        means = x[: x.size // m * m].reshape(-1, m).mean(axis=1)
        found = 0.5 * np.mean(np.diff(means) ** 2)
        assert slow.allan_variance(np.array([m * DT]), DT)[0] == pytest.approx(found, rel=0.15)
    with pytest.raises(ValueError, match="not stationary"):
        slow.autocovariance(np.zeros(1))


def test_an_ar_model_is_valid_at_its_own_step_only():
    with pytest.raises(ValueError, match="resample"):
        Autoregressive((-0.5,), 1.0, 0.01).sample(10, 0.02, np.random.default_rng(0))


@pytest.mark.parametrize(
    "make", [lambda: WhiteNoise(-1.0), lambda: GaussMarkov(1.0, 0.0), lambda: FlickerNoise(float("nan"))]
)
def test_impossible_parameters_are_refused(make):
    with pytest.raises(ValueError, match="must be"):
        make()


def test_a_constant_is_one_draw_of_its_sigma():
    draws = np.array([Constant(2.0).sample(3, DT, np.random.default_rng(seed)) for seed in range(2000)])
    assert (draws == draws[:, :1]).all()
    assert draws[:, 0].std() == pytest.approx(2.0, rel=0.08)


def test_a_ramp_rises_by_its_rate():
    np.testing.assert_allclose(RateRamp(-0.2).sample(4, DT, np.random.default_rng(0)), -0.02 * (np.arange(4) + 0.5))
