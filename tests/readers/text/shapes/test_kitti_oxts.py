"""The folder oxts of KITTI's raw data."""

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.readers import read
from tests.readers.repairs import repairs
from tests.readers.text.shapes.truth import ACCEL, GYRO, TIME, N, axes

LATITUDE, LONGITUDE, HEIGHT = 49.0, 8.43, 112.8
ROLL, PITCH, HEADING = 0.02, -0.01, 0.5  # FRD, NED
NORTH, EAST, DOWN = 3.0, -4.0, 0.25


@pytest.fixture
def oxts(tmp_path):
    folder = tmp_path / "2011_09_26_drive_0001_extract" / "oxts"
    (folder / "data").mkdir(parents=True)
    stamps = [f"{np.datetime64(t, 'ns')}".replace("T", " ") for t in TIME.tolist()]
    (folder / "timestamps.txt").write_text("\n".join([*stamps, ""]))
    for i, (w, a) in enumerate(zip(axes(GYRO, "FLU"), axes(ACCEL, "FLU"), strict=True)):
        row = [LATITUDE, LONGITUDE, HEIGHT, ROLL, -PITCH, np.pi / 2 - HEADING, NORTH, EAST, 5, 0, -DOWN]
        row += [*a, *a, *w, *w, 0.1, 0.05, 4, 10, 4, 4, 0]
        (folder / "data" / f"{i:010d}.txt").write_text(" ".join(f"{x:.12f}" for x in row) + "\n")
    return folder


@pytest.mark.parametrize("place", [".", "..", "data"])
def test_a_folder_is_one_log(oxts, place):
    log = read(oxts / place)
    (imu,), (solution,) = log.imus, log.references
    assert imu.angular_rate.time.tolist() == TIME.tolist()
    assert imu.origin.frame.startswith("FLU")
    np.testing.assert_allclose(imu.angular_rate.value, GYRO, rtol=0, atol=1e-9)
    np.testing.assert_allclose(imu.specific_force.value, ACCEL, rtol=0, atol=1e-9)
    assert solution.origin.by_filter
    np.testing.assert_allclose(
        solution.position[0], [np.radians(LATITUDE), np.radians(LONGITUDE), HEIGHT], rtol=0, atol=1e-9
    )
    np.testing.assert_allclose(solution.velocity[0], [NORTH, EAST, DOWN], rtol=0, atol=1e-9)
    np.testing.assert_allclose(solution.attitude[0], [ROLL, PITCH, HEADING], rtol=0, atol=1e-9)


def test_samples_without_a_time_and_files_of_other_numbers_are_counted(oxts):
    lines = (oxts / "timestamps.txt").read_text().splitlines()
    (oxts / "timestamps.txt").write_text("\n".join([*lines[:10], "", *lines[11:-3], ""]))
    (oxts / "data" / "0000000050.txt").write_text("1 2 3\n")
    imu = read(oxts).imus[0]
    assert len(imu.angular_rate) == N - 5
    assert repairs(imu) == {"no_time": 4, "cell_count": 1}


def test_times_that_are_no_dates_are_refused(oxts):
    (oxts / "timestamps.txt").write_text("1\n2\n3\n")
    with pytest.raises(UnreadableLogError, match=r"timestamps\.txt"):
        read(oxts)
