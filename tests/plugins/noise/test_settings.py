import numpy as np
import pytest

from imuwb.analysis import Case
from imuwb.cli.studies import cases
from imuwb.errors import MissingDataError
from imuwb.log import SECOND, ImuStream, Log, Provenance, Triad
from imuwb.stochastic import WhiteNoise
from imuwb_plugins.noise import show_settings
from imuwb_plugins.noise.answer import answer_study
from imuwb_plugins.noise.parameters import Parameters
from imuwb_plugins.noise.settings import AxisCase, CaseResult, aliased, rule, study

N = 1e-3


def white(samples, rate, seed=61):
    rng = np.random.default_rng(seed)
    values = np.stack([WhiteNoise(N).sample(samples, 1 / rate, rng) for _ in range(3)], axis=1)
    time = np.arange(samples) * (SECOND // rate)
    return Log(Provenance("fast.csv", "csv", "sha256:0", 0), imus=(ImuStream("/imu", Triad(time, values), None),))


@pytest.fixture(scope="module")
def grid():
    """Return the study of a fast sensor's bandwidths and rates."""
    return study(cases([white(200_000, 1000)], ["bandwidth=98,42,20", "rate=200,100,50"]), Parameters())


@pytest.mark.slow
def test_every_setting_is_there_at_its_rate(grid):
    assert [c.settings for c in grid.cases] == [
        {"bandwidth": b, "rate": r} for b in ("98", "42", "20") for r in ("200", "100", "50")
    ]
    for c in grid.cases:
        assert c.rate_hz["gyro"] == pytest.approx(float(c.settings["rate"]))
        assert set(c.axes) == {"gyro_x", "gyro_y", "gyro_z"}


def test_n_is_kept_where_the_rate_is_twice_the_bandwidth_and_grows_where_it_is_not(grid):
    for c in grid.cases:
        bandwidth, rate = float(c.settings["bandwidth"]), float(c.settings["rate"])
        # What of the filter's white noise folds to 0 Hz: the sum of its gain at all multiples of the rate.
        f = np.arange(-10, 11) * rate
        folded = (1 / (1 + (f / bandwidth) ** 4)).sum() ** 0.5
        for found in c.axes.values():
            assert found.coefficients["N"].value == pytest.approx(N * folded, rel=0.12), c.settings


def test_the_rule_is_found(grid):
    assert [tested.axis for tested in grid.rule] == ["gyro_x", "gyro_y", "gyro_z"]
    for tested in grid.rule:
        assert tested.best.value == pytest.approx(N, rel=0.05)
        assert tested.broken.lower > 1.3
        assert tested.kept.value < 1.1
        assert tested.kept.lower < tested.kept.value < tested.kept.upper
        assert tested.holds in ("yes", "open")


def test_what_a_filter_takes_for_q_is_n_squared_of_white_samples():
    (found,) = study([Case({}, white(20_000, 100))], Parameters()).cases
    for axis in found.axes.values():
        assert axis.deviation == pytest.approx(N * 10, rel=0.03)
        assert axis.per_step == pytest.approx(N**2, rel=0.05)
    assert found.rate_hz == {"gyro": pytest.approx(100)}


def result(bandwidth, rate, n, wide=1e-9):
    from imuwb.statistics import Coefficient

    none = np.empty(0)
    low, high = (None, 1.0) if n is None else (n * (1 - wide), n * (1 + wide))
    axis = AxisCase(none, none, {"N": Coefficient(n, low, high, at=1.0)}, 1.0, 1.0)
    return CaseResult(
        {"bandwidth": str(bandwidth)}, {"gyro": rate}, {"gyro_x": axis}, {"gyro": rate / (2 * bandwidth)}, {}, ""
    )


@pytest.mark.parametrize(
    ("sizes", "wide", "holds"),
    [
        ((1.0, 1.05, 1.0, 1.5), 1e-9, "yes"), ((1.0, 1.2, 1.0, 1.5), 1e-9, "no"), ((1.0, 1.0, 1.0, 1.05), 1e-9, "no"),
        ((1.0, None, 1.0, 1.5), 1e-9, "yes"), ((1.0, None, 1.0, 1.05), 1e-9, "no"), ((1.0, 1.05, 1.0, 1.5), 0.05, "open"), ((1.0, 1.0, 1.0, 1.2), 0.1, "open"),
        ((1.0, 1.3, 1.0, 1.5), 0.05, "no"),
    ],
)  # fmt: skip
def test_the_rule_holds_where_n_is_kept_above_and_grows_below(sizes, wide, holds):
    grid = zip(((20, 100), (40, 100), (20, 50), (40, 50)), sizes, strict=True)
    (tested,) = rule(tuple(result(b, r, n, wide) for (b, r), n in grid))
    assert tested.holds == holds
    assert tested.best.value == 1.0
    assert tested.broken.value == pytest.approx(sizes[3])


def test_the_ratio_of_two_coefficients_has_the_width_of_both():
    grid = ((10, 100, 1.0), (20, 100, 1.2), (25, 100, 1.1), (10, 50, 1.0))
    (tested,) = rule(tuple(result(b, r, n, 0.1) for b, r, n in grid))
    assert tested.kept.upper / tested.kept.value == pytest.approx(np.exp(np.hypot(np.log(1.1), np.log(1 / 0.9))))


def test_white_noise_folds_as_the_filter_lets_it():
    assert aliased(np.array([100.0])) == pytest.approx([1.0], abs=1e-6)
    assert aliased(np.array([0.5])) == pytest.approx([(1 + 2 * sum(1 / (1 + k**4) for k in range(1, 201))) ** 0.5])


def test_without_a_grid_there_is_no_rule():
    assert rule((result(20, 100, 1.0), result(40, 100, 1.0))) == ()
    (found,) = study([Case({"rate": "100"}, white(2000, 100))], Parameters()).cases
    assert rule((found,)) == ()


def test_a_setting_that_leaves_too_little_is_named():
    with pytest.raises(MissingDataError, match=r"fast\.csv, rate 10 Hz: .*256"):
        study(cases([white(1000, 100)], ["rate=50,10"]), Parameters())


def test_settings_are_drawn_over_each_other(grid):
    figures, tables = [], []

    class Review:
        figure = figures.append
        table = tables.append

    show_settings.draw_study(grid, Review())
    assert len(figures[0].curves) == 9
    assert figures[0].curves[0].label == "bandwidth 98 Hz, rate 200 Hz"
    assert [v.text for v in figures[1].verticals] == ["rate = 2 bandwidth"]
    assert [c.label for c in figures[1].curves] == ["gyro z", "white noise, aliased"]
    table, rules = tables  # nine settings are too many for a column each
    assert len(table.rows) == 27
    assert [row[0] for row in rules.rows] == ["gyro_x", "gyro_y", "gyro_z"]


def test_the_answer_has_a_row_for_each_setting(grid):
    answer = answer_study(grid)
    count = len(grid.cases)
    assert answer.about == f"{count} settings"
    assert len(answer.rows) <= 8
    first = grid.cases[0]
    assert answer.rows[0][0] == first.text == "bandwidth 98 Hz, rate 200 Hz"
    n = first.axes["gyro_x"].coefficients["N"]
    assert float(answer.rows[0][1]) == pytest.approx(n.value * 3437.75, rel=6e-3)  # deg/√h
    assert answer.rows[-1][0] == ""
    assert "twice the bandwidth" in answer.sentences[-1]
