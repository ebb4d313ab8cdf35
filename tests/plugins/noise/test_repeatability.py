import numpy as np
import pytest
from scipy import stats

from imuwb.analysis import Finding
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.coefficient import interval
from imuwb.log import SECOND, ImuStream, Log, Provenance, Triad
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb_plugins.noise.repeatability import compare
from imuwb_plugins.noise.show_repeatability import draw


def log(mean, name="a.csv", step=1):
    time = np.arange(4) * SECOND * step
    value = np.array([[mean, mean, mean]] * 4) + np.array([[1.0], [-1.0], [2.0], [-2.0]])
    return Log(
        Provenance(f"/some/where/{name}", "csv", f"sha256:{name}{mean}", 0),
        imus=(ImuStream("/imu", Triad(time, value), None),),
    )


def both(one, other, letter="K"):
    """Return the comparison of one coefficient of two logs of one length."""
    findings = [(finding(1.0, **{letter: one}),), (finding(1.0, **{letter: other}),)]
    return compare([log(0.0), log(1.0)], findings, 0.95).coefficients["gyro_x"][letter]


def nothing(upper=1.0):
    return Coefficient(None, None, upper)


def finding(n, spread=0.05, axis="gyro_x", **others):
    c = {
        "Q": nothing(),
        "B": nothing(),
        "K": nothing(),
        "N": Coefficient(n, n * np.exp(-spread), n * np.exp(spread), at=1.0),
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


def test_the_test_is_chi_square_of_squares():
    sizes, spread = np.array([1.0, 1.05, 1.12]), 0.06
    c = compared(*sizes, spread=spread).coefficients["gyro_x"]["N"]
    square = sizes**2
    sigma = square * (np.exp(2 * spread) - np.exp(-2 * spread)) / (2 * 1.959964)
    best = np.average(square, weights=sigma**-2)
    statistic = np.sum(((square - best) / sigma) ** 2)
    assert c.statistic == pytest.approx(statistic, rel=1e-5)
    assert c.probability == pytest.approx(stats.chi2.sf(statistic, 2), rel=1e-4)
    assert c.mean.value == pytest.approx(np.mean(square) ** 0.5)
    assert (c.mean.lower, c.mean.upper) == pytest.approx(
        interval(np.mean(square), np.sum(sigma**2) ** 0.5 / 3, 0.95), rel=1e-6
    )
    assert c.mean.lower < c.mean.value < c.mean.upper


def test_longer_logs_weigh_more_and_not_surer_ones():
    logs = [log(0.0), log(1.0, step=3)]  # 3 s and 9 s
    for spreads in ((0.01, 0.1), (0.1, 0.01)):
        found = [(finding(1.0, spreads[0]),), (finding(1.1, spreads[1]),)]
        c = compare(logs, found, 0.95).coefficients["gyro_x"]["N"]
        assert c.mean.value == pytest.approx(((1 + 3 * 1.1**2) / 4) ** 0.5)


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


SURE = Coefficient(2.0, 1.9, 2.1, at=1.0)
ONE_SIDED, TWO_SIDED = stats.norm.ppf([0.95, 0.975])


def test_a_log_with_a_limit_alone_counts_with_zero():
    found = both(SURE, nothing(1.0))
    sigma = np.array([(2.1**2 - 1.9**2) / (2 * TWO_SIDED), 1 / ONE_SIDED])
    assert [c.value for c in found.logs] == [2.0, None]
    assert found.mean.value == pytest.approx(2**0.5)  # of 4 and 0
    assert (found.mean.lower, found.mean.upper) == pytest.approx(interval(2.0, np.sum(sigma**2) ** 0.5 / 2, 0.95))
    assert found.statistic == pytest.approx(16 / np.sum(sigma**2))
    assert found.probability < 1e-6
    assert both(SURE, nothing(5.0)).probability > 0.05  # it may well be there and not be seen


def test_a_value_that_may_be_0_has_the_error_that_its_upper_end_shows():
    found = both(SURE, Coefficient(1.0, 0.0, 2.5, at=1.0))
    sigma = np.array([(2.1**2 - 1.9**2) / (2 * TWO_SIDED), (2.5**2 - 1) / TWO_SIDED])
    assert found.mean.value == pytest.approx(2.5**0.5)
    assert found.statistic == pytest.approx(9 / np.sum(sigma**2))


def test_of_what_no_log_shows_all_together_have_a_lower_limit_than_each():
    found = both(nothing(1.0), nothing(1.0))
    assert (found.mean.value, found.mean.lower, found.statistic) == (None, None, 0)
    assert found.mean.upper == pytest.approx(0.5**0.25)


def test_beside_what_nothing_bounds_one_log_stands_alone():
    found = both(SURE, UNKNOWN)
    assert [c.value for c in found.logs] == [2.0, None]
    assert (found.mean.value, found.mean.lower, found.mean.upper) == (2.0, SURE.lower, SURE.upper)
    assert found.probability is None


@pytest.mark.parametrize("scatter", [(0.05, 0.1, 0.15), (0.1, 0.1, 0.1), (0.02, 0.05, 0.15)])
def test_the_common_interval_contains_the_truth_as_often_as_its_level(scatter):
    rng = np.random.default_rng(72)
    sigma, inside = np.array(scatter), 0
    logs = [log(0.0), log(1.0), log(2.0)]
    for _ in range(200):
        found = [(finding(1.0, K=estimated(*x)),) for x in zip(1 + sigma * rng.standard_normal(3), sigma, strict=True)]
        mean = compare(logs, found, 0.95).coefficients["gyro_x"]["K"].mean
        inside += mean.lower < 1 < mean.upper
    assert 0.92 * 200 <= inside <= 0.98 * 200


@pytest.mark.parametrize("truth", [0.0, 1.0])
def test_what_each_log_hardly_sees_is_not_held_for_sure_and_lies_below_the_common_limit(truth):
    """A square of no or one standard error: the logs have a limit, or an interval as the estimators give it."""
    rng = np.random.default_rng(73)
    above, wrong = 0, 0
    logs = [log(0.0), log(1.0), log(2.0)]
    for _ in range(200):
        squares = truth + rng.standard_normal(3)
        each = [
            Coefficient(x**0.5, *interval(x, 1.0, 0.95), at=1.0) if x > 0 else nothing(ONE_SIDED**0.5) for x in squares
        ]
        mean = compare(logs, [(finding(1.0, K=x),) for x in each], 0.95).coefficients["gyro_x"]["K"].mean
        above += mean.upper > truth**0.5
        wrong += (mean.lower or 0) > truth**0.5
    assert above >= 190
    assert wrong <= 8


def estimated(square, sigma):
    """Return what an estimator says that found this square, far from 0, and knows its standard error."""
    return Coefficient(square**0.5, (square - TWO_SIDED * sigma) ** 0.5, (square + TWO_SIDED * sigma) ** 0.5, at=1.0)


def test_the_table_shows_all_logs_together_beside_each():
    notes, tables = [], []

    class Review:
        note, table, figure = notes.append, tables.append, print

    found = compare([log(0.0), log(1.0, "b.csv")], [(finding(1.0, K=SURE),), (finding(1.0),)], 0.95)
    draw(found, Review())
    table = tables[0]
    assert table.headings[2:4] == ("a.csv", "b.csv")
    rows = {row[1]: row[2:] for row in table.rows}
    assert "[" in rows["K"][0]
    assert rows["K"][1].startswith("< ")
    assert "[" in rows["K"][2]
    assert rows["K"][3].endswith("DIFFER")
    assert rows["Q"][2].startswith("< ")
    assert notes[0].id == "differ"
    assert "gyro_x K" in notes[0]


def test_coefficients_are_drawn_from_log_to_log_with_their_intervals():
    figures = []

    class Review:
        def note(self, text):
            pass

        def table(self, table):
            pass

        def figure(self, figure):
            figures.append(figure)

    logs = [log(0.0), log(1.0, "b.csv")]
    draw(compare(logs, [(finding(1.0),), (finding(2.0),)], 0.95), Review())
    (found,) = [f for f in figures if "random walk N" in f.title]
    (curve,) = found.curves
    assert found.x_title == "log [1]; 1: a.csv, 2: b.csv"
    assert (found.x_scale, found.y_scale) == ("whole", "linear")  # a logarithmic axis would show one line
    assert curve.label == "gyro x"
    assert curve.y[1] / curve.y[0] == pytest.approx(2)
    assert (curve.lower < curve.y).all()
    assert (curve.y < curve.upper).all()


def test_the_turn_on_bias_is_the_scatter_of_the_means():
    logs = [log(m) for m in (0.1, 0.3, 0.2, -0.1)]
    turn_on = compare(logs, [(finding(0.01),)] * 4, 0.95).turn_on["gyro_x"]
    assert turn_on.means == pytest.approx((0.1, 0.3, 0.2, -0.1))
    noise = 0.01**2 / 3  # of the mean of 3 s
    square = np.var([0.1, 0.3, 0.2, -0.1], ddof=1)
    assert turn_on.sigma.value == pytest.approx((square - noise) ** 0.5)
    assert turn_on.sigma.lower == pytest.approx((3 * square / stats.chi2.ppf(0.975, 3) - noise) ** 0.5)
    assert turn_on.sigma.upper == pytest.approx((3 * square / stats.chi2.ppf(0.025, 3) - noise) ** 0.5)
    assert turn_on.sigma.unit == "rad/s"


def test_each_process_within_the_logs_has_its_own_share_of_the_means_scatter():
    """Of a mean over T = 3 s: N²/T, 2 ln2/pi B², and K² T/3 of a walk from 0."""
    others = {"B": Coefficient(0.03, 0.02, 0.04), "K": Coefficient(0.05, 0.04, 0.06)}
    logs = [log(m) for m in (0.1, 0.3, 0.2, -0.1)]
    sigma = compare(logs, [(finding(0.02, **others),)] * 4, 0.95).turn_on["gyro_x"].sigma
    noise = 0.02**2 / 3 + 2 * np.log(2) / np.pi * 0.03**2 + 0.05**2 * 3 / 3
    square = np.var([0.1, 0.3, 0.2, -0.1], ddof=1)
    assert sigma.value == pytest.approx((square - noise) ** 0.5, rel=1e-12)


def test_means_that_scatter_as_the_noise_makes_them_have_no_turn_on_bias():
    logs = [log(m) for m in (0.1, 0.3, 0.2, -0.1)]
    turn_on = compare(logs, [(finding(1.0),)] * 4, 0.95).turn_on["gyro_x"]
    assert (turn_on.sigma.value, turn_on.sigma.lower) == (None, None)
    assert turn_on.sigma.upper >= 3**-0.5


def test_a_log_is_not_compared_with_itself():
    with pytest.raises(UsageError, match="a.csv, .*a.csv: .*twice"):
        compare([log(0.0), log(0.0)], [(finding(1.0),)] * 2, 0.95)


def test_logs_without_a_common_axis_cannot_be_compared():
    with pytest.raises(MissingDataError, match="no axis is in all"):
        compare([log(0.0), log(1.0)], [(finding(1.0),), (finding(1.0, axis="gyro_y"),)], 0.95)


def test_only_headlines_are_compared():
    other = Finding("gyro_x", "psd", {"N": Coefficient(9.0, 8.9, 9.1, at=1.0)})
    found = compare([log(0.0), log(1.0)], [(other, finding(1.0)), (finding(1.0), other)], 0.95)
    assert [c.value for c in found.coefficients["gyro_x"]["N"].logs] == [1.0, 1.0]
