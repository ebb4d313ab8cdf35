import gc
import gzip
import warnings
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read, reader_of
from tests.readers.repairs import repairs

DEG = np.pi / 180
G = 9.80665
NAMES = ("gx", "gy", "gz", "ax", "ay", "az")
UNITS = {"gyro": "deg/s", "accel": "g"}
HEADER = "gx_dps,gy_dps,gz_dps,ax [g],ay [g],az [g]"
TYPED = "0123456789.,-+eExn;#% \n\t\r"  # what a damaged line may hold
ROW = "1,2,3,0.5,0.25,-1"
RATE = np.array([1, 2, 3]) * DEG
FORCE = np.array([0.5, 0.25, -1]) * G


@pytest.fixture
def imu_of(text_log):
    def imu(text, sidecar=None, **options):
        log = read(text_log(text, sidecar=sidecar), ReadOptions(**options))
        assert len(log.imus) == 1
        return log.imus[0]

    return imu


def timed(name, *times):
    return f"{name},{HEADER}\n" + "".join(f"{time},{ROW}\n" for time in times)


def assert_one_row(imu, row=0):
    np.testing.assert_allclose(imu.angular_rate.value[row], RATE, rtol=1e-15)
    np.testing.assert_allclose(imu.specific_force.value[row], FORCE, rtol=1e-15)


# What the columns are


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


# How the text stands


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


# Time


@pytest.mark.parametrize(
    ("name", "cells", "expected"),
    [
        ("time_s", ("0.123456789", "0.2"), [123_456_789, 200_000_000]),
        ("time_s", ("1714564800.123456789", "1714564801"), [1_714_564_800_123_456_789, 1_714_564_801_000_000_000]),
        ("time_s", ("0", "0.5"), [0, 500_000_000]),
        ("time_s", ("-0.5", "0.25"), [-500_000_000, 250_000_000]),
        ("time_s", ("0.0", "5e-05"), [0, 50_000]),
        ("time_s", ("1e-3", "2e-3"), [1_000_000, 2_000_000]),
        ("time_s", ("0.0", "0.010000000000001"), [0, 10_000_000]),
        ("time_ms", ("5", "15"), [5_000_000, 15_000_000]),
        ("time_ms", ("0.5", "15.25"), [500_000, 15_250_000]),
        ("time_ms", ("0", "2.5", "5"), [0, 2_500_000, 5_000_000]),
        ("t [us]", ("5", "10000"), [5_000, 10_000_000]),
        ("t (ns)", ("1714564800123456789", "1714564800123456790"), [1_714_564_800_123_456_789, 1_714_564_800_123_456_790]),
        ("time", ("2024-05-01T12:00:00", "2024-05-01T12:00:00.5"), [1_714_564_800_000_000_000, 1_714_564_800_500_000_000]),
        ("time", ("2024-05-01T12:00:00Z", "2024-05-01T12:00:00.5Z"), [1_714_564_800_000_000_000, 1_714_564_800_500_000_000]),
        ("time", ("2024-05-01T14:00:00+02:00", "2024-05-01T12:00:01Z"), [1_714_564_800_000_000_000, 1_714_564_801_000_000_000]),
        ("time", ("2024-05-01 12:00:00.123456789", "2024-05-01 12:00:01"), [1_714_564_800_123_456_789, 1_714_564_801_000_000_000]),
    ],
)  # fmt: skip
def test_times_are_exact(imu_of, name, cells, expected):
    assert imu_of(timed(name, *cells)).angular_rate.time.tolist() == expected


@pytest.mark.parametrize(
    ("name", "cells"),
    [
        ("time_s", ("0.0", "99999999999999")),
        ("time_s", ("0.0", "-99999999999999")),
        ("time_s", ("0.0", "1" * 40)),
        ("time_s", ("0.0", "inf")),
        ("time_s", ("0.0", "nan")),
        ("time_s", ("0e0", "9.3e9")),
        ("time_ms", ("0", "9223372036854775")),
        ("time_ms", ("0", "9223372036854775.5")),
        ("time_ms", ("0", "99999999999999999999")),
        ("time_ms", ("0", "inf")),
    ],
)
def test_times_that_no_clock_can_show_cost_their_row(imu_of, name, cells):
    imu = imu_of(timed(name, *cells, "1"))
    assert imu.angular_rate.time.tolist() == [0, 10**9 if name == "time_s" else 10**6]
    assert repairs(imu)["no_time"] == 1


