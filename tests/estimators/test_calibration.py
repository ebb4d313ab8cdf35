import numpy as np
import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.estimators.calibration import (
    FILES,
    Matrices,
    calibration_text,
    imu_tk_files,
    read_calibration_text,
    subtracted,
    thermal_text,
)
from imuwb.stochastic import AxisModel, ImuErrorModel, shown

RNG = np.random.default_rng(3)


@pytest.fixture(scope="module")
def model():
    return Matrices(
        np.eye(3) + 0.02 * RNG.standard_normal((3, 3)), 0.01 * RNG.standard_normal(3), 1e-4 * RNG.standard_normal((3, 3)),
        np.eye(3) + 0.02 * RNG.standard_normal((3, 3)), 0.1 * RNG.standard_normal(3),
    ).model("mine", "drawn")  # fmt: skip


def test_matrices_measure_as_the_models_own_terms(model):
    rate, force = RNG.standard_normal((5, 3)), 9.8 * RNG.standard_normal((5, 3))
    gyro, accel = shown(model, (rate, force), None)
    m = Matrices.of(model)
    assert gyro == pytest.approx(rate @ m.gyro.T + force @ m.leak.T + m.gyro_bias, abs=1e-12)
    assert accel == pytest.approx(force @ m.accel.T + m.accel_bias, abs=1e-12)


@pytest.mark.parametrize("form", list(FILES))
def test_a_file_is_read_back_as_far_as_it_has_places(form, model):
    """Kalibr and OpenVINS keep gains up to the turn of their frame; the others keep each value that they have."""
    text, notes = calibration_text(model, form)
    found = read_calibration_text(text, "file")
    assert found is not None
    name, back = found
    assert name == form
    before, after = Matrices.of(model), Matrices.of(back)
    if form in ("kalibr-imu", "openvins-imu"):
        turn = np.linalg.solve(before.accel, after.accel)
        assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-9)
        assert after.gyro == pytest.approx(before.gyro @ turn, abs=1e-9)
        assert after.leak == pytest.approx(before.leak @ turn, abs=1e-9)
        assert any("mrad" in note for note in notes)
    elif form in ("imu-tk", "imu-calib"):
        assert after.accel == pytest.approx(before.accel, abs=1e-9)
        assert after.accel_bias == pytest.approx(before.accel_bias, abs=1e-9)
    else:
        assert np.diag(after.accel) == pytest.approx(np.diag(before.accel), abs=1e-8)
        assert after.gyro_bias == pytest.approx(before.gyro_bias, abs=1e-8)
        assert sum("left out" in note for note in notes) == 3


def test_imu_tk_has_a_file_for_each_triad_and_each_is_read_alone(model):
    before = Matrices.of(model)
    files = imu_tk_files(calibration_text(model, "imu-tk")[0])
    for name, gain, bias in (("acc", before.accel, before.accel_bias), ("gyro", before.gyro, before.gyro_bias)):
        numbers = np.array(files[name].split(), float)
        assert np.linalg.inv(numbers[:9].reshape(3, 3) @ numbers[9:18].reshape(3, 3)) == pytest.approx(gain, abs=1e-9)
        found = read_calibration_text(files[name], f"gyros/cube.{name}.calib")
        assert found is not None
        back = Matrices.of(found[1])
        assert (back.gyro if name == "gyro" else back.accel) == pytest.approx(gain, abs=1e-9)
        assert (back.gyro_bias if name == "gyro" else back.accel_bias) == pytest.approx(bias, abs=1e-9)
        assert set(found[1].axes) == {f"{'gyro' if name == 'gyro' else 'accel'}_{axis}" for axis in "xyz"}


def test_a_matrix_of_kalibr_may_be_one_list_over_several_lines():
    text = "accelerometers:\n  M: [[1.0, 0.0,\n       0.0], [0.001, 1.01, 0.0],\n    [0.0, 0.0, -9.9e-1]]\ngyroscopes:\n  M:\n  - - 1.0\n    - 0.0\n    - 0.0\n  - [0.0, 1.0, 0.0]\n  - [0.0, 0.0, -1.0]\n"
    found = read_calibration_text(text, "file")
    assert found is not None
    m = Matrices.of(found[1])
    assert np.diag(m.accel) == pytest.approx([1, 1.01, -0.99])
    assert m.accel[1, 0] == pytest.approx(1e-3)
    assert np.diag(m.gyro) == pytest.approx([1, 1, -1])


