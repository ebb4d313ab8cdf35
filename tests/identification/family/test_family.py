"""The family of many sensors: random effects, sensors outside, changes, and the maximum statistic, against other programs and planted truth."""

import warnings

import numpy as np
import pytest
from scipy import stats
from scipy.special import digamma, loggamma, polygamma

from imuwb.identification.family import Observations, judge, observations, random_effects
from imuwb.identification.family.changes import changes
from imuwb.identification.family.maximum import largest_tail
from imuwb.identification.family.members import members, outside
from imuwb.identification.family.observations import degrees_of_freedom, usable
from imuwb.identification.family.scores import Errors, in_tails
from imuwb.identification.family.spread import between_spread, within_spread
from imuwb.identification.family.tails import heavy_tails, tails_together
from imuwb.statistics.distributions import chi_square_limits, student_score

MONTH = 30 * 86400.0


def rows_of(sensor, y, variance=0.0, time=None, half=np.inf):
    unknown = np.full(y.size, np.nan)
    full = (np.broadcast_to(value, y.shape).astype(float) for value in (variance, half))
    return Observations(sensor, y, *full, unknown if time is None else time, unknown, logarithmic=True)


def fleet(rng, sensors=40, logs=5, nu=4000.0, between=0.05, within=0.005, added=None, slope=0.0):
    sensor = np.repeat(np.arange(sensors), logs)
    months = np.tile(np.arange(float(logs)), sensors)
    temperature = rng.normal(25, 6, sensor.size)
    y = between * rng.standard_normal(sensors)[sensor] + within * rng.standard_normal(sensor.size)
    y += slope * (temperature - 25) + (0.0 if added is None else added(sensor, months))
    value = np.exp(y) * np.sqrt(rng.chisquare(nu, sensor.size) / nu)
    low, high = (np.sqrt(x) for x in chi_square_limits(0.95, nu))
    return observations(
        sensor, value, value * low, value * high, level=0.95, time=months * MONTH, temperature=temperature
    )


def test_the_restricted_likelihood_is_that_of_statsmodels():
    mixed = pytest.importorskip("statsmodels.regression.mixed_linear_model")
    rng = np.random.default_rng(3)
    sensor = np.repeat(np.arange(30), rng.integers(1, 9, 30))
    x = rng.standard_normal(sensor.size)
    y = 3 + 0.4 * x + rng.normal(0, 0.5, 30)[sensor] + rng.normal(0, 0.3, sensor.size)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        other = mixed.MixedLM(y, np.stack([np.ones_like(x), x], axis=1), sensor).fit(reml=True)
    own = random_effects(rows_of(sensor, y), x)
    assert own.coefficients == pytest.approx(other.fe_params, rel=1e-5)
    assert (own.between, own.within) == pytest.approx((other.cov_re[0, 0], other.scale), rel=1e-3)


def test_known_variances_count_as_in_a_meta_analysis():
    meta = pytest.importorskip("statsmodels.stats.meta_analysis")
    rng = np.random.default_rng(4)
    effect = rng.normal(0, np.sqrt(0.3), 25)
    equal = random_effects(rows_of(np.arange(25), effect, 0.1))
    # With equal variances DerSimonian and Laird, Paule and Mandel, and REML are the same.
    assert equal.between == pytest.approx(
        meta.combine_effects(effect, np.full(25, 0.1), method_re="chi2").tau2, rel=1e-6
    )
    variance = rng.uniform(0.02, 0.3, 25)
    own = random_effects(rows_of(np.arange(25), effect, variance))

    def loss(between):
        weight = 1 / (variance + between)
        mean = weight @ effect / weight.sum()
        return -np.log(weight).sum() + np.log(weight.sum()) + weight @ (effect - mean) ** 2

    assert loss(own.between) < min(loss(own.between * 0.99), loss(own.between * 1.01))


