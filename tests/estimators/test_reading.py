import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.errors import UsageError
from imuwb.estimators import Options, Setting, export, read_estimator_file, read_estimator_text, tools
from imuwb.stochastic import (
    FLICKER_LEVEL,
    AxisModel,
    Constant,
    FlickerNoise,
    GaussMarkov,
    ImuErrorModel,
    RandomWalk,
    Sum,
    WhiteNoise,
)

SIZES = st.floats(1e-8, 1e-1)
RATE = 200.0


def models(bounded):
    """Return models of white noise, one kind of slow error, and biases at turn-on."""
    return st.composite(_drawn)(bounded)


def _drawn(draw, bounded):
    axes = {}
    for sensor in ("gyro", "accel"):
        for axis in "xyz":
            slow = GaussMarkov(draw(SIZES), 1800.0) if bounded else RandomWalk(draw(SIZES))
            axes[f"{sensor}_{axis}"] = AxisModel(Sum((WhiteNoise(draw(SIZES)), slow, Constant(draw(SIZES)))))
    return ImuErrorModel("m", axes, {"rate": f"{RATE:g} Hz"})


@pytest.mark.parametrize("tool", list(tools()))
@settings(max_examples=5, deadline=None)
@given(data=st.data())
def test_what_an_export_states_is_read_back_to_its_digits(tool, data):
    """The file of the model that was read is the file itself, but for numbers outside of a tool's range."""
    model = data.draw(models("sigma" in tools()[tool].terms))
    options = Options(rate=RATE, scale_factor=1e-4)
    first = export(model, tool, options)
    reading = read_estimator_text(first.text, "file", None, Setting(rate=RATE))
    assert reading.form == tool
    again = export(reading.model, tool, options)
    assert set(again.values) == set(first.values)
    for key, values in first.values.items():
        assert again.values[key] == pytest.approx(values, rel=2e-3 if "Stab" in key else 1e-6), key
    for axis, content in model.axes.items():
        white = content.processes.terms[0].N
        worst = max(model.axes[f"{axis[:-1]}{a}"].processes.terms[0].N for a in "xyz")
        field = next(f for f in tools()[tool].fields if f.term == "N" and f.sensor == axis.partition("_")[0])
        if field.least is None:
            expected = worst if field.shape == "largest" else white
            assert pytest.approx(expected, rel=1e-8) == reading.model.axes[axis].processes.terms[0].N


@pytest.mark.parametrize(
    ("text", "n", "k"),
    [
        ("imu0:\n  accelerometer_noise_density: 0.002\n  gyroscope_noise_density:   1.6e-4  #Noise\n  gyroscope_random_walk: 2e-6\n", 1.6e-4, 2e-6),
        ("%YAML:1.0\n---\nIMU.NoiseGyro: 1.7e-04 # rad/s^0.5\nIMU.NoiseAcc: 2.0e-03\nIMU.GyroWalk: 1.9393e-05\nIMU.AccWalk: 3.0e-3\nIMU.Frequency: 200.0\n", 1.7e-4, 1.9393e-5),
        ("lio_sam:\n  imuAccNoise: 3.9939570888238808e-03\n  imuGyrNoise: 1.5636343949698187e-03\n  imuGyrBiasN: 3.5640318696367613e-05\n", 1.5636343949698187e-3, 3.5640318696367613e-5),
        ("acc_n: 0.08          # accelerometer measurement noise\ngyr_n: 0.004\nacc_w: 0.00004\ngyr_w: 2.0e-6\n", 0.004 / math.sqrt(400), 2e-6 / math.sqrt(200)),
    ],
)  # fmt: skip
def test_files_as_their_tools_come_with_are_read(text, n, k):
    terms = read_estimator_text(text, "file", None, Setting(rate=200)).model.axes["gyro_y"].processes.terms
    assert terms == (WhiteNoise(pytest.approx(n)), RandomWalk(pytest.approx(k)))


def test_what_a_file_does_not_state_stays_unknown_and_is_said():
    reading = read_estimator_text("gyroscope_noise_density: 1e-4\naccelerometer_noise_density: 1e-3\n", "imu.yaml")
    assert reading.model.axes["gyro_x"].processes == Sum((WhiteNoise(1e-4),))
    assert any("gyroscope_random_walk" in note and "unknown" in note for note in reading.notes)
    assert reading.model.doubts
    assert ImuErrorModel.from_toml(reading.model.to_toml()).axes == reading.model.axes


