"""IMUs of telemetry logs in SI, and the clocks of all messages."""

import numpy as np
import pytest

from imuwb.notes import ids
from imuwb.units import STANDARD_GRAVITY
from tests.readers.flight.mavlink_writer import (
    BOOT,
    IMU_COUNTS,
    STEP,
    T,
    at,
    fixes,
    frame,
    heartbeat,
    numbered,
    record,
    since_start,
    system_time,
)
from tests.readers.repairs import repairs


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("name", IMU_COUNTS)
def test_counts_become_si(tlog_of, name, version):
    counts = {"xgyro": 1000, "ygyro": -2, "zgyro": 3, "xacc": 4, "yacc": -5, "zacc": -1000}
    log = tlog_of(*(at(i, name, version=version, **counts) for i in range(4)))
    (imu,) = log.imus
    assert (imu.name, imu.origin.frame, imu.origin.epoch) == (name, "FRD", "unix")
    np.testing.assert_allclose(imu.angular_rate.value, [[1, -0.002, 0.003]] * 4, rtol=1e-14)
    expected = np.array([4, -5, -1000]) * 1e-3 * STANDARD_GRAVITY
    np.testing.assert_allclose(imu.specific_force.value, [expected] * 4, rtol=1e-14)
    assert since_start(imu.angular_rate) == since_start(imu.specific_force) == [0, 1, 2, 3]
    assert imu.temperature is None
    assert any(note.id == "coarse" and note.startswith(f"{name}: ") for note in log.notes)


@pytest.mark.parametrize("name", ["HIGHRES_IMU", "HIL_SENSOR"])
def test_floats_are_si_already(tlog_of, name):
    values = {"xgyro": 0.5, "ygyro": -0.25, "zgyro": 2, "xacc": 0.125, "yacc": 1, "zacc": -9.75, "temperature": 21.5}
    log = tlog_of(*(at(i, name, time_usec=T + STEP * i, **values) for i in range(3)))
    (imu,) = log.imus
    assert imu.angular_rate.value.tolist() == [[0.5, -0.25, 2]] * 3
    assert imu.specific_force.value.tolist() == [[0.125, 1, -9.75]] * 3
    assert imu.temperature.value.tolist() == [21.5] * 3
    assert since_start(imu.angular_rate) == [0, 1, 2]
    assert "coarse" not in ids(log.notes)


@pytest.mark.parametrize("name", ["HIGHRES_IMU", "HIL_SENSOR"])
def test_floats_since_power_up_are_dated_by_the_recorder(tlog_of, name):
    (imu,) = tlog_of(*(at(i, name, zacc=-9.75) for i in range(3))).imus
    assert since_start(imu.angular_rate) == [0, 1, 2]


def test_floats_since_power_up_are_dated_by_another_messages_clock(tlog_of):
    log = tlog_of(*(at(i, "ATTITUDE") + at(i, "HIGHRES_IMU", zacc=-9.75) for i in range(3)))
    assert since_start(log.imus[0].angular_rate) == [0, 1, 2]


@pytest.mark.parametrize("name", IMU_COUNTS)
def test_a_temperature_in_hundredths_of_which_zero_is_none(tlog_of, name):
    (imu,) = tlog_of(*(at(i, name, temperature=warmth) for i, warmth in enumerate([0, 2534, 0, -150]))).imus
    assert imu.temperature.value.tolist() == pytest.approx([25.34, -1.5], abs=1e-12)
    assert since_start(imu.temperature) == [1, 3]
    assert len(imu.angular_rate) == 4


@pytest.mark.parametrize("name", ["RAW_IMU", "HIGHRES_IMU"])
def test_instances_are_streams_of_their_own(tlog_of, name):
    log = tlog_of(*(at(i, "ATTITUDE") + at(i, name, id=i % 3, xgyro=i) for i in range(9)))
    assert [imu.name for imu in log.imus] == [name, f"{name}.1", f"{name}.2"]
    assert [since_start(imu.angular_rate) for imu in log.imus] == [[0, 3, 6], [1, 4, 7], [2, 5, 8]]
    scale = 1e-3 if name == "RAW_IMU" else 1
    assert log.imus[1].angular_rate.value[:, 0] == pytest.approx([scale, 4 * scale, 7 * scale])


@pytest.mark.parametrize(
    ("z", "kept"),
    [(-1000, True), (-700, True), (-1900, True), (0, True), (-4096, False), (-16384, False), (-98, False)],
)
def test_raw_counts_whose_size_is_not_that_of_gravity_are_not_used(tlog_of, z, kept):
    """RAW_IMU has mG by its definition, but some autopilots send the sensor's counts."""
    log = tlog_of(
        *(at(i, "RAW_IMU", zacc=z, xgyro=5) for i in range(9)), *(at(i, "SCALED_IMU2", zacc=-1000) for i in range(9))
    )
    assert [imu.name for imu in log.imus] == ["RAW_IMU", "SCALED_IMU2"][not kept :]
    assert any("RAW_IMU (9)" in note for note in log.notes if note.id == "unused") == (not kept)


