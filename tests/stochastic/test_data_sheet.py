import math

import pytest

from imuwb.errors import UsageError
from imuwb.simulation import preset, preset_names
from imuwb.stochastic import (
    FLICKER_LEVEL,
    Autoregressive,
    Constant,
    FlickerNoise,
    ImuErrorModel,
    RandomWalk,
    WhiteNoise,
)
from imuwb.stochastic import read_data_sheet as read

DEGREE = math.pi / 180


def test_each_statement_becomes_its_process_with_the_interval_of_its_definition():
    model = read(
        'name = "X"\nsource = "sheet"\n[gyro]\nN = "0.3 deg/√h"\nallan_minimum = "5 deg/h"\nK = "20 deg/h^1.5"\n'
        'turn_on = "0.2 deg/s"\nrange = "450 deg/s"\nbandwidth = "330 Hz"\n[accel]\nnoise_density = "100 µg/√Hz"\n'
        'bias_instability = "10 µg"\n[accel_z]\nN = "0.1 m/s/√h"\n',
        "sheet.toml",
    )
    gyro = model.axes["gyro_y"]
    assert gyro.processes.terms == (
        WhiteNoise(pytest.approx(0.3 * DEGREE / 60)), FlickerNoise(pytest.approx(5 * DEGREE / 3600 / FLICKER_LEVEL)),
        RandomWalk(pytest.approx(20 * DEGREE / 3600 / 60)), Constant(pytest.approx(0.2 * DEGREE)),
    )  # fmt: skip
    assert gyro.intervals["1.B"] == pytest.approx((0, 5 * DEGREE / 3600 / FLICKER_LEVEL))
    assert (gyro.range, gyro.bandwidth) == (pytest.approx(450 * DEGREE), 330)
    accel, density, unsaid = model.axes["accel_x"], 100 * 9.80665e-6, 10 * 9.80665e-6
    assert accel.intervals["0.N"] == pytest.approx((density / math.sqrt(2), density))
    assert accel.intervals["1.B"] == pytest.approx((unsaid, unsaid / FLICKER_LEVEL))
    assert model.axes["accel_z"].processes.terms == (WhiteNoise(pytest.approx(0.1 / 60)),)
    assert model.provenance["source"] == "sheet"
    assert ImuErrorModel.from_toml(model.to_toml()).axes == model.axes


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ('[gyro]\nN = "0.3 deg/h"', "with a unit"), ('[gyro]\nN = "0.3"', "with a unit"), ('[gyro]\nN = "-1 deg/√h"', "must be positive"),
        ('[gyro]\nnoise = "1 deg/√h"', "unknown key 'noise'"), ('[wheel]\nN = "1 deg/√h"', "unknown key 'wheel'"), ("", "no table gyro"),
        ("[gyro", "not TOML"), ("gyro = 3", "unknown key 'gyro'"),
    ],
)  # fmt: skip
def test_what_a_sheet_cannot_state_is_named(text, named):
    with pytest.raises(UsageError, match=rf"sheet\.toml.*{named}"):
        read(text, "sheet.toml")


def test_every_published_sensor_has_a_source_a_grade_and_white_noise_of_both_sensors_or_says_what_is_not_stated():
    assert len(preset_names()) >= 22
    for name in preset_names():
        model = preset(name)
        assert model.provenance["source"]
        assert model.provenance["grade"] in {"consumer", "industrial", "tactical", "navigation"}, name
        white = {axis.partition("_")[0] for axis, content in model.axes.items()
                 if any(isinstance(t, WhiteNoise | Autoregressive) for t in content.processes.terms)}  # fmt: skip
        assert "gyro" in white, name
        assert "accel" in white or "white noise of the accelerometers" in model.provenance["note"], name
