"""``--join``: the other sensors of an IMU from files of their own; options that are given twice."""

import numpy as np
import pytest

from imuwb import read
from imuwb.errors import MissingDataError

ROWS = 3000
RNG = np.random.default_rng(9)
RATES = RNG.normal(0, 0.5, (ROWS, 3))  # deg/s
FORCES = RNG.normal((0, 0, -1), 0.002, (ROWS, 3))  # g


def table(path, sensor, values, late=0.0, unit=""):
    end = f" [{unit}]" if unit else ""
    lines = [",".join(["time_s", *(f"{sensor}_{a}{end}" for a in "xyz")])]
    lines += [f"{0.01 * i + late:.4f}," + ",".join(f"{x:.6f}" for x in row) for i, row in enumerate(values)]
    path.write_text("\n".join([*lines, ""]), "utf-8")
    return path


@pytest.fixture
def files(tmp_path):
    rates, forces = table(tmp_path / "first.csv", "gyro", RATES), table(tmp_path / "second.csv", "accel", FORCES, 0.004)
    warm = tmp_path / "third.csv"
    warm.write_text("time_s,temperature_c\n" + "".join(f"{i},{20 + i / 10}\n" for i in range(30)), "utf-8")
    return rates, forces, warm


UNITS = ("--units", "gyro=deg/s,accel=g")


def test_sensors_of_other_files_are_joined(imuwb, files, tmp_path):
    rates, forces, warm = files
    done = imuwb("convert", rates, "--join", forces, "--join", warm, *UNITS, "-o", "both.mcap")
    assert done.code == 0, done.err
    (imu,) = read(tmp_path / "both.mcap").imus
    np.testing.assert_allclose(imu.angular_rate.value, np.radians(np.round(RATES, 6)), rtol=1e-9)
    np.testing.assert_allclose(imu.specific_force.value, np.round(FORCES, 6) * 9.80665, rtol=1e-9)
    assert imu.specific_force.time[0] - imu.angular_rate.time[0] == 4_000_000
    np.testing.assert_allclose(imu.temperature.value, 20 + np.arange(30) / 10, rtol=1e-9)


def test_a_temperature_alone_is_no_imu(files):
    with pytest.raises(MissingDataError, match="no IMU"):
        read(files[2]).imu()


def test_info_joins_too(imuwb, files):
    rates, forces, _ = files
    done = imuwb("info", rates, "--join", forces, *UNITS, "--full")
    assert done.code == 0, done.err
    assert "imu (gyro)" in done.out
    assert "imu (accelerometer)" in done.out
    assert "deg/s, g" in done.out


def test_frames_that_differ_are_noted(imuwb, files, tmp_path):
    path = tmp_path / "phone.csv"
    rows = "".join(f"{0.01 * i:.2f},0.1,0.2,0.3,0.4\n" for i in range(100))
    path.write_text(
        '"Time (s)","Gyroscope x (rad/s)","Gyroscope y (rad/s)","Gyroscope z (rad/s)","Absolute (rad/s)"\n' + rows,
        "utf-8",
    )
    done = imuwb("info", path, "--join", files[1], "--units", "accel=g")
    assert done.code == 0, done.err
    assert "--frame" in done.out
    assert "--frame" not in imuwb("info", path, "--join", files[1], "--units", "accel=g", "--frame", "FLU").out.replace(
        "--frame FLU", ""
    )


def test_a_sensor_that_the_log_has_is_not_joined(imuwb, files):
    rates, _, _ = files
    done = imuwb("info", rates, "--join", rates, *UNITS)
    assert done.code == 3
    assert "nothing to join" in done.err


def test_a_file_that_is_not_there_is_named(imuwb, files):
    done = imuwb("info", files[0], "--join", "gone.csv", *UNITS)
    assert done.code == 4
    assert "gone.csv" in done.err


def test_units_may_be_given_in_several_options(imuwb, files):
    rates, forces, _ = files
    done = imuwb("info", rates, "--join", forces, "--units", "gyro=deg/s", "--units", "accel=g")
    assert done.code == 0, done.err
    assert "deg/s, g" in done.out


@pytest.mark.parametrize(
    "twice",
    [
        ("--units", "gyro=deg/s", "--units", "gyro=rad/s"), ("--rate", "100", "--rate", "200"), ("--frame", "FRD", "--frame", "FLU"),
        ("--columns", "a,b", "--columns", "c,d"),
    ],
)  # fmt: skip
def test_an_option_that_takes_one_value_is_given_once(imuwb, files, twice):
    done = imuwb("info", files[0], *twice)
    assert done.code == 2
    assert twice[0] in done.err
