"""Stamps that are not set give way to the time of recording; stamps of another clock are named."""

import pytest

from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from tests.readers.repairs import repairs

from .db3_writer import write_db3

T = 1_714_564_800 * 10**9
STEP = 10**7
COUNT = 50
IMU = "sensor_msgs/msg/Imu"


@pytest.fixture
def log_of(fresh, ros):
    """Return a function that reads an IMU whose stamps are a function of the number and the time of recording."""

    def made(stamp, topics=("/imu",), **options):
        rows = [(T + i * STEP, ros.imu(stamp(i, T + i * STEP), (0.1, 0, 0), (0, 0, 9.8))) for i in range(COUNT)]
        return read(write_db3(fresh("log.db3"), dict.fromkeys(topics, (IMU, rows))), ReadOptions(**options))

    return made


def recorded(time):
    return time.tolist() == [T + i * STEP for i in range(COUNT)]


def test_stamps_that_are_never_set_give_way_to_the_time_of_recording(log_of):
    (imu,) = log_of(lambda _, __: 0).imus
    assert recorded(imu.angular_rate.time)
    assert repairs(imu) == {"no_stamp": COUNT}
    assert imu.origin.epoch == "unix"


def test_a_clock_that_starts_late_is_not_mixed_with_the_time_of_recording(log_of, monkeypatch):
    from imuwb.readers.containers import sqlite_rows

    monkeypatch.setattr(sqlite_rows, "ROWS", 10)
    (imu,) = log_of(lambda i, _: 0 if i < 10 else i * STEP).imus
    assert recorded(imu.angular_rate.time)
    assert repairs(imu) == {"no_stamp": COUNT}


@pytest.mark.parametrize(
    ("shift", "said"),
    [(0, False), (5 * 10**9, False), (-5 * 10**9, False), (18 * 10**9, True), (-3600 * 10**9, True), (315_964_800 * 10**9, True)],
)  # fmt: skip
def test_stamps_far_from_the_time_of_recording_are_named(log_of, shift, said):
    log = log_of(lambda _, time: time + shift, topics=("/imu", "/imu2"))
    assert [imu.angular_rate.time[0] for imu in log.imus] == [T + shift] * 2
    assert ids(log.notes) == (("other_clock",) if said else ())
    if said:
        assert "/imu, /imu2" in log.notes[0]
        assert ("after" in log.notes[0]) == (shift > 0)
        assert "--time-source log" in log.notes[0]


def test_stamps_that_count_from_power_up_are_named(log_of):
    log = log_of(lambda i, _: 5 * 10**9 + i * STEP)
    assert log.imu().angular_rate.time[0] == 5 * 10**9
    assert ids(log.notes) == ("other_clock",)
    assert "power-up" in log.notes[0]


def test_the_time_of_recording_needs_no_note(log_of):
    log = log_of(lambda i, _: 5 * 10**9 + i * STEP, time_source="log")
    assert recorded(log.imu().angular_rate.time)
    assert log.notes == ()