def test_the_likelihood_is_largest_with_several_logs_and_known_variances():
    rng = np.random.default_rng(5)
    sensor = np.repeat(np.arange(12), rng.integers(1, 6, 12))
    variance = rng.uniform(0.001, 0.01, sensor.size)
    y = rng.normal(0, 0.2, 12)[sensor] + rng.normal(0, np.sqrt(variance + 0.01))
    own = random_effects(rows_of(sensor, y, variance))

    def loss(between, within):
        whole = np.diag(variance + within) + between * (sensor[:, None] == sensor)
        inverse = np.linalg.inv(whole)
        information = inverse.sum()
        left = y - (inverse @ y).sum() / information
        return np.linalg.slogdet(whole)[1] + np.log(information) + left @ inverse @ left

    best = loss(own.between, own.within)
    for a, b in ((0.98, 1), (1.02, 1), (1, 0.98), (1, 1.02)):
        assert loss(own.between * a, own.within * b) > best


def test_a_sensor_alone_has_no_spread_between_sensors():
    own = random_effects(rows_of(np.zeros(6, int), np.array([1.0, 1.1, 0.9, 1.0, 1.05, 0.95]), 0.0001))
    assert own.free == (False, True)
    assert own.between == 0
    assert own.within == pytest.approx(np.var([1.0, 1.1, 0.9, 1.0, 1.05, 0.95], ddof=1) - 0.0001, rel=1e-4)
    assert random_effects(rows_of(np.arange(6), np.arange(6.0), 0.01)).free == (True, False)


def test_scores_are_as_improbable_as_their_values():
    x = np.array([-4.0, -1.0, 0.5, 3.0, 5.0])
    assert stats.norm.cdf(student_score(x, 7.0)) == pytest.approx(stats.t.cdf(x, 7), rel=1e-8)


@pytest.mark.parametrize("nu", [1.0, 8.0, 5000.0])
def test_tails_of_few_degrees_of_freedom_are_those_of_chi_square_and_f(nu):
    half = nu / 2
    sigma, mean = polygamma(1, half) ** 0.5 / 2, (digamma(half) - np.log(half)) / 2
    x = np.array([-9.0, -5.0, -2.5, 2.5])
    one = Errors(np.ones(4), np.full(4, half), np.arange(4))
    chi = nu * np.exp(2 * (x * sigma + mean))
    tail = np.where(x < 0, stats.chi2.cdf(chi, nu), stats.chi2.sf(chi, nu))
    assert stats.norm.sf(np.abs(in_tails(x, np.full(4, sigma**2), one))) == pytest.approx(tail, rel=0.05)
    two = Errors(np.tile([1.0, -1.0], 4), np.full(8, half), np.repeat(np.arange(4), 2))
    ratio = np.exp(2 * np.abs(x) * sigma * 2**0.5)
    assert stats.norm.sf(np.abs(in_tails(x, np.full(4, 2 * sigma**2), two))) == pytest.approx(
        stats.f.sf(ratio, nu, nu), rel=0.05
    )


@pytest.mark.parametrize(
    ("kind", "y", "weight"),
    [
        ("log", [0.3, 0, -1.5, 0.2, 0.1], [-0.25, -0.25, 1, -0.25, -0.25]),
        ("log", [-0.3, 0, 0.2, 0.1, -1.5], [-0.25, -0.25, -0.25, -0.25, 1]),
        ("step", [0.6, 0.5, -0.5, -0.6, -0.5], [-1 / 2, -1 / 2, 1 / 3, 1 / 3, 1 / 3]),
        ("trend", [0.8, 0.4, 0, -0.4, -0.8], [-0.4, -0.2, 0, 0.2, 0.4]),
    ],
)
def test_a_change_is_as_improbable_as_the_characteristic_function_says(kind, y, weight):
    """The tail by Gil-Pelaez's integral; a normal one is 2 to 20 times too small."""
    half, within, w, y = 4.0, 0.002, np.array(weight), np.array(y)
    rows = rows_of(np.zeros(5, int), y, polygamma(1, half) / 4, np.arange(5.0) * MONTH, half)
    (found,) = changes(rows, within, 0.0, 0.95, np.ones(5, dtype=bool))
    u = (np.arange(20000) + 0.5) * 0.01
    at = 0.5j * u[:, None] * w
    phi = (loggamma(half + at) - loggamma(half) - at * digamma(half)).sum(axis=1) - within * (w @ w) * u**2 / 2
    tail = 0.5 - abs(np.imag(np.exp(phi - 1j * u * (w @ y))).dot(0.01 / (np.pi * u)))
    assert found.kind == kind
    assert stats.norm.sf(abs(found.score)) == pytest.approx(tail, rel=0.05)


