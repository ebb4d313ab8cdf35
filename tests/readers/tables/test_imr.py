"""Inertial Explorer's raw files: scales, rates and increments, both byte orders, and damage."""

import struct

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from tests.readers.repairs import repairs

N, RATE = 400, 200.0
GYRO, ACCEL = 2.0**-20, 2.0**-22  #: deg, m/s
COUNTS = np.random.default_rng(1).integers(-30_000, 30_000, (N, 6)) + np.array(
    [0, 0, 0, 0, 0, int(-9.8 / RATE / ACCEL)]
)
TIME = 345_600.0 + np.arange(N) / RATE


def header(order="<", flags=(1, 1), rate=RATE, gyro=GYRO, accel=ACCEL, kind=2, bias=0.0, name=b"FSAS"):
    head = b"$IMURAW\0" + bytes((order == ">",))
    head += struct.pack(f"{order}diidddiid32s", 8.8, *flags, rate, gyro, accel, kind, 2, bias, name)
    return head.ljust(512, b"\0")


def rows(order="<"):
    row = np.dtype([("time", f"{order}f8"), ("counts", f"{order}i4", 6)])
    table = np.zeros(N, row)
    table["time"], table["counts"] = TIME, COUNTS
    return table.tobytes()


@pytest.fixture
def log_of(tmp_path):
    def log(data, **options):
        path = tmp_path / "raw.imr"
        path.write_bytes(data)
        return read(path, ReadOptions(**options))

    return log


@pytest.mark.parametrize("order", "<>")
def test_increments(log_of, order):
    log = log_of(header(order) + rows(order))
    (imu,) = log.imus
    assert log.provenance.format == "imr"
    np.testing.assert_allclose(imu.angular_rate.value, np.radians(COUNTS[:, :3] * GYRO * RATE), rtol=1e-14)
    np.testing.assert_allclose(imu.specific_force.value, COUNTS[:, 3:] * ACCEL * RATE, rtol=1e-14)
    assert np.abs(imu.angular_rate.time - TIME * 1e9).max() < 1
    assert any("FSAS" in note and note.id == "week_unknown" for note in log.notes)


def test_rates_and_forces(log_of):
    log = log_of(header(flags=(0, 0), gyro=GYRO * RATE, accel=ACCEL * RATE) + rows())
    np.testing.assert_allclose(log.imus[0].angular_rate.value, np.radians(COUNTS[:, :3] * GYRO * RATE), rtol=1e-14)
    np.testing.assert_allclose(log.imus[0].specific_force.value, COUNTS[:, 3:] * ACCEL * RATE, rtol=1e-14)


def test_the_users_frame_and_a_bias(log_of):
    log = log_of(header(bias=0.5) + rows(), frame="FLU")
    np.testing.assert_allclose(log.imus[0].specific_force.value[:, 2], -COUNTS[:, 5] * ACCEL * RATE, rtol=1e-14)
    assert "time_bias" in ids(log.notes)


def test_forces_in_g_are_refused(log_of):
    with pytest.raises(UnreadableLogError, match="g"):
        log_of(header(accel=ACCEL / 9.80665) + rows())


@pytest.mark.parametrize("size", [9, 100, 511])
def test_a_cut_header_is_refused(log_of, size):
    with pytest.raises(UnreadableLogError, match=r"raw\.imr"):
        log_of(header()[:size])


@pytest.mark.parametrize("change", [{"rate": 0.0}, {"rate": np.nan}, {"gyro": 0.0}, {"accel": np.inf}, {"rate": 1e300}])
def test_impossible_headers_are_refused(log_of, change):
    with pytest.raises(UnreadableLogError, match="header"):
        log_of(header(**change) + rows())


def test_cut_and_damaged_rows_are_counted(log_of):
    data = bytearray(header() + rows())
    data[512 + 32 * 7 : 512 + 32 * 7 + 8] = struct.pack("<d", np.nan)
    log = log_of(bytes(data[:-5]))
    assert len(log.imus[0].angular_rate) == N - 2
    assert repairs(log.imus[0])["no_time"] == 1
    assert "row_cut" in ids(log.notes)


def test_blocks_within_rows(log_of, monkeypatch):
    monkeypatch.setattr("imuwb.readers.bytes.source.BLOCK", 100)
    monkeypatch.setattr("imuwb.readers.bytes.source.PIECE", 50)
    log = log_of(header() + rows())
    np.testing.assert_allclose(log.imus[0].angular_rate.value, np.radians(COUNTS[:, :3] * GYRO * RATE), rtol=1e-14)
