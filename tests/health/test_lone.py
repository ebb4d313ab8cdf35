"""Lone samples: found while the IMU is still, never at a gap, a step or a motion."""

import numpy as np
import pytest

from imuwb.health import check
from imuwb.log import ImuStream, Log, Provenance, Triad

from .records import N, changed, faults, log_of, motion, still


def test_lone_samples_are_counted_with_the_first_and_the_largest():
    def strike(values):
        values[1000] += 2.0
        values[2000] -= 3.0

    gyro, accel = changed(gyro_y=strike)
    (lone,) = faults(gyro, accel, "lone samples")
    assert (lone.stream, lone.severity, lone.count, lone.start) == ("/imu gyro_y", "warning", 2, 10.0)
    size = min(abs(gyro[2000, 1] - gyro[1999, 1]), abs(gyro[2000, 1] - gyro[2001, 1]))
    assert lone.what.endswith(f"by up to {np.degrees(size):.4g} deg/s")


def test_another_level_behind_a_gap_is_not_lone():
    gyro, accel = still()
    gyro[1100:, 0] += 1
    keep = np.ones(N, bool)
    keep[1000:1100] = False
    assert faults(gyro, accel, "lone samples", keep=keep) == []


@pytest.mark.parametrize("beside", [999, 1100])
def test_samples_beside_a_gap_are_not_lone(beside):
    gyro, accel = still()
    gyro[beside, 0] += 3
    keep = np.ones(N, bool)
    keep[1000:1100] = False
    assert faults(gyro, accel, "lone samples", keep=keep) == []
    assert len(faults(gyro, accel, "lone samples")) == 1  # without the gap it is


def test_a_step_of_a_coarse_sensor_is_no_lone_sample():
    gyro, accel = still()
    gyro[:, 0] = 0.0
    gyro[[500, 1500], 0] = 0.02  # one step, while it hardly ever changes
    gyro[2500:, 0] = -0.02
    assert faults(gyro, accel, "lone samples") == []
    gyro[3500, 0] = 0.12
    assert [f.count for f in faults(gyro, accel, "lone samples")] == [1]


def test_samples_are_not_lone_while_the_imu_moves():
    gyro, accel = still()
    moved = motion(3)
    moved[:2000] = 0
    gyro += 0.1 * moved[:, :3]
    gyro[4000, 1] += 5.0
    assert faults(gyro, accel + moved[:, 3:], "lone samples") == []
    gyro[1000, 1] += 5.0
    assert [f.count for f in faults(gyro, accel + moved[:, 3:], "lone samples")] == [1]


def test_many_lone_samples_are_no_motion():
    gyro, accel = still()
    gyro[500::500, 1] += 2.0
    found = check(log_of(gyro, accel))
    assert [f.count for f in found.faults if f.kind == "lone samples"] == [11]
    assert [s.moving for s in found.segments] == [False]


def test_slow_samples_are_not_judged_to_be_lone():
    gyro, accel = still()
    gyro[1000, 0] += 3
    time = np.arange(N) * (10**9 // 10)
    imu = ImuStream("/imu", Triad(time, gyro), Triad(time, accel))
    found = check(Log(Provenance("made.csv", "csv", "", 0), (imu,)), lines=False).faults
    assert not [f for f in found if f.kind == "lone samples"]


def test_shaking_is_no_series_of_lone_samples():
    gyro, accel = still()
    gyro[1000:1200] += 5 * np.random.default_rng(9).standard_normal((200, 3))
    assert faults(gyro, accel, "lone samples") == []


def test_a_step_has_no_lone_samples():
    gyro, accel = still()
    gyro[3000:, 0] += 1
    assert faults(gyro, accel, "lone samples") == []
