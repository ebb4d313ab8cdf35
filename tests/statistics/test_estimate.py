import math

import pytest

from imuwb.statistics import UNKNOWN, Coefficient, Estimate
from imuwb.texts import coefficient_text, estimate_text, interval_text, number_text, quantity_text, seconds_text
from imuwb.units import UNITS


def test_another_unit_scales_all_and_a_negative_factor_turns_the_interval_round():
    found = Estimate(2.0, 1.0, 4.0, 0.5, "rad").scaled(-10, "mrad")
    assert found == Estimate(-20.0, -40.0, -10.0, 5.0, "mrad")
    assert -30.0 in found
    assert -9.0 not in found


def test_a_known_number_shifts_all_but_the_standard_deviation():
    assert Estimate(2.0, 1.0, 4.0, 0.5, "1").shifted(-1.0) == Estimate(1.0, 0.0, 3.0, 0.5, "1")


def test_an_estimate_has_the_decimals_that_its_interval_is_worth():
    assert estimate_text(Estimate(0.0123456, 0.0121, 0.0125), "mrad", 1e-3) == "12.35 [12.10, 12.50] mrad"


def test_estimates_print_themselves():
    assert str(Estimate(2.0, 1.5, 2.5, unit="m")) == "2 [1.5, 2.5] m"
    assert str(Estimate(2.0, math.nan, math.nan)) == "2"
    assert str(Coefficient(2.0, None, 2.5, "m")) == "2 [0, 2.5] m"
    assert str(Coefficient(None, None, 2.5, "m")) == "< 2.5 m"
    assert str(UNKNOWN) == "unknown"


@pytest.mark.parametrize(
    ("coefficient", "text"),
    [
        (Coefficient(1e-3, 0.9e-3, 1.1e-3), "1 [0.9, 1.1] mrad"),
        (
            Coefficient(1.23456e-3, 1.2345e-3, 1.2347e-3),
            "1.23456 [1.2345, 1.2347] mrad",
        ),  # digits that the interval is worth
        (Coefficient(1e-3, 0.9e-3, math.inf), "1 [0.9, —] mrad"),
        (Coefficient(None, None, 2e-3), "< 2 mrad"),
        (UNKNOWN, "—"),
    ],
)
def test_a_coefficient_is_shown_with_its_interval_or_as_a_limit(coefficient, text):
    assert coefficient_text(coefficient, UNITS["mrad"]) == text


def test_numbers_have_three_digits_and_no_power_of_ten_where_they_are_large():
    assert [number_text(x) for x in (0.01234, 4.567, 123456.0, -250.4)] == ["0.0123", "4.57", "123456", "-250"]
    assert [seconds_text(x) for x in (0.35, 20.5, 655.2, 8280)] == ["0.35 s", "20.5 s", "655 s", "2.3 h"]
    assert (quantity_text(None, "m"), quantity_text(0.5, "m")) == ("—", "0.5 m")
    assert interval_text(Estimate(12.3, 10, 150), "m") == "12.3 [10, 150] m"
    assert interval_text(Estimate(12.3, math.nan, math.nan, unit="m")) == "12.3 m"
