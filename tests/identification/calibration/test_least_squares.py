import numpy as np
import pytest
from scipy import stats

from imuwb.identification.calibration.axis_calibration import student_estimate
from imuwb.identification.calibration.least_squares import RowNoise, fit_linear, is_determined


def noise(variance, freedom=1e6):
    variance = np.asarray(variance, dtype=float)
    return RowNoise(variance, np.zeros(variance.size, dtype=np.int64), np.full(variance.size, float(freedom)))


def straight(n):
    return np.stack([np.ones(n), np.linspace(-1, 1, n)], axis=1)


def test_without_extra_error_it_is_weighted_least_squares():
    rng = np.random.default_rng(0)
    design, variance = straight(30), rng.uniform(0.5, 4.0, 30)
    y = design @ [1.0, 2.0] + rng.standard_normal(30) * np.sqrt(variance)
    fit = fit_linear(design, y, noise(variance), None, always=False)
    weight = np.diag(1 / variance)
    covariance = np.linalg.inv(design.T @ weight @ design)
    np.testing.assert_allclose(fit.value, covariance @ design.T @ weight @ y)
    np.testing.assert_allclose(fit.covariance, covariance)
    assert (fit.extra, fit.extra_freedom) == (0.0, 28.0)


def test_equal_rows_with_unknown_variance_give_the_t_interval_of_every_textbook():
    """With no noise of its own, all error is extra: the restricted likelihood's variance is the residuals' over n - m."""
    rng = np.random.default_rng(1)
    design = straight(8)
    y = design @ [1.0, 2.0] + 0.1 * rng.standard_normal(8)
    fit = fit_linear(design, y, noise(np.full(8, 1e-12)), np.ones(8), always=True)
    line = stats.linregress(design[:, 1], y)
    assert fit.extra == pytest.approx((fit.residual**2).sum() / 6, rel=1e-3)
    assert np.sqrt(fit.covariance[1, 1]) == pytest.approx(line.stderr, rel=1e-3)
    assert fit.freedom[1] == pytest.approx(6, rel=1e-2)
    found = fit.estimate(1, 0.95)
    half = stats.t.ppf(0.975, 6) * line.stderr
    assert (found.lower, found.upper) == pytest.approx((line.slope - half, line.slope + half), rel=1e-3)


def test_extra_error_is_allowed_for_where_residuals_show_it_only():
    rng = np.random.default_rng(2)
    design = straight(12)
    y = design @ [0.0, 1.0] + rng.standard_normal(12)
    assert fit_linear(design, y, noise(np.full(12, 4.0)), np.ones(12), always=False).extra == 0
    fit = fit_linear(design, y, noise(np.full(12, 0.01)), np.ones(12), always=False)
    assert fit.extra == pytest.approx(1.0, rel=0.7)
    assert fit.probability < 1e-6


def test_extra_error_goes_where_its_pattern_says():
    rng = np.random.default_rng(3)
    pattern = np.tile([0.0, 1.0], 100)
    y = np.where(pattern > 0, 3.0, 0.1) * rng.standard_normal(200)
    fit = fit_linear(np.ones((200, 1)), y, noise(np.full(200, 0.01)), pattern, always=True)
    assert fit.extra == pytest.approx(9.0, rel=0.35)
    assert fit.covariance[0, 0] == pytest.approx(0.01 / 100, rel=0.05)  # the rows without it rule


def test_one_shared_variance_gives_its_own_degrees_of_freedom():
    fit = fit_linear(straight(20), np.zeros(20), noise(np.ones(20), 18), None, always=False)
    np.testing.assert_allclose(fit.freedom, 18)
    apart = RowNoise(np.ones(20), np.arange(20), np.full(20, 18.0))  # twenty estimates know more than one
    assert (fit_linear(straight(20), np.zeros(20), apart, None, always=False).freedom > 100).all()


@pytest.mark.slow
def test_coverage_where_both_errors_are_alike():
    rng = np.random.default_rng(4)
    design, inside = straight(9), 0
    for _ in range(600):
        own = 1.0 * rng.chisquare(18) / 18
        y = design @ [1.0, 2.0] + rng.standard_normal(9) + rng.standard_normal(9)
        e = fit_linear(design, y, noise(np.full(9, own), 18), np.ones(9), always=True).estimate(1, 0.95)
        inside += e.lower <= 2.0 <= e.upper
    assert 0.92 < inside / 600 < 0.985


def test_what_rows_leave_open_is_refused():
    design = np.ones((5, 2))
    assert not is_determined(design)
    assert not is_determined(np.ones((1, 2)))
    assert not is_determined(np.stack([np.ones(5), np.zeros(5)], axis=1))
    with pytest.raises(ValueError, match="2 parameters .* 5 rows"):
        fit_linear(design, np.zeros(5), noise(np.ones(5)), None, always=False)


def test_as_many_rows_as_parameters_have_no_residual_to_judge_by():
    fit = fit_linear(straight(2), np.array([0.0, 1.0]), noise([1.0, 1.0]), np.ones(2), always=True)
    assert (fit.extra, fit.extra_freedom, fit.probability) == (0.0, 0.0, 1.0)


def test_an_estimate_has_students_interval():
    e = student_estimate(2.0, 4.0, 5.0, 0.9)
    assert (e.upper - 2.0) / 2.0 == pytest.approx(stats.t.ppf(0.95, 5))
    assert e.value - e.lower == pytest.approx(e.upper - e.value)


@pytest.mark.parametrize(("chance", "allowed"), [(0.1, True), (0.3, False)])
def test_extra_error_is_estimated_where_noise_explains_the_residuals_less_than_once_in_five(chance, allowed):
    y = np.random.default_rng(5).standard_normal(11)
    y -= y.mean()
    y *= (stats.chi2.isf(chance, 10) / (y @ y)) ** 0.5
    fit = fit_linear(np.ones((11, 1)), y, noise(np.ones(11)), np.ones(11), always=False)
    assert fit.probability == pytest.approx(chance)
    assert (fit.extra > 0) == allowed


@pytest.mark.parametrize(("part", "determined"), [(1e-5, True), (1e-9, False)])
def test_columns_that_differ_by_rounding_are_not_determined(part, determined):
    x = np.linspace(-1, 1, 9)
    assert is_determined(np.stack([np.ones(9), 1 + part * x], axis=1)) == determined
