"""The outage replay with an error model that knows biases by temperature."""

from dataclasses import replace

import pytest

from imuwb.log import AXES
from imuwb.notes import ids
from imuwb.simulation import Temperature, drive, mixed_route
from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, Sum, WhiteNoise
from imuwb_plugins import outage

from .made import stated

CURVES = {"gyro": ((-20.0, 0.02), (50.0, -0.02)), "acce": ((-20.0, 1.5), (50.0, 0.5))}  #: rad/s, m/s²


def sensor():
    """Return a sensor whose accelerometers are off by up to 1.5 m/s²: a tilt of 9 degrees."""
    axes = {}
    for axis in AXES:
        k = int(axis[0] == "a")
        noise = Sum((WhiteNoise((2e-4, 2e-3)[k]), Constant((1e-3, 0.02)[k])))
        axes[axis] = AxisModel(noise, thermal_bias=CURVES[axis[:4]])
    return ImuErrorModel("curves", axes)


WARMING = Temperature.ramp(-20.0, 50.0, 240.0)


def blind():
    """Return the sensor's model without its curves."""
    return replace(sensor(), axes={a: replace(m, thermal_bias=()) for a, m in sensor().axes.items()})


def driven(model):
    return drive(model, mixed_route(240, 3), 1, rate=50.0, celsius=WARMING)


@pytest.fixture(scope="module")
def log():
    return driven(sensor())


def ran(log, tmp_path, model, **options):
    path = tmp_path / "m.toml"
    path.write_text(model.to_toml(), "utf-8")
    return outage.run([log], stated(error_model=path, models="full", at="150:20,180:20", **options))


@pytest.mark.slow
def test_biases_are_taken_off_before_anything_is_estimated(log, tmp_path):
    found = ran(log, tmp_path, sensor(), mounting="auto")
    assert ids(found.notes).count("corrected") == 1
    without = ran(driven(blind()), tmp_path, blind(), mounting="auto")
    # The temperature of each second is held: 0.15 °C of 0.29 °C/s on average, 2 mm/s² of the curves, 0.012 degrees.
    assert found.mounting.angles == pytest.approx(without.mounting.angles, abs=0.02)
    assert "corrected" not in ids(without.notes)
    off = ran(log, tmp_path, blind(), mounting="auto")
    assert abs(off.mounting.angles[0] - without.mounting.angles[0]) > 3


def test_outages_are_short_with_the_curves_and_long_without(log, tmp_path):
    known, unknown = (ran(log, tmp_path, model) for model in (sensor(), blind()))
    for with_curves, without in zip(known.outages, unknown.outages, strict=True):
        assert with_curves.models["full"].end < 0.2 * without.models["full"].end
