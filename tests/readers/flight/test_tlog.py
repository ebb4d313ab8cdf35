"""Telemetry logs become IMUs, receivers and references in SI, on the clock that the log itself tells."""

import gzip
import math
from functools import partial

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from imuwb.readers.bytes import source
from imuwb.readers.flight import tlog, tlog_streams
from imuwb.units import STANDARD_GRAVITY
from tests.readers.repairs import repairs

from .mavlink_writer import T, frame, heard, heartbeat, numbered, record, spoilt

START = T * 1000
STEP = 100_000  #: µs between messages
BOOT = 5000  #: ms since power-up at the start
FIX = {"lat": 473_977_420, "lon": 85_455_940, "alt": 488_000, "fix_type": 3, "vel": 65_535, "cog": 65_535}
IMU_COUNTS = ("SCALED_IMU", "SCALED_IMU2", "SCALED_IMU3", "RAW_IMU")


@pytest.fixture(scope="module")
def opened(fresh):
    """Return a function that writes records and reads them."""

    def log(*records, **options):
        path = fresh("log.tlog")
        path.write_bytes(b"".join(records))
        return read(path, ReadOptions(**options))

    return log


def at(i, name, *, clock=True, **fields):
    """Return the record of a message that is the i-th, its clock set to that."""
    if clock and name in (*IMU_COUNTS[:3], "ATTITUDE", "GLOBAL_POSITION_INT"):
        fields = {"time_boot_ms": BOOT + 100 * i, **fields}
    elif clock:
        fields = {"time_usec": 1000 * BOOT + STEP * i, **fields}
    return record(T + STEP * i, frame(name, **fields))


def system_time(unix, i=0, **options):
    return record(T + STEP * i, frame("SYSTEM_TIME", time_unix_usec=unix, time_boot_ms=BOOT + 100 * i, **options))


def fixes(count=4, first=0, name="GPS_RAW_INT", **fields):
    return [at(i, name, **{**FIX, **fields}) for i in range(first, first + count)]


def since_start(stream):
    """Return a stream's times in steps from the start."""
    return ((stream.time - START) / (1000 * STEP)).tolist()


# IMUs


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("name", IMU_COUNTS)
def test_counts_become_si(opened, name, version):
    counts = {"xgyro": 1000, "ygyro": -2, "zgyro": 3, "xacc": 4, "yacc": -5, "zacc": -1000}
    log = opened(*(at(i, name, version=version, **counts) for i in range(4)))
    (imu,) = log.imus
    assert (imu.name, imu.origin.frame, imu.origin.epoch) == (name, "FRD", "unix")
    np.testing.assert_allclose(imu.angular_rate.value, [[1, -0.002, 0.003]] * 4, rtol=1e-14)
    expected = np.array([4, -5, -1000]) * 1e-3 * STANDARD_GRAVITY
    np.testing.assert_allclose(imu.specific_force.value, [expected] * 4, rtol=1e-14)
    assert since_start(imu.angular_rate) == since_start(imu.specific_force) == [0, 1, 2, 3]
    assert imu.temperature is None
    assert any(note.id == "coarse" and note.startswith(f"{name}: ") for note in log.notes)


@pytest.mark.parametrize("name", ["HIGHRES_IMU", "HIL_SENSOR"])
def test_floats_are_si_already(opened, name):
    values = {"xgyro": 0.5, "ygyro": -0.25, "zgyro": 2, "xacc": 0.125, "yacc": 1, "zacc": -9.75, "temperature": 21.5}
    log = opened(*(at(i, name, time_usec=T + STEP * i, **values) for i in range(3)))
    (imu,) = log.imus
    assert imu.angular_rate.value.tolist() == [[0.5, -0.25, 2]] * 3
    assert imu.specific_force.value.tolist() == [[0.125, 1, -9.75]] * 3
    assert imu.temperature.value.tolist() == [21.5] * 3
    assert since_start(imu.angular_rate) == [0, 1, 2]
    assert "coarse" not in ids(log.notes)


