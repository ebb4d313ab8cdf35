"""Numbers and their intervals as texts."""

import math

import pytest

from imuwb.statistics import Coefficient, Estimate
from imuwb.texts import (
    bytes_text,
    coefficient_text,
    decimals,
    estimate_text,
    interval_text,
    markdown_block,
    markdown_text,
    name_of,
    names_text,
    number_text,
    printable,
    printable_lines,
    quantity_text,
    seconds_text,
)
from imuwb.units import UNITS


@pytest.mark.parametrize(
    ("width", "digits"),
    [(0.0074, 4), (0.0099, 4), (0.01, 3), (0.074, 3), (1.0, 1), (9.9, 1), (10.0, 0), (30.0, 0), (1e-30, 9), (0.0, 6), (math.inf, 6)],
)  # fmt: skip
def test_a_value_has_two_digits_of_its_intervals_width(width, digits):
    assert decimals(width) == digits


@pytest.mark.parametrize(
    ("value", "text"), [(99.4, "99.4"), (100.0, "100"), (100.4, "100"), (-250.4, "-250"), (0.01234, "0.0123")]
)
def test_numbers_from_100_have_no_decimals(value, text):
    assert number_text(value) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.35, "0.35 s"), (7199.0, "7199 s"), (7200.0, "2 h"), (8280.0, "2.3 h"), (36_900.0, "10.2 h"), (1e6, "278 h")],
)
def test_times_from_two_hours_are_in_hours(seconds, text):
    assert seconds_text(seconds) == text


@pytest.mark.parametrize(
    ("count", "text"),
    [(0, "0 bytes"), (812, "812 bytes"), (64_000, "64 kB"), (8_160_000, "8.16 MB"), (1.2e12, "1.2 TB")],
)
def test_bytes_are_in_the_unit_that_fits(count, text):
    assert bytes_text(count) == text


def test_a_quantity_has_its_unit_and_a_dash_without_a_value():
    assert quantity_text(0.12345, "m") == "0.123 m"
    assert quantity_text(0.12345, "m", 4) == "0.1235 m"
    assert quantity_text(None, "m") == "—"


def test_an_estimate_without_an_interval_is_a_number():
    assert interval_text(Estimate(12.3, math.nan, math.nan, unit="m")) == "12.3 m"
    assert interval_text(Estimate(12.3, 10, 150), "m") == "12.3 [10, 150] m"


def test_a_factor_converts_value_and_interval():
    assert estimate_text(Estimate(2.0, 1.0, 4.0), "", 2.0) == "1.0 [0.5, 2.0]"


@pytest.mark.parametrize(
    ("width", "text"),
    [(2.0, "1.23 [0.235, 2.23]"), (0.4, "1.23 [1.03, 1.43]"), (0.02, "1.235 [1.225, 1.245]"), (1e-4, "1.23457 [1.23452, 1.23462]"), (1e-9, "1.23457")],
)  # fmt: skip
def test_a_coefficient_has_three_to_six_digits_by_its_relative_width(width, text):
    value = 1.234567
    shown = coefficient_text(Coefficient(value, value - width / 2, value + width / 2), UNITS["1"])
    assert shown.startswith(text)
    assert shown.endswith(" 1")


@pytest.mark.parametrize(
    ("names", "text"),
    [([], ""), (["a"], "a"), (["a", "b", "c"], "a, b, c"), (["a", "b", "c", "d"], "a, b, c and 1 more")],
)
def test_many_names_are_counted(names, text):
    assert names_text(names, most=3) == text


def test_words_of_a_log_are_shown_letter_by_letter():
    assert printable("a\x1b[2J\n\u202eb\u00a0c\ufffd\ud800 µ√é加") == "a?[2J??b c?? µ√é加"
    assert printable_lines("a\x07\nb") == "a?\nb"
    assert name_of("/imu/data") == "/imu/data"
    assert len({name_of(name) for name in ("a\x1b", "a\x07", "a?", "a" * 500, "a" * 501)}) == 5
    assert all(len(name_of("a" * n)) < 140 for n in (10, 1000, 100_000))
    assert markdown_text("![p](http://x)<b>|`_*#") == r"\!\[p\](http://x)\<b\>\|\`\_\*\#"
    assert [markdown_text(line) for line in ("- a", "1. a", "-1.5", "+")] == [r"\- a", r"1\. a", "-1.5", r"\+"]
    block = markdown_block(["a", "```", "![p](x)"]).split("\n")
    assert (block[0], block[-1], block[2]) == ("````text", "````", "```")
