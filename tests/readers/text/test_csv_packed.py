"""Packed text logs, whole, cut and damaged."""

import gc
import gzip
import warnings

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.readers import read
from tests.readers.repairs import repairs
from tests.readers.text.csv_writer import DEG, HEADER, ROW, assert_one_row, timed


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