@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(0, 2 * 10**18), min_size=2, max_size=5, unique=True).map(sorted))
def test_seconds_with_nine_digits_are_exact(text_log, times):
    cells = (f"{Decimal(time) / 10**9:.9f}" for time in times)
    time = read(text_log(timed("time_s", *cells))).imus[0].angular_rate.time
    # Over so few rows nothing is ever out of order or repeated.
    assert time.tolist() == times


@pytest.mark.parametrize(
    ("cell", "ns", "unit"),
    [
        ("1714564800.5", 1_714_564_800_500_000_000, "s"),
        ("1714564800500", 1_714_564_800_500_000_000, "ms"),
        ("1714564800500000", 1_714_564_800_500_000_000, "us"),
        ("1714564800500000000", 1_714_564_800_500_000_000, "ns"),
    ],
)
def test_a_unix_time_has_the_unit_of_its_size(text_log, cell, ns, unit):
    log = read(text_log(timed("time", cell)))
    assert log.imus[0].angular_rate.time.tolist() == [ns]
    assert log.imus[0].origin.epoch == "unix"
    (note,) = (note for note in log.notes if note.id == "time_unit_guessed")
    assert f" {unit} " in note


def test_a_rate_beside_a_time_column_is_not_used_and_noted(text_log):
    log = read(text_log(timed("time_s", "0.0", "0.1")), ReadOptions(rate=3.0))
    assert log.imus[0].angular_rate.time[1] == 100_000_000
    assert "rate_unused" in ids(log.notes)


def test_rows_out_of_order_are_sorted_with_their_values_and_repeats_dropped(imu_of):
    rows = "".join(f"{time},{i},0,0,0,0,-1\n" for i, time in enumerate(("0.0", "0.2", "0.1", "0.1", "0.3")))
    imu = imu_of(f"time_s,{HEADER}\n{rows}")
    assert imu.angular_rate.time.tolist() == [0, 100_000_000, 200_000_000, 300_000_000]
    np.testing.assert_allclose(imu.angular_rate.value[:, 0] / DEG, [0, 2, 1, 4])
    assert {"out_of_order", "repeated_time"} == set(repairs(imu))


# Faults


def test_a_last_line_that_is_cut_is_left_out_with_a_note(imu_of):
    imu = imu_of(timed("time_s", "0.0", "0.1") + "0.2,1,2")
    assert len(imu.angular_rate) == 2
    assert repairs(imu) == {"last_line_cut": 1}
    assert "'0.2,1,2'" in imu.origin.repairs[0].what


def test_a_last_line_without_its_end_but_whole_is_used(imu_of):
    imu = imu_of(timed("time_s", "0.0", "0.1", "0.2").rstrip("\n"))
    assert len(imu.angular_rate) == 3
    assert repairs(imu) == {}


def test_a_whole_last_line_may_end_in_a_shorter_cell_than_the_one_before(imu_of):
    downs = ("-1.25", "-1", "-1.25")
    rows = [f"0.{i},1,2,3,0,0,{down}" for i, down in enumerate((*downs, "-1.2"))]
    imu = imu_of(f"time_s,{HEADER}\n" + "\n".join(rows))
    assert imu.specific_force.value[-1, 2] == -1.2 * G
    assert repairs(imu) == {}


def test_a_last_line_whose_last_cell_is_shorter_than_all_before_is_cut(imu_of):
    rows = [f"0.{i},1,2,3,0,0,-1.25" for i in range(3)]
    imu = imu_of(f"time_s,{HEADER}\n" + "\n".join([*rows, "0.3,1,2,3,0,0,-1."]))
    assert len(imu.angular_rate) == 3
    assert len(repairs(imu)) == 1


@pytest.mark.parametrize("first", ["3,0.5,0.25,-1", "# by me\n0.25,-1", "-1"])
def test_a_first_line_that_is_cut_is_left_out_with_a_note(text_log, first):
    path = text_log(f"{first}\n" + f"{ROW}\n" * 5)
    log = read(path, ReadOptions(columns=NAMES, units=UNITS, rate=10.0))
    assert len(log.imus[0].angular_rate) == 5
    assert ids(log.notes) == ("first_line_cut",)


def test_lines_with_another_number_of_cells_are_left_out_and_counted(imu_of):
    imu = imu_of(timed("time_s", "0.0", "0.1") + "0.2,1\n0.3,1,2,3,4,5,6,7,8,9\n" + f"0.4,{ROW}\n0.5,{ROW}\n")
    assert len(imu.angular_rate) == 4
    assert repairs(imu) == {"cell_count": 2}


