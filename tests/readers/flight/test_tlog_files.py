"""Telemetry logs as files: recognised, cut, packed, damaged, compared with pymavlink."""

import gzip
import math
from functools import partial

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from imuwb.readers.bytes import source
from imuwb.readers.flight import tlog
from tests.readers.flight.mavlink_writer import (
    T,
    at,
    content,
    fixes,
    frame,
    heard,
    heartbeat,
    numbered,
    record,
    solution,
    spoilt,
    system_time,
)


def test_what_is_no_measurement_makes_an_empty_log(tlog_of):
    log = tlog_of(*(heartbeat(T + i) for i in range(5)))
    assert (log.imus, log.gnss, log.references) == ((), (), ())


def test_what_was_wrong_with_frames_is_counted(tlog_of):
    unknown = bytearray(numbered(1)[0])
    unknown[15:18] = b"\xff\xff\xff"
    impossible = [record(stamp, frame("SCALED_IMU", xgyro=1)) for stamp in (1, T * 1000)]
    log = tlog_of(
        *numbered(3), spoilt(numbered(1)[0]), bytes(unknown), *impossible, *numbered(3, 3), b"seventeen bytes ."
    )
    assert len(log.imus[0].angular_rate) == 6
    counts = {note.id: int(note.split()[0]) for note in log.notes if note[0].isdigit()}
    assert counts == {"checksum_failed": 1, "unknown_message": 1, "no_frame": 17, "impossible_time": 2}


def test_a_log_without_faults_has_no_notes_of_any(tlog_of):
    notes = tlog_of(*numbered(3)).notes
    assert not {"checksum_failed", "unknown_message", "no_frame", "impossible_time"} & set(ids(notes))


@pytest.mark.slow
def test_cut_at_any_byte_the_whole_frames_are_read(fresh):
    records, path = numbered(4), fresh("log.tlog")
    data = b"".join(records)
    for size in range(len(records[0]), len(data) + 1):
        path.write_bytes(data[:size])
        (imu,) = read(path).imus
        whole = size // len(records[0])
        assert imu.angular_rate.value[:, 0] * 1000 == pytest.approx(np.arange(whole) + 1)


def test_packed_with_gzip_it_is_the_same(tlog_of, fresh):
    records, path = [*numbered(50), *fixes(20)], fresh("log.tlog.gz")
    path.write_bytes(gzip.compress(b"".join(records)))
    packed, plain = read(path), tlog_of(*records)
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


@pytest.mark.slow
@pytest.mark.parametrize("block", [1, 100, 1000])
def test_small_blocks_give_what_one_does(tlog_of, monkeypatch, block):
    rows = [*numbered(30), *fixes(20), b"garbage", spoilt(numbered(1)[0]), *(solution(i) for i in range(20))]
    rows += [*(at(i, "ATTITUDE", yaw=0.1 * i) for i in range(20)), *numbered(20, 30, version=1), *numbered(5, system=2)]
    rows += [at(i, "SCALED_IMU2", time_boot_ms=1000 + 100 * (i % 60)) for i in range(0, 180, 7)]  # with two reboots
    whole = tlog_of(*rows)
    monkeypatch.setattr(source, "BLOCK", block)
    monkeypatch.setattr(source, "PIECE", min(block, 64))
    assert content(tlog_of(*rows)) == content(whole)


def test_a_real_log_in_small_blocks_is_the_same(shared, monkeypatch):
    path = shared / "tlog" / "ardusub_pymavlink_bug_2023-04-18.tlog"
    whole = read(path)
    monkeypatch.setattr(source, "BLOCK", 5000)
    monkeypatch.setattr(source, "PIECE", 5000)
    assert content(read(path)) == content(whole)


@pytest.mark.slow
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


@pytest.mark.parametrize("first", [b"", b"\0garbage", bytes(100), spoilt(numbered(1)[0])])
def test_it_is_known_by_a_frame_within_its_first_records(tlog_of, first):
    assert tlog_of(first, *numbered(5)).provenance.format == "tlog"


def test_it_is_known_also_by_a_frame_behind_some_that_are_damaged(tlog_of):
    damaged = [spoilt(at(i, "HIL_SENSOR", id=1)) for i in range(10)]
    assert tlog_of(*damaged, *numbered(50)).provenance.format == "tlog"


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


def test_values_at_their_limits_give_a_result(tlog_of):
    extreme = partial(dict.fromkeys, ("lat", "lon", "alt", "alt_ellipsoid"))
    rows = [at(i, "GPS_RAW_INT", clock=False, **extreme(limit)) for i, limit in enumerate([-(2**31), 2**31 - 1])]
    rows += [
        at(i, "HIGHRES_IMU", clock=False, time_usec=2**64 - 1 - i, xgyro=math.inf, zacc=math.nan) for i in range(3)
    ]
    rows += [at(i, "SCALED_IMU", time_boot_ms=2**32 - 1 - i, xacc=-(2**15)) for i in range(3)]
    log = tlog_of(*rows)
    assert log.gnss == ()
    assert [imu.name for imu in log.imus] == ["SCALED_IMU"]


def test_a_file_cut_behind_its_first_frames_is_refused(fresh):
    path = fresh("log.tlog")
    path.write_bytes(heartbeat(T) + heartbeat(T + 1) + numbered(1)[0][:20])
    with pytest.raises(UnreadableLogError, match="cut.* 2 MAVLink frames"):
        read(path)