@pytest.mark.parametrize("name", ["HIGHRES_IMU", "HIL_SENSOR"])
def test_floats_since_power_up_are_dated_by_the_recorder(opened, name):
    (imu,) = opened(*(at(i, name, zacc=-9.75) for i in range(3))).imus
    assert since_start(imu.angular_rate) == [0, 1, 2]


def test_floats_since_power_up_are_dated_by_another_messages_clock(opened):
    log = opened(*(at(i, "ATTITUDE") + at(i, "HIGHRES_IMU", zacc=-9.75) for i in range(3)))
    assert since_start(log.imus[0].angular_rate) == [0, 1, 2]


@pytest.mark.parametrize("name", IMU_COUNTS)
def test_a_temperature_in_hundredths_of_which_zero_is_none(opened, name):
    (imu,) = opened(*(at(i, name, temperature=warmth) for i, warmth in enumerate([0, 2534, 0, -150]))).imus
    assert imu.temperature.value.tolist() == pytest.approx([25.34, -1.5], abs=1e-12)
    assert since_start(imu.temperature) == [1, 3]
    assert len(imu.angular_rate) == 4


@pytest.mark.parametrize("name", ["RAW_IMU", "HIGHRES_IMU"])
def test_instances_are_streams_of_their_own(opened, name):
    log = opened(*(at(i, "ATTITUDE") + at(i, name, id=i % 3, xgyro=i) for i in range(9)))
    assert [imu.name for imu in log.imus] == [name, f"{name}.1", f"{name}.2"]
    assert [since_start(imu.angular_rate) for imu in log.imus] == [[0, 3, 6], [1, 4, 7], [2, 5, 8]]
    scale = 1e-3 if name == "RAW_IMU" else 1
    assert log.imus[1].angular_rate.value[:, 0] == pytest.approx([scale, 4 * scale, 7 * scale])


def test_two_systems_and_two_components_are_apart(opened):
    parts = [(1, 1), (1, 2), (42, 1)]
    log = opened(*(r for s, c in parts for r in numbered(s + c, system=s, component=c)))
    assert {imu.name: len(imu.angular_rate) for imu in log.imus} == {
        "1.1.SCALED_IMU": 2, "1.2.SCALED_IMU": 3, "42.1.SCALED_IMU": 43,
    }  # fmt: skip


def test_a_system_that_measures_nothing_does_not_change_names(opened):
    log = opened(*numbered(3), heartbeat(system=255), at(0, "ATTITUDE", system=2), system_time(T, system=255))
    assert [imu.name for imu in log.imus] == ["SCALED_IMU"]


# Time


def test_boot_times_become_what_system_time_says(opened):
    hour = 3600 * 10**6
    log = opened(system_time(T + hour), *numbered(3), system_time(0, 4), system_time(T + hour + 5 * STEP, 5))
    assert since_start(log.imus[0].angular_rate) == [36_000, 36_001, 36_002]
    assert "utc_by_message" in ids(log.notes)


@pytest.mark.parametrize("unix", [0, 5_000_000, 946_684_799_000_000])
def test_dates_before_2000_are_not_believed(opened, unix):
    log = opened(system_time(unix), *numbered(3))
    assert since_start(log.imus[0].angular_rate) == [0, 1, 2]
    assert "utc_by_recorder" in ids(log.notes)


@pytest.mark.parametrize("unix", [4_102_444_800_000_001, 2**63, 2**64 - 1])
def test_dates_behind_2100_are_not_believed(opened, unix):
    log = opened(system_time(unix), *numbered(3))
    assert since_start(log.imus[0].angular_rate) == [0, 1, 2]


def test_what_the_recorder_wrote_down_is_used_when_asked_for(opened):
    log = opened(system_time(T + 3600 * 10**6), *numbered(3), *fixes(), time_source="log")
    assert since_start(log.imus[0].angular_rate) == [0, 1, 2]
    assert since_start(log.gnss[0]) == [0, 1, 2, 3]


