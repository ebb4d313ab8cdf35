"""The limits between what is a text log, a time, a unit, and what is damage."""

import gzip

import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.readers import read
from imuwb.readers.text import csv_text
from imuwb.readers.text.layout import layout_of
from tests.readers.repairs import repairs
from tests.readers.text.csv_writer import HEADER, NAMES, ROW, UNITS, timed

DAY = 86_400


@pytest.mark.parametrize(("odd", "text"), [(1, True), (2, False)])
def test_one_byte_in_a_hundred_may_be_no_text(odd, text):
    assert csv_text.probe(b"1" * (100 - odd) + b"\x01" * odd) == text


@pytest.mark.parametrize(("numbers", "names"), [(1, 4), (2, 0)])
def test_a_row_of_which_half_the_cells_are_numbers_is_no_header(text_log, numbers, names):
    first = ",".join(["name"] * (4 - numbers) + ["7"] * numbers)
    assert len(layout_of(text_log(f"{first}\n" + "1,2,3,4\n" * 5)).names) == names


@pytest.mark.parametrize(("before", "kept"), [(100, True), (101, False)])
def test_a_last_line_without_its_end_is_compared_with_a_hundred_rows(imu_of, before, kept):
    rows = [f"{i / 10},1,2,3,0,0,{-1 if i == 120 - before else -1.25}" for i in range(120)]
    imu = imu_of(f"time_s,{HEADER}\n" + "\n".join([*rows, "12.0,1,2,3,0,0,-1"]))
    assert len(imu.angular_rate) == 120 + kept
    assert ("last_line_cut" in repairs(imu)) == (not kept)


@pytest.mark.parametrize(("step", "rows"), [(3600, 100), (3600.01, 60)])
def test_a_damaged_file_is_used_up_to_a_step_of_more_than_an_hour(imu_of, step, rows):
    times = [0.01 * i + (step - 0.01 if i >= 60 else 0) for i in range(100)]
    packed = bytearray(gzip.compress(timed("time_s", *(f"{t:.2f}" for t in times)).encode()))
    packed[-8] ^= 0xFF  # the checksum
    assert len(imu_of(bytes(packed)).angular_rate) == rows


def test_half_of_the_rows_may_be_unusable_and_no_more(imu_of):
    def rows(bad):
        return f"time_s,{HEADER}\n" + "".join(f"{i},{'nan' if i < bad else 1},2,3,0,0,-1\n" for i in range(10))

    assert len(imu_of(rows(5)).angular_rate) == 5
    with pytest.raises(UnreadableLogError, match=r"6 rows"):
        imu_of(rows(6))


@pytest.mark.parametrize(("norm", "likely"), [(0.91, True), (1.09, True), (0.89, False), (1.11, False)])
def test_the_unit_is_likely_within_a_tenth_of_gravity(text_log, norm, likely):
    with pytest.raises(UsageError) as caught:
        read(text_log(f"time_s,ax,ay,az\n0,0,0,{-norm}\n1,0,0,{-norm}\n"))
    assert ("likely g)" in str(caught.value)) == likely
    assert ("no specific force" in str(caught.value)) != likely


def test_a_gravity_in_a_unit_of_similar_size_is_no_contradiction(imu_of):
    assert len(imu_of("time_s,ax [cm/s^2],ay [cm/s^2],az [cm/s^2]\n0,0,0,-981\n1,0,0,-981\n").specific_force) == 2


def test_damaged_numbers_do_not_hide_a_wrong_unit(text_log):
    rows = "".join(f"{i},0,0,{1e10 if i < 6 else -1.0}\n" for i in range(10))
    with pytest.raises(UnreadableLogError, match="--units accel=g"):
        read(text_log(f"time_s,ax_m_s2,ay_m_s2,az_m_s2\n{rows}"))


@pytest.mark.parametrize(("seconds", "epoch"), [(4.99e8, "log"), (5.01e8, "unix"), (2.99e9, "unix"), (3.01e9, "log")])
def test_times_of_1985_to_2065_count_from_1970(imu_of, seconds, epoch):
    assert imu_of(timed("time_s", f"{seconds:.0f}", f"{seconds + 1:.0f}")).origin.epoch == epoch


@pytest.mark.parametrize(("tow", "unit"), [("604800.5", "s"), ("604802", "ms")])
def test_a_time_of_week_is_in_seconds_up_to_the_week_s_end(text_log, tow, unit):
    rows = f"2300,{tow},{ROW}\n"
    (imu,) = read(text_log(f"week,tow,{HEADER}\n{rows}")).imus
    seconds = float(tow) * (1 if unit == "s" else 1e-3)
    start = 315_964_800 - 18 + 2300 * 7 * DAY
    assert imu.angular_rate.time[0] == pytest.approx((start + seconds) * 1e9, abs=1e3)


def test_a_number_of_a_later_century_is_no_gps_week(text_log):
    rows = f"{{}},100,{ROW}\n"
    assert read(text_log(f"week,tow_s,{HEADER}\n{rows.format(7000)}")).imus[0].origin.epoch == "unix"
    assert read(text_log(f"week,tow_s,{HEADER}\n{rows.format(10_000)}")).imus[0].origin.epoch == "log"


def test_a_time_at_the_end_of_int64_costs_its_row(imu_of):
    imu = imu_of(f"time_ns,{HEADER}\n0e0,{ROW}\n{2**63}e0,{ROW}\n1e9,{ROW}\n")
    assert imu.angular_rate.time.tolist() == [0, 10**9]
    assert repairs(imu) == {"no_time": 1}


def test_options_as_texts_read_a_log_without_a_header(imu_of):
    imu = imu_of(
        f"{ROW}\n{ROW}\n", columns=",".join(NAMES), units=",".join(f"{k}={v}" for k, v in UNITS.items()), rate="4"
    )
    assert imu.angular_rate.time.tolist() == [0, 250_000_000]
