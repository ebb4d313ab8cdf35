import pytest

from imuwb.errors import UsageError
from imuwb.readers.text.column_names import columns


def meaning(name, **units):
    return [(c.quantity, c.axis, c.unit.name if c.unit else None) for c in columns((name,), units)]


@pytest.mark.parametrize(
    ("name", "quantity", "axis", "unit"),
    [
        ("gyro_x_deg_s", "gyro", 0, "deg/s"), ("gyro_z_rad_s", "gyro", 2, "rad/s"), ("wx(rad/s)", "gyro", 0, "rad/s"),
        ("wy [mrad/s]", "gyro", 1, "mrad/s"), ("Gyro_Y [dps]", "gyro", 1, "deg/s"), ("gx_dps", "gyro", 0, "deg/s"),
        ("angular_velocity.z", "gyro", 2, None), ("imu_gyro_x", "gyro", 0, None), ("gyro[x]", "gyro", 0, None),
        ("ax [g]", "accel", 0, "g"), ("ay(m/s^2)", "accel", 1, "m/s²"), ("accel_z_m_s2", "accel", 2, "m/s²"),
        ("acc_x_mg", "accel", 0, "mg"), ("specific_force_y", "accel", 1, None), ("fz", "accel", 2, None),
        ("linear_acceleration.x", "accel", 0, None), ("ax_g", "accel", 0, "g"), ("g_x", "gyro", 0, None),
        ("time_s", "time", 0, "s"), ("time_ns", "time", 0, "ns"), ("t [ms]", "time", 0, "ms"),
        ("timestamp", "time", 0, None), ("unix_us", "time", 0, "us"), ("temperature_c", "temperature", 0, "°C"),
        ("temp [K]", "temperature", 0, "K"), ("temp [°F]", "temperature", 0, "°F"), ("temperature_f", "temperature", 0, "°F"), ("lat_deg", "latitude", 0, "deg"), ("lon_degE7", "longitude", 0, "degE7"),
        ("alt_m", "height", 0, "m"), ("vn", "velocity_north", 0, None), ("vd_m_s", "velocity_down", 0, "m/s"),
        ("gnss_lat", "latitude", 0, None), ("sd_n", "sigma_north", 0, None), ("fix_type", "fix_type", 0, "1"),
    ],
)  # fmt: skip
def test_names_and_their_units(name, quantity, axis, unit):
    assert meaning(name) == [(quantity, axis, unit)]


def test_p_q_and_r_are_rates_where_all_three_have_such_a_unit():
    assert [(c.quantity, c.axis) for c in columns(("p [deg/s]", "q [deg/s]", "r [deg/s]"), {})] == [
        ("gyro", i) for i in range(3)
    ]
    assert columns(("p [deg/s]", "r [deg/s]"), {}) == ()
    assert columns(("p", "q", "r"), {}) == ()
    assert columns(("p_m", "q_m", "r_m"), {}) == ()


def test_a_linear_acceleration_beside_another_is_left_out():
    whole, linear = (tuple(f"{name}_{axis}_m_s2" for axis in "xyz") for name in ("acc", "lin_acc"))
    assert [c.name for c in columns((*linear, *whole), {})] == list(whole)
    assert [c.name for c in columns(linear, {})] == list(linear)


@pytest.mark.parametrize("speed", ["speed", "ground_speed", "gps_speed", "SOG"])
def test_a_speed_beside_a_course_and_a_position_is_over_ground(speed):
    found = columns(("lat", "lon", f"{speed} (m/s)", "course (deg)", "hAcc (m)", "vAcc (m)"), {})
    expected = ["latitude", "longitude", "ground_speed", "course", "sigma_horizontal", "sigma_vertical"]
    assert [c.quantity for c in found] == expected
    assert [c.quantity for c in columns(("speed (m/s)", "course (deg)"), {})] == ["speed", "course"]


