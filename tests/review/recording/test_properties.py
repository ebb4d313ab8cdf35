"""The properties of a recording: numbers with their unit in the name, texts that can be shown."""

import math
from types import SimpleNamespace

import pytest

from imuwb.analysis import Answer, Finding
from imuwb.review.recording.properties import properties, recording_name
from imuwb.statistics import Coefficient, Estimate
from imuwb.units import coefficient_units

ROWS = (("gyro x", "2.40 [2.38, 2.43]", "31 at 51 s", "yes"), ("", "deg/√h", "deg/h", ""))
ANSWER = Answer("1 h still", ("", "N", "lowest point", "trust"), ROWS, ("Trust \x1b[2Jthem.", "More."))


@pytest.fixture
def log():
    return SimpleNamespace(
        provenance=SimpleNamespace(path="C:\\logs\\a.csv", hash="sha256:1"), imus=(SimpleNamespace(name="IMU.0"),)
    )


def test_a_catalog_gets_what_was_analysed_and_the_verdict(log):
    stated = properties("noise", "0.1", 0.95, [log, log], ANSWER, ())
    assert stated["log"] == ["a.csv", "a.csv"]
    assert (stated["sensor"], stated["level"], stated["hash"][0]) == (["IMU.0"], 0.95, "sha256:1")
    assert stated["headline"] == "gyro x: N 2.40 [2.38, 2.43] deg/√h, lowest point [deg/h] 31 at 51 s, trust yes"
    assert stated["verdict"].isprintable()
    assert "level" not in properties("health", "0.1", None, [log], ANSWER, ())
    assert recording_name("noise", [log, log], ANSWER) == "noise · a.csv and 1 more · gyro x N 2.40 [2.38, 2.43] deg/√h"
    assert recording_name("noise", [log], Answer("x")) == "noise · a.csv"


def test_coefficients_of_the_headline_are_numbers_in_units_of_data_sheets(log):
    unit = coefficient_units("gyro_x", "N")[1]
    shown = Coefficient(unit.to_si(2.4), unit.to_si(2.38), unit.to_si(2.43))
    limit = Coefficient(None, None, coefficient_units("gyro_x", "K")[1].to_si(220.0))
    unknown = Coefficient(None, None, math.inf)
    other = Finding("gyro_x", "allan", {"N": limit})
    mine = Finding("gyro_x", "likelihood", {"N": shown, "K": limit, "B": unknown}, headline=True)
    stated = properties("noise", "0.1", 0.95, [log], ANSWER, (other, mine))
    numbers = {name: value for name, value in stated.items() if name.startswith("gyro")}
    assert numbers == {
        "gyro x N [deg/√h]": 2.4, "gyro x N interval [deg/√h]": [2.38, 2.43], "gyro x K limit [deg/h^1.5]": 220.0
    }  # fmt: skip
    assert "gyro x N limit [deg/√h]" in properties("allan", "0.1", 0.95, [log], ANSWER, (other,))


def test_numbers_of_the_answer_take_the_place_of_findings(log):
    drift = {"drift at 60 s": Estimate(1234.5678, 1000.0, 2000.0, unit="m"), "alone": Estimate(2.0, math.nan, math.nan)}
    answer = Answer("x", numbers=drift)
    stated = properties("outage", "0.1", 0.95, [log], answer, (Finding("gyro_x", "a", {"N": Coefficient(1, 1, 1)}),))
    assert stated["drift at 60 s [m]"] == 1234.57
    assert stated["drift at 60 s interval [m]"] == [1000.0, 2000.0]
    assert stated["alone"] == 2.0
    assert not any(name.startswith("gyro") for name in stated)


def test_a_coefficient_whose_interval_begins_at_0_is_a_limit_as_in_the_panel(log):
    unit = coefficient_units("gyro_x", "K")[1]
    found = Finding("gyro_x", "likelihood", {"K": Coefficient(unit.to_si(75.8), 0.0, unit.to_si(220.0))})
    stated = properties("noise", "0.1", 0.95, [log], Answer("x"), (found,))
    assert stated["gyro x K limit [deg/h^1.5]"] == pytest.approx(220.0)
    assert not any("interval" in name for name in stated)