@pytest.mark.parametrize(
    ("text", "tool", "named"),
    [
        ("hello: 3\n", None, "--from"),
        ("hello: 3\n", "kalibr", "no value of kalibr"),
        ("acc_n: 0.1\ngyr_n: 0.2\n", None, "--rate"),
        (
            "gyroscope_noise_density: -1\naccelerometer_noise_density: 1\n",
            None,
            "noise_density is -1.0; it must be 0 or more",
        ),
        (
            "gyroscope_noise_density: 1\naccelerometer_noise_density: 1\ngyroscope_noise_density: 2\n",
            None,
            "stated 2 times",
        ),
        ("imunoise:\n  arw: [1, 2]\n  vrw: [1, 2, 3]\n  gbstd: [1, 2, 3]\n  gsstd: [1, 2, 3]\n", None, "2 numbers"),
        (
            "<!DOCTYPE a [<!ENTITY b 'c'>]><imu><angular_velocity/><linear_acceleration/></imu>",
            "gazebo",
            "document type",
        ),
        ("<imu><angular_velocity></imu>", "gazebo", "not XML"),
        ("acc_n: 0.1", "nothing", "--from nothing"),
        *(
            (f"gyroscope_noise_density: {value}\naccelerometer_noise_density: 1\n", None, named)
            for value, named in (
                ("1.0d-3", "'d-3'"),
                ("1_000e-6", "'_000e-6'"),
                ("2 / 3", "'/"),
                ("0.01 deg/s/sqrt(Hz)", "deg/s"),
                ("[1e-4, 1e-4, 1e-4] .* D2R", r"\.\*"),
                ("1e400", "below 1e"),
            )
        ),
        ("gyroscope_noise_density: 0\naccelerometer_noise_density: 0.0\n", None, "every value"),
        (
            "accelerometers:\n  M: [[1,0,0],[0,1,0],[0,0,0]]\ngyroscopes:\n  M: [[1,0,0],[0,1,0],[0,0,1]]\n",
            None,
            "inverted",
        ),
        (
            "accelerometers:\n  M: [[1.0,0,0],[0,1.0,0]]\ngyroscopes:\n  M: [[1,0,0],[0,1,0],[0,0,1]]\n",
            None,
            "three rows",
        ),
    ],
)
def test_wrong_files_are_named(text, tool, named):
    with pytest.raises(UsageError, match=named):
        read_estimator_text(text, "file", tool)


IMU_UTILS = """%YAML:1.0
---
type: IMU
Gyr:
   unit: " {gyr}"
   avg-axis:
      gyr_n: 2e-3
      gyr_w: 1e-5
   x-axis:
      gyr_n: 2.0e-03
      gyr_w: 1.0e-05
Acc:
   unit: " {acc}"
   avg-axis:
      acc_n: 2e-2
   z-axis:
      acc_n: 2.0e-02
      acc_w: 1.0e-04
"""


def test_imu_utils_multiplies_by_the_rate_and_its_walk_is_the_lowest_point_of_the_allan_curve():
    text = IMU_UTILS.format(gyr="rad/s", acc="m/s^2")
    reading = read_estimator_text(text, "r.yaml", None, Setting(rate=400))
    assert reading.form == "imu_utils"
    assert reading.model.axes["gyro_x"].processes == Sum(
        (WhiteNoise(1e-4), FlickerNoise(pytest.approx(1e-5 / FLICKER_LEVEL)))
    )
    with pytest.raises(UsageError, match="--rate"):
        read_estimator_text(text, "r.yaml")
    other = IMU_UTILS.format(gyr="gyr_n: rad / sqrt(s), gyr_w: rad / s^2 / sqrt(Hz)", acc="sqrt(s)")
    assert read_estimator_text(other, "r.yaml").model.axes["accel_z"].processes == Sum(
        (WhiteNoise(2e-2), RandomWalk(1e-4))
    )


def test_allan_variance_ros_gives_a_walk_that_is_a_limit():
    text = "gyroscope_noise_density: 1e-4\naccelerometer_noise_density: 1e-3\nupdate_rate: 400.0 #Make sure this is correct\n"
    assert any("upper limit" in note for note in read_estimator_text(text, "imu.yaml").notes)