def test_a_message_that_arrives_late_keeps_its_time(opened):
    late = record(T + 10**6, frame("SCALED_IMU", time_boot_ms=BOOT + 300))
    (imu,) = opened(*numbered(3), *numbered(4, 4), late).imus
    assert since_start(imu.angular_rate) == [0, 1, 2, 3, 4, 5, 6, 7]
    assert repairs(imu)["out_of_order"] == 1


def test_times_go_on_behind_a_reboot(opened):
    anew = [record(T + STEP * i, frame("SCALED_IMU", time_boot_ms=100 * (i - 50))) for i in range(50, 60)]
    long = [at(i, "SCALED_IMU") for i in range(5)]
    long += [record(T + STEP * 40, frame("SCALED_IMU", time_boot_ms=BOOT + 4000))]
    log = opened(*long, *anew)
    assert since_start(log.imus[0].angular_rate) == [*range(5), 40, *range(50, 60)]
    assert any(note.id == "reboots" and "system 1, component 1: 1 " in note for note in log.notes)


def test_raw_imu_may_tell_unix_time(opened):
    (imu,) = opened(*(at(i, "RAW_IMU", time_usec=T + STEP * (i + 7)) for i in range(3))).imus
    assert since_start(imu.angular_rate) == [7, 8, 9]


def test_components_stay_together_when_one_knows_the_date(opened):
    log = opened(system_time(T + 3600 * 10**6), *numbered(3), *numbered(3, component=2))
    first, second = (imu.angular_rate.time.tolist() for imu in log.imus)
    assert first == second


# Receivers


@pytest.mark.parametrize("name", tlog_streams.RECEIVERS)
@pytest.mark.parametrize("version", [1, 2])
def test_a_fix_in_si(opened, name, version):
    name = {24: "GPS_RAW_INT", 124: "GPS2_RAW"}[name]
    told = {
        "vel": 1000,
        "cog": 3000,
        "fix_type": 5,
        "alt_ellipsoid": 535_125,
        "h_acc": 1500,
        "v_acc": 2500,
        "vel_acc": 300,
    }
    log = opened(*fixes(name=name, version=version, **told))
    (gnss,) = log.gnss
    assert (gnss.name, gnss.origin.frame, gnss.origin.epoch) == (name, "NED", "unix")
    height, sigma = (535.125, [1.5, 1.5, 2.5]) if version == 2 else (488.0, None)
    expected = [math.radians(47.3977420), math.radians(8.5455940), height]
    np.testing.assert_allclose(gnss.position, [expected] * 4, rtol=1e-14)
    velocity = [10 * math.cos(math.radians(30)), 10 * math.sin(math.radians(30)), np.nan]
    np.testing.assert_allclose(gnss.velocity, [velocity] * 4, rtol=1e-14)
    assert gnss.fix_type.tolist() == [5] * 4
    assert (gnss.position_sigma is None) == (gnss.velocity_sigma is None) == (version == 1)
    if sigma:
        np.testing.assert_allclose(gnss.position_sigma, [sigma] * 4, rtol=1e-14)
        np.testing.assert_allclose(gnss.velocity_sigma, [[0.3] * 3] * 4, rtol=1e-14)
    assert ("above_sea" in ids(log.notes)) == (version == 1)


@pytest.mark.parametrize("unknown", ["vel", "cog"])
def test_speed_or_course_that_is_unknown_is_no_velocity(opened, unknown):
    known = [at(i, "GPS_RAW_INT", **{**FIX, "vel": 100, "cog": 0}) for i in range(3)]
    odd = at(3, "GPS_RAW_INT", **{**FIX, "vel": 100, "cog": 0, unknown: 65_535})
    (gnss,) = opened(*known, odd).gnss
    assert np.isfinite(gnss.velocity[:, :2]).tolist() == [[True, True]] * 3 + [[False, False]]
    assert np.isnan(gnss.velocity[:, 2]).all()
    assert gnss.velocity[0, :2].tolist() == [1, 0]


