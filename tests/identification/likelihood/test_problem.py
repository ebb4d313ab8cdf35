import numpy as np
import pytest
from scipy import fft, integrate, linalg, stats

from imuwb.identification.likelihood.cosine_spectrum import cosine_spectrum
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, RateRamp, Sum, WhiteNoise
from imuwb.stochastic.flicker import _flicker_increments

DT = 0.1
UNITS = [Quantization(1.0), WhiteNoise(1.0), FlickerNoise(1.0), RandomWalk(1.0)]
TRUTH = np.array([0.0, 0.3, 0.2, 0.02]) ** 2


def record(n=2048, seed=0, squared=TRUTH, ramp=0.0):
    sizes = np.sqrt(squared)
    process = Sum(
        (Quantization(sizes[0]), WhiteNoise(sizes[1]), FlickerNoise(sizes[2]), RandomWalk(sizes[3]), RateRamp(ramp))
    )
    return process.sample(n, DT, np.random.default_rng(seed))


def problem_of(values):
    return LikelihoodProblem.of(cosine_spectrum(values, DT), UNITS)


def dense(values, squared):
    """All coefficients one by one, with the covariance of all, and the ramp taken off."""
    spectrum = cosine_spectrum(values, DT)
    straight = np.polyval(np.polyfit(np.arange(values.size), values, 1), np.arange(values.size))
    coefficients = fft.dct(values - straight, type=2, norm="ortho")[1:] * np.sqrt(DT)
    low = sum(s * spectrum.covariance(process) for s, process in zip(squared, UNITS, strict=True))
    bins = sum(s * spectrum.density(process) for s, process in zip(squared, UNITS, strict=True))
    covariance = linalg.block_diag(low, np.diag(np.repeat(bins, spectrum.last - spectrum.first + 1)))
    trend = np.zeros(coefficients.size)
    trend[: low.shape[0]] = spectrum.trend()
    return coefficients, covariance, trend, spectrum.ramp


@pytest.mark.parametrize("squared", [TRUTH, np.array([1e-4, 0.1, 0.0, 1e-3]), np.array([0.0, 0.0, 0.05, 0.0])])
def test_deviance_is_that_of_a_dense_gaussian(squared):
    values = record(512, ramp=0.01)
    coefficients, covariance, trend, ramp = dense(values, squared)
    density = stats.multivariate_normal(np.zeros(coefficients.size), covariance)
    expected = -2 * density.logpdf(coefficients + ramp * trend) - coefficients.size * np.log(2 * np.pi)
    assert problem_of(values).deviance(squared) == pytest.approx(expected, abs=1e-6)


def test_a_ramp_is_integrated_out():
    values = record(512, ramp=0.01)
    coefficients, covariance, trend, _ = dense(values, TRUTH)
    density = stats.multivariate_normal(np.zeros(coefficients.size), covariance)
    base = density.logpdf(coefficients)
    sigma = float(trend @ np.linalg.solve(covariance, trend)) ** -0.5
    total = integrate.quad(
        lambda s: np.exp(density.logpdf(coefficients - s * trend) - base), -12 * sigma, 12 * sigma, limit=100
    )[0]
    expected = -2 * (np.log(total) + base) - (coefficients.size - 1) * np.log(2 * np.pi)
    assert problem_of(values).deviance(TRUTH, ramp=True) == pytest.approx(expected, abs=1e-5)


def test_deviances_differ_as_the_exact_ones_of_the_record_do():
    values = record(600, seed=3)
    n = values.size
    steps = np.diff(values)

    def exact(squared):
        """-2 log density of the increments: stationary, with covariances that are known exactly."""
        first = np.zeros((4, n - 1))
        first[0, :3] = np.array([6, -4, 1]) / DT**2
        first[1, :2] = np.array([2, -1]) / DT
        first[2] = _flicker_increments(n - 1)
        first[3, :2] = np.array([2 / 3, 1 / 6]) * DT
        root = linalg.cholesky(linalg.toeplitz(squared @ first), lower=True)
        return 2 * np.log(np.diag(root)).sum() + np.sum(linalg.solve_triangular(root, steps, lower=True) ** 2)

    problem = problem_of(values)
    reference = exact(TRUTH) - problem.deviance(TRUTH)
    for factors in ((0, 1.1, 1, 1), (0, 0.8, 1, 1), (0, 1, 3, 1), (0, 1, 0.3, 1), (0, 1, 1, 40), (0, 1, 0, 4)):
        squared = TRUTH * factors
        change = exact(squared) - exact(TRUTH)
        assert abs(change) > 0.1
        assert exact(squared) - problem.deviance(squared) == pytest.approx(reference, abs=0.3)


