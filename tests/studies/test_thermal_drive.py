"""Drives that warm up: with a model by temperature the filter is consistent in outages, with a constant one it is not."""

import numpy as np
import pytest
from scipy import stats

from imuwb.navigation import FilterModel
from imuwb.replay import model_named, prepare

RARE = 1e-4
CONSTANT, CURVES = "constant, of 25 °C", "bias curves only"
DRIVES, MINUTES = 4, 20.0

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def study(load):
    return load("thermal_drive")


@pytest.fixture(scope="module")
def outcomes(study):
    """Return {error model: outcomes} of four drives."""
    drives = [study.driven(MINUTES, seed) for seed in range(DRIVES)]
    return {title: [study.thermal_outcome(log, title) for log in drives] for title in ("thermal", CONSTANT, CURVES)}


def nees(outcomes, title):
    """Return (s, 2) NEES after 30 and 60 s, and the temperatures at which the outages began."""
    observed = outcomes[title]
    return np.concatenate([r.nees for r in observed]), np.concatenate([r.celsius for r in observed])


def test_the_thermal_model_knows_its_errors(outcomes):
    observed, _ = nees(outcomes, "thermal")
    assert len(observed) >= 40
    # Neighbouring outages share a bias: half of the degrees of freedom count.
    for at in range(observed.shape[1]):
        tail = stats.chi2.cdf(observed[:, at].mean() / 2 * len(observed), len(observed))
        assert RARE < tail < 1 - RARE, at
    assert stats.binom.cdf(int((observed[:, 0] <= 5.991).sum()), len(observed), 0.95) > RARE


def test_the_constant_model_does_not(outcomes):
    observed, _ = nees(outcomes, CONSTANT)
    assert (observed.mean(axis=0) > 2 * 3).all()
    assert (observed <= 5.991).mean() < 0.6


def test_noise_of_one_temperature_is_too_much_in_the_cold_and_too_little_in_the_heat(outcomes):
    observed, celsius = nees(outcomes, CURVES)
    cold, hot = observed[celsius < 0].mean() / 2, observed[celsius > 35].mean() / 2
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
    expected = [study.SENSOR.axes["gyro_x"].at(float(t)).terms[0].N ** 2 for t in celsius]
    assert tables.white[:, 0] == pytest.approx(expected)
    assert expected[-1] > 10 * expected[0]
