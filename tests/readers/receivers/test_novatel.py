"""NovAtel's binary logs through novatel-edie, and the sentence where it is not installed."""

import sys
from itertools import count

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import read
from imuwb.readers.gps_time import unix_of_gps
from imuwb.readers.receivers import novatel, novatel_messages
from tests.readers.receivers import novatel_writer as nv

START, N = 491_674.0, 250
GYRO, ACCEL = (100_000, -200_000, 300_000), (6_000_000, 7_000_000, 329_000_000)  #: counts; x right, y forward, z up
STEP = np.radians(0.008 / 65_536), 0.2e-3 / 65_536 * 9.80665  #: of type 41 (Epson G320): rad/s, m/s²
RATE = np.array([GYRO[1], GYRO[0], -GYRO[2]]) * STEP[0]
FORCE = np.array([ACCEL[1], ACCEL[0], -ACCEL[2]]) * STEP[1]


def at(i):
    return START + i / 125


def unix(seconds):
    return int(unix_of_gps(np.array([nv.WEEK]), np.array([0]))[0]) + round(seconds * 1e6) * 1000


@pytest.fixture
def needs_edie():
    pytest.importorskip("novatel_edie", reason="the extra imuwb[novatel] is not installed")


def drive():
    parts = []
    for i in range(N):
        parts.append(nv.rawimusx(at(i), GYRO, ACCEL))
        if i % 25 == 0:
            parts.append(nv.bestpos(at(i), (47.5, 8.5, 440.5), 47.5, (1.0, 2.0, 3.0)))
            parts.append(nv.inspvas(at(i), (47.5, 8.5, 488.0), (3.0, -4.0, 0.5), (1.0, 2.0, 90.0)))
            parts.append(nv.short(nv.CORRIMUDATAS, at(i), bytes(60)))
    return parts


def test_counts_of_an_imu_fixes_and_a_solution(needs_edie, log_of):
    log = log_of(*drive())
    (imu,) = log.imus
    assert log.provenance.format == "novatel"
    np.testing.assert_allclose(imu.angular_rate.value, [RATE] * N, rtol=1e-12)
    np.testing.assert_allclose(imu.specific_force.value, [FORCE] * N, rtol=1e-12)
    assert imu.angular_rate.time.tolist() == [unix(at(i)) for i in range(N)]
    np.testing.assert_allclose(log.gnss[0].position, [[np.radians(47.5), np.radians(8.5), 488]] * 10, rtol=1e-12)
    np.testing.assert_allclose(log.gnss[0].position_sigma, [[1, 2, 3]] * 10)
    np.testing.assert_allclose(log.references[0].velocity, [[3, -4, -0.5]] * 10)
    np.testing.assert_allclose(log.references[0].attitude, [np.radians([1, 2, 90])] * 10, atol=1e-12)
    assert any(note.id == "unused" and "CORRIMUDATAS" in note for note in log.notes)


def test_damage_costs_only_its_message(needs_edie, log_of):
    parts = drive()
    parts[100] = parts[100][:20] + b"\xff" + parts[100][21:]
    log = log_of(b"\r\n[COM1]<OK", *parts, b"\xaa\x44\x12rest")
    assert sum(map(len, (log.imus[0].angular_rate, log.gnss[0], log.references[0]))) >= N + 19
    assert "no_frame" in ids(log.notes)


def test_a_message_for_which_the_library_has_no_room_is_left_out_and_counted(needs_edie, log_of, monkeypatch):
    """A message with a right checksum may state an array that is larger than any memory."""
    own, calls = novatel_messages._line, count()  # noqa: SLF001 - the step in which the library makes room

    def line(message):
        if next(calls) == 3:
            raise MemoryError("std::bad_alloc")
        return own(message)

    monkeypatch.setattr(novatel_messages, "_line", line)
    log = log_of(*drive())
    assert "absurd_message" in ids(log.notes)
    assert len(log.imus) == 1


def test_each_cut_is_read_or_refused(needs_edie, tmp_path):
    data, path = b"".join(nv.rawimusx(at(i), GYRO, ACCEL) for i in range(5)), tmp_path / "cut.gps"
    size = len(nv.rawimusx(at(0), GYRO, ACCEL))
    for length in range(size, len(data), 13):
        path.write_bytes(data[:length])
        assert len(read(path).imus[0].angular_rate) == length // size


def test_absurd_lengths_are_no_message():
    assert not novatel.probe(b"")
    assert not novatel.probe(b"\xaa\x44\x12")
    assert not novatel.probe(b"\xaa\x44\x12" + b"\xff" * 100)
    assert not novatel.probe(nv.rawimusx(at(0), GYRO, ACCEL)[:-1])
    assert novatel.probe(b"[COM1]<OK\r\n" + nv.rawimusx(at(0), GYRO, ACCEL))


def test_what_to_install(log_of, monkeypatch):
    monkeypatch.setitem(sys.modules, "novatel_edie", None)
    with pytest.raises(UnreadableLogError, match=r"imuwb\[novatel\]"):
        log_of(*drive())
