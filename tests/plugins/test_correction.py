from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import SECOND, ImuStream, Log, Provenance, Scalars, Triad
from imuwb.stochastic import AxisModel, ImuErrorModel, Sum, WhiteNoise, shown
from imuwb_plugins import correction


@pytest.fixture
def save(tmp_path):
    def write(**axes):
        path = tmp_path / "model.toml"
        path.write_text(ImuErrorModel("mine", axes).to_toml(), "utf-8")
        return correction.Parameters(path)

    return write


def triad(values, rate, start=0.0):
    values = np.asarray(values, dtype=float)
    return Triad(np.rint((np.arange(len(values)) / rate + start) * SECOND).astype(np.int64), values)


def log(gyro, accel, temperature=None):
    return Log(Provenance("made.csv", "csv", "sha256:0", 0), imus=(ImuStream("/imu", gyro, accel, temperature),))


AXES = {
    "gyro_x": AxisModel(bias=0.1, scale_factor=0.02, cross_coupling=(0.01, -0.02), g_sensitivity=(1e-3, 0.0, 2e-3)),
    "gyro_z": AxisModel(scale_factor_nonlinear=0.01, range=4.0),
    "accel_y": AxisModel(bias=-0.3, scale_factor=-0.03, cross_coupling=(0.02, 0.01)),
}


def test_it_is_the_inverse_of_what_sensors_show(save):
    rng = np.random.default_rng(0)
    motion = rng.standard_normal((200, 3)), 9.8 * rng.standard_normal((200, 3))
    seen = shown(ImuErrorModel("mine", AXES), motion, None)
    changed, found = correction.condition(log(triad(seen[0], 100), triad(seen[1], 100)), save(**AXES))
    np.testing.assert_allclose(changed.imu().angular_rate.value, motion[0], atol=1e-10)
    np.testing.assert_allclose(changed.imu().specific_force.value, motion[1], atol=1e-10)
    (step,) = changed.conditioning
    assert (step.name, step.causal, step.delay, step.band) == ("correction", True, 0.0, None)
    for term in ("bias", "scale factor", "non-linear", "cross-coupling", "g-sensitivity"):
        assert term in step.note
    assert found.celsius is None


