import numpy as np
import pytest

from imuwb.identification.coefficient import interval


@pytest.mark.parametrize("freedom", [10, 200])
@pytest.mark.parametrize("level", [0.683, 0.95])
def test_intervals_of_chi_square_estimates_contain_the_truth_as_often_as_they_say(freedom, level):
    truth = 0.7
    rng = np.random.default_rng(freedom)
    squares = truth**2 * rng.chisquare(freedom, 2000) / freedom
    ends = np.array([interval(square, square * (2 / freedom) ** 0.5, level) for square in squares])
    inside = np.mean((ends[:, 0] < truth) & (truth < ends[:, 1]))
    below, above = np.mean(truth < ends[:, 0]), np.mean(truth > ends[:, 1])
    error = np.sqrt(level * (1 - level) / 2000)
    assert inside == pytest.approx(level, abs=4 * error)
    assert below == pytest.approx(above, abs=6 * error)


def test_an_estimate_with_few_degrees_of_freedom_has_a_normal_upper_end():
    lower, upper = interval(1.0, 0.83, 0.95)
    assert lower == 0
    assert upper == pytest.approx((1 + 1.959964 * 0.83) ** 0.5)


def test_what_chance_makes_may_be_absent():
    assert interval(1.0, 0.52, 0.95)[0] == 0
    assert interval(1.0, 0.5, 0.95)[0] > 0


def test_intervals_scale_with_the_unit():
    plain, scaled = interval(1.0, 0.3, 0.95), interval(1e-12, 0.3e-12, 0.95)
    np.testing.assert_allclose(scaled, np.array(plain) * 1e-6)