def test_a_file_of_qgroundcontrol_has_its_value_in_the_fourth_column():
    text = "# Vehicle-Id Component-Id Name Value Type\n1\t1\tEKF2_GYR_NOISE\t0.015\t9\n1\t1\tEKF2_ACC_NOISE\t0.35\t9\n1\t1\tCAL_ACC0_XOFF\t0.1\t9\n"
    axis = read_estimator_text(text, "file").model.axes["accel_x"]
    assert axis.processes.terms == (WhiteNoise(pytest.approx(0.035)),)
    assert axis.bias == pytest.approx(0.1)


def test_a_covariance_times_the_unit_matrix_is_read_and_a_name_without_a_number_is_said():
    text = "p.setGyroscopeCovariance(1e-8 * np.eye(3))\np.setAccelerometerCovariance(I)\n"
    reading = read_estimator_text(text, "file", "gtsam")
    assert reading.model.axes["gyro_y"].processes == Sum((WhiteNoise(pytest.approx(1e-4)),))
    assert "setAccelerometerCovariance stands no number" in reading.notes[0]


def test_data_sheets_calibrations_and_files_with_both_are_read():
    sheet = read_estimator_text('name = "X"\n[gyro]\nN = "0.3 deg/√h"\n', "x.toml")
    assert (sheet.form, sheet.model.name) == ("data sheet", "X")
    cube = read_estimator_text("SM: [0.5, 0, 0, 0, 1, 0, 0, 0, 1]\nbias: [0.1, 0, 0]\n", "c.yaml")
    assert (cube.form, cube.model.axes["accel_x"].scale_factor) == ("imu-calib", pytest.approx(1.0))
    axes = {
        f"{s}_{a}": AxisModel(Sum((WhiteNoise(1e-3), RandomWalk(1e-5))), scale_factor=0.01)
        for s in ("gyro", "accel")
        for a in "xyz"
    }
    both = read_estimator_text(export(ImuErrorModel("m", axes), "openvins").text, "o.yaml")
    assert both.form == "openvins"
    assert both.model.axes["gyro_z"].scale_factor == pytest.approx(0.01)
    assert both.model.axes["gyro_z"].processes == axes["gyro_z"].processes


def test_a_file_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(UsageError, match=r"none\.yaml: cannot be read"):
        read_estimator_file(tmp_path / "none.yaml")
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UsageError, match="save it as UTF-8"):
        read_estimator_file(tmp_path / "bytes.yaml")


def test_matlab_states_properties_as_pairs_or_by_assignment_and_double_sided_noise_is_converted():
    text = (
        "p = gyroparams('NoiseDensity', [1e-4 2e-4 3e-4], 'RandomWalk', 1e-6, ...  % comment\n"
        "   'BiasInstability', 2e-5, 'NoiseType', 'single-sided');\n"
        "imu = imuSensor('accel-gyro', 'SampleRate', 125, 'Gyroscope', p);\n"
        "imu.Accelerometer = accelparams(NoiseDensity=0.002);\nimu.Accelerometer.RandomWalk = [1e-4 1e-4 1e-4];\n"
    )
    reading = read_estimator_text(text, "imu.m")
    y, accel = (reading.model.axes[axis].processes.terms for axis in ("gyro_y", "accel_z"))
    assert y == (WhiteNoise(2e-4), FlickerNoise(2e-5), RandomWalk(1e-6))
    root = math.sqrt(2)  # the default is double-sided: noise of a sample N √(f/2), step of the walk K/√(f/2)
    assert accel == (WhiteNoise(pytest.approx(0.002 / root)), RandomWalk(pytest.approx(1e-4 * root)))
    assert (reading.form, reading.model.provenance["rate"]) == ("matlab", "125 Hz")
    assert any("accel: NoiseType is double-sided" in note for note in reading.notes)
    assert not any("gyro: NoiseType" in note for note in reading.notes)
    unread = read_estimator_text("g = gyroparams('NoiseDensity', deg2rad(0.01), 'RandomWalk', 1e-6);", "imu.m")
    assert any("no number that can be read" in note for note in unread.notes)
