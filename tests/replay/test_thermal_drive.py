"""A drive that warms up: the model that knows temperature is consistent in outages, the one that does not is not."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from imuwb.navigation import FilterModel
from imuwb.replay import model_named, prepare

HERE = Path(__file__).parent
RARE = 1e-4
CONSTANT, CURVES = "constant, of 25 °C", "bias curves only"


@pytest.fixture(scope="module")
def study():
    spec = spec_from_file_location("study_thermal_drive", HERE.parent / "studies" / "thermal_drive.py")
    module = module_from_spec(spec)
    # its frozen dataclass looks its module up by name
    import sys

    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.fixture(scope="module")
def outcomes(study):
    return study.study(4, 20.0, ("thermal", CONSTANT, CURVES), workers=1)


def nees(outcomes, title):
    """Return (s, 2) NEES after 30 and 60 s, and the temperatures at which the outages began."""
    found = outcomes[title]
    return np.concatenate([r.nees for r in found]), np.concatenate([r.celsius for r in found])


def test_the_thermal_model_knows_its_errors(outcomes):
    found, _ = nees(outcomes, "thermal")
    assert len(found) >= 40
    # neighbours share a bias: half as many count
    for at in range(found.shape[1]):
        tail = stats.chi2.cdf(found[:, at].mean() / 2 * len(found), len(found))
        assert RARE < tail < 1 - RARE, at
    assert stats.binom.cdf(int((found[:, 0] <= 5.991).sum()), len(found), 0.95) > RARE


def test_the_constant_model_does_not(outcomes):
    found, _ = nees(outcomes, CONSTANT)
    assert (found.mean(axis=0) > 2 * 3).all()
    assert (found <= 5.991).mean() < 0.6


def test_noise_of_one_temperature_is_too_much_in_the_cold_and_too_little_in_the_heat(outcomes):
    found, celsius = nees(outcomes, CURVES)
    cold, hot = found[celsius < 0].mean() / 2, found[celsius > 35].mean() / 2
    assert cold < 0.7
    assert hot > 1.4


def test_regimes_carry_the_noise_of_their_temperature(study):
    log = study.driven(5.0, 0)
    model = model_named("full", FilterModel("f", study.SENSOR), interval=0.01)
    prepared = prepare(log, model)
    celsius = np.array(prepared.measurement.celsius, dtype=float)
    thermometer = log.imus[0].temperature
    at = np.interp(prepared.measurement.time, log.seconds(thermometer.time), thermometer.value)
    assert np.abs(celsius[prepared.measurement.samples.regime] - at).max() <= 1.0 + 1e-6
    tables, _ = model.tables(prepared.measurement.interval, prepared.measurement.celsius)
    wanted = [study.SENSOR.axes["gyro_x"].at(float(t)).terms[0].N ** 2 for t in celsius]
    assert tables.white[:, 0] == pytest.approx(wanted)
    assert wanted[-1] > 10 * wanted[0]