@pytest.mark.parametrize("name", ["HIGHRES_IMU", "HIL_SENSOR"])
def test_a_sensor_has_the_rows_that_its_flags_call_new(tlog_of, name):
    """The accelerometer is new in every second message only; between, its last sample is sent again."""
    flags = [0b111111, 0b111000]
    rows = [at(i, name, xgyro=i, xacc=i // 2, zacc=-9.75, fields_updated=flags[i % 2]) for i in range(10)]
    (imu,) = tlog_of(*rows).imus
    assert imu.angular_rate.value[:, 0].tolist() == list(range(10))
    assert imu.specific_force.value[:, 0].tolist() == list(range(5))
    assert since_start(imu.specific_force) == [0, 2, 4, 6, 8]


@pytest.mark.parametrize("flags", [0, 0b1_0000_0000_0000])
def test_without_flags_of_the_sensors_every_row_counts(tlog_of, flags):
    (imu,) = tlog_of(*(at(i, "HIGHRES_IMU", zacc=-9.75, fields_updated=flags) for i in range(4))).imus
    assert (len(imu.angular_rate), len(imu.specific_force)) == (4, 4)


def test_two_systems_and_two_components_are_apart(tlog_of):
    parts = [(1, 1), (1, 2), (42, 1)]
    log = tlog_of(*(r for s, c in parts for r in numbered(s + c, system=s, component=c)))
    assert {imu.name: len(imu.angular_rate) for imu in log.imus} == {
        "1.1.SCALED_IMU": 2, "1.2.SCALED_IMU": 3, "42.1.SCALED_IMU": 43,
    }  # fmt: skip


def test_a_system_that_measures_nothing_does_not_change_names(tlog_of):
    log = tlog_of(*numbered(3), heartbeat(system=255), at(0, "ATTITUDE", system=2), system_time(T, system=255))
    assert [imu.name for imu in log.imus] == ["SCALED_IMU"]


def test_boot_times_become_what_system_time_says(tlog_of):
    hour = 3600 * 10**6
    log = tlog_of(system_time(T + hour), *numbered(3), system_time(0, 4), system_time(T + hour + 5 * STEP, 5))
    assert since_start(log.imus[0].angular_rate) == [36_000, 36_001, 36_002]
    assert "utc_by_message" in ids(log.notes)


@pytest.mark.parametrize("unix", [0, 5_000_000, 946_684_799_000_000])
def test_dates_before_2000_are_not_believed(tlog_of, unix):
    log = tlog_of(system_time(unix), *numbered(3))
    assert since_start(log.imus[0].angular_rate) == [0, 1, 2]
    assert "utc_by_recorder" in ids(log.notes)


@pytest.mark.parametrize("unix", [4_102_444_800_000_001, 2**63, 2**64 - 1])
def test_dates_behind_2100_are_not_believed(tlog_of, unix):
    log = tlog_of(system_time(unix), *numbered(3))
    assert since_start(log.imus[0].angular_rate) == [0, 1, 2]


def test_what_the_recorder_wrote_down_is_used_when_asked_for(tlog_of):
    log = tlog_of(system_time(T + 3600 * 10**6), *numbered(3), *fixes(), time_source="log")
    assert since_start(log.imus[0].angular_rate) == [0, 1, 2]
    assert since_start(log.gnss[0]) == [0, 1, 2, 3]


def test_a_message_that_arrives_late_keeps_its_time(tlog_of):
    late = record(T + 10**6, frame("SCALED_IMU", time_boot_ms=BOOT + 300))
    (imu,) = tlog_of(*numbered(3), *numbered(4, 4), late).imus
    assert since_start(imu.angular_rate) == [0, 1, 2, 3, 4, 5, 6, 7]
    assert repairs(imu)["out_of_order"] == 1


def test_times_go_on_behind_a_reboot(tlog_of):
    anew = [record(T + STEP * i, frame("SCALED_IMU", time_boot_ms=100 * (i - 50))) for i in range(50, 60)]
    long = [at(i, "SCALED_IMU") for i in range(5)]
    long += [record(T + STEP * 40, frame("SCALED_IMU", time_boot_ms=BOOT + 4000))]
    log = tlog_of(*long, *anew)
    assert since_start(log.imus[0].angular_rate) == [*range(5), 40, *range(50, 60)]
    assert any(note.id == "reboots" and "system 1, component 1: 1 " in note for note in log.notes)


def test_raw_imu_may_tell_unix_time(tlog_of):
    (imu,) = tlog_of(*(at(i, "RAW_IMU", time_usec=T + STEP * (i + 7)) for i in range(3))).imus
    assert since_start(imu.angular_rate) == [7, 8, 9]


def test_components_stay_together_when_one_knows_the_date(tlog_of):
    log = tlog_of(system_time(T + 3600 * 10**6), *numbered(3), *numbered(3, component=2))
    first, second = (imu.angular_rate.time.tolist() for imu in log.imus)
    assert first == second