def test_sigmas_that_are_unknown_are_none_of_zero(opened):
    accuracy = [{"h_acc": 1000, "v_acc": 2000, "vel_acc": 100}, {"h_acc": 1000}, {"v_acc": 2000}, {"vel_acc": 100}]
    (gnss,) = opened(*(at(i, "GPS_RAW_INT", **{**FIX, **told}) for i, told in enumerate(accuracy))).gnss
    none = np.nan
    np.testing.assert_allclose(gnss.position_sigma, [[1, 1, 2], [1, 1, none], [none, none, 2], [none] * 3])
    np.testing.assert_allclose(gnss.velocity_sigma[:, 0], [0.1, none, none, 0.1])


def test_rows_before_a_fix_are_left_out_and_counted(opened):
    clock = [at(i, "ATTITUDE") for i in range(9)]
    (gnss,) = opened(*clock, *fixes(3, lat=0, lon=0), *fixes(4, 3), *fixes(1, 7, lat=0), *fixes(1, 8, lon=0)).gnss
    assert since_start(gnss) == [3, 4, 5, 6, 7, 8]
    assert repairs(gnss) == {"no_position": 3}


@pytest.mark.parametrize("bad", [{"lat": 900_000_001}, {"lon": -1_800_000_001}, {"alt": 100_000_000}])
def test_positions_that_cannot_be_are_left_out(opened, bad):
    (gnss,) = opened(*fixes(3), *fixes(1, 3, **bad)).gnss
    assert since_start(gnss) == [0, 1, 2]


def test_a_receiver_that_never_had_a_fix_is_noted_with_its_name_and_count(opened):
    log = opened(*numbered(3), *fixes(7, lat=0, lon=0))
    assert log.gnss == ()
    assert any(note.id == "no_position" and "GPS_RAW_INT: all 7 " in note for note in log.notes)


def test_a_fix_since_power_up_is_dated_by_the_boot_clock(opened):
    (gnss,) = opened(system_time(T + 3600 * 10**6), *(at(i, "ATTITUDE") for i in range(4)), *fixes()).gnss
    assert since_start(gnss) == [36_000, 36_001, 36_002, 36_003]
    assert repairs(gnss) == {}


def test_a_fix_may_tell_unix_time(opened):
    (gnss,) = opened(*(at(i, "GPS_RAW_INT", **FIX, time_usec=T + STEP * (i + 2)) for i in range(4))).gnss
    assert since_start(gnss) == [2, 3, 4, 5]


@pytest.mark.parametrize("stuck", [0, 1_000_000, T, 2**64 - 1])
def test_a_frozen_time_of_fixes_is_not_used(opened, stuck):
    (gnss,) = opened(*fixes(6, time_usec=stuck)).gnss
    assert since_start(gnss) == [0, 1, 2, 3, 4, 5]
    assert repairs(gnss) == {"fix_time_frozen": 6}


def test_one_fix_whose_time_is_far_off_gets_the_recorders(opened):
    rows = [at(i, "GPS_RAW_INT", **FIX, time_usec=T + STEP * i + 61 * 10**6 * (i == 2)) for i in range(5)]
    (gnss,) = opened(*rows).gnss
    assert since_start(gnss) == [0, 1, 2, 3, 4]
    assert repairs(gnss) == {"fix_time_wrong": 1}


def test_two_receivers_are_two_streams(opened):
    log = opened(*fixes(), *fixes(3, name="GPS2_RAW"))
    assert {gnss.name: len(gnss) for gnss in log.gnss} == {"GPS_RAW_INT": 4, "GPS2_RAW": 3}


# The navigation solution


def solution(i, **fields):
    return at(i, "GLOBAL_POSITION_INT", **{"lat": 473_977_420, "lon": -85_455_940, "alt": 488_500, **fields})