def test_the_tail_of_a_sensor_comes_from_its_own_logs():
    rng = np.random.default_rng(14)
    rows = fleet(rng, 60, 3, nu=8.0, between=0.0, within=0.0)
    own = members(rows, 0.0)
    kept = np.arange(60) % 2 == 1
    part = own.of(kept)
    assert part.errors.owner.tolist() == np.repeat(np.arange(30), 3).tolist()
    assert own.errors.weight == pytest.approx(1 / 3)
    scores = np.full(30, -6.0)
    among = in_tails(scores, part.variance, part.errors)
    alone = stats.norm.sf(
        -in_tails(scores[:1], part.variance[:1], Errors(np.full(3, 1 / 3), rows.half[:3], np.zeros(3, int)))
    )
    assert stats.norm.sf(-among) == pytest.approx(np.repeat(alone, 30), rel=1e-6)
    assert alone > 5 * stats.norm.sf(6.0)


def test_the_bound_of_the_maximum_is_close_and_never_too_small():
    correlation = np.array([[1, 0.6, 0.3], [0.6, 1, 0.5], [0.3, 0.5, 1]])
    for limit in (2.5, 3.5):
        inside = stats.multivariate_normal(cov=correlation).cdf(np.full(3, limit), lower_limit=np.full(3, -limit))
        bound = largest_tail(limit, 3, np.array([0.6, 0.5]))
        assert 1 - inside - 3e-5 <= bound <= 1.03 * (1 - inside)


def test_degrees_of_freedom_come_back_from_an_interval():
    for nu in (3.0, 8.0, 500.0):
        low, high = chi_square_limits(0.9, nu)
        assert degrees_of_freedom(np.array([np.log(high / low) / 2]), 0.9)[0] == pytest.approx(nu, rel=1e-5)


def test_logarithms_of_few_degrees_of_freedom_have_no_mean_error():
    rng = np.random.default_rng(6)
    rows = fleet(rng, 4000, 1, nu=6.0, between=0.0, within=0.0)
    assert rows.y.mean() == pytest.approx(0, abs=4 * rows.y.std() / rows.y.size**0.5)
    assert rows.y.var() == pytest.approx(rows.variance.mean(), rel=0.1)
    assert rows.half == pytest.approx(3.0, rel=1e-5)


def test_rows_without_an_interval_are_not_used():
    value, nan = np.array([1.0, 1.0, 1.0, np.nan, 1.0]), np.nan
    lower, upper = np.array([0.9, 0.0, nan, nan, 1.0]), np.array([1.1, 1.1, 1.1, 1.1, 1.0])
    assert usable(value, lower, upper).tolist() == [True, False, False, False, False]
    assert usable(value, lower, upper, logarithmic=False).tolist() == [True, True, False, False, False]


def test_three_sensors_outside_do_not_hide_each_other():
    sizes = {3: 0.4, 11: 0.42, 29: -0.4}
    rows = fleet(np.random.default_rng(7), added=lambda sensor, _: sum(v * (sensor == k) for k, v in sizes.items()))
    one = outside(members(rows, 0.005**2), 0.003)
    found, family = one.outside, one.family
    assert {one.sensor for one in found} == set(sizes)
    assert family.between**0.5 == pytest.approx(0.05, rel=0.3)


