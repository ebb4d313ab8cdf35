import numpy as np
import pytest
from scipy import fft

from imuwb.identification.likelihood.cosine_spectrum import cosine_spectrum
from imuwb.identification.likelihood.fit import TERMS, fit_problem
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.identification.temperature.thermal_trend import joined, lowest, restricted, trend_of, without_trend
from imuwb.stochastic import FlickerNoise, RandomWalk, Sum, WhiteNoise

DT, N = 0.01, 20_000
KINDS = [make(1.0) for make in TERMS.values()]


def problem_of(values, trend):
    spectrum = cosine_spectrum(values, DT)
    return restricted(LikelihoodProblem.of(spectrum, KINDS), spectrum, lowest(trend, DT))


@pytest.fixture(scope="module")
def record():
    rng = np.random.default_rng(3)
    sensor = Sum((WhiteNoise(0.005), FlickerNoise(0.002), RandomWalk(1e-4)))
    warm = 20 + 5 * np.linspace(0, 1, N) ** 1.5
    return sensor.sample(N, DT, rng), warm


def test_the_lowest_coefficients_are_those_of_the_columns(record):
    trend = trend_of(N, record[1])
    by_hand = fft.dct(trend, axis=0, norm="ortho")[1:33] * DT**0.5
    found = lowest(trend, DT)
    # The same span: a column may differ by a multiple of the line, which is taken out too.
    for column in by_hand.T:
        rest = column - found @ np.linalg.lstsq(found, column, rcond=None)[0]
        assert np.abs(rest).max() < 1e-9 * np.abs(column).max()


def test_a_thermal_drift_changes_nothing(record):
    values, warm = record
    trend = trend_of(N, warm)
    drift = 3.0 + 0.7 * warm - 0.02 * warm**2 + 1e-3 * np.arange(N) * DT
    plain, drifting = (fit_problem(problem_of(without_trend(x, trend), trend)) for x in (values, values + drift))
    for letter in "NBK":
        a, b = plain.coefficients[letter], drifting.coefficients[letter]
        assert (a.value or 0) == pytest.approx(b.value or 0, rel=1e-5, abs=1e-9)
        assert a.upper == pytest.approx(b.upper, rel=1e-3)


def test_a_drift_that_is_left_in_passes_for_a_walk(record):
    values, warm = record
    line = trend_of(N, None)
    left = fit_problem(problem_of(without_trend(values + 0.02 * (warm - 22) ** 2, line), line))
    taken = trend_of(N, warm)
    out = fit_problem(problem_of(without_trend(values + 0.02 * (warm - 22) ** 2, taken), taken))
    assert (left.coefficients["K"].lower or 0) > 0.002
    assert out.coefficients["K"].upper < 0.002


def test_restriction_takes_as_many_coefficients_as_the_trend_has_directions(record):
    values, warm = record
    for celsius, directions in ((None, 1), (warm, 3), (20 + 5 * np.linspace(0, 1, N), 2)):
        trend = trend_of(N, celsius)
        found = problem_of(without_trend(values, trend), trend)
        assert found.low.size == 32 - directions
        assert found.parts.shape == (4, found.low.size, found.low.size)


def test_records_side_by_side_have_the_likelihood_of_their_product(record):
    values, _ = record
    line = trend_of(N // 2, None)
    parts = [problem_of(without_trend(half, line), line) for half in np.split(values, 2)]
    squared = np.array([0.0, 0.005**2, 0.002**2, 1e-8])
    together = joined(parts)
    assert together.deviance(squared) == pytest.approx(sum(p.deviance(squared) for p in parts), rel=1e-9)
    assert (np.diff(together.frequency) >= 0).all()
    assert together.parts.size == sum(p.parts.size for p in parts)  # so the cost grows as the number of records


@pytest.mark.parametrize(("span", "columns"), [(0.18, 1), (0.22, 3)])
def test_a_temperature_that_moves_by_a_fifth_of_a_degree_makes_a_trend(span, columns):
    assert trend_of(1000, 20 + span * np.linspace(0, 1, 1000)).shape == (1000, columns)
