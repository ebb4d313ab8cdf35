"""When an IMU is still and when it moves."""

import numpy as np
import pytest

from imuwb.health import check
from imuwb.log import ImuStream, Log, Provenance, Triad

from .records import log_of, motion, still


@pytest.mark.parametrize(("rows", "rate"), [(900, 100.0), (600, 2.0)], ids=["short", "slow"])
def test_what_is_too_short_or_too_slow_is_neither_still_nor_moving(rows, rate):
    gyro, accel = still()
    time = np.rint(np.arange(rows) * 1e9 / rate).astype(np.int64)
    imu = ImuStream("/imu", Triad(time, gyro[:rows] + 0.4), Triad(time, accel[:rows] + 5))
    found = check(Log(Provenance("made.csv", "csv", "", 0), (imu,)))
    assert (found.segments, found.segments_of) == ((), "/imu")
    assert not [f for f in found.faults if f.kind in ("gravity", "rate")]


def test_a_still_record_is_one_segment():
    (segment,) = check(log_of(*still())).segments
    assert (segment.start, segment.end, segment.moving) == (0, pytest.approx(59.99), False)


def test_segments_tell_when_the_imu_moves():
    gyro, accel = still()
    moving = motion(5)
    moving[:2000] = moving[4000:] = 0
    parts = check(log_of(gyro + moving[:, :3], accel + 3 * moving[:, 3:])).segments
    assert [p.moving for p in parts] == [False, True, False]
    assert [p.start for p in parts[1:]] == [p.end for p in parts[:-1]]
    assert (parts[1].start, parts[1].end) == (pytest.approx(20, abs=1.1), pytest.approx(40, abs=1.1))
