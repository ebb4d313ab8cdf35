"""The columns of text logs: names, units, sidecars, frames, separators."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from tests.readers.repairs import repairs
from tests.readers.text.csv_writer import DEG, FORCE, HEADER, NAMES, RATE, ROW, UNITS, G, assert_one_row, timed


@pytest.mark.parametrize(
    ("header", "rate", "force"),
    [
        ("gyro_x_deg_s,gyro_y_deg_s,gyro_z_deg_s,accel_x_g,accel_y_g,accel_z_g", DEG, G),
        ("wx(rad/s),wy(rad/s),wz(rad/s),ax [g],ay [g],az [g]", 1.0, G),
        ("wx [mrad/s],wy [mrad/s],wz [mrad/s],ax(mg),ay(mg),az(mg)", 1e-3, G * 1e-3),
        ("imu_gyro_x_rad_s,imu_gyro_y_rad_s,imu_gyro_z_rad_s,fx (m/s²),fy (m/s²),fz (m/s²)", 1.0, 1.0),
        ('"gyr_x [dps]","gyr_y [dps]","gyr_z [dps]","acc_x_m_s2","acc_y_m_s2","acc_z_m_s2"', DEG, 1.0),
    ],
)
def test_units_stand_in_the_header(imu_of, header, rate, force):
    down = repr(-9.8 / force)
    imu = imu_of(f"time_s,{header}\n0.0,1,2,3,0,0,{down}\n0.1,4,5,6,0,0,{down}\n")
    np.testing.assert_allclose(imu.angular_rate.value, np.array([[1, 2, 3], [4, 5, 6]]) * rate, rtol=1e-15)
    np.testing.assert_allclose(imu.specific_force.value, [[0, 0, -9.8]] * 2, rtol=1e-14)


def test_columns_may_stand_in_any_order_among_others(imu_of):
    imu = imu_of(
        "az [g],mag,gz_dps,gy_dps,time_s,gx_dps,ay [g],ax [g]\n-1,9,3,2,0.5,1,0.25,0.5\n-1,9,3,2,0.6,1,0.25,0.5\n"
    )
    assert_one_row(imu)
    assert imu.angular_rate.time.tolist() == [500_000_000, 600_000_000]


def test_without_a_header_columns_units_and_rate_are_stated(imu_of):
    imu = imu_of(f"{ROW}\n{ROW}\n", columns=NAMES, units=UNITS, rate=200.0)
    assert_one_row(imu, 1)
    assert imu.angular_rate.time.tolist() == [0, 5_000_000]
    assert imu.origin.epoch == "log"


def test_a_dash_is_a_column_that_is_not_used(imu_of):
    imu = imu_of(f"8,{ROW}\n8,{ROW}\n", columns=("-", *NAMES), units=UNITS, rate=100.0)
    assert_one_row(imu)


def test_stated_units_override_those_of_the_header(imu_of):
    imu = imu_of(timed("time_s", "0.0", "0.1"), units={"gyro": "rad/s"})
    np.testing.assert_array_equal(imu.angular_rate.value[0], [1, 2, 3])


def test_a_sidecar_states_everything(imu_of):
    sidecar = f'rate = 50\ncolumns = {list(NAMES)}\nframe = "FLU"\n[units]\ngyro = "deg/s"\naccel = "g"\n'
    imu = imu_of(f"{ROW}\n{ROW}\n", sidecar)
    np.testing.assert_allclose(imu.angular_rate.value[0], RATE * [1, -1, -1], rtol=1e-15)
    assert imu.angular_rate.time[1] == 20_000_000


def test_options_go_before_the_sidecar(imu_of):
    sidecar = f'rate = 50\ncolumns = {list(NAMES)}\n[units]\ngyro = "deg/s"\naccel = "g"\n'
    imu = imu_of(f"{ROW}\n{ROW}\n", sidecar, rate=10.0, units={"gyro": "rad/s"})
    assert imu.angular_rate.time[1] == 100_000_000
    assert imu.angular_rate.value[0].tolist() == [1, 2, 3]
    np.testing.assert_allclose(imu.specific_force.value[0], FORCE)


def test_the_sidecar_is_noted(text_log):
    log = read(text_log(timed("time_s", "0.0", "0.1"), sidecar="rate = 1\n"))
    assert "sidecar" in ids(log.notes)


@pytest.mark.parametrize(
    ("sidecar", "message"), [("rat = 5\n", "'rat'"), ("rate = = 5\n", "TOML"), ("rate = true\n", "rate is True")]
)
def test_a_sidecar_that_is_wrong_is_named(text_log, sidecar, message):
    with pytest.raises(UsageError, match=rf"log\.toml: .*{message}"):
        read(text_log(timed("time_s", "0.0", "0.1"), sidecar=sidecar))


def test_flu_changes_the_signs_of_y_and_z(imu_of):
    imu = imu_of(timed("time_s", "0.0", "0.1"), frame="FLU")
    np.testing.assert_allclose(imu.angular_rate.value[0], RATE * [1, -1, -1], rtol=1e-15)
    np.testing.assert_allclose(imu.specific_force.value[0], FORCE * [1, -1, -1], rtol=1e-15)
    assert imu.origin.frame == "FLU (stated)"


def test_a_gyro_alone_is_an_imu(imu_of):
    imu = imu_of("time_s,gx_dps,gy_dps,gz_dps\n0.0,1,2,3\n0.1,1,2,3\n")
    assert imu.specific_force is None


def test_a_sparse_temperature_has_its_own_times(imu_of):
    imu = imu_of(f"time_s,{HEADER},temperature_c\n0.0,{ROW},25.5\n0.1,{ROW},\n0.2,{ROW},26\n0.3,{ROW},nan\n")
    assert imu.temperature.time.tolist() == [0, 200_000_000]
    assert imu.temperature.value.tolist() == [25.5, 26.0]
    assert len(imu.angular_rate) == 4


def test_kelvin_becomes_celsius(imu_of):
    imu = imu_of(f"time_s,{HEADER},temp [K]\n0.0,{ROW},300.15\n0.1,{ROW},300.15\n")
    assert imu.temperature.value[0] == pytest.approx(27.0)


def test_fixes_beside_an_imu_are_the_rows_that_have_one(text_log):
    text = f"time_s,{HEADER},lat,lon,alt\n0.0,{ROW},45,90,7\n0.1,{ROW},,,\n0.2,{ROW},46,91,8\n"
    log = read(text_log(text))
    assert len(log.imus[0].angular_rate) == 3
    assert log.gnss[0].time.tolist() == [0, 200_000_000]
    np.testing.assert_allclose(log.gnss[0].position, [[np.pi / 4, np.pi / 2, 7], [46 * DEG, 91 * DEG, 8]])


def test_fixes_with_velocity_and_sigma(text_log):
    text = (
        "time_s,lat,lon,alt,vn,ve,vd,sd_n,sd_e,sd_d,fix\n0.0,45,90,7,1,2,3,.1,.2,.3,6\n1.0,45,90,7,1,2,3,.1,.2,.3,5\n"
    )
    (fix,) = read(text_log(text)).gnss
    assert fix.velocity[0].tolist() == [1, 2, 3]
    assert fix.position_sigma[0].tolist() == [0.1, 0.2, 0.3]
    assert fix.fix_type.tolist() == [6, 5]


def test_a_velocity_north_and_east_is_kept_without_one_down(text_log):
    text = "time_s,lat,lon,alt,vn,ve,sd_n,sd_e\n0.0,45,90,7,1,2,.1,.2\n1.0,45,90,7,3,4,.1,.2\n"
    (fix,) = read(text_log(text)).gnss
    assert fix.velocity[:, :2].tolist() == [[1, 2], [3, 4]]
    assert fix.position_sigma[:, :2].tolist() == [[0.1, 0.2]] * 2
    assert np.isnan(fix.velocity[:, 2]).all()
    assert np.isnan(fix.position_sigma[:, 2]).all()


def test_a_velocity_up_is_one_down(text_log):
    text = "time_s,lat,lon,alt,ve,vn,vu\n0.0,45,90,7,1,2,3\n1.0,45,90,7,1,2,3\n"
    (fix,) = read(text_log(text)).gnss
    assert fix.velocity.tolist() == [[2, 1, -3]] * 2


def test_a_reference_without_a_velocity_down_has_no_velocity_and_says_so(text_log):
    text = "time_s,lat,lon,alt,vn,ve,roll,pitch,yaw\n0.0,45,90,7,1,2,0,0,9\n1.0,45,90,7,1,2,0,0,9\n"
    log = read(text_log(text))
    assert log.references[0].velocity is None
    assert "velocity_left_out" in ids(log.notes)


@pytest.mark.parametrize("mark", [";", "\t", " ", "   "])
def test_other_separators(imu_of, mark):
    header = "time_s gx_dps gy_dps gz_dps ax_g ay_g az_g".replace(" ", mark)
    rows = "".join(mark.join([time, *ROW.split(",")]) + "\n" for time in ("0.0", "0.1"))
    imu = imu_of(f"{header}\n{rows}")
    assert_one_row(imu, 1)


def test_blanks_at_the_ends_of_a_line(imu_of):
    row = ROW.replace(",", "  ")
    imu = imu_of(f"  {row} \n  {row} \n", columns=NAMES, units=UNITS, rate=1.0)
    assert_one_row(imu, 1)


@pytest.mark.parametrize("comment", ["# by me", "% by me", "// by me, 5, 6"])
def test_comments_before_and_between(imu_of, comment):
    text = f"{comment}\n{timed('time_s', '0.0', '0.1')}{comment}\n0.2,{ROW}\n"
    assert imu_of(text).angular_rate.time.tolist() == [0, 100_000_000, 200_000_000]


def test_windows_line_ends_a_byte_order_mark_and_blank_lines(imu_of):
    text = "\ufeff" + timed("time_s", "0.0", "0.1").replace("\n", "\r\n") + "\r\n"
    assert len(imu_of(text).angular_rate) == 2


def test_every_cell_may_be_quoted(imu_of):
    text = timed("time_s", "0.0", "0.1", "0.2").replace(",", '","').replace("\n", '"\n"')
    imu = imu_of('"' + text.removesuffix('"'))
    assert imu.angular_rate.time.tolist() == [0, 100_000_000, 200_000_000]
    assert_one_row(imu, 2)
    assert repairs(imu) == {}


def test_numbers_that_contradict_the_unit_are_refused_with_the_likely_one(text_log):
    text = "time_s,gx_dps,gy_dps,gz_dps,ax_m_s2,ay_m_s2,az_m_s2\n0.0,1,2,3,0,0,-1\n0.1,1,2,3,0,0,-1.01\n"
    with pytest.raises(UnreadableLogError, match=r"m/s².*\|f\| is 1.*--units accel=g$"):
        read(text_log(text))


@pytest.mark.parametrize(("down", "stated", "likely"), [("-9.8", "g", "m/s²"), ("-1000", "g", "mg"), ("-1", "mg", "g")])
def test_the_likely_unit_is_the_one_that_makes_one_gravity(text_log, down, stated, likely):
    text = f"time_s,ax [{stated}],ay [{stated}],az [{stated}]\n0.0,0,0,{down}\n0.1,0,0,{down}\n"
    with pytest.raises(UnreadableLogError, match=rf"--units accel={likely}$"):
        read(text_log(text))


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (f"time_s,{HEADER.replace('_dps', '')}\n0.0,{ROW}\n", {}, r"gx, gy, gz .*--units gyro=UNIT"),
        (f"time_s,gx_dps,gy_dps,gz_dps,ax,ay,az\n0.0,1,2,3,0,0,-9.8\n", {}, r"likely m/s²\).*--units accel=UNIT"),  # noqa: F541
        (f"time_s,gx_dps,gy_dps,gz_dps,ax,ay,az\n0.0,1,2,3,,0,-1\n0.1,{ROW}\n", {}, r"--units accel=UNIT"),
        (f"{HEADER}\n{ROW}\n", {}, r"--rate HZ"),
        (f"{ROW}\n{ROW}\n", {}, r"6 columns.*--columns"),
        (f"{ROW}\n{ROW}\n", {"columns": NAMES[:3]}, r"3 .*\(gx, gy, gz\).* 6 "),
        (timed("time", "0.0", "0.1"), {}, r"'time'.*--units time=s"),
        (timed("time_s", "noon", "night"), {}, r"'time_s'.*'noon'"),
        (timed("time_s", "0.0"), {"units": {"gyro": "g"}}, r"'g'.*angular rate"),
        (timed("time_s", "0.0"), {"units": {"gyro": "foo"}}, r"'foo'"),
    ],
)
def test_what_is_unknown_is_asked_for(text_log, text, options, message):
    with pytest.raises(UsageError, match=message):
        read(text_log(text), ReadOptions(**options))


@pytest.mark.parametrize(
    ("text", "options", "columns"),
    [
        ("time_s,odd\n0.0,1\n0.1,1\n", {}, "time_s"),
        ("foo,bar\n1,2\n1,2\n", {"rate": 10.0}, "none that is known"),
    ],
)
def test_a_file_of_which_nothing_can_be_used_is_noted(text_log, text, options, columns):
    log = read(text_log(text), ReadOptions(**options))
    assert (log.imus, log.gnss, len(log.notes)) == ((), (), 1)
    assert ids(log.notes) == ("no_stream",)
    assert columns in log.notes[0]


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-1e3, 1e3)] * 3), min_size=2, max_size=6))
def test_any_double_comes_back_to_the_last_bit(text_log, rows):
    text = "time_ns,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n"
    text += "".join(f"{i},{x!r},{y!r},{z!r}\n" for i, (x, y, z) in enumerate(rows))
    np.testing.assert_array_equal(read(text_log(text)).imus[0].angular_rate.value, rows)


@pytest.mark.parametrize("name", ["height_msl_m", "alt_amsl_m", "altitude_msl [m]", "msl_m"])
def test_a_height_above_mean_sea_level_is_known_by_its_name(text_log, name):
    (fix,) = read(text_log(f"time_s,lat_deg,lon_deg,{name}\n0,47,8,400\n1,47,8,401\n")).gnss
    assert fix.position[:, 2].tolist() == [400, 401]
    assert fix.origin.above_sea
    (fix,) = read(text_log("time_s,lat_deg,lon_deg,height_m\n0,47,8,400\n1,47,8,401\n")).gnss
    assert not fix.origin.above_sea


@pytest.mark.parametrize("count", [3, 4, 6, 7, 11])
def test_the_columns_of_the_example_are_as_many_as_the_cells(tmp_path, count):
    path = tmp_path / "a.csv"
    path.write_text("".join(",".join(f"{i + k}.5" for k in range(count)) + "\n" for i in range(5)), "utf-8")
    with pytest.raises(UsageError, match="no header line") as found:
        read(path, ReadOptions(rate=10))
    example = str(found.value).split("--columns ")[1].split(" ")[0].split(",")
    assert len(example) == count