def test_text_in_a_number_cell_costs_its_row(imu_of):
    imu = imu_of(timed("time_s", "0.0", "0.1") + "0.2,oops,2,3,0,0,-1\n" + f"0.3,{ROW}\n")
    assert imu.angular_rate.time.tolist() == [0, 100_000_000, 300_000_000]
    assert repairs(imu)["not_a_number"] == 1


def test_rows_full_of_text_cost_no_more_than_themselves(imu_of):
    rows = [f"{i / 10},{'x,x,x,x,x,x' if i % 10 == 5 else ROW}\n" for i in range(100)]
    imu = imu_of(f"time_s,{HEADER}\n{''.join(rows)}")
    assert len(imu.angular_rate) == 90
    assert repairs(imu)["not_a_number"] == 60


@pytest.mark.parametrize("bad", [b"0.2,\xff\xfe,2,3,0,0,-1\n", b"\xff0.2,1,2,3,0,0,-1\n"])
def test_a_byte_that_is_no_text_costs_its_row(imu_of, bad):
    imu = imu_of(timed("time_s", "0.0", "0.1").encode() + bad + f"0.3,{ROW}\n".encode())
    assert imu.angular_rate.time.tolist() == [0, 100_000_000, 300_000_000]
    assert repairs(imu)["not_a_number"] == 1


def test_text_far_after_the_first_block_costs_its_row_alone(imu_of):
    rows = [f"{i},{ROW}" for i in range(300_000)]
    rows[250_000] = "250000,oops,2,3,0,0,-1"
    imu = imu_of(f"time_ms,{HEADER}\n" + "\n".join(rows) + "\n")
    assert len(imu.angular_rate) == 299_999
    assert imu.angular_rate.time[[0, 249_999, 250_000, -1]].tolist() == [
        0,
        249_999 * 10**6,
        250_001 * 10**6,
        299_999 * 10**6,
    ]
    assert repairs(imu)["not_a_number"] == 1


def test_text_in_a_time_cell_costs_its_row(imu_of):
    imu = imu_of(timed("time_s", "0.0", "abc", "0.2", "0.3"))
    assert imu.angular_rate.time.tolist() == [0, 200_000_000, 300_000_000]
    assert repairs(imu)["no_time"] == 1


@pytest.mark.parametrize("zone", ["", "Z", "+00:00"])
@pytest.mark.parametrize("bad", ["oops", "2024-13-01T12:00:00", ""])
def test_a_date_that_is_none_costs_its_row(imu_of, zone, bad):
    good = [f"2024-05-01T12:00:0{i}{zone}" for i in range(3)]
    imu = imu_of(timed("time", good[0], bad and bad + zone, *good[1:]))
    assert (imu.angular_rate.time - 1_714_564_800 * 10**9).tolist() == [0, 10**9, 2 * 10**9]
    assert repairs(imu)["no_time"] == 1


def test_an_accelerometer_that_starts_blocks_later_is_read_from_there(imu_of, monkeypatch):
    monkeypatch.setattr("imuwb.readers.text.cells.BLOCK", 256)
    rows = "".join(f"{i},1,2,3,{'nan,nan,nan' if i < 40 else '0,0,-1'}\n" for i in range(100))
    imu = imu_of(f"time_ms,{HEADER}\n{rows}")
    assert imu.specific_force.time[0] == 40_000_000
    assert repairs(imu) == {"not_finite": 40}


def test_an_accelerometer_without_a_number_is_refused(text_log):
    rows = "".join(f"{i}.0,1,2,3,nan,nan,nan\n" for i in range(5))
    with pytest.raises(UnreadableLogError, match=r"5 rows without a number"):
        read(text_log(f"time_s,{HEADER}\n{rows}"))


@pytest.mark.parametrize("huge", ["1e155", "-1e200"])
def test_a_huge_specific_force_is_read_as_it_stands(imu_of, huge):
    imu = imu_of(f"time_s,{HEADER}\n0.0,1,2,3,{huge},0,-1\n0.1,{ROW}\n")
    assert imu.specific_force.value[0, 0] == float(huge) * G


