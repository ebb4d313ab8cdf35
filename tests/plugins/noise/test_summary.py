import pytest

from imuwb.analysis import Finding
from imuwb.statistics import Coefficient
from imuwb.texts import coefficient_text
from imuwb.units import coefficient_units
from imuwb_plugins.noise import summary

N = {"N": Coefficient(1e-3, 0.9e-3, 1.1e-3, at=1.0)}
FINDINGS = (
    Finding("gyro_x", "allan", N),
    Finding("gyro_x", "likelihood", N, ("white noise to 9 s", "drifts", "SUSPICIOUS: odd"), headline=True),
    Finding("gyro_x", "autocorrelation", {}, ("white",)),
    Finding("accel_z", "allan", N, ("SUSPICIOUS: the channel is constant",), headline=True),
)


def test_estimators_stand_beside_each_other():
    found = summary.axes(FINDINGS)
    assert list(found) == ["gyro_x", "accel_z"]
    assert found["gyro_x"].headline == "likelihood"
    assert found["gyro_x"].coefficients == N
    assert list(found["gyro_x"].estimators) == ["allan", "likelihood"]
    assert found["gyro_x"].verdict == ("white noise to 9 s", "drifts", "SUSPICIOUS: odd", "white")


def test_what_is_suspicious_comes_first():
    tables = []

    class Review:
        table = tables.append

    summary.draw(summary.axes(FINDINGS), Review())
    verdicts, noise, also = tables
    assert verdicts.rows[0] == ("gyro_x", "white noise to 9 s", "SUSPICIOUS: odd; drifts")
    assert verdicts.caption.startswith("SUSPICIOUS")
    assert "SUSPICIOUS: the channel is constant" in verdicts.rows[1]
    assert [row[:2] for row in noise.rows] == [
        ("gyro_x", "Allan"), ("gyro_x", "likelihood (headline)"), ("accel_z", "Allan (headline)")
    ]  # fmt: skip
    assert noise.rows[0][3].endswith("deg/√h")
    assert noise.rows[2][3].endswith("m/s/√h")
    assert also.rows == (("gyro_x", "autocorrelation", "white"),)


def test_where_nothing_is_suspicious_the_word_is_not_explained():
    tables = []

    class Review:
        table = tables.append

    calm = (Finding("gyro_x", "likelihood", N, ("white noise to 9 s", "drifts"), headline=True),)
    summary.draw(summary.axes(calm), Review())
    assert tables[0].rows == (("gyro_x", "white noise to 9 s", "drifts"),)
    assert tables[0].caption == ""


@pytest.mark.parametrize("upper", [float("inf")])
def test_a_value_that_nothing_bounds_has_a_dash_for_its_upper_end(upper):
    si = coefficient_units("gyro_x", "N")[0]
    assert coefficient_text(Coefficient(2e-3, 1e-3, upper), si) == f"0.002 [0.001, —] {si.name}"
    assert coefficient_text(Coefficient(2e-3, None, upper), si) == f"0.002 [0, —] {si.name}"
    assert coefficient_text(Coefficient(None, None, upper), si) == "—"
    assert coefficient_text(Coefficient(2e-3, 1e-3, 3e-3), si) == f"0.002 [0.001, 0.003] {si.name}"