@pytest.mark.parametrize("ramp", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_scoring_ends_where_the_gradient_is_0(seed, ramp):
    problem = problem_of(record(4096, seed=seed))
    found = problem.solve(range(4), ramp=ramp)
    assert found.deviance == pytest.approx(problem.deviance(found.squared, ramp=ramp), abs=1e-9)
    for term in range(4):
        sigma = found.information[term, term] ** -0.5
        step = np.eye(4)[term] * sigma * 1e-3
        if found.squared[term] > 2e-3 * sigma:
            ends = [problem.deviance(found.squared + side * step, ramp=ramp) for side in (-1, 1)]
            assert abs(ends[1] - ends[0]) / 2e-3 < 0.05  # of the deviance, over a sigma
        else:
            assert problem.deviance(found.squared + step, ramp=ramp) > found.deviance - 1e-4


@pytest.mark.slow
def test_information_is_the_inverse_of_the_scatter_over_records():
    truth = np.array([0.0, 0.3, 0.0, 0.3]) ** 2
    found = [problem_of(record(2048, seed, truth)).solve([1, 3], ramp=False) for seed in range(150)]
    squares = np.array([f.squared[[1, 3]] for f in found])
    assert (np.abs(squares.mean(axis=0) / truth[[1, 3]] - 1) < 4 * squares.std(axis=0) / truth[[1, 3]] / 150**0.5).all()
    information = np.mean([f.information[np.ix_([1, 3], [1, 3])] for f in found], axis=0)
    sigma = np.sqrt(np.diag(np.linalg.inv(information)))
    np.testing.assert_allclose(squares.std(axis=0), sigma, rtol=4 / np.sqrt(300))


@pytest.mark.slow
def test_the_ramp_scatters_as_its_sigma_states():
    found = [problem_of(record(1024, seed, ramp=0.05)).solve([1, 2, 3]) for seed in range(150)]
    pull = np.array([(f.ramp - 0.05) / f.ramp_sigma for f in found])
    assert abs(pull.mean()) < 4 / 150**0.5
    assert pull.std() == pytest.approx(1, abs=0.25)


def test_a_solution_without_ramp_has_none():
    found = problem_of(record(ramp=0.05)).solve([1, 2], ramp=False)
    assert (found.ramp, found.ramp_sigma) == (0, 0)
    assert found.squared[0] == found.squared[3] == 0


def test_held_terms_stay_and_the_others_follow():
    problem = problem_of(record(8192))
    best = problem.solve([1, 2], ramp=False)
    held = np.array([0, 0, best.squared[2] * 1.5, 0])
    found = problem.solve([1], ramp=False, held=held, start=best.squared)
    assert found.squared[2] == held[2]
    assert found.squared[1] < best.squared[1]
    assert found.deviance > best.deviance
    near = [problem.deviance(held + np.eye(4)[1] * found.squared[1] * side) for side in (0.99, 1.01)]
    assert min(near) > found.deviance


def test_what_lies_above_a_frequency_counts_no_more():
    values = record(8192)
    problem = problem_of(values).below(1.0)
    assert problem.frequency.max() <= 1.0 < problem_of(values).frequency.max()
    t = np.arange(values.size) * DT
    louder = problem_of(values + 0.5 * np.sin(2 * np.pi * 3.3 * t)).below(1.0)
    assert louder.solve([1, 2]).squared[1] == pytest.approx(problem.solve([1, 2]).squared[1], rel=0.01)