def test_a_solution_in_si_is_a_reference(opened):
    (reference,) = opened(*(solution(i, vx=100, vy=-250, vz=5) for i in range(3))).references
    assert reference.name == "GLOBAL_POSITION_INT"
    np.testing.assert_allclose(
        reference.position, [[math.radians(47.397742), math.radians(-8.545594), 488.5]] * 3, rtol=1e-14
    )
    np.testing.assert_allclose(reference.velocity, [[1, -2.5, 0.05]] * 3, rtol=1e-14)
    assert reference.attitude is None
    assert since_start(reference) == [0, 1, 2]


def test_attitude_is_interpolated_also_through_the_turn(opened):
    angles = [at(2 * i, "ATTITUDE", roll=0.1 * i, pitch=-0.2, yaw=math.remainder(0.4 * i, math.tau)) for i in range(20)]
    (reference,) = opened(*angles, *(solution(i) for i in range(38))).references
    expected = [[0.05 * i, -0.2, 0.2 * i] for i in range(38)]
    wrong = np.angle(np.exp(1j * (reference.attitude - expected)))
    assert np.abs(wrong).max() < 1e-6


def test_attitude_is_that_of_the_moment_by_the_recorders_clock(opened):
    rows = [at(i, "ATTITUDE", yaw=0.1 * i) + solution(i) for i in range(10)]
    (reference,) = opened(system_time(T + 3600 * 10**6), *rows, time_source="log").references
    assert since_start(reference) == list(range(10))
    assert reference.attitude[:, 2] == pytest.approx(0.1 * np.arange(10), abs=1e-6)


def test_an_attitude_that_is_no_number_costs_no_more_than_its_neighbours(opened):
    rows = [at(i, "ATTITUDE", yaw=math.nan if i == 4 else 0.1 * i) + solution(i) for i in range(20)]
    (reference,) = opened(*rows).references
    assert {0, 1, 2, 10, 15, 19} <= set(since_start(reference))


def test_a_solution_of_nothing_is_none(opened):
    log = opened(*(solution(i, lat=0 if i < 3 else 1, lon=0) for i in range(6)))
    assert since_start(log.references[0]) == [3, 4, 5]
    assert opened(*(solution(i, lat=0, lon=0) for i in range(6))).references == ()


def test_rows_of_a_solution_without_a_position_are_counted(opened):
    log = opened(*(solution(i, lat=0 if i < 3 else 1, lon=0) for i in range(6)))
    assert repairs(log.references[0]) == {"no_position": 3}
    assert any(note.id == "no_position" and note.endswith("(3)") for note in log.notes)


# Files


def test_what_is_no_measurement_makes_an_empty_log(opened):
    log = opened(*(heartbeat(T + i) for i in range(5)))
    assert (log.imus, log.gnss, log.references) == ((), (), ())


def test_what_was_wrong_with_frames_is_counted(opened):
    unknown = bytearray(numbered(1)[0])
    unknown[15:18] = b"\xff\xff\xff"
    impossible = [record(stamp, frame("SCALED_IMU", xgyro=1)) for stamp in (1, T * 1000)]
    log = opened(
        *numbered(3), spoilt(numbered(1)[0]), bytes(unknown), *impossible, *numbered(3, 3), b"seventeen bytes ."
    )
    assert len(log.imus[0].angular_rate) == 6
    counts = {note.id: int(note.split()[0]) for note in log.notes if note[0].isdigit()}
    assert counts == {"checksum_failed": 1, "unknown_message": 1, "no_frame": 17, "impossible_time": 2}


def test_a_log_without_faults_has_no_notes_of_any(opened):
    notes = opened(*numbered(3)).notes
    assert not {"checksum_failed", "unknown_message", "no_frame", "impossible_time"} & set(ids(notes))


