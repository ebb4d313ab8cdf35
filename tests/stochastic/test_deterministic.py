"""Deterministic terms, put upon a motion and taken off again."""

import numpy as np
import pytest

from imuwb.stochastic import AxisModel, ImuErrorModel, corrected, is_ideal, is_thermal, shown

GYRO = AxisModel(
    bias=0.02, scale_factor=0.01, scale_factor_nonlinear=2e-3, cross_coupling=(0.01, -0.02), g_sensitivity=(1e-3, 2e-3, -1e-3),
    range=5.0,
)  # fmt: skip
ACCEL = AxisModel(
    bias=0.3, scale_factor=-0.02, cross_coupling=(-0.01, 0.015), thermal_bias=((0.0, 0.1), (40.0, 0.5)),
    thermal_scale_factor=((0.0, 0.01), (20.0, 0.03)),
)  # fmt: skip
MODEL = ImuErrorModel("of all terms", {"gyro_y": GYRO, "accel_x": ACCEL, "accel_z": ACCEL})


def motions(n=500):
    rng = np.random.default_rng(1)
    return rng.standard_normal((n, 3)), rng.standard_normal((n, 3)) * 10, rng.uniform(-10, 60, n)


def test_a_corrected_measurement_is_the_motion():
    rate, force, celsius = motions()
    for t in (celsius, np.array(25.0), None):
        again = corrected(MODEL, shown(MODEL, (rate, force), t), t)
        assert np.abs(again[0] - rate).max() < 1e-12
        assert np.abs(again[1] - force).max() < 1e-11


def test_terms_are_shown_as_the_papers_write_them():
    rate, force, celsius = motions()
    gyro, accel = shown(MODEL, (rate, force), celsius)
    assert np.array_equal(gyro[:, [0, 2]], rate[:, [0, 2]])
    assert np.array_equal(accel[:, 1], force[:, 1])
    k = int(np.argmin(np.abs(celsius - 10)))
    t = celsius[k]
    y, f = rate[k], force[k]
    wanted = (1.01 + 2e-3 * abs(y[1]) / 5) * y[1] + 0.01 * y[0] - 0.02 * y[2] + 0.02 + f @ [1e-3, 2e-3, -1e-3]
    assert gyro[k, 1] == pytest.approx(wanted, rel=1e-12)
    wanted = (1.01 + 0.001 * t) * f[0] - 0.01 * f[1] + 0.015 * f[2] + 0.1 + 0.01 * t
    assert accel[k, 0] == pytest.approx(wanted, rel=1e-12)


def test_beyond_set_points_terms_are_held_and_without_a_temperature_the_plain_ones_count():
    rate, force, _ = motions(3)
    beyond = shown(MODEL, (rate, force), np.array([-50.0, 90.0, 90.0]))[1][:, 2]
    wanted = np.array([1.01, 1.03, 1.03]) * force[:, 2] + [0.1, 0.5, 0.5] - 0.01 * force[:, 0] + 0.015 * force[:, 1]
    assert beyond == pytest.approx(wanted, rel=1e-12)
    plain = shown(MODEL, (rate, force), None)[1][:, 2]
    assert plain == pytest.approx(0.98 * force[:, 2] + 0.3 - 0.01 * force[:, 0] + 0.015 * force[:, 1], rel=1e-12)


def test_a_model_tells_whether_it_has_such_terms():
    assert is_ideal(ImuErrorModel("", {"gyro_x": AxisModel()}))
    assert not is_ideal(ImuErrorModel("", {"gyro_x": GYRO}))
    assert not is_ideal(ImuErrorModel("", {"gyro_x": AxisModel(thermal_bias=((0.0, 1.0),))}))
    assert is_thermal(MODEL)
    assert not is_thermal(ImuErrorModel("", {"gyro_x": GYRO}))


def test_terms_go_through_a_document_with_units():
    again = ImuErrorModel.from_toml(MODEL.to_toml())
    assert again.axes == MODEL.axes
    text = MODEL.to_toml().replace("0.02 rad/s", "72 deg/h")
    assert ImuErrorModel.from_toml(text).axes["gyro_y"].bias == pytest.approx(np.radians(72 / 3600))


def test_terms_that_hide_the_motion_are_refused():
    wild = AxisModel(cross_coupling=(2.0, 2.0))
    model = ImuErrorModel("wild", {"gyro_x": wild, "gyro_y": wild, "gyro_z": wild})
    with pytest.raises(ValueError, match="wild: its scale factors"):
        corrected(model, motions(5)[:2], None)
