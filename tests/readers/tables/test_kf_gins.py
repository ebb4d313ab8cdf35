"""Binary increments of KF-GINS as rates over their steps."""

import gzip

import numpy as np
import pytest

from imuwb.errors import ImuwbError
from imuwb.notes import ids
from imuwb.readers import read, reader_of

N = 1000
RNG = np.random.default_rng(5)
TIME = 456_300.0 + np.cumsum(np.where(np.arange(N) % 3 == 0, 0.00505, 0.00497))
RATE, FORCE = RNG.normal(0, 0.1, (N, 3)), RNG.normal(0, 0.3, (N, 3)) - (0, 0, 9.8)


def rows(odometer=False):
    steps = np.diff(TIME, prepend=TIME[0] - 0.005)[:, None]
    parts = [TIME[:, None], RATE * steps, FORCE * steps] + ([np.full((N, 1), 12.5)] if odometer else [])
    return np.hstack(parts).astype("<f8")


@pytest.fixture
def log_of(tmp_path):
    def log(data):
        path = tmp_path / "imu.bin"
        path.write_bytes(data)
        return read(path)

    return log


@pytest.mark.parametrize("packed", [False, True])
def test_increments_are_divided_by_their_steps(log_of, packed):
    data = rows().tobytes()
    log = log_of(gzip.compress(data) if packed else data)
    (imu,) = log.imus
    assert log.provenance.format == "kf_gins"
    np.testing.assert_allclose(imu.angular_rate.value[1:], RATE[1:], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(imu.specific_force.value[1:], FORCE[1:], rtol=1e-6)
    assert np.abs(imu.angular_rate.time[:N] / 1e9 - TIME).max() < 1e-8
    assert imu.origin.frame.startswith("FRD")
    assert imu.origin.epoch == "log"
    assert "week_unknown" in ids(log.notes)


def test_an_odometer_is_a_speed(log_of):
    log = log_of(rows(odometer=True).tobytes())
    assert log.speeds[0].value.tolist() == [12.5] * N
    np.testing.assert_allclose(log.imus[0].specific_force.value[1:], FORCE[1:], rtol=1e-6)


def test_a_cut_file_gives_its_whole_rows(log_of):
    log = log_of(rows().tobytes()[: 56 * 100 + 17])
    assert len(log.imus[0].angular_rate) == 100
    assert "row_cut" in ids(log.notes)


@pytest.mark.parametrize(
    "change",
    [
        lambda r: r[::-1], lambda r: r * [1, 1, 1, 1, 0.01, 0.01, 0.01], lambda r: r * [10, 1, 1, 1, 1, 1, 1],
        lambda r: r * [1, 1000, 1, 1, 1, 1, 1], lambda r: r * [1, 1, 1, 1, 1, 1, np.nan], lambda r: r[:3],
    ],
)  # fmt: skip
def test_other_doubles_are_not_increments(tmp_path, change):
    path = tmp_path / "imu.bin"
    path.write_bytes(np.ascontiguousarray(change(rows())).tobytes())
    with pytest.raises(ImuwbError, match=r"imu\.bin"):
        reader_of(path)


def test_damage_in_the_middle_is_counted(log_of):
    table = np.vstack([rows() + np.eye(7)[0] * 10 * k for k in range(3)])
    table[1500, 1:] = np.nan
    table[1600, 0] = np.inf
    (imu,) = log_of(table.tobytes()).imus
    assert sum(repair.count for repair in imu.origin.repairs) >= 2
    assert len(imu.angular_rate) == 3 * N - 2
    assert np.isfinite(imu.angular_rate.value).all()