def test_clocks_of_their_own_and_no_look_ahead(save):
    """A g-sensitivity meets the latest force at a gyro's time, whatever comes later."""
    axes = {"gyro_x": AxisModel(g_sensitivity=(0.5, 0.0, 0.0))}
    accel = np.zeros((10, 3))
    accel[:, 0] = np.arange(10)
    found, _ = correction.condition(log(triad(np.zeros((20, 3)), 100), triad(accel, 50, 0.005)), save(**axes))
    # Before the first force, the first; behind it, the last that is known.
    wanted = [-0.5 * max((k - 1) // 2 if k else 0, 0) for k in range(20)]
    np.testing.assert_allclose(found.imu().angular_rate.value[:, 0], wanted)
    later = accel.copy()
    later[5:] += 100
    other, _ = correction.condition(log(triad(np.zeros((20, 3)), 100), triad(later, 50, 0.005)), save(**axes))
    np.testing.assert_array_equal(other.imu().angular_rate.value[:11], found.imu().angular_rate.value[:11])


def test_the_logs_own_temperature_counts(save):
    axes = {"accel_z": AxisModel(thermal_bias=((0.0, 0.0), (50.0, 1.0)))}
    temperature = Scalars("t", np.array([0, 1, 2]) * SECOND, np.array([0.0, 25.0, 100.0]))
    changed, found = correction.condition(log(None, triad(np.zeros((300, 3)), 100), temperature), save(**axes))
    z = changed.imu().specific_force.value[:, 2]
    np.testing.assert_allclose(z[[0, 99, 100, 199, 200, 299]], [0, 0, -0.5, -0.5, -1.0, -1.0])
    assert found.celsius == (0.0, 100.0)
    assert "0.0 to 100.0 °C" in changed.conditioning[0].note


def test_one_sensor_alone_is_corrected_where_it_can_be(save):
    accel = correction.condition(log(None, triad(np.zeros((50, 3)), 100)), save(**AXES))[0].imu()
    assert accel.angular_rate is None
    assert accel.specific_force.value[0, 1] == pytest.approx(0.3 / 0.97)
    without = {"gyro_x": replace(AXES["gyro_x"], g_sensitivity=(0.0, 0.0, 0.0))}
    gyro = correction.condition(log(triad(np.zeros((50, 3)), 100), None), save(**without))[0].imu()
    assert gyro.angular_rate.value[0, 0] == pytest.approx(-0.1 / 1.02)


def test_what_it_cannot_do(save, tmp_path):
    gyro = triad(np.zeros((50, 3)), 100)
    with pytest.raises(MissingDataError, match="no accelerometer, .* g-sensitivity"):
        correction.condition(log(gyro, None), save(**AXES))
    with pytest.raises(MissingDataError, match="no temperature"):
        correction.condition(log(gyro, None), save(gyro_x=AxisModel(thermal_bias=((0.0, 1.0),))))
    with pytest.raises(UsageError, match="no bias, scale factor"):
        correction.condition(log(gyro, None), save(gyro_x=AxisModel(Sum((WhiteNoise(1.0),)))))
    with pytest.raises(UsageError, match="so large"):
        correction.condition(log(gyro, gyro), save(
            gyro_x=AxisModel(bias=1.0, cross_coupling=(3.0, 3.0)), gyro_y=AxisModel(bias=1.0, cross_coupling=(3.0, 3.0)),
        ))  # fmt: skip
    with pytest.raises(UsageError, match="nowhere.toml: cannot be read"):
        correction.condition(log(gyro, None), correction.Parameters(tmp_path / "nowhere.toml"))
    with pytest.raises(MissingDataError, match="no IMU"):
        correction.condition(Log(Provenance("made.csv", "csv", "sha256:0", 0)), save(**AXES))


def test_a_model_is_taken_off_once(save):
    samples = triad(np.ones((4, 3)), 10)
    model = save(**AXES)
    once, _ = correction.condition(log(samples, samples), model)
    with pytest.raises(UsageError, match=r"model.toml: its terms are already removed; give it once"):
        correction.condition(once, model)


def test_what_was_taken_off_is_drawn(save, shown):
    _, found = correction.condition(log(None, triad(np.zeros((50, 3)), 100)), save(**AXES))
    correction.draw(found, shown)
    (table,) = shown.tables
    assert [row[0] for row in table.rows] == ["gyro_x", "gyro_z", "accel_y"]
    assert "5.7" in table.rows[0][1]  # deg/s


def test_axes_that_stay_in_counts_are_left_out(tmp_path):
    scaled = {f"accel_{k}": AxisModel(bias=30_000.0, scale_factor=1670.0) for k in "xyz"}
    still = {f"gyro_{k}": AxisModel(bias=500.0, g_sensitivity=(0.1, 0.0, 0.0)) for k in "xyz"}
    time = np.arange(100) * (SECOND // 100)
    counts = ImuStream("/imu", Triad(time, np.full((100, 3), 500.0)), Triad(time, np.full((100, 3), 31_671.0)))
    raw = Log(Provenance("a.csv", "csv", "sha256:0", 0), imus=(counts,))
    for turned, left in (({}, "xyz"), ({"gyro_z": AxisModel(bias=500.0, scale_factor=7505.0)}, "xy")):
        model = ImuErrorModel("mine", {**scaled, **still, **turned}, provenance={"calibration_unit": "count"})
        path = tmp_path / f"{left}.toml"
        path.write_text(model.to_toml(), "utf-8")
        found, _ = correction.condition(raw, correction.Parameters(path))
        imu = found.imu()
        assert imu.specific_force.value == pytest.approx(1.0, abs=2e-3)
        assert (imu.angular_rate is None) == (left == "xyz")
        assert imu.angular_rate is None or imu.angular_rate.axes == "z"
        assert f"without gyro {left[0]}" in found.conditioning[-1].note
