from itertools import pairwise

import numpy as np
import pytest

from imuwb.identification.temperature import Record, axis_model, over_temperature, set_point_of
from imuwb.stochastic import FlickerNoise, Sum, WhiteNoise

DT, N = 0.01, 30_000
CELSIUS = (-30.0, -10.0, 10.0, 30.0, 50.0)


def size_at(celsius):
    return 0.005 * np.exp(0.004 * (celsius - 25))


@pytest.fixture(scope="module")
def found():
    rng = np.random.default_rng(1)
    points = [
        set_point_of([Record(Sum((WhiteNoise(size_at(t)), FlickerNoise(0.002))).sample(N, DT, rng) + 0.01 * t, 300.0 * k, t)], DT)
        for k, t in enumerate(CELSIUS)
    ]  # fmt: skip
    return over_temperature(points)


@pytest.mark.slow
def test_the_model_has_the_sensors_noise_at_every_temperature(found):
    model = axis_model(found)
    for t in (-30.0, -17.0, 25.0, 44.0):
        white, flicker = model.at(t).terms
        assert pytest.approx(size_at(t), rel=0.02) == white.N
        assert pytest.approx(0.002, rel=0.25) == flicker.B
    celsius = [t for t, _ in model.thermal]
    assert max(b - a for a, b in pairwise(celsius)) <= 5
    assert set(CELSIUS) <= set(celsius)
    assert model.intervals["0.N"][0] < size_at(25) < model.intervals["0.N"][1]
    assert "K" in model.limits


def test_the_bias_is_a_curve_of_a_gyro_and_a_change_of_an_accelerometer(found):
    gyro, accel = axis_model(found), axis_model(found, gravity=True)
    at = np.array([-30.0, 25.0, 50.0])
    curve = np.interp(at, *zip(*gyro.thermal_bias, strict=True))
    change = np.interp(at, *zip(*accel.thermal_bias, strict=True))
    np.testing.assert_allclose(curve, 0.01 * at, rtol=0, atol=0.01)
    np.testing.assert_allclose(change, curve - curve[1], rtol=0, atol=1e-12)
    assert gyro.bias == pytest.approx(float(curve[1]), abs=1e-12)
    assert accel.bias == 0


def test_what_never_changes_is_no_table():
    rng = np.random.default_rng(2)
    points = [
        set_point_of([Record(WhiteNoise(0.005).sample(N, DT, rng) + 0.3, 300.0 * k, t)], DT)
        for k, t in enumerate(CELSIUS)
    ]
    over = over_temperature(points)
    model = axis_model(over)
    assert model.bias == pytest.approx(0.3, abs=1e-3)
    assert axis_model(over, gravity=True).bias == 0
    assert model.thermal == ()
    assert model.thermal_bias == ()
    (white,) = model.processes.terms
    assert pytest.approx(0.005, rel=0.01) == white.N


@pytest.mark.slow
def test_a_coefficient_found_here_and_there_is_what_all_temperatures_say_together():
    rng = np.random.default_rng(3)
    sensor = Sum((WhiteNoise(0.005), FlickerNoise(0.0012)))
    points = [
        set_point_of([Record(sensor.sample(N, DT, rng), 300.0 * k, t)], DT)
        for k, t in enumerate((*CELSIUS, 60.0, 70.0))
    ]
    sure = [bool(p.coefficients["B"].lower) for p in points]
    law = over_temperature(points).laws["B"]
    assert not all(sure)  # else there is nothing to decide
    assert law.function is not None
    assert law.function.kind == "constant"
    assert law.function.at(np.array([0.0]))[0] == pytest.approx(0.0012, rel=0.4)
    assert "common to all" in law.reason
    _, lower, upper = (float(end[0]) for end in law.function.at(np.array([0.0])))
    common = over_temperature(points).dependence["B"].common
    assert upper / lower == pytest.approx(common.upper / common.lower, rel=0.02)
