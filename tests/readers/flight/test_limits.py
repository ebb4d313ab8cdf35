"""The limits beyond which a flight controller's value is damage, or its time is not believed."""

import struct

import numpy as np
import pytest

from imuwb.readers.flight.boot_clock import boot_clock
from imuwb.readers.flight.dataflash_text import TextTables
from imuwb.readers.flight.trajectory import FASTEST, HIGHEST, usable, velocities
from imuwb.readers.flight.ulog_records import walk
from tests.readers.flight import dataflash_writer as log
from tests.readers.flight import ulog_writer as px4
from tests.readers.flight.mavlink_writer import FIX, STEP, T, at, since_start
from tests.readers.repairs import repairs

SECOND = 10**9


@pytest.mark.parametrize(("height", "possible"), [(99_999.0, True), (-99_999.0, True), (100_001.0, False)])
def test_a_height_up_to_a_hundred_kilometres_is_possible(height, possible):
    assert HIGHEST == 100_000
    assert usable(np.array([[0.8, 0.1, height]])).tolist() == [possible]


@pytest.mark.parametrize(("speed", "possible"), [(19_999.0, True), (20_001.0, False)])
def test_a_speed_up_to_that_of_a_launcher_is_possible(speed, possible):
    assert FASTEST == 20_000
    assert np.isfinite(velocities(np.array([speed]), np.zeros(1), 0.0))[0].tolist() == [possible, True, True]


@pytest.mark.parametrize(("back", "reboots"), [(5 * SECOND, 0), (5 * SECOND + 1, 1)])
def test_a_clock_that_steps_back_by_more_than_five_seconds_was_restarted(back, reboots):
    place, boot = np.arange(4), np.array([10, 20, 30, 30]) * SECOND
    boot[3] -= back
    assert boot_clock(place, boot, boot, np.zeros(4, np.int64)).reboots == reboots


@pytest.mark.parametrize(
    ("field", "value", "kept"),
    [(2, 199.0, 3), (2, -201.0, 2), (5, 4999.0, 3), (5, -5001.0, 2)],
)
def test_a_rate_of_200_and_a_force_of_5000_are_no_motion(dataflash_of, field, value, kept):
    rows = [log.imu(i) for i in range(3)]
    values = list(rows[1][1])
    values[field] = value
    rows[1] = (log.IMU, tuple(values))
    assert len(dataflash_of([*log.declared(), *rows]).imu().angular_rate) == kept


@pytest.mark.parametrize(("temperature", "kept"), [(299.0, 3), (301.0, 2), (-301.0, 2)])
def test_a_temperature_of_300_degrees_is_damage(dataflash_of, temperature, kept):
    rows = [log.imu(i) for i in range(3)]
    rows[1] = (log.IMU, (*rows[1][1][:-1], temperature))
    assert len(dataflash_of([*log.declared(), *rows]).imu().temperature) == kept


@pytest.mark.parametrize(("roll", "known"), [(999.0, True), (1001.0, False)])
def test_an_angle_of_a_thousand_radians_is_damage(dataflash_of, roll, known):
    kind = log.Format(136, "ATT", "Qfff", "TimeUS,Roll,Pitch,Yaw")
    rows = [(kind, (log.START + 1000 * i, np.degrees(roll), 0.0, 0.0)) for i in range(3)]
    rows += [(log.POS, (log.START + 1000 * i, 47.3, 8.5, 400.0, 0.0, 0.0)) for i in range(3)]
    attitude = dataflash_of([*log.declared(kind, log.POS), *rows]).references[0].attitude
    assert (attitude is not None) == known


@pytest.mark.parametrize(("late", "known"), [(499_999, True), (500_000, False)])
def test_a_fix_takes_the_accuracy_within_half_a_second(dataflash_of, late, known):
    time = log.START + late
    (gnss,) = dataflash_of([*log.declared(), log.fix(0), (log.GPA, (time, 0, 1.2, 0.5, 0.9, 0.3))]).gnss
    assert (gnss.position_sigma is not None) == known


@pytest.mark.parametrize(
    ("changes", "epoch"),
    [
        ({"Status": 3}, "unix"), ({"Status": 2}, "boot"),
        ({"GWk": 1001}, "unix"), ({"GWk": 1000}, "boot"), ({"GWk": 4999}, "unix"), ({"GWk": 5000}, "boot"),
    ],
)  # fmt: skip
def test_a_fix_in_three_dimensions_and_a_week_of_1999_to_2075_state_the_date(dataflash_of, changes, epoch):
    assert dataflash_of([*log.declared(), log.fix(0, **changes)]).gnss[0].origin.epoch == epoch


@pytest.mark.parametrize(("off", "wrong"), [(60 * 10**6, 0), (60 * 10**6 + 1, 1)])
def test_a_fix_whose_time_is_a_minute_from_its_arrival_takes_the_recorders(tlog_of, off, wrong):
    rows = [at(i, "GPS_RAW_INT", **FIX, time_usec=T + STEP * i + off * (i == 2)) for i in range(5)]
    (gnss,) = tlog_of(*rows).gnss
    assert repairs(gnss).get("fix_time_wrong", 0) == wrong


@pytest.mark.parametrize(("same", "frozen"), [(5, False), (6, True)])
def test_a_time_that_stays_the_same_for_more_than_half_of_the_fixes_is_frozen(tlog_of, same, frozen):
    stamps = [T + STEP * max(i - same, 0) for i in range(11)]  # ten steps, ``same`` of them of no length
    (gnss,) = tlog_of(*(at(i, "GPS_RAW_INT", **FIX, time_usec=stamp) for i, stamp in enumerate(stamps))).gnss
    assert ("fix_time_frozen" in repairs(gnss)) == frozen
    assert (since_start(gnss) == list(range(11))) == frozen


@pytest.mark.parametrize(("step", "samples"), [(999_999.0, 2), (1_000_000.0, 0)])
def test_a_second_between_the_samples_of_a_buffer_is_damage(ulog_of, step, samples):
    row = {
        "timestamp": px4.START,
        "timestamp_sample": px4.START,
        "device_id": 1,
        "dt": step,
        "scale": 1.0,
        "samples": 2,
    }
    row |= {axis: [1, 2] + [0] * 30 for axis in "xyz"}
    sound = {**row, "dt": 100.0, "timestamp": px4.START + 10**7, "timestamp_sample": px4.START + 10**7}
    found = ulog_of(px4.topic("sensor_gyro_fifo", 9, px4.FIFO, [row, sound]))
    assert len(found.imu().angular_rate) == 2 + samples


@pytest.mark.parametrize(("size", "whole"), [(4095, 10), (4096, 9)])
def test_a_message_that_the_file_s_end_cuts_is_shorter_than_four_kilobytes(size, whole):
    messages = (struct.pack("<HB", 8, ord("D")) + bytes(8)) * 10
    cut = struct.pack("<HB", size, ord("D")) + bytes(5)
    kind, _, _, _ = walk(np.frombuffer(messages + cut, np.uint8))
    assert kind.size == whole


@pytest.mark.parametrize(("time", "bad"), [(2**53 - 1, 0), (2**53, 1)])
def test_a_time_in_text_that_a_double_cannot_hold_is_a_bad_line(time, bad):
    tables = TextTables({"IMU"})
    tables.take([b"FMT, 131, 20, IMU, Qf, TimeUS,GyrX", f"IMU, {time}, 0.5".encode()])
    assert (tables.bad, tables.table("IMU") is None) == (bad, bool(bad))
