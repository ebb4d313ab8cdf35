import math

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.identification import allan, fit_allan
from imuwb.statistics import UNKNOWN, Coefficient, Estimate
from imuwb.texts import (
    coefficient_text,
    counted,
    estimate_text,
    interval_text,
    number_text,
    quantity_text,
    seconds_text,
)
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
    assert [number_text(x) for x in (0.01234, 4.567, 123456.0, -250.4)] == [
        "0.0123",
        "4.57",
        "123\N{NO-BREAK SPACE}456",
        "-250",
    ]
    assert [seconds_text(x) for x in (0.35, 20.5, 655.2, 8280)] == ["0.35 s", "20.5 s", "655 s", "2.3 h"]
    assert (quantity_text(None, "m"), quantity_text(0.5, "m")) == ("—", "0.5 m")
    assert interval_text(Estimate(12.3, 10, 150), "m") == "12.3 [10, 150] m"
    assert interval_text(Estimate(12.3, math.nan, math.nan, unit="m")) == "12.3 m"


@pytest.mark.parametrize(
    ("estimate", "name", "expected"),
    [
        (Estimate(1.0, 0.5, 2.0, 0.1, "rad/s"), "deg/s", (57.29578, 28.64789, 114.59156, 5.729578)),
        (Estimate(25.0, 24.0, 26.0, 1.0, "°C"), "°F", (77.0, 75.2, 78.8, 1.8)),
        (Estimate(0.5, 0.4, 0.6), "%", (50.0, 40.0, 60.0, None)),
    ],
)
def test_an_estimate_in_another_unit(estimate, name, expected):
    found = estimate.to(name)
    assert (found.value, found.lower, found.upper) == pytest.approx(expected[:3], rel=1e-6)
    assert found.sigma == (None if expected[3] is None else pytest.approx(expected[3], rel=1e-6))
    assert found.unit == name


def test_a_coefficient_in_the_units_of_data_sheets():
    n = Coefficient(1e-4, 9e-5, 1.1e-4, "rad/s/√Hz")
    assert n.to("deg/√h").value == pytest.approx(math.degrees(1e-4) * 60)
    assert n.to("deg/√h").to("rad/s/√Hz").upper == pytest.approx(1.1e-4)
    assert n.to("deg/sqrt(h)").unit == "deg/√h"
    unknown = Coefficient(None, None, math.inf, "rad/s")
    assert (unknown.to("deg/h").value, unknown.to("deg/h").upper) == (None, math.inf)
    with pytest.raises(UsageError, match=r"deg/h is a unit of angular rate; the value is in rad/s/√Hz.*deg/√h"):
        n.to("deg/h")


def test_a_coefficient_of_samples_of_any_sensor_knows_its_letter():
    """The units of a fit's coefficients follow from those of the samples; the letter says which units there can be."""
    curve = allan(np.random.default_rng(1).normal(0, 1e-3, 4000), dt=0.01)
    n = fit_allan(curve).coefficients["N"]
    assert n.unit == ""
    assert n.to("deg/√h").value == pytest.approx(math.degrees(n.value) * 60)
    assert n.to("µg/√Hz").value == pytest.approx(n.value / 9.80665e-6)
    for wrong in ("deg/h", "m", "deg/h^1.5"):
        with pytest.raises(UsageError, match="which N is not; write one of"):
            n.to(wrong)


@pytest.mark.parametrize(
    ("count", "text"), [(0, "0 gaps"), (1, "1 gap"), (2, "2 gaps"), (12_345, "12\N{NO-BREAK SPACE}345 gaps")]
)
def test_a_number_of_things_is_in_singular_or_plural(count, text):
    assert counted(count, "gap") == text
    assert counted(1, "analysis", "analyses") == "1 analysis"
    assert counted(2, "analysis", "analyses") == "2 analyses"