def test_imu_tk_undoes_a_measurement_by_its_own_formula(model):
    numbers = np.array(calibration_text(model, "imu-tk")[0].split(), float)[:21]
    force = np.array([1.0, -2.0, 9.0])
    raw = shown(model, (np.zeros((1, 3)), force[None]), None)[1][0]
    assert numbers[:9].reshape(3, 3) @ numbers[9:18].reshape(3, 3) @ (raw - numbers[18:]) == pytest.approx(force)


def test_what_cannot_be_written_is_refused():
    with pytest.raises(MissingDataError, match="no bias"):
        calibration_text(ImuErrorModel("m", {"gyro_x": AxisModel()}), "imu-tk")
    mirrored = Matrices(np.eye(3), np.zeros(3), np.zeros((3, 3)), np.diag([1.0, 1.0, -0.5]), np.zeros(3)).model("m", "")
    with pytest.raises(UsageError, match="mirrors"):
        calibration_text(mirrored, "kalibr-imu")
    with pytest.raises(UsageError, match="kalibr-imu"):
        calibration_text(mirrored, "imutk")
    assert read_calibration_text("hello", "file") is None


@pytest.mark.parametrize(
    ("form", "instance"), [("ardupilot-tcal", 0), ("ardupilot-tcal", 1), ("px4-tc", 0), ("px4-tc", 2)]
)
def test_an_autopilot_takes_off_the_bias_at_every_temperature(form, instance):
    """The formulas of the autopilots, applied to the file, give the bias of the model; outside its range, that of the end."""
    celsius = np.array([-10.0, 5.0, 20.0, 40.0, 55.0, 65.0])

    def bias(scale, t):
        return scale * (0.5 + 0.02 * t - 3e-4 * t**2 + 2e-6 * t**3)

    axes = {
        f"{sensor}_{axis}": AxisModel(thermal_bias=tuple((t, bias(scale * (1 + k), t)) for t in celsius))
        for sensor, scale in (("gyro", 1e-3), ("accel", 0.1))
        for k, axis in enumerate("xyz")
    }
    text, notes = thermal_text(ImuErrorModel("m", axes), form, instance)
    values = {
        parts[0]: float(parts[1]) for line in text.splitlines() if not line.startswith("#") and (parts := line.split())
    }
    at = np.array([-30.0, -10.0, 12.0, 35.0, 50.0, 90.0])
    gyro, accel = subtracted(form, values, at, instance)
    held = np.clip(at, -10, 65)
    for k in range(3):
        assert gyro[:, k] == pytest.approx(bias(1e-3 * (1 + k), held), rel=1e-6)
        assert accel[:, k] == pytest.approx(bias(0.1 * (1 + k), held), rel=1e-6)
    assert any("-10 to 65" in note for note in notes)


@pytest.mark.parametrize(
    ("points", "instance", "error", "named"),
    [((), 0, MissingDataError, "no bias by temperature"), (((20.0, 0.1), (25.0, 0.2)), 0, MissingDataError, "10 °C or more"),
     (((0.0, 0.1), (25.0, 0.2)), 7, UsageError, "--instance 7")],
)  # fmt: skip
def test_curves_that_cannot_be_written_are_named(points, instance, error, named):
    model = ImuErrorModel("m", {"gyro_x": AxisModel(thermal_bias=points)})
    with pytest.raises(error, match=named):
        thermal_text(model, "px4-tc", instance)


def test_a_calibration_by_temperature_has_a_table_in_its_comments():
    curve = ((10.0, 0.1), (20.0, 0.3))
    warm = ImuErrorModel(
        "m", {"accel_x": AxisModel(thermal_bias=curve, thermal_scale_factor=((10.0, 0.0), (20.0, 0.02)))}
    )
    text, notes = calibration_text(warm, "ardupilot-ins", celsius=15.0)
    assert "# at 20 °C: accel bias 0.3 m/s²; accel scale factor 0.02" in text
    assert "INS_ACCOFFS_X 0.2" in text
    assert any("at 15 °C" in note for note in notes)
