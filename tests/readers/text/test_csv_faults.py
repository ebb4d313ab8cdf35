"""What is wrong in text logs is left out and counted, or refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read, reader_of
from tests.readers.repairs import repairs
from tests.readers.text.csv_writer import HEADER, NAMES, ROW, UNITS, G, timed

TYPED = "0123456789.,-+eExn;#% \n\t\r"  # what a damaged line may have


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


@pytest.mark.slow
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


@settings(max_examples=60, deadline=None)
@given(st.text(TYPED, min_size=1, max_size=60), st.integers(0, 200))
def test_damaged_text_raises_nothing_but_our_own_errors(text_log, junk, at):
    text = timed("time_s", *(f"{i / 10}" for i in range(20))).encode()
    try:
        log = read(text_log(text[:at] + junk.encode() + text[at:]))
    except (UnreadableLogError, UsageError):
        return
    assert all(len(imu.angular_rate) <= 40 for imu in log.imus if imu.angular_rate)
