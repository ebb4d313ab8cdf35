import math

import pytest

from imuwb.errors import UsageError
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.stochastic import AxisModel, ImuErrorModel, RandomWalk, Sinusoid, Sum, WhiteNoise
from imuwb.stochastic.model_check import Limit, check, coefficient, limits

DEGREE = math.pi / 180

MODEL = ImuErrorModel(
    "m",
    {
        "gyro_x": AxisModel(
            Sum((Sinusoid(1.0, 2.0), WhiteNoise(1e-3), RandomWalk(2e-5))), {"1.N": (0.9e-3, 1.2e-3)}, {"B": 3e-5}
        ),
        "accel_z": AxisModel(Sum((WhiteNoise(2e-2),)), {"0.N": (1.9e-2, 2.1e-2)}),
    },
)


@pytest.fixture
def file(tmp_path):
    def make(text):
        path = tmp_path / "limits.toml"
        path.write_text(text, "utf-8")
        return path

    return make


def test_a_coefficient_has_the_interval_of_its_own_term():
    assert coefficient(MODEL.axes["gyro_x"], "N") == Coefficient(1e-3, 0.9e-3, 1.2e-3)
    assert coefficient(MODEL.axes["gyro_x"], "K") == Coefficient(2e-5, 2e-5, 2e-5)  # no interval: the value itself
    assert coefficient(MODEL.axes["gyro_x"], "B") == Coefficient(None, None, 3e-5)
    assert coefficient(MODEL.axes["gyro_x"], "Q") == UNKNOWN


@pytest.mark.parametrize(
    ("letter", "at_most", "outcome"),
    [("N", 1.2e-3, "within"), ("N", 1.19e-3, "not sure"), ("N", 0.95e-3, "not sure"), ("N", 0.9e-3, "not sure"),
     ("N", 0.89e-3, "beyond"), ("K", 2e-5, "within"), ("K", 1.9e-5, "beyond"), ("B", 3e-5, "within"), ("B", 2.9e-5, "not sure"),
     ("R", 1.0, "not known")],
)  # fmt: skip
def test_verdicts(letter, at_most, outcome):
    (verdict,) = check(MODEL, (Limit("gyro_x", letter, at_most),))
    assert verdict.outcome == outcome
    assert verdict.coefficient == coefficient(MODEL.axes["gyro_x"], letter)


def test_an_axis_that_the_model_lacks_is_not_known():
    (verdict,) = check(MODEL, (Limit("gyro_y", "N", 1.0),))
    assert (verdict.outcome, verdict.coefficient.value) == ("not known", None)


def test_limits_have_units_and_go_for_three_axes_or_one(file):
    found = limits(file('[gyro]\nN = "0.3 deg/√h"\n[accel_z]\nB = "10 µg"\nK = "2e-4 m/s²/√s"\n'), 2)
    assert [(x.axis, x.letter) for x in found] == [
        ("gyro_x", "N"), ("gyro_y", "N"), ("gyro_z", "N"), ("accel_z", "B"), ("accel_z", "K")
    ]  # fmt: skip
    assert [x.at_most for x in found] == pytest.approx([2 * 0.3 * DEGREE / 60] * 3 + [2 * 9.80665e-5, 4e-4])


def test_another_models_upper_ends_are_limits(file):
    found = {(x.axis, x.letter): x.at_most for x in limits(file(MODEL.to_toml()), 1.5)}
    assert found == pytest.approx({
        ("gyro_x", "N"): 1.8e-3, ("gyro_x", "K"): 3e-5, ("gyro_x", "B"): 4.5e-5, ("accel_z", "N"): 3.15e-2
    })  # fmt: skip


def test_a_model_is_within_itself(file):
    assert {v.outcome for v in check(MODEL, limits(file(MODEL.to_toml())))} == {"within"}


@pytest.mark.parametrize(
    ("text", "named"),
    [("[gyro]\nN = [", "cannot be read as limits"), ("", "limits.toml: "), ("[gyro]\n", "limits.toml: "),
     ('[gyros]\nN = "1 deg/√h"', "'gyros'"), ("gyro = 3", "'gyro'"), ('[gyro]\nX = "1 deg/h"', "'X'"),
     ('[gyro]\nN = "1 deg/h"', "deg/√h"), ('[gyro]\nN = "much deg/√h"', "a number and its unit"),
     ('[gyro]\nN = "0 deg/√h"', "must be positive"), ('[gyro]\nN = "-1 deg/√h"', "must be positive"),
     ('[gyro]\nN = "nan deg/√h"', "must be positive"), ('[gyro]\nN = "1 furlong"', r"limits.toml: N = '1 furlong'; it must be a number and its unit"),
     ("[gyro]\nN = 3e-4", r"limits.toml: N = 0.0003; .* deg/√h"), ("[gyro_y]\nB = 3", r"limits.toml: B = 3; "),
     ('[gyro]\nN = "0.3"', r"limits.toml: N = '0.3'; .* deg/√h"), ("[gyro]\nN = true", r"limits.toml: N = True; "),
     ('[gyro]\nN = ""', r"limits.toml: N = ''; ")],
)  # fmt: skip
def test_limits_that_cannot_be_are_named(file, text, named):
    with pytest.raises(UsageError, match=named):
        limits(file(text))


def test_no_file_is_named(tmp_path):
    with pytest.raises(UsageError, match="gone.toml: cannot be read"):
        limits(tmp_path / "gone.toml")
