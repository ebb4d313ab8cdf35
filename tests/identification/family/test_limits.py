"""Logs that give a limit only: the family with them is that of the exact likelihood, and their words."""

import numpy as np
import pytest
from scipy import optimize, stats

from imuwb.identification.family import Limits, Observations, judge, random_effects
from imuwb.identification.family.limits import with_limits
from tests.identification.family.test_family import rows_of

SENSORS, LEVEL = 200, 0.95
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(80)


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
@pytest.mark.parametrize("where", [-0.3, 0.1])
def test_the_family_with_limits_is_that_of_the_exact_likelihood(share, where):
    rng = np.random.default_rng([1, round(10 * share)])
    error = 0.1
    sensor, y, below = limited(rng, 0.0, 0.4, error, where)
    rows, limits = parts(sensor, y, below, error, where, share)
    fit, stand = with_limits(rows, limits, random_effects(rows))

    def loss(theta):
        mean, between = theta[0], np.exp(theta[1])
        there = stats.norm.logpdf(y[~below], mean, np.hypot(between, error)).sum()
        one = np.log(WEIGHTS @ np.exp(factor(mean + between * NODES, where, share)) / WEIGHTS.sum())
        return -(there + below.sum() * one)

    exact = optimize.minimize(loss, [0.0, np.log(0.4)], method="Nelder-Mead").x
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
    assert (plain.limits, counted.limits) == (0, count)
    assert counted.mean.value < plain.mean.value - 0.05
    assert counted.sensors.sensor.max() == number.max()
    assert limits.at(0.02, 25).upper == pytest.approx(-0.1)
