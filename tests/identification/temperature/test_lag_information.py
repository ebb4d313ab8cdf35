import numpy as np
import pytest
from scipy import fft

from imuwb.identification.temperature.cosine_window import CosineWindow, smoothed
from imuwb.identification.temperature.drift_fit import Weights, fit_drift
from imuwb.identification.temperature.lag_information import lag_information

N = 300


@pytest.fixture(scope="module")
def record():
    """Return the coefficients of an axis, those of its drift's columns, a derivative by the lag, and the weights."""
    rng = np.random.default_rng(4)
    t = np.linspace(-1, 1, N)
    noise = rng.standard_normal(N) + 0.1 * np.cumsum(rng.standard_normal(N))
    columns = fft.dct(np.column_stack([t, t**2]), axis=0, norm="ortho")[1:]
    return (*(fft.dct(x, norm="ortho")[1:] for x in (noise, np.sign(t) * (1 - np.abs(t)))), columns, Weights.of(N, 1.0))


@pytest.mark.parametrize("blurred", [0.0, 0.5])
def test_the_information_is_the_curvature_of_half_the_deviance(record, blurred):
    series, along, columns, weights = record
    noise = np.full(N - 1, blurred)

    def half(lag):
        return fit_drift(series - lag * along, columns, weights, noise).deviance / 2

    fit = fit_drift(series, columns, weights, noise)
    assert fit.probability.max() < 0.9
    found = lag_information(fit, series, columns, along, noise)
    step = 0.02
    assert found.information == pytest.approx((half(step) + half(-step) - 2 * half(0.0)) / step**2, rel=1e-3)
    assert found.score @ series == pytest.approx((half(-step) - half(step)) / (2 * step), rel=1e-3)
    share = found.own / found.information
    assert share == pytest.approx(1.0) if not blurred else 0.5 < share < 0.95


def test_a_sum_over_coefficients_is_one_over_readings_and_has_their_variance():
    window = CosineWindow.of(200, 2.0, 6.0)
    rng = np.random.default_rng(0)
    series, coefficients = rng.standard_normal(200), rng.standard_normal(window.factor.size)
    readings = window.readings(coefficients)
    assert readings @ series[window.inside] == pytest.approx(coefficients @ window.cosines(series))
    through = np.array([smoothed(x, 2.0, 6.0) for x in np.eye(window.length)])
    wanted = 3.0 * np.sum((through @ readings) ** 2)
    assert window.variance(readings, lambda f: np.full(f.size, 3.0)) == pytest.approx(wanted)
    # A noise above the coefficients that are used reaches the means too, but little of it.
    above = window.variance(readings, lambda f: 3.0 * (f > window.frequency[-1]))
    assert 0 <= above < 0.05 * wanted
