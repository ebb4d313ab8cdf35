import numpy as np
import pytest

from imuwb.identification.temperature import TemperatureFunction, choose_function
from imuwb.identification.temperature.functions import KELVIN, KINDS, fitted, left_out, parameters_of, weights

CELSIUS = np.linspace(-30, 60, 10)


@pytest.mark.parametrize("kind", KINDS)
def test_every_function_goes_through_what_is_of_its_kind(kind):
    shapes = {"constant": 0 * CELSIUS + 2, "linear": 2 + CELSIUS, "arrhenius": 2 + 500 / (CELSIUS + KELVIN),
              "quadratic": CELSIUS**2, "cubic": CELSIUS**3}  # fmt: skip
    values = shapes.get(kind, np.sin(CELSIUS))
    function = fitted(kind, CELSIUS, values, np.full(10, 0.1), logarithmic=False)
    np.testing.assert_allclose(function.at(CELSIUS)[0], values, rtol=1e-9, atol=1e-8 * np.abs(values).max())


@pytest.mark.parametrize("kind", KINDS)
def test_weights_reproduce_a_weighted_fit(kind):
    rng = np.random.default_rng(1)
    sigma = rng.uniform(0.5, 2, 10)
    at = np.array([-12.3, 41.0])
    found = weights(kind, at, CELSIUS, sigma)
    np.testing.assert_allclose(found.sum(axis=1), 1, rtol=1e-9)
    if kind in ("linear", "quadratic", "cubic"):
        y = rng.standard_normal(10)
        degree = ("constant", "linear", "quadratic", "cubic").index(kind)
        by_numpy = np.polyval(np.polyfit(CELSIUS, y, degree, w=1 / sigma), at)
        np.testing.assert_allclose(found @ y, by_numpy, rtol=1e-8)


def test_a_function_is_held_beyond_its_set_points():
    function = fitted("linear", CELSIUS, CELSIUS, np.full(10, 0.1), logarithmic=False)
    assert function.at(np.array([-200.0, 200.0]))[0] == pytest.approx([-30, 60])


def test_positive_coefficients_stay_positive():
    function = fitted("linear", CELSIUS, np.log(np.linspace(1, 2, 10)), np.full(10, 0.3), logarithmic=True)
    value, lower, upper = function.at(CELSIUS)
    assert (lower > 0).all()
    assert (lower < value).all()
    assert (value < upper).all()


def test_intervals_of_a_line_hold_it():
    rng = np.random.default_rng(2)
    at = np.linspace(-30, 60, 7)
    inside = []
    for _ in range(200):
        y = 1 + 0.01 * CELSIUS + 0.05 * rng.standard_normal(10)
        _, lower, upper = fitted("linear", CELSIUS, y, np.full(10, 0.05), logarithmic=False).at(at)
        inside.append((lower <= 1 + 0.01 * at) & (1 + 0.01 * at <= upper))
    assert 0.93 < np.mean(inside) < 0.99  # what left-out points miss by chance makes them a little wide


def test_an_interval_knows_what_lies_between_set_points():
    values = np.where(CELSIUS < 15, 0.0, 1.0)
    function = fitted("piecewise", CELSIUS, values, np.full(10, 1e-3), logarithmic=False)
    _, lower, upper = function.at(np.array([CELSIUS[4], (CELSIUS[4] + CELSIUS[5]) / 2]))
    assert (upper - lower)[0] < 0.01
    assert (upper - lower)[1] > 0.3
    # of a Brownian bridge at its middle: half of what leaving one out showed of one twice as long
    half = 1.959964 * (0.5 * 1e-6 + 0.5 * function.excess) ** 0.5
    assert (upper - lower)[1] == pytest.approx(2 * half, rel=1e-6)


def test_left_out_points_are_predicted_by_the_others_alone():
    rng = np.random.default_rng(3)
    y, sigma = rng.standard_normal(10), rng.uniform(0.5, 2, 10)
    missed, expected = left_out("linear", CELSIUS, y, sigma)
    assert missed.size == 8
    others = np.arange(10) != 4
    line = np.polyfit(CELSIUS[others], y[others], 1, w=1 / sigma[others])
    assert missed[3] == pytest.approx(y[4] - np.polyval(line, CELSIUS[4]))
    assert expected[3] > sigma[4] ** 2


