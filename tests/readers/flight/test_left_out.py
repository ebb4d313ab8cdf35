"""What a flight log holds and imuwb does not use is named: with the reason, or in one line with its number."""

import pytest

from imuwb.readers import read
from tests.readers.flight import dataflash_writer as log
from tests.readers.flight import mavlink_writer
from tests.readers.flight import ulog_writer as px4

AHR2 = log.Format(150, "AHR2", "QccCfLLffff", "TimeUS,Roll,Pitch,Yaw,Alt,Lat,Lng,Q1,Q2,Q3,Q4")
IMT = log.Format(151, "IMT", "Qfffffffff", "TimeUS,DelT,DelvT,DelaT,DelAX,DelAY,DelAZ,DelVX,DelVY,DelVZ")
BARO = log.Format(152, "BARO", "Qff", "TimeUS,Alt,Press")
CURR = log.Format(153, "CURR", "Qf", "TimeUS,Volt")


def unused(found):
    return [str(note) for note in found.notes if note.id == "unused"]


def named(found, name, count):
    return [note for note in unused(found) if f"{name} ({count})" in note]


@pytest.mark.parametrize("form", [log.binary, log.text])
def test_dataflash_records_with_motion_are_named_the_others_are_counted(dataflash_of, fresh, form):
    rows = [*log.declared(*log.ALL, AHR2, IMT, BARO, CURR), *(log.imu(i) for i in range(5))]
    rows += [(AHR2, (log.START, *[1.0] * 10))] * 3 + [(IMT, (log.START, *[1.0] * 9))] * 4
    rows += [(BARO, (log.START, 1.0, 2.0))] * 6 + [(CURR, (log.START, 1.0))] * 7
    path = fresh("log.bin")
    path.write_bytes(form(rows))
    found = read(path)
    assert named(found, "AHR2", 3)
    assert named(found, "IMT", 4)
    (others,) = [note for note in unused(found) if "no inertial" in note]
    assert "2 other kinds of records" in others
    assert "13 in all" in others
    assert len(unused(found)) == 3


def test_dataflash_records_without_their_partners_are_named(dataflash_of):
    rows = [row for row in log.flight(10) if row[0] not in (log.POS, log.GPS)]
    found = dataflash_of(rows)
    for name, count in (("XKF1", 10), ("ATT", 5), ("GPA", 2)):
        assert named(found, name, count), name


def test_high_rate_batches_in_a_text_log_are_named(fresh):
    """Each list of 32 counts is one cell in some exports and 32 in others; the samples are in the binary log."""
    rows = log.text([*log.declared(), *(log.imu(i) for i in range(5))])
    path = fresh("log.log")
    path.write_bytes(rows + b"ISBD, 5000, 0, 0, [1, 2, 3], [4, 5, 6], [7, 8, 9]\n" * 3)
    found = read(path)
    assert named(found, "ISBD", 3)
    assert not [note for note in found.notes if note.id == "bad_line"]


def test_px4_topics_with_motion_are_named_the_others_are_counted(ulog_of):
    any_text = "uint64_t timestamp;float x;"
    row = [{"timestamp": px4.START}]
    topics = ("vehicle_angular_velocity", "vehicle_attitude_groundtruth", "estimator_odometry", "sensor_gnss_relative",
              "vehicle_attitude_setpoint", "battery_status", "cpuload")  # fmt: skip
    attitude = px4.topic("vehicle_attitude", 2, px4.ATTITUDE, [{"timestamp": px4.START, "q": (1, 0, 0, 0)}] * 4)
    found = ulog_of(
        px4.combined(20), attitude, *(px4.topic(name, 10 + i, any_text, row) for i, name in enumerate(topics))
    )
    for name in topics[:4]:
        assert named(found, name, 1), name
    assert named(found, "vehicle_attitude", 4)
    (others,) = [note for note in unused(found) if "no inertial" in note]
    assert "3 other topics" in others


def test_a_px4_log_that_is_used_whole_has_no_such_note(ulog_of):
    assert unused(ulog_of(whole=px4.flight())) == []


def test_telemetry_messages_with_motion_are_named_the_others_are_counted(tlog_of):
    at = mavlink_writer.at
    others = [at(i, name, clock=False) for i in range(3) for name in ("AHRS2", "LOCAL_POSITION_NED", "VFR_HUD")]
    found = tlog_of(
        *mavlink_writer.numbered(5), *(at(i, "ATTITUDE") for i in range(4)), *others, mavlink_writer.heartbeat()
    )
    for name, count in (("AHRS2", 3), ("LOCAL_POSITION_NED", 3), ("ATTITUDE", 4)):
        assert named(found, name, count), name
    (rest,) = [note for note in unused(found) if "no inertial" in note]
    assert "2 other kinds of messages (4 in all)" in rest


def test_an_attitude_beside_a_solution_is_used(tlog_of):
    found = tlog_of(*(mavlink_writer.at(i, "ATTITUDE") for i in range(4)), *map(mavlink_writer.solution, range(4)))
    assert unused(found) == []