def test_the_sign_of_zero_comes_back(imu_of):
    imu = imu_of(f"time_s,{HEADER},temperature_c\n0.0,-0.0,0.0,-0,-0.0,0.0,-1,-0.0\n0.1,{ROW},1\n")
    assert np.signbit(imu.angular_rate.value[0]).tolist() == [True, False, True]
    assert np.signbit(imu.specific_force.value[0]).tolist() == [True, False, True]
    assert np.signbit(imu.temperature.value).tolist() == [True, False]


@pytest.mark.parametrize("cell", ["nan", "NaN", "", "inf", "-inf"])
def test_a_row_with_a_value_that_is_not_finite_is_left_out(imu_of, cell):
    imu = imu_of(timed("time_s", "0.0", "0.1") + f"0.2,{cell},2,3,0,0,-1\n0.3,{ROW}\n")
    assert imu.angular_rate.time.tolist() == [0, 100_000_000, 300_000_000]
    assert repairs(imu) == {"not_finite": 1}


def test_numbers_that_contradict_the_unit_are_refused_with_the_likely_one(text_log):
    text = "time_s,gx_dps,gy_dps,gz_dps,ax_m_s2,ay_m_s2,az_m_s2\n0.0,1,2,3,0,0,-1\n0.1,1,2,3,0,0,-1.01\n"
    with pytest.raises(UnreadableLogError, match=r"m/s².*\|f\| is 1.*--units accel=g$"):
        read(text_log(text))


@pytest.mark.parametrize(("down", "stated", "likely"), [("-9.8", "g", "m/s²"), ("-1000", "g", "mg"), ("-1", "mg", "g")])
def test_the_likely_unit_is_the_one_that_makes_one_gravity(text_log, down, stated, likely):
    text = f"time_s,ax [{stated}],ay [{stated}],az [{stated}]\n0.0,0,0,{down}\n0.1,0,0,{down}\n"
    with pytest.raises(UnreadableLogError, match=rf"--units accel={likely}$"):
        read(text_log(text))


def test_a_free_fall_is_no_contradiction(imu_of):
    assert len(imu_of("time_s,ax [g],ay [g],az [g]\n0.0,0,0,0.01\n0.1,0,0,0.01\n").specific_force) == 2


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
        ("time_s,gx_dps,gy_dps\n0.0,1,2\n0.1,1,2\n", {}, "time_s, gx_dps, gy_dps"),
        ("foo,bar\n1,2\n1,2\n", {"rate": 10.0}, "none that is known"),
    ],
)
def test_a_file_of_which_nothing_can_be_used_is_noted(text_log, text, options, columns):
    log = read(text_log(text), ReadOptions(**options))
    assert (log.imus, log.gnss, len(log.notes)) == ((), (), 1)
    assert ids(log.notes) == ("no_stream",)
    assert columns in log.notes[0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "empty"),
        (b"hello world\nhow are you\n", "b'hello wo'.*csv, dataflash"),
        (b"\x00\x01\x02\x03 123", "csv, dataflash"),
        (b"it was night number 1\nand it was dark\n", "numbers.*'it was night number 1'"),
        (b"# 1\n# 2\n", "first 2 lines"),
    ],
)
def test_what_is_no_log_is_refused(text_log, text, message):
    with pytest.raises(UnreadableLogError, match=message):
        read(text_log(text))


def test_a_directory_and_a_missing_file_are_refused(fresh):
    path = fresh("log.csv")
    with pytest.raises(UnreadableLogError, match="directory"):
        read(path.parent)
    with pytest.raises(UnreadableLogError, match=r"log\.csv"):
        read(path)


def test_rows_of_text_are_not_a_log(text_log):
    rows = "".join(f"{i}.0,a,b,c,d,e,f\n" for i in range(1, 20))
    with pytest.raises(UnreadableLogError, match=r"114 cells"):
        read(text_log(timed("time_s", "0.0") + rows))


def test_the_suffix_does_not_matter(text_log):
    path = text_log(timed("time_s", "0.0", "0.1"), name="log.mcap")
    assert reader_of(path).format == "csv"
    assert read(path).provenance.format == "csv"


def test_the_provenance_names_size_and_hash(text_log):
    path = text_log(b"time_s,ax_g,ay_g,az_g\n0.0,0,0,1\n")
    assert read(path).provenance.size == path.stat().st_size
    assert len(read(path).provenance.hash) == len("sha256:") + 64


def test_progress_ends_within_the_file(text_log):
    path, seen = text_log(timed("time_s", *(f"{i}.0" for i in range(100)))), []
    read(path, progress=lambda done, size: seen.append((done, size)))
    assert seen
    assert all(0 < done <= size == path.stat().st_size for done, size in seen)


