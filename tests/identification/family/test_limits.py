"""Logs that give a limit only: the family with them is that of the exact likelihood, and their words."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize, stats

from imuwb.identification.family import Limits, Observations, judge, random_effects
from imuwb.identification.family.limits import matched, with_limits
from tests.identification.family.test_family import rows_of

SENSORS, LEVEL = 200, 0.95
NODES = np.linspace(-9, 9, 4001)
WEIGHTS = stats.norm.pdf(NODES)


def limited(rng, mean, between, error, where, logs=1):
    """Return sensor, ln θ with an error, and which logs give a limit instead: those below ``where``."""
    sensor = np.repeat(np.arange(SENSORS), logs)
    y = mean + between * rng.standard_normal(SENSORS)[sensor] + error * rng.standard_normal(sensor.size)
    return sensor, y, y < where


def parts(sensor, y, below, error, where, share):
    there = np.unique(sensor[~below])
    number = np.empty(SENSORS, dtype=int)
    number[np.append(there, np.setdiff1d(sensor, there))] = np.arange(SENSORS)
    count = int(below.sum())
    limits = Limits(
        number[sensor[below]],
        np.full(count, where),
        np.full(count, share),
        np.full(count, LEVEL),
        np.full(count, np.nan),
    )
    return rows_of(number[sensor[~below]], y[~below], error**2), limits


def factor(x, where, share):
    """Return the logarithm of the likelihood of ln θ = x of a log with a limit."""
    z = stats.norm.ppf(LEVEL) / (1 - share)
    return -((z * (np.exp(2 * (x - where)) - share)) ** 2) / 2


@pytest.mark.parametrize("share", [0.0, 0.4])
@pytest.mark.parametrize("spread", [0.2, 0.5, 1.5])
def test_the_family_with_limits_is_that_of_the_exact_likelihood(share, spread):
    rng = np.random.default_rng([1, round(10 * share)])
    error, where = 0.1, -0.1
    sensor, y, below = limited(rng, 0.0, spread, error, where)
    rows, limits = parts(sensor, y, below, error, where, share)
    fit, stand = with_limits(rows, limits, random_effects(rows))

    def loss(theta):
        mean, between = theta[0], np.exp(theta[1])
        there = stats.norm.logpdf(y[~below], mean, np.hypot(between, error)).sum()
        one = np.log(WEIGHTS @ np.exp(factor(mean + between * NODES, where, share)) / WEIGHTS.sum())
        return -(there + below.sum() * one)

    exact = optimize.minimize(loss, [0.0, np.log(spread)], method="Nelder-Mead").x
    sigma = fit.covariance[0, 0] ** 0.5
    assert fit.coefficients[0] == pytest.approx(exact[0], abs=0.1 * sigma)
    assert fit.between**0.5 == pytest.approx(np.exp(exact[1]), rel=0.02)
    assert stand.y.size == below.sum() > 30


def test_several_logs_of_a_sensor_share_what_is_its_own():
    """A limit beside four values of the same sensor says less of the family than one of a further sensor."""
    rng = np.random.default_rng(2)
    sensor = np.repeat(np.arange(30), 4)
    y = 0.3 * rng.standard_normal(30)[sensor] + 0.02 * rng.standard_normal(120)
    rows = rows_of(sensor, y, 0.02**2)
    start = random_effects(rows)
    nan, lowest = np.full(1, np.nan), int(np.argmin([y[sensor == one].mean() for one in range(30)]))

    def mean(of):
        limits = Limits(np.array([of]), np.array([-1.0]), np.zeros(1), np.array([LEVEL]), nan)
        return with_limits(rows, limits, start)[0].coefficients[0]

    assert start.coefficients[0] - mean(30) > 3 * abs(start.coefficients[0] - mean(lowest))


def below(rows, sensor, ends):
    count = len(ends)
    return Limits(
        np.full(count, sensor), np.array(ends), np.zeros(count), np.full(count, LEVEL), np.full(count, np.nan)
    )


@pytest.mark.parametrize("end", [-0.8, -2.0, -8.0])
def test_a_sensor_with_limits_far_below_is_outside_and_hides_no_other(end):
    rng = np.random.default_rng(6)
    y = 0.05 * rng.standard_normal(30)
    y[7] = 0.6
    rows = rows_of(np.arange(30), y, 1e-4)
    judged = judge({"N": rows}, limits={"N": below(rows, 30, [end])}).families["N"]
    assert [one.sensor for one in judged.outside] == [7]
    assert [one.sensor for one in judged.below] == [30]
    assert judged.between.value == pytest.approx(0.05, rel=0.4)
    assert (judged.limited, judged.sensors.sensor.max()) == (1, 29)


def test_limits_far_below_the_values_of_the_same_sensor_do_not_count():
    rng = np.random.default_rng(7)
    sensor = np.repeat(np.arange(20), 5)
    rows = rows_of(sensor, 0.05 * rng.standard_normal(20)[sensor] + 0.01 * rng.standard_normal(100), 1e-4)
    plain = judge({"N": rows}).families["N"]
    judged = judge({"N": rows}, limits={"N": below(rows, 4, [-1.0, 3.0])}).families["N"]
    assert (judged.limited, judged.contradicting) == (1, 1)
    assert judged.mean.value == pytest.approx(plain.mean.value, abs=1e-3)


def test_spreads_that_are_not_estimated_have_no_bound_and_truncated_families_no_tails():
    rng = np.random.default_rng(8)
    y = 0.3 * rng.standard_normal(60)
    rows = rows_of(np.arange(40), np.sort(y)[20:], 1e-3)
    limits = Limits(
        40 + np.arange(20), np.full(20, np.sort(y)[20]), np.zeros(20), np.full(20, LEVEL), np.full(20, np.nan)
    )
    judged = judge({"B": rows}, limits={"B": limits}).families["B"]
    assert judged.within.upper == np.inf
    assert judged.tails is None


@pytest.mark.parametrize("sigma", [1e-3, 0.1, 0.8, 2.0])
@pytest.mark.parametrize("mean", [-2.0, 0.0, 0.7])
@pytest.mark.parametrize("share", [0.0, 0.4, 0.95])
def test_an_observation_leaves_mean_and_variance_as_they_are(share, mean, sigma):
    limits = Limits(np.array([0]), np.zeros(1), np.array([share]), np.array([LEVEL]), np.full(1, np.nan))
    (precision,), (pull,) = matched(limits, np.array([mean]), np.array([sigma**2]))
    x = np.union1d(np.linspace(mean - 12 * sigma, mean + 12 * sigma, 100_001), np.linspace(-6.0, 3.0, 100_001))
    log = factor(x, 0.0, share) - (x - mean) ** 2 / (2 * sigma**2)
    weight = np.exp(log - log.max()) * np.gradient(x)
    first = weight @ x / weight.sum()
    second = weight @ (x - first) ** 2 / weight.sum()
    if second < sigma**2 * (1 - 1e-6):
        assert 1 / (precision + sigma**-2) == pytest.approx(second, rel=0.02)
        assert (pull + mean / sigma**2) / (precision + sigma**-2) == pytest.approx(first, abs=0.02 * second**0.5)
    else:
        assert precision < 1e-3 / sigma**2


@pytest.mark.parametrize(
    ("values", "limits", "spread", "ratio"),
    [(4, 4, 0.05, 0.01), (4, 4, 0.005, 0.5), (10, 15, 0.005, 0.5), (3, 6, 0.05, 1e-3)],
)
def test_limits_far_below_few_values_widen_the_family(values, limits, spread, ratio):
    rng = np.random.default_rng([9, values])
    rows = rows_of(np.arange(values), spread * rng.standard_normal(values), spread**2)
    further = replace(below(rows, 0, [np.log(ratio)] * limits), sensor=values + np.arange(limits))
    fit, stand = with_limits(rows, further, random_effects(rows))
    assert stand.y.max() < np.log(ratio)
    assert fit.coefficients[0] < 0.5 * np.log(ratio)
    assert fit.between**0.5 > -0.5 * np.log(ratio)


def test_a_limit_far_above_says_nothing_and_no_limits_change_nothing():
    rows = rows_of(np.arange(20), 0.1 * np.random.default_rng(3).standard_normal(20), 1e-4)
    start = random_effects(rows)
    far = Limits(np.array([3, 20]), np.full(2, 9.0), np.zeros(2), np.full(2, LEVEL), np.full(2, np.nan))
    for limits in (far, Limits.none()):
        fit, stand = with_limits(rows, limits, start)
        assert (fit.coefficients[0], fit.between, stand.y.size) == (
            pytest.approx(start.coefficients[0]),
            pytest.approx(start.between),
            0,
        )


def test_limits_of_a_family_without_scatter_are_counted():
    rows = rows_of(np.arange(12), np.zeros(12), 0.04)
    limits = Limits(np.arange(12, 20), np.full(8, 0.1), np.zeros(8), np.full(8, LEVEL), np.full(8, np.nan))
    fit, stand = with_limits(rows, limits, random_effects(rows))
    assert fit.between == 0
    assert stand.y.size == 8
    assert -0.3 < fit.coefficients[0] < -0.02


def test_a_judgement_counts_limits_at_one_temperature():
    rng = np.random.default_rng(4)
    sensor, y, below = limited(rng, 0.0, 0.3, 0.05, -0.1, logs=3)
    temperature = rng.normal(25, 6, y.size)
    warm = y + 0.02 * (temperature - 25)
    number = np.unique(sensor[~below], return_inverse=True)[1]
    rows = Observations(
        number, warm[~below], np.full(number.size, 0.05**2), np.full(number.size, np.inf), np.full(number.size, np.nan),
        temperature[~below], logarithmic=True,
    )  # fmt: skip
    count = int(below.sum())
    limits = Limits(
        number.max() + 1 + np.arange(count), -0.1 + 0.02 * (temperature[below] - 25), np.zeros(count), np.full(count, LEVEL),
        temperature[below],
    )  # fmt: skip
    plain, counted = (judge({"K": rows}, limits=one).families["K"] for one in (None, {"K": limits}))
    assert counted.slope is not None
    assert counted.slope.used
    assert (plain.limited, counted.limited) == (0, count)
    assert counted.mean.value < plain.mean.value - 0.05
    assert counted.sensors.sensor.max() == number.max()
    assert limits.at(0.02, 25).upper == pytest.approx(-0.1)
