import numpy as np
import pytest
from scipy import stats

from imuwb.analysis import Finding
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification import Coefficient
from imuwb.log import SECOND, ImuStream, Log, Provenance, Triad
from imuwb.recipes.repeatability import compare


def log(mean, name="a.csv"):
    time = np.arange(4) * SECOND
    value = np.array([[mean, mean, mean]] * 4) + np.array([[1.0], [-1.0], [2.0], [-2.0]])
    return Log(
        Provenance(f"/some/where/{name}", "csv", f"sha256:{name}{mean}", 0),
        imus=(ImuStream("/imu", Triad(time, value), None),),
    )


def nothing(upper=1.0):
    return Coefficient(None, None, upper, None)


def finding(n, spread=0.05, axis="gyro_x", **others):
    c = {
        "Q": nothing(),
        "B": nothing(),
        "K": nothing(),
        "N": Coefficient(n, n * np.exp(-spread), n * np.exp(spread), 1.0),
    }
    return Finding(axis, "likelihood", {**c, **others}, headline=True)


def compared(*sizes, spread=0.05):
    logs = [log(0.1 * i, f"{i}.csv") for i in range(len(sizes))]
    return compare(logs, [(finding(n, spread),) for n in sizes], 0.95)


def test_equal_logs_do_not_differ():
    found = compared(1.0, 1.01, 0.99)
    assert found.differ == ()
    assert found.names == ("0.csv", "1.csv", "2.csv")


def test_different_logs_differ():
    assert compared(1.0, 1.0, 1.5).differ == ("gyro_x N",)


def test_the_test_is_chi_square_of_logarithms():
    sizes, spread = np.array([1.0, 1.05, 1.12]), 0.06
    c = compared(*sizes, spread=spread).coefficients["gyro_x"]["N"]
    sigma = spread / 1.959964
    logs = np.log(sizes)
    statistic = np.sum((logs - logs.mean()) ** 2) / sigma**2
    assert c.statistic == pytest.approx(statistic, rel=1e-5)
    assert c.probability == pytest.approx(stats.chi2.sf(statistic, 2), rel=1e-4)
    assert c.mean == pytest.approx(np.exp(logs.mean()))
    assert np.log(c.mean_interval) == pytest.approx(logs.mean() + np.array([-1, 1]) * spread / 3**0.5, rel=1e-5)


def test_surer_logs_weigh_more():
    logs = [log(0.0), log(1.0)]
    c = compare(logs, [(finding(1.0, 0.01),), (finding(1.1, 0.1),)], 0.95).coefficients["gyro_x"]["N"]
    assert np.log(c.mean) == pytest.approx(np.log(1.1) / 101)


def test_chance_is_shared_among_all_comparisons():
    rng = np.random.default_rng(71)
    sigma = 0.05 / 1.96
    wrong = 0
    for _ in range(300):
        found = [
            tuple(finding(float(np.exp(sigma * rng.standard_normal())), axis=a) for a in ("gyro_x", "gyro_y", "gyro_z"))
            for _ in range(3)
        ]
        wrong += bool(compare([log(0.0), log(1.0), log(2.0)], found, 0.95).differ)
    assert wrong <= 10  # 1 % of 300, and its scatter


def test_a_term_that_fewer_than_two_logs_show_is_not_compared():
    logs = [log(0.0), log(1.0)]
    sure = Coefficient(2.0, 1.9, 2.1, 1.0)
    found = compare(logs, [(finding(1.0, K=sure),), (finding(1.0),)], 0.95).coefficients["gyro_x"]["K"]
    assert (found.values, found.mean, found.probability) == ((2.0, None), None, None)
    unsure = Coefficient(2.0, 0.0, 2.1, 1.0)  # may be 0: its logarithm has no scatter
    found = compare(logs, [(finding(1.0, K=sure),), (finding(1.0, K=unsure),)], 0.95).coefficients["gyro_x"]["K"]
    assert found.probability is None


def test_the_turn_on_bias_is_the_scatter_of_the_means():
    logs = [log(m) for m in (0.1, 0.3, 0.2, -0.1)]
    turn_on = compare(logs, [(finding(0.01),)] * 4, 0.95).turn_on["gyro_x"]
    assert turn_on.means == pytest.approx((0.1, 0.3, 0.2, -0.1))
    noise = 0.01**2 / 3  # of the mean of 3 s
    square = np.var([0.1, 0.3, 0.2, -0.1], ddof=1)
    assert turn_on.value == pytest.approx((square - noise) ** 0.5)
    assert turn_on.lower == pytest.approx((3 * square / stats.chi2.ppf(0.975, 3) - noise) ** 0.5)
    assert turn_on.upper == pytest.approx((3 * square / stats.chi2.ppf(0.025, 3) - noise) ** 0.5)
    assert turn_on.unit == "rad/s"


def test_means_that_scatter_as_the_noise_makes_them_have_no_turn_on_bias():
    logs = [log(m) for m in (0.1, 0.3, 0.2, -0.1)]
    turn_on = compare(logs, [(finding(1.0),)] * 4, 0.95).turn_on["gyro_x"]
    assert (turn_on.value, turn_on.lower) == (None, None)
    assert turn_on.upper >= 3**-0.5


def test_a_log_is_not_compared_with_itself():
    with pytest.raises(UsageError, match="given twice"):
        compare([log(0.0), log(0.0)], [(finding(1.0),)] * 2, 0.95)


def test_logs_without_a_common_axis_cannot_be_compared():
    with pytest.raises(MissingDataError, match="no axis is in all of them"):
        compare([log(0.0), log(1.0)], [(finding(1.0),), (finding(1.0, axis="gyro_y"),)], 0.95)


def test_only_headlines_are_compared():
    other = Finding("gyro_x", "psd", {"N": Coefficient(9.0, 8.9, 9.1, 1.0)})
    found = compare([log(0.0), log(1.0)], [(other, finding(1.0)), (finding(1.0), other)], 0.95)
    assert found.coefficients["gyro_x"]["N"].values == (1.0, 1.0)
