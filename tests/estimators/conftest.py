import pytest

from imuwb.stochastic import AxisModel, ImuErrorModel, Sum


@pytest.fixture(scope="session")
def made():
    """Return a maker of models whose axes have terms that grow from x to z by a share."""

    def make(gyro=(), accel=(), *, rate=200.0, growth=0.1):
        axes = {
            f"{sensor}_{axis}": AxisModel(Sum(tuple(term(1 + growth * k) for term in terms)))
            for sensor, terms in (("gyro", gyro), ("accel", accel))
            for k, axis in enumerate("xyz")
            if terms
        }
        stated = {"rate": f"gyro {rate:g} Hz, accel {rate:g} Hz"} if rate else {}
        return ImuErrorModel("mine", axes, {"log": "a.mcap sha256:1", **stated})

    return make
