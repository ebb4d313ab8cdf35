"""A sensor's temperature over time, and logs of a sensor whose temperature changes."""

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.simulation import Temperature, drive, mixed_route, preset, static
from imuwb.stochastic import Autoregressive, AxisModel, ImuErrorModel, Sum, WhiteNoise

WARM = Temperature(((0.0, -20.0), (100.0, -20.0), (200.0, 50.0)))


def values(log):
    imu = log.imus[0]
    return np.hstack([imu.angular_rate.value, imu.specific_force.value])


def test_between_corners_a_temperature_is_linear_and_beyond_held():
    at = WARM.at(np.array([0.0, 50.0, 100.0, 150.0, 200.0, 1e6]))
    assert at == pytest.approx([-20, -20, -20, 15, 50, 50])
    assert Temperature.ramp(-40.0, 70.0, 3600.0).at(np.array([0.0, 900.0, 3600.0])) == pytest.approx([-40, -12.5, 70])


def test_electronics_warm_themselves_up():
    found = Temperature(((0.0, 20.0), (1000.0, 10.0)), rise=15.0, time_constant=300.0)
    t = np.array([0.0, 300.0, 600.0, 3000.0])
    assert found.at(t) == pytest.approx(
        [20, 17 + 15 * (1 - 1 / np.e), 14 + 15 * (1 - np.e**-2), 10 + 15 * (1 - np.e**-10)]
    )
    assert found.constant is None


@pytest.mark.parametrize(
    ("make", "why"),
    [
        (lambda: Temperature(()), "at least one"),
        (lambda: Temperature(((0.0, 1.0), (0.0, 2.0))), "must rise"),
        (lambda: Temperature(((float("nan"), 1.0),)), "must rise"),
        (lambda: Temperature(((0.0, -300.0),)), "-300"),
        (lambda: Temperature(((0.0, float("nan")),)), "nan"),
        (lambda: Temperature(((0.0, 20.0),), rise=2000.0), "2020"),
        (lambda: Temperature(((0.0, 20.0),), rise=1.0, time_constant=0.0), "time constant"),
    ],
)
def test_what_cannot_be_is_refused(make, why):
    with pytest.raises(UsageError, match=why):
        make()


@pytest.mark.parametrize("flat", [Temperature(((0.0, 40.0),)), Temperature.ramp(40.0, 40.0, 60.0)])
def test_a_profile_that_is_constant_gives_the_log_of_that_temperature(flat):
    sensor = preset("motionpakii")
    one, other = (static(sensor, 20, 100, 1, celsius=c) for c in (40.0, flat))
    assert np.array_equal(values(one), values(other))
    assert one.provenance.hash == other.provenance.hash
    route = mixed_route(90, 0)
    one, other = (drive(sensor, route, 1, rate=20, celsius=c) for c in (40.0, flat))
    assert np.array_equal(values(one), values(other))
    assert one.provenance.hash == other.provenance.hash


def test_without_a_temperature_a_sensor_is_at_the_25_degrees_that_its_log_tells():
    sensor = preset("motionpakii")
    one, other = (static(sensor, 20, 100, 1, celsius=c) for c in (None, 25.0))
    assert set(one.imus[0].temperature.value) == {25.0}
    assert np.array_equal(values(one), values(other))


def test_windows_of_a_ramp_have_the_noise_of_their_temperature():
    sensor = preset("motionpakii")
    log = static(sensor, 4000, 50, 3, celsius=Temperature.ramp(-40.0, 70.0, 4000.0))
    thermometer = log.imus[0].temperature
    assert len(thermometer) == 4000
    assert thermometer.value == pytest.approx(-40 + 110 * np.arange(4000) / 4000, abs=1e-9)
    for name, (_, found) in log.imus[0].axes().items():
        parts = found.reshape(40, -1)
        of_each = thermometer.value.reshape(40, -1).mean(axis=1)
        wanted = np.array([sensor.axes[name].at(float(t)).terms[0].N for t in of_each]) * np.sqrt(50)
        # within a window the noise changes by 5 % at most; its scatter is 1/√(2n)
        off = (parts.std(axis=1) / wanted - 1) * np.sqrt(2 * parts.shape[1])
        assert np.abs(off).max() < 4.5, name
        assert (off**2).mean() < 2.5, name


def test_a_bias_and_a_scale_factor_follow_the_temperature():
    axis = AxisModel(thermal_bias=((-20.0, 0.1), (50.0, -0.3)), thermal_scale_factor=((-20.0, 0.0), (50.0, 0.02)))
    log = static(ImuErrorModel("curves", {"accel_z": axis}), 200, 10, 0, celsius=WARM)
    celsius = WARM.at(np.arange(2000) / 10)
    wanted = 0.1 - 0.4 * (celsius + 20) / 70 - 9.80665 * (1 + 0.02 * (celsius + 20) / 70)
    assert log.imus[0].specific_force.value[:, 2] == pytest.approx(wanted, rel=1e-12)


def test_another_profile_is_another_log():
    sensor = preset("motionpakii")
    logs = [static(sensor, 20, 50, 1, celsius=Temperature.ramp(0.0, end, 20.0)) for end in (10.0, 10.0, 20.0)]
    assert logs[0].provenance.hash == logs[1].provenance.hash != logs[2].provenance.hash
    assert np.array_equal(values(logs[0]), values(logs[1]))


def test_an_ar_set_that_is_not_stable_between_set_points_is_refused():
    sets = [
        Autoregressive(alpha, 1.0, 0.01) for alpha in ((-2.7, 2.43, -0.729), (2.7, 2.43, 0.729), (-2.7, 2.43, -0.729))
    ]
    points = tuple(zip((0.0, 10.0, 20.0), (Sum((one,)) for one in sets), strict=True))
    model = ImuErrorModel("bent", {"gyro_x": AxisModel(points[0][1], thermal=points)})
    with pytest.raises(UsageError, match="not stable"):
        static(model, 20, 100, 1, celsius=Temperature.ramp(0.0, 20.0, 20.0))


def test_what_does_not_depend_on_temperature_is_drawn_as_ever():
    model = ImuErrorModel("plain", {"gyro_x": AxisModel(Sum((WhiteNoise(0.1),)))})
    one, other = (static(model, 20, 100, 1, celsius=c) for c in (None, Temperature.ramp(0.0, 20.0, 20.0)))
    assert np.array_equal(values(one), values(other))