@pytest.mark.parametrize("count", [5, 8, 12, 30])
def test_a_sensor_is_as_improbable_as_the_deleted_residual_of_student(count):
    """Without errors of the logs the family is a normal sample, and the probability is exact: Bonferroni's, of Student's variable."""
    drawn = np.random.default_rng(count).standard_normal(count)
    drawn[2] = 9.0
    (found,) = outside(members(rows_of(np.arange(count), drawn, 1e-12), 0.0), 0.2).outside
    others = np.delete(drawn, 2)
    residual = (9.0 - others.mean()) / (others.std(ddof=1) * np.sqrt(1 + 1 / (count - 1)))
    steps = {5: 2, 8: 3, 12: 4, 30: 1}[count]
    assert found.sensor == 2
    assert found.probability == pytest.approx(steps * count * 2 * stats.t.sf(residual, count - 2), rel=0.02)


@pytest.mark.parametrize("count", [5, 6, 9, 10, 11, 20, 21, 40, 120])
def test_three_tenths_of_the_sensors_far_outside_are_found_in_families_of_all_sizes(count):
    most = -(-3 * count // 10)
    drawn = np.random.default_rng([count, 1]).standard_normal(count)
    drawn[:most] += 200.0
    found = outside(members(rows_of(np.arange(count), drawn, 0.01), 0.0), 0.001)
    assert {one.sensor for one in found.outside} == set(range(most))
    assert max(one.probability for one in found.outside) < 0.001
    assert found.more
    assert found.family.between < 4


@pytest.mark.parametrize("half", [np.inf, 4.0])
@pytest.mark.parametrize("count", [6, 15, 40])
def test_the_limits_of_sensors_are_where_the_most_distant_one_is_found(count, half):
    """Also where the errors of the logs are skewed: the lower limit is farther away then."""
    rng = np.random.default_rng([17, count])
    variance = 1e-10 if half == np.inf else polygamma(1, half) / 4
    y = 0.05 * rng.standard_normal(count) + (0.0 if half == np.inf else np.log(rng.chisquare(2 * half, count)) / 2)

    def judged(values):
        return judge({"N": rows_of(np.arange(count), values, variance, half=half)}, error=0.03).families["N"]

    one = judged(y)
    assert not one.outside
    middle = one.mean.value
    worst = int(np.abs(y - middle).argmax())
    for end in one.sensor_limits:
        for share, seen in ((1.05, True), (0.95, False)):
            moved = y.copy()
            moved[worst] = middle + share * (end - middle)
            assert (worst in {found.sensor for found in judged(moved).outside}) is seen, (end, share)
    low, high = (abs(end - middle) for end in one.sensor_limits)
    assert (low > 1.2 * high) is (half < np.inf)


@pytest.mark.parametrize(
    ("kind", "added", "size"),
    [
        ("trend", lambda m: 0.12 * m / 4, 0.12),
        ("step", lambda m: 0.12 * (m > 1.5), 0.12),
        ("log", lambda m: 0.3 * (m == 2), 0.3),
        ("log", lambda m: 0.3 * (m == 0), 0.3),
    ],
)
def test_a_change_is_found_with_its_kind_and_size(kind, added, size):
    rows = fleet(np.random.default_rng(8), added=lambda sensor, m: (sensor == 7) * added(m))
    (found,) = judge({"N": rows}).families["N"].changes
    assert (found.sensor, found.kind) == (7, kind)
    assert size in found.size
    assert found.probability < 1e-3
    if kind == "log":
        assert added(rows.time[found.rows[0]] / MONTH) == size
    assert judge({"N": rows}).families["N"].outside == ()


def test_a_step_that_is_the_largest_scatter_of_a_small_fleet_is_a_step():
    """While it is found, the step is in the variance from log to log, and a line explains it as well."""
    rows = fleet(
        np.random.default_rng(18), sensors=12, logs=4, added=lambda sensor, m: (sensor == 3) * (m > 1.5) * np.log(3)
    )
    (found,) = judge({"N": rows}).families["N"].changes
    assert (found.sensor, found.kind) == (3, "step")
    assert np.log(3) in found.size
    assert found.size.upper - found.size.lower < 0.2


def test_a_fleet_of_which_all_sensors_change_is_judged():
    rows = fleet(np.random.default_rng(19), sensors=1, logs=60, added=lambda _, m: 1.0 * (m > 30))
    judged = judge({"N": rows}).families["N"]
    assert [one.kind for one in judged.changes] == ["step"]
    assert np.isfinite(judged.mean.value)


def test_one_log_far_off_hides_no_trend():
    def added(sensor, months):
        return (sensor == 7) * 0.12 * months / 4 + (sensor == 20) * (months == 3) * 2.0

    found = judge({"N": fleet(np.random.default_rng(9), added=added)}).families["N"].changes
    assert {(one.sensor, one.kind) for one in found} == {(7, "trend"), (20, "log")}


def test_a_fleet_without_any_has_no_finding():
    names = ("x", "y", "z")
    for seed in range(3):
        rng = np.random.default_rng([10, seed])
        judged = judge({name: fleet(rng) for name in names}, error=0.001).families
        assert all(not one.found for one in judged.values())
        assert all(one.slope is not None and not one.slope.used for one in judged.values())


def test_temperature_is_taken_off_and_makes_no_findings():
    judged = judge({"N": fleet(np.random.default_rng(11), slope=0.01)}).families["N"]
    assert judged.slope is not None
    assert judged.slope.used
    assert 0.01 in judged.slope.per_degree
    assert not judged.found
    assert (judged.within.value or 0.0) < 0.02


def test_intervals_of_the_spread_have_the_stated_tails():
    rows = fleet(np.random.default_rng(12), between=0.1, within=0.03)
    fit = random_effects(rows)
    sensors = members(rows, fit.within)
    between, within = (
        between_spread(sensors, fit.between, fit.errors[0], 0.95),
        within_spread(rows, fit.within, fit.errors[1], 0.95),
    )
    assert between.lower < 0.1 < between.upper
    assert within.lower < 0.03 < within.upper
    weight = 1 / (sensors.variance + between.upper**2)
    square = weight @ (sensors.mean - np.average(sensors.mean, weights=weight)) ** 2
    assert stats.chi2.cdf(square, sensors.mean.size - 1) == pytest.approx(0.025, rel=1e-4)
    none = fleet(np.random.default_rng(13), between=0.0, within=0.0)
    assert within_spread(none, 0.0, 1e-6, 0.95).value is None
    calm = rows_of(np.repeat(np.arange(4), 2), np.zeros(8), 0.01)
    assert within_spread(calm, 0.0, 1e-6, 0.95).upper == pytest.approx((1.645e-3) ** 0.5, rel=1e-3)


def test_logs_of_one_time_have_no_change():
    rows = rows_of(np.repeat([0, 1], 3), np.array([1.0, 2, 9, 4, 5, 6]), 0.01, np.zeros(6))
    assert changes(rows, 0.0, 0.0, 0.95, np.ones(6, dtype=bool)) == []


def tails_of(drawn, variance=1e-4, half=np.inf):
    own = members(rows_of(np.arange(drawn.size), drawn, variance, half=half), 0.0)
    return heavy_tails(own, own.family())


def test_heavy_tails_are_named_and_normal_ones_at_most_as_often_as_stated():
    rng = np.random.default_rng(15)
    normal = np.array([tails_of(rng.standard_normal(60)) for _ in range(200)])
    assert 0 < np.mean(normal <= 0.1) < 0.17
    heavy = [tails_of(rng.standard_t(4, 400)) for _ in range(5)]
    assert max(heavy) < 0.01
    # The kurtosis is scipy's, where sampling errors are negligible.
    drawn = rng.standard_normal(80) ** 3
    assert tails_of(drawn, 1e-12) == pytest.approx(stats.kurtosistest(drawn, alternative="greater").pvalue, rel=1e-6)


def test_tails_are_not_told_from_few_or_uncertain_sensors():
    rng = np.random.default_rng(16)
    assert tails_of(rng.standard_normal(19)) is None
    assert tails_of(0.1 * rng.standard_normal(60), 0.07, half=4.0) is None
    assert tails_together([]) is None
    assert tails_together([0.004, 0.9, 0.9]) == pytest.approx(0.024)
    assert tails_together([0.02] * 4) == pytest.approx(2 * stats.norm.sf(2 * stats.norm.isf(0.02)))
    assert tails_together([0.0, 1.0]) == 0.0