@pytest.mark.parametrize(
    ("kind", "shape"),
    [
        ("linear", lambda t: 0.02 * t),
        ("quadratic", lambda t: (t / 40) ** 2),
        ("piecewise", lambda t: np.interp(t, [-30, 0, 30, 60], [0.8, 0.3, 0.6, 0.6])),
        ("arrhenius", lambda t: 4000 * (1 / (t + KELVIN) - 1 / 298.15)),
    ],
)
def test_the_function_that_made_the_estimates_is_chosen(kind, shape):
    rng = np.random.default_rng(4)
    choice = choose_function(
        CELSIUS, shape(CELSIUS) + 0.002 * rng.standard_normal(10), np.full(10, 0.002), logarithmic=True
    )
    assert choice.function.kind == kind
    assert min(c.excess for c in choice.candidates) == 0
    assert [c.kind for c in choice.candidates] == list(KINDS)


def test_what_does_not_depend_is_a_constant():
    y = np.random.default_rng(5).standard_normal(10)
    choice = choose_function(CELSIUS, y, np.ones(10), logarithmic=False, varies=False)
    assert choice.function.kind == "constant"
    assert choice.function.at(np.array([0.0]))[0] == pytest.approx(y.mean())


def test_few_set_points_are_joined_by_lines():
    choice = choose_function(CELSIUS[:3], np.array([0.0, 1.0, 0.0]), np.full(3, 0.01), logarithmic=False)
    assert choice.function.kind == "piecewise"
    assert not choice.candidates


def test_what_is_asked_for_is_taken_or_refused():
    ones = np.ones(3)
    assert choose_function(CELSIUS, np.ones(10), np.ones(10), logarithmic=True, kind="cubic").function.kind == "cubic"
    with pytest.raises(ValueError, match="4 set-points; .* 3"):
        choose_function(CELSIUS[:3], ones, ones, logarithmic=True, kind="cubic")
    with pytest.raises(ValueError, match="positive"):
        choose_function(CELSIUS[:3], ones, ones, logarithmic=False, kind="arrhenius")


def test_a_formula_can_be_put_in():
    function = fitted(
        "quadratic", CELSIUS, 1 + 0.5 * (CELSIUS - 25) + 0.25 * (CELSIUS - 25) ** 2, np.ones(10), logarithmic=False
    )
    assert function.text == "value = 1 +0.5 (T - 25) +0.25 (T - 25)^2"
    assert isinstance(function, TemperatureFunction)
    assert parameters_of("spline", 10) == 10


def test_a_function_that_the_set_points_contradict_is_not_taken():
    celsius = np.array([-30.0, -15, 0, 15, 30, 45, 60])
    sharp = np.interp(celsius, [-30, 0, 30, 60], [0.8, 0.48, 0.67, 0.67])  # as of a published sensor
    found = choose_function(celsius, sharp, np.full(7, 0.003), logarithmic=True)
    assert found.function.kind == "piecewise"
    assert found.function.at(celsius)[0] == pytest.approx(np.exp(sharp), rel=1e-9)
    scattered = sharp + 0.3 * np.random.default_rng(1).standard_normal(7)
    loose = choose_function(celsius, scattered, np.full(7, 0.3), logarithmic=True)
    assert loose.function.kind in ("constant", "linear", "arrhenius")


@pytest.mark.slow
def test_a_line_is_mostly_taken_for_a_line():
    rng = np.random.default_rng(6)
    kinds = [
        choose_function(
            CELSIUS, 0.005 * CELSIUS + 0.05 * rng.standard_normal(10), np.full(10, 0.05), logarithmic=True
        ).function.kind
        for _ in range(60)
    ]
    assert (
        sum(kind in ("linear", "arrhenius") for kind in kinds) >= 42
    )  # the simplest within a standard error of the best


def test_a_set_point_far_off_excuses_no_function_that_the_others_contradict():
    celsius = np.array([-30.0, -15, 0, 15, 30, 45, 60])
    sharp = np.interp(celsius, [-30, 0, 30, 60], [0.8, 0.48, 0.67, 0.67])
    sharp[3] += 0.6
    found = choose_function(celsius, sharp, np.full(7, 0.03), logarithmic=True)
    assert found.function.kind == "piecewise"
