import numpy as np
import pytest
from scipy import fft
from scipy.signal import lfilter

from imuwb.identification.temperature import (
    bias_polynomial,
    polynomial_through,
    thermal_lag,
    thermometer_curve,
)
from imuwb.identification.temperature.drift_fit import Weights, fit_drift

STEP, BLOCKS, FINE, LAG = 2.0, 900, 20, 40.0
AT = STEP * (np.arange(BLOCKS) + 0.5)
SLOPES = {"gyro_x": (3e-4, 2e-6), "gyro_y": (-1e-4, 0.0), "accel_z": (5e-3, 1e-5)}
LOOPS = {"gyro_x": 1e-3, "gyro_y": 0.0, "accel_z": -1e-3}
NOISE = 5e-5


def ramp(seconds=0.0):
    """Return block means of a ramp up and down, through a low-pass."""
    n = BLOCKS * FINE
    fine = -20 + 80 * (1 - np.abs(2 * (np.arange(n) + 0.5) / n - 1))
    if seconds:
        keep = np.exp(-STEP / FINE / seconds)
        fine = lfilter([1 - keep], [1, -keep], fine, zi=[keep * fine[0]])[0]
    return fine.reshape(BLOCKS, FINE).mean(axis=1)


RAMP, LATE = ramp(), ramp(LAG)


def means(celsius, seed=0, *, loops=None):
    rng = np.random.default_rng(seed)
    rising = np.sign(np.gradient(celsius))
    return {
        axis: a * (celsius - 25)
        + b * (celsius - 25) ** 2
        + (loops or {}).get(axis, 0.0) / 2 * rising
        + NOISE * rng.standard_normal(BLOCKS)
        for axis, (a, b) in SLOPES.items()
    }


def found(read, axes, **options):
    return thermal_lag(thermometer_curve(AT, read, AT), axes, **options)


@pytest.mark.parametrize(("noise", "late"), [(0.0, True), (0.05, True), (0.0, False)])
def test_the_lag_and_the_hysteresis_of_a_ramp_are_found(noise, late):
    own, read = (RAMP, LATE) if late else (LATE, RAMP)
    read = read + noise * np.random.default_rng(9).standard_normal(BLOCKS)
    result = found(read, means(own, loops=LOOPS))
    truth = LAG if late else -LAG
    assert abs(result.lag.value - truth) < 4 * result.lag.sigma
    assert result.lag.sigma < 2
    assert result.evident
    assert len(result.turns) == 1
    for axis, loop in LOOPS.items():
        assert abs(result.hysteresis[axis].value - loop) < 4 * result.hysteresis[axis].sigma


def test_a_thermometer_without_lag_has_none():
    result = found(RAMP, means(RAMP, seed=3))
    assert not result.evident
    assert abs(result.lag.value) < 4 * result.lag.sigma
    np.testing.assert_array_equal(result.celsius, result.later)


def test_a_lag_that_is_given_is_taken():
    result = found(RAMP, means(RAMP), given=10.0)
    assert (result.lag.value, result.evident) == (10.0, True)
    middle = result.celsius[100] - RAMP[100]
    assert middle == pytest.approx(10 * (RAMP[101] - RAMP[99]) / (2 * STEP), rel=1e-6)


def test_a_steady_or_short_record_shows_no_lag():
    assert found(20 + 0 * RAMP, means(RAMP)) is None
    few = slice(0, 50)
    assert thermal_lag(thermometer_curve(AT[few], RAMP[few], AT[few]), {"gyro_x": RAMP[few]}) is None


def test_a_one_way_ramp_does_not_determine_it():
    warm = np.linspace(-20, 60, BLOCKS)
    result = found(warm, means(warm))
    assert not result.evident
    assert not result.hysteresis


def test_a_polynomial_of_the_samples_holds_the_truth_and_does_not_extrapolate():
    result = found(RAMP, means(RAMP, seed=5, loops=LOOPS))
    for axis, (a, b) in SLOPES.items():
        p = bias_polynomial(result, axis, 25.0, level=0.9999)
        for factor, truth in zip(p.factors, (0.0, a, b), strict=False):
            assert truth in factor
        value, lower, upper = p.at(np.array([0.0, 25.0]))
        assert (lower < value).all()
        assert (value < upper).all()
        with pytest.raises(ValueError, match="61 °C is outside"):
            p.at(np.array([20.0, 61.0]))
    assert len(bias_polynomial(result, "gyro_y", 25.0).factors) < 4


def test_a_polynomial_through_points_is_the_autopilots():
    celsius = np.array([0.0, 10.0, 20.0, 30.0, 40.0])
    cubic = 1e-3 + 2e-4 * (celsius - 35) - 3e-6 * (celsius - 35) ** 2 + 4e-8 * (celsius - 35) ** 3
    p = polynomial_through(celsius, cubic, 35.0)
    np.testing.assert_allclose([f.value for f in p.factors], [1e-3, 2e-4, -3e-6, 4e-8], rtol=1e-8)
    assert [f.value for f in polynomial_through(celsius[:2], cubic[:2], 35.0).factors[2:]] == [0, 0]


def test_slow_noise_widens_a_drifts_interval():
    n = 400
    rng = np.random.default_rng(1)
    t = np.linspace(-1, 1, n)
    column = fft.dct(t, norm="ortho")[1:, None]
    weights = Weights.of(n, 1.0)
    white = rng.standard_normal(n)
    walk = np.cumsum(rng.standard_normal(n))
    fits = [fit_drift(fft.dct(x, norm="ortho")[1:], column, weights) for x in (white, white + walk)]
    assert abs(fits[0].factors[0]) < 4 * fits[0].covariance[0, 0] ** 0.5
    assert fits[0].covariance[0, 0] ** 0.5 == pytest.approx(1 / np.linalg.norm(column), rel=0.2)
    assert fits[1].covariance[0, 0] > 25 * fits[0].covariance[0, 0]
    with pytest.raises(ValueError, match="depend on each other"):
        fit_drift(fft.dct(white, norm="ortho")[1:], np.hstack([column, 2 * column]), weights)


def test_a_drifts_interval_holds_it_beside_slow_noise_that_barely_shows():
    n, records = 200, 400
    rng = np.random.default_rng(11)
    column = fft.dct(np.linspace(-1, 1, n), norm="ortho")[1:, None]
    weights = Weights.of(n, 1.0)
    errors = []
    for _ in range(records):
        noise = rng.standard_normal(n) + 0.02 * np.cumsum(rng.standard_normal(n))
        fit = fit_drift(fft.dct(noise, norm="ortho")[1:], column, weights)
        errors.append(fit.factors[0] / fit.covariance[0, 0] ** 0.5)
    assert fit.probability.sum() == pytest.approx(1)
    assert np.mean(np.square(errors)) < 1.45  # 1.25; with the likeliest slow noise alone it is 1.7


def test_a_sensor_that_lags_is_at_rest_where_the_first_block_begins():
    curve = thermometer_curve(AT, AT, AT)
    own = curve.of_sensor(-LAG, 1e-6)
    np.testing.assert_allclose(own, AT - LAG * (1 - np.exp(-AT / LAG)), atol=1e-9)