def test_cut_at_any_byte_the_whole_frames_are_read(fresh):
    records, path = numbered(4), fresh("log.tlog")
    data = b"".join(records)
    for size in range(len(records[0]), len(data) + 1):
        path.write_bytes(data[:size])
        (imu,) = read(path).imus
        whole = size // len(records[0])
        assert imu.angular_rate.value[:, 0] * 1000 == pytest.approx(np.arange(whole) + 1)


def test_packed_with_gzip_it_is_the_same(opened, fresh):
    records, path = [*numbered(50), *fixes(20)], fresh("log.tlog.gz")
    path.write_bytes(gzip.compress(b"".join(records)))
    packed, plain = read(path), opened(*records)
    assert packed.provenance.format == plain.provenance.format == "tlog"
    assert packed.imus[0].angular_rate.time.tolist() == plain.imus[0].angular_rate.time.tolist()
    assert packed.gnss[0].position.tolist() == plain.gnss[0].position.tolist()


def test_a_gzip_file_that_is_cut_is_read_as_far_as_it_unpacks(fresh):
    noise = np.random.default_rng(1).bytes(200_000)
    packed, path = gzip.compress(b"".join(numbered(2000)) + noise), fresh("log.tlog.gz")
    path.write_bytes(packed[:-100_000])
    log = read(path)
    assert len(log.imus[0].angular_rate) == 2000
    assert "packed_cut" in ids(log.notes)


def told(log):
    """Return all that a log holds, to be compared."""
    triads = [part for imu in log.imus for part in (imu.angular_rate, imu.specific_force)]
    others = [*log.gnss, *log.references]
    arrays = [*(t.value for t in triads), *(o.position for o in others), *(s.time for s in (*triads, *others))]
    return [array.tobytes() for array in arrays], [s.origin for s in (*log.imus, *others)], log.notes


@pytest.mark.parametrize("block", [1, 100, 1000])
def test_small_blocks_give_what_one_does(opened, monkeypatch, block):
    rows = [*numbered(30), *fixes(20), b"garbage", spoilt(numbered(1)[0]), *(solution(i) for i in range(20))]
    rows += [*(at(i, "ATTITUDE", yaw=0.1 * i) for i in range(20)), *numbered(20, 30, version=1), *numbered(5, system=2)]
    rows += [at(i, "SCALED_IMU2", time_boot_ms=1000 + 100 * (i % 60)) for i in range(0, 180, 7)]  # with two reboots
    whole = opened(*rows)
    monkeypatch.setattr(source, "BLOCK", block)
    monkeypatch.setattr(source, "PIECE", min(block, 64))
    assert told(opened(*rows)) == told(whole)


def test_a_real_log_in_small_blocks_is_the_same(shared, monkeypatch):
    path = shared / "tlog" / "ardusub_pymavlink_bug_2023-04-18.tlog"
    whole = read(path)
    monkeypatch.setattr(source, "BLOCK", 5000)
    monkeypatch.setattr(source, "PIECE", 5000)
    assert told(read(path)) == told(whole)


def test_the_values_of_a_real_log_are_pymavlinks(shared):
    path = shared / "tlog" / "ardusub_small.tlog"
    messages = {}
    for _, message in heard(path):
        messages.setdefault(message.get_type(), []).append(message)
    log = read(path)
    for imu in log.imus:
        counts = np.array([[m.xgyro, m.ygyro, m.zgyro, m.xacc, m.yacc, m.zacc] for m in messages[imu.name]])
        np.testing.assert_allclose(imu.angular_rate.value, counts[:, :3] * 1e-3, rtol=1e-14)
        np.testing.assert_allclose(imu.specific_force.value, counts[:, 3:] * 9.80665e-3, rtol=1e-14)
    (reference,) = log.references
    degrees = [[m.lat * 1e-7, m.lon * 1e-7] for m in messages["GLOBAL_POSITION_INT"]]
    np.testing.assert_allclose(np.degrees(reference.position[:, :2]), degrees, rtol=1e-14)