# Packed files


class TestGzip:
    def test_a_gzip_file_is_read_as_what_it_holds(self, text_log):
        text = timed("time_s", "0.0", "0.1").encode()
        log = read(text_log(gzip.compress(text)))
        assert_one_row(log.imus[0], 1)
        assert log.provenance.format == "csv"

    def test_of_a_gzip_file_that_is_cut_what_unpacks_is_used(self, text_log):
        rng = np.random.default_rng(1)
        rows = "".join(f"{i},{x:.9f},2,3,0,0,-1\n" for i, x in enumerate(rng.normal(size=100_000)))
        packed = gzip.compress(f"time_ms,{HEADER}\n{rows}".encode(), 1)
        (imu,) = read(text_log(packed[:-20_000])).imus
        assert 30_000 < len(imu.angular_rate) < 100_000
        np.testing.assert_array_equal(np.diff(imu.angular_rate.time), 1_000_000)
        assert "packed_cut" in repairs(imu)

    def test_of_a_short_gzip_file_that_is_cut_most_rows_are_used(self, text_log):
        packed = gzip.compress(timed("time_ms", *range(2000)).encode())
        (imu,) = read(text_log(packed[:-200])).imus
        assert 1500 < len(imu.angular_rate) < 2000
        np.testing.assert_array_equal(np.diff(imu.angular_rate.time), 1_000_000)
        assert "packed_cut" in repairs(imu)

    def test_no_file_is_left_open(self, text_log):
        path = text_log(gzip.compress(timed("time_s", "0.0", "0.1").encode()))
        gc.collect()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            read(path)
            gc.collect()
        assert caught == []

    def test_a_gzip_file_of_nothing_is_refused(self, text_log):
        with pytest.raises(UnreadableLogError):
            read(text_log(gzip.compress(b"")))


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-1e3, 1e3)] * 3), min_size=2, max_size=6))
def test_any_double_comes_back_to_the_last_bit(text_log, rows):
    text = "time_ns,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n"
    text += "".join(f"{i},{x!r},{y!r},{z!r}\n" for i, (x, y, z) in enumerate(rows))
    np.testing.assert_array_equal(read(text_log(text)).imus[0].angular_rate.value, rows)


@settings(max_examples=60, deadline=None)
@given(st.text(TYPED, min_size=1, max_size=60), st.integers(0, 200))
def test_damaged_text_raises_nothing_but_our_own_errors(text_log, junk, at):
    text = timed("time_s", *(f"{i / 10}" for i in range(20))).encode()
    try:
        log = read(text_log(text[:at] + junk.encode() + text[at:]))
    except (UnreadableLogError, UsageError):
        return
    assert all(len(imu.angular_rate) <= 40 for imu in log.imus if imu.angular_rate)


