import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.identification import allan
from imuwb.simulation import preset, static
from imuwb.stochastic import AxisModel, ImuErrorModel, Sum, WhiteNoise


def model(**axis):
    return ImuErrorModel("test", {"gyro_z": AxisModel(Sum((WhiteNoise(0.01),)), **axis)})


def test_same_seed_same_log_other_seed_other_log():
    logs = [static(preset("3dm-gx3-25"), 20, 100, seed) for seed in (1, 1, 2)]
    values = [log.imus[0].angular_rate.value for log in logs]
    assert np.array_equal(values[0], values[1])
    assert not np.array_equal(values[0], values[2])
    assert logs[0].provenance.hash == logs[1].provenance.hash != logs[2].provenance.hash


def test_axes_are_independent_and_level():
    log = static(preset("3dm-gx3-25"), 100, 100, 3)
    imu = log.imus[0]
    assert imu.specific_force.value.mean(axis=0) == pytest.approx([0, 0, -9.80665], abs=0.02)
    correlation = np.corrcoef(np.diff(imu.angular_rate.value, axis=0).T)
    assert np.abs(correlation - np.eye(3)).max() < 0.06


def test_output_is_whole_steps_within_the_range():
    log = static(model(lsb=0.02, range=0.05), 10, 100, 1, quantize=True)
    steps = log.imus[0].angular_rate.value[:, 2] / 0.02
    assert np.array_equal(steps, np.rint(steps))
    assert set(np.unique(steps)) == {-2.0, -1.0, 0.0, 1.0, 2.0}


def test_quantizing_needs_a_step():
    with pytest.raises(UsageError, match="lsb"):
        static(model(), 10, 100, 1, quantize=True)


def test_bandwidth_takes_the_high_frequencies_and_leaves_the_low():
    wide, narrow = (static(model(), 600, 100, 5, bandwidth=b).imus[0].angular_rate.value[:, 2] for b in (None, 5.0))
    assert allan(narrow, 0.01, [0.01]).deviation < 0.2 * allan(wide, 0.01, [0.01]).deviation
    assert allan(narrow, 0.01, [10.0]).deviation == pytest.approx(allan(wide, 0.01, [10.0]).deviation, rel=0.05)


def test_temperature_chooses_the_noise():
    sensor = preset("motionpakii")
    cold, warm = (static(sensor, 300, 100, 1, celsius=t).imus[0] for t in (-30, 0))
    ratio = cold.angular_rate.value.std() / warm.angular_rate.value.std()
    assert ratio == pytest.approx(2.2292 / 1.6224, rel=1e-3)
    assert set(cold.temperature.value) == {-30.0}


@pytest.mark.parametrize(
    "wrong",
    [
        {"duration": -1},
        {"rate": 0},
        {"duration": 1e12},
        {"duration": float("nan")},
        {"rate": float("inf")},
        {"bandwidth": 60.0},
    ],
)
def test_what_cannot_be_is_refused(wrong):
    with pytest.raises(UsageError):
        static(model(), **{"duration": 10, "rate": 100, "seed": 1, **wrong})


def test_deterministic_terms_show_in_gravity():
    accel = AxisModel(scale_factor=0.01, cross_coupling=(0.0, 0.002))
    gyro = AxisModel(g_sensitivity=(0.0, 0.0, 1e-3))
    imu = static(ImuErrorModel("test", {"accel_z": accel, "accel_x": accel, "gyro_y": gyro}), 1, 100, 0).imus[0]
    assert imu.specific_force.value[0] == pytest.approx([-9.80665 * 0.002, 0, -9.80665 * 1.01])
    assert imu.angular_rate.value[0] == pytest.approx([0, -9.80665e-3, 0])
