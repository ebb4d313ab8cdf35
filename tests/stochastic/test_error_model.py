import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.stochastic import (
    Autoregressive,
    AxisModel,
    Constant,
    GaussMarkov,
    ImuErrorModel,
    RandomWalk,
    Sum,
    WhiteNoise,
)


def test_a_model_reads_back_to_the_last_bit():
    gyro = AxisModel(
        WhiteNoise(0.1 / 3) + GaussMarkov(1e-4 / 7, 490.89) + Autoregressive((-0.93759283746, 0.1), 1e-5, 0.01),
        {"0.N": (0.03, 0.04), "1.sigma": (1e-5, 2e-5)},
        {"K": 1e-6},
        scale_factor=1e-3, cross_coupling=(1e-4, 2e-4), g_sensitivity=(1e-5, 0.0, 0.0), bandwidth=42.0,
        group_delay=0.005, lsb=1e-4, range=8.7,
    )  # fmt: skip
    accel = AxisModel(WhiteNoise(2.0) + Constant(0.3), thermal=((-30.0, Sum((WhiteNoise(1.0), Constant(0.3)))), (30.0, Sum((WhiteNoise(2.0), Constant(0.3))))))  # fmt: skip
    model = ImuErrorModel("mine", {"gyro_x": gyro, "accel_z": accel}, {"log": "sha256:00"})
    assert ImuErrorModel.from_toml(model.to_toml()) == model


def test_people_may_write_units():
    text = """
        name = "hand"
        [[gyro_x.processes]]
        process = "white_noise"
        N = "0.3 deg/√h"
        [[gyro_x.processes]]
        process = "flicker_noise"
        B = { value = 10, unit = "deg/h", lower = 8, upper = 12 }
        [[accel_y.processes]]
        process = "random_walk"
        K = 0.001
    """
    model = ImuErrorModel.from_toml(text)
    white, flicker = model.axes["gyro_x"].processes.terms
    assert pytest.approx(0.3 * np.pi / 180 / 60) == white.N
    assert pytest.approx(10 * np.pi / 180 / 3600) == flicker.B
    assert model.axes["gyro_x"].intervals["1.B"] == pytest.approx((8 * np.pi / 648000, 12 * np.pi / 648000))
    assert model.axes["accel_y"].processes == Sum((RandomWalk(0.001),))


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("x = [", "TOML"),
        ("schema = 7", "schema 7"),
        ("[gyro_w]", "gyro_w"),
        ("[gyro_x]\nnoise = 3", "noise"),
        ('[[gyro_x.processes]]\nprocess = "pink"', "pink"),
        ('[[gyro_x.processes]]\nprocess = "white_noise"', "needs N"),
        ('[[gyro_x.processes]]\nprocess = "white_noise"\nN = "1 deg/h"', "deg/h"),
        ('[[gyro_x.processes]]\nprocess = "white_noise"\nN = -1', "must be"),
        ('[[gyro_x.processes]]\nprocess = "white_noise"\nN = 1\nM = 2', "'M'"),
        ('[[gyro_x.processes]]\nprocess = "white_noise"\nN = "many"', "a number and its unit"),
        ('[[gyro_x.processes]]\nprocess = "white_noise"\nN = true', "a number"),
        ('[[gyro_x.processes]]\nprocess = "white_noise"\nN = {value = 1, lower = 1}', "upper"),
        ("[gyro_x]\nprocesses = 3", "a list"),
        ('[gyro_x]\nprocesses = ["a"]', "a table"),
        ("[gyro_x]\ncross_coupling = [1]", "2 numbers"),
        ("[gyro_x]\nthermal = [{}]", "celsius"),
        ("[gyro_x]\nnot_identified = 3", "a table"),
        ("[gyro_x]\nlsb = -1", "positive"),
        ("[gyro_x]\nlsb = nan", "a number"),
        ("provenance = 3", "a table"),
    ],
)
def test_what_is_wrong_is_named(text, named):
    with pytest.raises(UsageError, match=named):
        ImuErrorModel.from_toml(text, "model.toml")


def test_parameters_lie_between_set_points_and_are_held_beyond():
    points = tuple((t, Sum((WhiteNoise(n),))) for t, n in ((0.0, 1.0), (10.0, 3.0)))
    axis = AxisModel(Sum((WhiteNoise(9.0),)), thermal=points)
    for celsius, n in ((-5, 1.0), (0, 1.0), (2.5, 1.5), (10, 3.0), (40, 3.0)):
        assert pytest.approx(n) == axis.at(celsius).terms[0].N
    assert axis.at(None) == axis.processes


def test_an_unreadable_file_is_named(tmp_path):
    with pytest.raises(UsageError, match="gone.toml"):
        ImuErrorModel.read(tmp_path / "gone.toml")


def test_set_points_must_rise_and_agree():
    white, walk = Sum((WhiteNoise(1),)), Sum((RandomWalk(1),))
    for thermal in (((10.0, white), (0.0, white)), ((0.0, white), (10.0, walk))):
        with pytest.raises(ValueError, match="set-points"):
            AxisModel(thermal=thermal)


def test_ar_sets_are_mixed_between_set_points():
    cold, warm = (Sum((Autoregressive((a,), 1.0, 0.01),)) for a in (-0.9, -0.5))
    assert AxisModel(thermal=((0.0, cold), (10.0, warm))).at(5.0).terms[0].alpha == pytest.approx((-0.7,))