def test_the_frozen_receiver_of_a_real_log_is_noted(shared):
    log = read(shared / "tlog" / "ardusub_pymavlink_bug_2023-04-18.tlog")
    assert log.gnss == ()
    assert any(note.id == "fix_time_frozen" and note.startswith("GPS_RAW_INT: ") for note in log.notes)
    assert any(note.id == "checksum_failed" and note.startswith("1967 ") for note in log.notes)


# What is a telemetry log


@pytest.mark.parametrize("first", [b"", b"\0garbage", bytes(100), spoilt(numbered(1)[0])])
def test_it_is_known_by_a_frame_within_its_first_records(opened, first):
    assert opened(first, *numbered(5)).provenance.format == "tlog"


def test_it_is_known_also_by_a_frame_behind_some_that_are_damaged(opened):
    damaged = [spoilt(at(i, "HIL_SENSOR", id=1)) for i in range(10)]
    assert opened(*damaged, *numbered(50)).provenance.format == "tlog"


@pytest.mark.parametrize("head", [b"", b"\0" * 20, b"\0" * 400, b"\xfd" * 400, b"time,gx\n" * 50, numbered(1)[0][:30]])
def test_other_bytes_are_none(head):
    assert not tlog.probe(head)


@pytest.mark.parametrize("stamp", [0, 946_684_799_000_000, 4_102_444_800_000_001])
def test_a_recorder_before_2000_or_behind_2100_is_none(stamp):
    assert not tlog.probe(record(stamp, frame("HEARTBEAT", mavlink_version=3)))


def test_a_file_whose_frames_all_fail_is_refused_with_a_reason(fresh):
    path = fresh("log.tlog")
    path.write_bytes(b"".join(spoilt(one) for one in numbered(10)))
    with pytest.raises(UnreadableLogError, match="no MAVLink frame"):
        list(tlog.stream(path, ReadOptions()))


def test_flipped_bits_give_a_result_or_an_error_of_ours(fresh):
    chance, path = np.random.default_rng(1), fresh("log.tlog")
    rows = [*numbered(6), system_time(T), *fixes(5), *(solution(i) + at(i, "ATTITUDE") for i in range(5))]
    rows += [*numbered(4, version=1), *numbered(4, signed=True), *(at(i, "HIGHRES_IMU", id=i) for i in range(4))]
    sound, count = b"".join(rows), 0
    for _ in range(60):
        damaged = bytearray(sound)
        for _ in range(chance.integers(1, 13)):
            damaged[chance.integers(len(sound))] ^= 1 << int(chance.integers(8))
        path.write_bytes(damaged)
        try:
            log = read(path)
        except UnreadableLogError:
            continue
        count += 1
        assert sum(len(imu.angular_rate) for imu in log.imus) <= 18
    assert count > 50


def test_values_at_their_limits_give_a_result(opened):
    extreme = partial(dict.fromkeys, ("lat", "lon", "alt", "alt_ellipsoid"))
    rows = [at(i, "GPS_RAW_INT", clock=False, **extreme(limit)) for i, limit in enumerate([-(2**31), 2**31 - 1])]
    rows += [
        at(i, "HIGHRES_IMU", clock=False, time_usec=2**64 - 1 - i, xgyro=math.inf, zacc=math.nan) for i in range(3)
    ]
    rows += [at(i, "SCALED_IMU", time_boot_ms=2**32 - 1 - i, xacc=-(2**15)) for i in range(3)]
    log = opened(*rows)
    assert log.gnss == ()
    assert [imu.name for imu in log.imus] == ["SCALED_IMU"]


def test_a_file_cut_behind_its_first_frames_is_refused(fresh):
    path = fresh("log.tlog")
    path.write_bytes(heartbeat(T) + heartbeat(T + 1) + numbered(1)[0][:20])
    with pytest.raises(UnreadableLogError, match="cut.* 2 MAVLink frames"):
        read(path)
