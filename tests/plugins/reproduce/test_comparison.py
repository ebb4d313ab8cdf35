"""Printed values, the rule of agreement, and that no value or figure of a paper is missing without a reason."""

import math

import numpy as np
import pytest

import imuwb
from imuwb.statistics import Estimate
from imuwb_plugins.reproduce import METHODS
from imuwb_plugins.reproduce.comparison import AGREES, DIFFERS, OTHER, over_seeds, verdict_of
from imuwb_plugins.reproduce.printed import Key, PrintedValue, paper
from imuwb_plugins.reproduce.shown import answer

KEY = Key("4", "N", "gyro_x")


def printed(text, sigma=None, *, other=False):
    """Return a printed value."""
    return PrintedValue(KEY, text, "deg/√h", sigma, other)


@pytest.mark.parametrize(
    ("text", "digit"), [("2.420", 1e-3), ("-0.999", 1e-3), ("-1", 1.0), ("2.129e-10", 1e-13), ("7.04E-11", 1e-13)]
)
def test_last_digit(text, digit):
    assert printed(text).last_digit == pytest.approx(digit)
    assert printed(text).half_width == pytest.approx(digit / 2)


@pytest.mark.parametrize(
    ("ours", "sigma", "verdict"),
    [
        (Estimate(2.42, 2.41, 2.43), None, AGREES),
        (Estimate(2.44, 2.43, 2.45), None, DIFFERS),
        (Estimate(2.44, 2.43, 2.45), 0.0974, AGREES),  # the paper's own sigma contains it
        (Estimate(2.7, 2.69, 2.71), 0.0974, DIFFERS),
        (Estimate(2.425, 2.41, 2.44), None, AGREES),  # the end towards the printed value counts
        (Estimate(2.425, 2.4249, 2.5), None, DIFFERS),
    ],
)
def test_rule_of_agreement(ours, sigma, verdict):
    assert verdict_of(printed("2.420", sigma), ours) == verdict


def test_values_of_the_papers_own_data_are_not_judged():
    assert verdict_of(printed("2.420", other=True), Estimate(1.0, 1.0, 1.0)) == OTHER


def test_one_more_seed_lies_in_the_interval_of_several():
    rng, inside = np.random.default_rng(1), 0
    for _ in range(200):
        *several, one = rng.normal(5.0, 2.0, 6)
        inside += one in over_seeds([Estimate(v, math.nan, math.nan) for v in several])
    assert 0.90 < inside / 200 < 0.995  # 95 %: sigma 1.5 %


def test_every_paper_states_what_makes_each_table_and_figure():
    for name in METHODS:
        content = paper(name)
        for one in (*content.tables, *content.figures, *content.equations):
            assert bool(one.command) != bool(one.reason), (name, one.number)
        assert all(not table.reason for table in content.tables if table.values)


@pytest.fixture(scope="module")
def reproductions():
    """Return both papers beside short records."""
    return {
        name: imuwb.run(f"reproduce {name}", hours=hours, seed=3)
        for name, hours in (("el-diasty", 0.2), ("hassaballa", 0.1))
    }


@pytest.mark.parametrize("name", ["el-diasty", "hassaballa"])
def test_every_value_and_figure_is_there(reproductions, name):
    content, result = paper(name), reproductions[name].result
    assert [row.item for table in result.tables for row in table.rows] == [value.key.item for value in content.values()]
    assert all(row.ours is not None for table in result.tables for row in table.rows)
    assert {f.number for f in result.figures if f.drawings} == {f.number for f in content.figures if not f.reason}
    assert len(reproductions[name].answer.rows) <= 7
    assert {row.verdict for table in result.tables for row in table.rows} <= {AGREES, DIFFERS, OTHER}
    assert str(result.count(AGREES)) in answer(result).sentences[0]


def test_published_noise_is_found_again(reproductions):
    by_number = {table.number: table for table in reproductions["el-diasty"].result.tables}
    assert by_number["2"].count(AGREES) >= 12  # of 16, of which chance takes one
    np.testing.assert_allclose([row.ratio for row in by_number["1"].rows], 1.0, atol=0.12)  # N is known within 3 %
