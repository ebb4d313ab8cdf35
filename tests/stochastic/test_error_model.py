import math

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
        ("schema = 7", "schema number is 7"),
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


def test_a_model_prints_a_line_for_each_axis_in_display_units():
    noise = WhiteNoise(math.radians(0.3) / 60) + GaussMarkov(math.radians(1.5), 20.0)
    gyro = AxisModel(noise, scale_factor=0.01, cross_coupling=(0.002, 0.0), thermal_bias=((-20.0, 0.1), (50.0, 0.0)))
    accel = AxisModel(Sum((RandomWalk(1 / 3600 / 60),)), bias=0.00980665, g_sensitivity=(0.0, 0.0, 0.5), lsb=1.0)
    name, *lines = str(ImuErrorModel("mine", {"accel_z": accel, "gyro_x": gyro})).splitlines()
    assert name == "mine"
    assert [line.partition(": ")[0] for line in lines] == ["gyro_x", "accel_z"]
    for text in (
        "N 0.3 deg/√h",
        "Gauss-Markov sigma 1.5 deg/s",
        "Tc 20 s",
        "1 %",
        "2, 0 mrad",
        "2 set-points from -20 to 50 °C",
    ):
        assert text in lines[0]
    for text in ("K 1 m/s/h^1.5", "bias 1 mg", "0.5 rad/s per m/s²", "LSB 102 mg"):
        assert text in lines[1]


def test_processes_and_axes_print_short():
    noise = WhiteNoise(0.123456789) + Autoregressive((-0.5,), 1.0, 0.01)
    assert str(noise) == "WhiteNoise(N=0.1235) + Autoregressive(alpha=(-0.5), beta0=1, dt=0.01)"
    assert eval(repr(noise)) == noise  # noqa: S307 - its own text
    axis = AxisModel(noise, bias=0.5, range=8.0, g_sensitivity=(0.0, 1.0, 0.0))
    assert str(axis) == f"{noise}; bias=0.5; g_sensitivity=(0, 1, 0); range=8"
    assert str(AxisModel()) == "no process"


def test_a_path_may_be_a_text(tmp_path):
    model = ImuErrorModel("mine", {"gyro_x": AxisModel(Sum((WhiteNoise(1.0),)))})
    path = tmp_path / "m.toml"
    path.write_text(model.to_toml(), "utf-8")
    assert ImuErrorModel.read(str(path)) == model == ImuErrorModel.read(path)