def packed_with(fault, rows=5000):
    """Return a packed log whose stream is damaged in the middle, and its plain text."""
    rng = np.random.default_rng(3)
    values = np.round(rng.standard_normal((rows, 6)), 5)
    text = f"time_s,{HEADER}\n" + "".join(
        f"{0.01 * i:.2f}," + ",".join(f"{x:.5f}" for x in row) + "\n" for i, row in enumerate(values)
    )
    packed = bytearray(gzip.compress(text.encode()))
    if fault == "checksum":
        packed[-8] ^= 0xFF
    elif fault == "hole":
        packed[len(packed) // 2 : len(packed) // 2 + 500] = b""
    elif fault:
        packed[int(fault * len(packed))] ^= 0xFF
    return bytes(packed), values


class TestDamagedPacked:
    @pytest.mark.parametrize("fault", [0.5, 0.65, 0.8, "hole"])
    def test_nothing_after_the_damage_is_used_and_a_note_states_it(self, text_log, fault):
        packed, values = packed_with(fault)
        (imu,) = read(text_log(packed, "log.csv.gz")).imus
        rows = np.rint(imu.angular_rate.time / 1e7).astype(int)
        assert 100 < rows.size < 4900
        assert rows.tolist() == list(range(rows.size))
        np.testing.assert_allclose(imu.angular_rate.value, values[: rows.size, :3] * DEG, rtol=1e-12)
        assert "packed_damaged" in repairs(imu)

    def test_a_checksum_that_fails_without_an_odd_row_makes_all_doubtful(self, text_log):
        (imu,) = read(text_log(packed_with("checksum")[0], "log.csv.gz")).imus
        (repair,) = imu.origin.repairs
        assert (repair.count, repair.effect) == (5000, "value")
        assert repair.what.id == "packed_damaged"

    def test_times_that_leap_end_a_damaged_file(self, text_log):
        rows = [f"{0.01 * i + (5000 if i >= 60 else 0):.2f},{ROW}" for i in range(100)]
        packed = bytearray(gzip.compress("\n".join([f"time_s,{HEADER}", *rows, ""]).encode()))
        packed[-8] ^= 0xFF
        (imu,) = read(text_log(bytes(packed), "log.csv.gz")).imus
        assert len(imu.angular_rate) == 60
        assert "packed_damaged" in repairs(imu)

    def test_bytes_behind_the_end_cost_nothing_but_a_note(self, text_log):
        (imu,) = read(text_log(packed_with(None)[0] + b"garbage", "log.csv.gz")).imus
        assert len(imu.angular_rate) == 5000
        assert "packed_more" in repairs(imu)

    def test_packed_files_in_a_row_are_sound(self, text_log):
        text = timed("time_s", "0.0", "0.1")
        (imu,) = read(text_log(gzip.compress(text.encode()) + gzip.compress(f"0.2,{ROW}\n".encode()))).imus
        assert (len(imu.angular_rate), repairs(imu)) == (3, {})


class TestTimeScale:
    UNIX = 1_714_564_818

    @pytest.mark.parametrize("name", ["gpst_s", "gps_time_s", "t_gps_s", "t_gpst_unix_s", "time_gps_s"])
    def test_a_name_of_gps_time_takes_off_leap_seconds(self, text_log, name):
        log = read(text_log(timed(name, f"{self.UNIX}.5", f"{self.UNIX + 1}.5")))
        assert log.imus[0].angular_rate.time[0] == (self.UNIX - 18) * 10**9 + 500_000_000
        assert ids(log.notes) == ("gps_time",)
        assert "18 leap seconds" in log.notes[0]

    @pytest.mark.parametrize("name", ["time_s", "unix_s", "tgpsx_time_s"])
    def test_another_name_is_taken_as_utc_with_a_note(self, text_log, name):
        log = read(text_log(timed(name, f"{self.UNIX}.5", f"{self.UNIX + 1}.5")))
        assert log.imus[0].angular_rate.time[0] == self.UNIX * 10**9 + 500_000_000
        assert ids(log.notes) == ("taken_as_utc",)

    def test_a_name_of_utc_needs_no_note(self, text_log):
        log = read(text_log(timed("gps_utc_time_s", f"{self.UNIX}.5", f"{self.UNIX + 1}.5")))
        assert (log.imus[0].angular_rate.time[0] // 10**9, log.notes) == (self.UNIX, ())

    def test_seconds_since_the_log_s_start_are_no_gps_time(self, text_log):
        log = read(text_log(timed("gps_time_s", "1.5", "2.5")))
        assert (log.imus[0].angular_rate.time[0], log.notes) == (1_500_000_000, ())

    @pytest.mark.parametrize("epoch", ["boot", "log", "unix"])
    def test_a_sidecar_states_where_times_count_from(self, text_log, epoch):
        log = read(
            text_log(timed("gps_time_s", f"{self.UNIX}.5", f"{self.UNIX + 1}.5"), sidecar=f'epoch = "{epoch}"\n')
        )
        imu = log.imus[0]
        assert (imu.origin.epoch, imu.angular_rate.time[0] // 10**9) == (epoch, self.UNIX)
        assert ids(log.notes) == ("sidecar",)
        assert "log.toml" in log.notes[0]

    def test_another_epoch_is_refused(self, text_log):
        with pytest.raises(UsageError, match=r"log\.toml: epoch is 'gps'"):
            read(text_log(timed("time_s", "0", "1"), sidecar='epoch = "gps"\n'))


@pytest.mark.parametrize("name", ["height_msl_m", "alt_amsl_m", "altitude_msl [m]", "msl_m"])
def test_a_height_above_mean_sea_level_is_known_by_its_name(text_log, name):
    (fix,) = read(text_log(f"time_s,lat_deg,lon_deg,{name}\n0,47,8,400\n1,47,8,401\n")).gnss
    assert fix.position[:, 2].tolist() == [400, 401]
    assert fix.origin.above_sea
    (fix,) = read(text_log("time_s,lat_deg,lon_deg,height_m\n0,47,8,400\n1,47,8,401\n")).gnss
    assert not fix.origin.above_sea