@pytest.mark.parametrize(
    ("name", "quantity", "axis", "unit", "stream"),
    [
        ("/imu/data/angular_velocity/x", "gyro", 0, None, "/imu/data"), ("imu_a/gyro_y", "gyro", 1, None, "imu_a"),
        ("field.linear_acceleration.z", "accel", 2, None, "field"), ("Acc1_X", "accel", 0, None, "1"),
        ("IMU::UncompAccel::X [m/s^2]", "accel", 0, "m/s²", "IMU.uncomp"), ("UncompGyro.Y", "gyro", 1, None, "uncomp"),
        ("raw_gyro_x", "gyro", 0, None, "raw"), ("/gps/fix/latitude", "latitude", 0, None, "/gps/fix"),
        ("xRate (deg/s)", "gyro", 0, "deg/s", ""), ("Y Accel", "accel", 1, None, ""), ("Gyro X deg/s", "gyro", 0, "deg/s", ""),
        ("GYRO-X", "gyro", 0, None, ""), ("Acceleration (y)", "accel", 1, None, ""), ("gyro.x_radps", "gyro", 0, "rad/s", ""),
        ("ωz [rad/s]", "gyro", 2, "rad/s", ""), ("a(x)", "accel", 0, None, ""), ("Gyroscope_X_rad_per_sec", "gyro", 0, "rad/s", ""),
        ("Gyro X, rad/s", "gyro", 0, "rad/s", ""), ("gx_raw", "gyro", 0, None, "raw"), ("accel_y_cal [g]", "accel", 1, "g", "cal"),
        ("gyro_x_2_rad_s", "gyro", 0, "rad/s", "2"), ("Rate Z (deg/s)", "gyro", 2, "deg/s", ""), ("Drehrate X (°/s)", "gyro", 0, "deg/s", ""),
        ("Beschleunigung z (m/s²)", "accel", 2, "m/s²", ""), ("Aceleración y (m/s^2)", "accel", 1, "m/s²", ""),
        ("GyroZRadPerSec", "gyro", 2, "rad/s", ""), ("ax (m s^-2)", "accel", 0, "m/s²", ""), ("wz [arcsec/s]", "gyro", 2, "arcsec/s", ""),
    ],
)  # fmt: skip
def test_nested_names(name, quantity, axis, unit, stream):
    (column,) = columns((name,), {})
    found = (column.quantity, column.axis, column.unit.name if column.unit else None, column.stream)
    assert found == (quantity, axis, unit, stream)


@pytest.mark.parametrize(
    ("names", "quantity", "unit"),
    [
        (("accel_m_s2_1", "accel_m_s2_2", "accel_m_s2_3"), "accel", "m/s²"), (("gyro[0]", "gyro[1]", "gyro[2]"), "gyro", None),
        (("accelReadings_1", "accelReadings_2", "accelReadings_3"), "accel", None),
        (("Gyro_1 (rad/s)", "Gyro_2 (rad/s)", "Gyro_3 (rad/s)"), "gyro", "rad/s"),
        (("gyro_deg_s_x", "gyro_deg_s_y", "gyro_deg_s_z"), "gyro", "deg/s"),
    ],
)  # fmt: skip
def test_axes_with_numbers_and_units_before_them(names, quantity, unit):
    found = [(c.name, c.quantity, c.axis, c.unit.name if c.unit else None) for c in columns(names, {})]
    assert found == [(name, quantity, axis, unit) for axis, name in enumerate(names)]


def test_two_sensors_in_one_file_are_no_contradiction():
    names = [f"/imu_{i}/{sensor}/{axis}" for i in "ab" for sensor in ("gyro", "accel") for axis in "xyz"]
    found = columns(tuple(names), {})
    assert len(found) == 12
    assert {c.stream for c in found} == {"/imu_a", "/imu_b"}


@pytest.mark.parametrize(
    "name",
    [
        "FreeAcc_X",
        "user_acceleration.x",
        "bias_gyro_x",
        "imu/sigma/accel/x",
        "orientation.w",
        "-",
        "battery_v",
        "mag_x",
        "humidity",
        "",
        "row",
    ],
)
def test_other_names_mean_nothing(name):
    assert meaning(name) == []


def test_a_stated_unit_overrides_the_name():
    assert meaning("gyro_x_deg_s", gyro="rad/s") == [("gyro", 0, "rad/s")]


def test_two_columns_of_one_meaning_are_refused_with_both_names():
    with pytest.raises(UsageError, match=r"'gyro_x' and 'wx' .* gyro;.*--columns"):
        columns(("gyro_x", "wx"), {})


def test_of_two_times_the_first_is_used():
    assert [c.name for c in columns(("time_s", "utc"), {})] == ["time_s"]


def test_indices_point_into_the_file():
    assert [(c.index, c.axis) for c in columns(("-", "wz", "-", "wx"), {})] == [(1, 2), (3, 0)]
