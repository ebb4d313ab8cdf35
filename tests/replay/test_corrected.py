"""Filters take samples without the deterministic terms of their error model."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.conditioning import corrected_log
from imuwb.navigation.filter_model import FilterModel
from imuwb.notes import ids
from imuwb.replay import prepare
from imuwb.simulation import Temperature, drive, mixed_route
from imuwb.stochastic import AxisModel, ImuErrorModel, Sum, WhiteNoise

SECONDS, RATE = 100, 20
NOISE = Sum((WhiteNoise(1e-3),))
GYRO = AxisModel(NOISE, bias=0.02, scale_factor=0.01, g_sensitivity=(1e-4, -2e-4, 1e-4))
ACCEL = AxisModel(NOISE, bias=0.1, cross_coupling=(0.01, -0.02), thermal_scale_factor=((-20.0, -0.01), (50.0, 0.02)))
MODEL = ImuErrorModel(
    "terms",
    {a: GYRO if a[0] == "g" else ACCEL for a in ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")},
)
SILENT = replace(MODEL, axes={a: replace(m, processes=Sum()) for a, m in MODEL.axes.items()})


def driven(model):
    return drive(model, mixed_route(SECONDS, 1), 1, rate=float(RATE), celsius=Temperature.ramp(-20.0, 50.0, SECONDS))


@pytest.fixture(scope="module")
def log():
    return driven(SILENT)


def test_filters_take_corrected_samples_and_say_so(log):
    truth = driven(ImuErrorModel("ideal", {})).imus[0]
    model = FilterModel("known", MODEL)
    prepared = prepare(log, model)
    assert "corrected" in ids(prepared.notes)
    samples = prepared.measurement.samples
    assert np.abs(samples.angle * RATE - truth.angular_rate.value).max() < 1e-4  # 2e-4 rad/s per m/s², held force
    # The thermometer gives a value each second, at 0.7 °C/s: 3e-4 of up to 12 m/s².
    assert np.abs(samples.velocity * RATE - truth.specific_force.value).max() < 4e-3
    before, _ = corrected_log(log, model.error_model)
    again = prepare(before, model)
    assert np.array_equal(again.measurement.samples.angle, samples.angle)
    assert again.notes == prepared.notes
