"""u-blox fixes in SI and UTC, the messages joined by epoch, and what is not used."""

from datetime import timedelta

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import read, reader_of
from imuwb.readers.receivers.ubx_frames import scan
from tests.readers.receivers import ubx_writer as ubx
from tests.readers.repairs import repairs
from tests.recordings import recording


def test_a_fix_in_si_and_utc(log_of):
    log = log_of(*(ubx.pvt(ubx.utc(i), nano=123_456) for i in range(4)))
    (gnss,) = log.gnss
    assert log.provenance.format == "ubx"
    assert gnss.time.tolist() == [ubx.ns(ubx.utc(i)) + 123_456 for i in range(4)]
    np.testing.assert_allclose(gnss.position[0], [np.radians(47.397742), np.radians(8.545594), 488], rtol=1e-15)
    np.testing.assert_allclose(gnss.velocity, [[1, -2, 0.03]] * 4, rtol=1e-15)
    np.testing.assert_allclose(gnss.position_sigma, [[0.014, 0.014, 0.025]] * 4, rtol=1e-15)
    np.testing.assert_allclose(gnss.velocity_sigma, [[0.06] * 3] * 4, rtol=1e-15)
    assert gnss.fix_type.tolist() == [3] * 4
    assert (gnss.origin.epoch, gnss.origin.frame) == ("unix", "NED")


def test_the_week_ends_within_the_log(log_of):
    times = [ubx.utc(i) for i in range(-80, 4)]
    assert ubx.tow(times[0]) > ubx.tow(times[-1])
    (gnss,) = log_of(*(ubx.pvt(t) + ubx.fine(t) for t in times)).gnss
    assert gnss.time.tolist() == [ubx.ns(t) for t in times]


@pytest.mark.parametrize(
    ("fix", "flags", "expected"),
    [(0, 1, 1), (1, 1, 1), (2, 1, 2), (3, 1, 3), (3, 3, 4), (3, 0x43, 5), (3, 0x83, 6), (4, 1, 3), (4, 0x81, 6), (5, 1, 1), (3, 0, 1),
     (3, 0x82, 1), (9, 1, 1)],
)  # fmt: skip
def test_fix_types(log_of, fix, flags, expected):
    log = log_of(*(ubx.pvt(ubx.utc(i), fix=fix, flags=flags) for i in range(2)))
    assert [gnss.fix_type.tolist() for gnss in log.gnss] == ([[expected] * 2] if expected > 1 else [])
    assert ("no_fix" in ids(log.notes)) == (expected == 1)
    assert ("dead_reckoning" in ids(log.notes), "sensor_fusion" in ids(log.notes)) == (fix == 1, fix == 4)


def test_high_precision_and_covariances_join_their_epoch(log_of):
    when = [ubx.utc(i) for i in range(4)]
    parts = [ubx.pvt(t, nano=777) for t in when]
    parts[1] += ubx.fine(when[1])
    parts[2] += ubx.fine(when[2], flags=1) + ubx.covariance(when[2], valid=(1, 0))
    parts[3] = ubx.covariance(when[3]) + ubx.fine(when[3]) + parts[3]
    (gnss,) = log_of(*parts).gnss
    assert gnss.time.tolist() == [ubx.ns(t) + 777 for t in when]
    degrees = np.degrees(gnss.position[:, :2])
    assert degrees[0] == pytest.approx([47.3977420, 8.5455940], abs=1e-13)
    assert degrees[1] == pytest.approx([47.397742012, 8.545593966], abs=1e-13)
    assert gnss.position[:, 2] == pytest.approx([488, 488.0005, 488, 488.0005], abs=1e-10)
    assert gnss.position_sigma[1] == pytest.approx([0.0123, 0.0123, 0.0456], abs=1e-15)
    assert gnss.position_sigma[2] == pytest.approx([2, 3, 4], abs=1e-6)
    assert gnss.position_sigma[3] == pytest.approx([2, 3, 4], abs=1e-6)
    assert gnss.velocity_sigma[2] == pytest.approx([0.06] * 3)
    assert gnss.velocity_sigma[3] == pytest.approx([0.1, 0.2, 0.3], abs=1e-6)


def test_old_receivers_state_a_fix_in_several_messages(log_of):
    when = [ubx.utc(i) for i in range(3)]
    log = log_of(*(ubx.posllh(t) + ubx.status(t, 3, 3) + ubx.velned(t) + ubx.time_gps(t, rest=-250) for t in when))
    (gnss,) = log.gnss
    assert gnss.time.tolist() == [ubx.ns(t) - 250 for t in when]
    np.testing.assert_allclose(gnss.velocity, [[1, -2, 0.03]] * 3, rtol=1e-15)
    np.testing.assert_allclose(gnss.velocity_sigma, [[0.07] * 3] * 3, rtol=1e-15)
    assert gnss.fix_type.tolist() == [4] * 3


def test_the_oldest_receivers_state_week_and_fix_in_one(log_of):
    when = [ubx.utc(i) for i in range(-66, -60)]
    log = log_of(*(ubx.solution(t, 3, 0x0D + 2 * (i > 2), rest=40) + ubx.posllh(t) for i, t in enumerate(when)))
    (gnss,) = log.gnss
    assert gnss.time.tolist() == [ubx.ns(t) + 40 for t in when]
    assert gnss.fix_type.tolist() == [3, 3, 3, 4, 4, 4]


def test_messages_about_the_receiver_alone_are_named(log_of):
    log = log_of(*(ubx.frame(0x0A04, bytes(40)) for _ in range(3)))
    assert log.provenance.format == "ubx"
    assert any(note.id == "unused" and "MON-VER (3)" in note for note in log.notes)


def test_raw_signals_alone_are_named_with_what_to_do(log_of):
    log = log_of(*(ubx.frame(0x0215, bytes(48)) for _ in range(4)))
    assert not log.gnss
    assert any(note.id == "unused" and "RXM-RAWX (4)" in note and "RTKLIB" in note for note in log.notes)


def test_without_a_date_times_count_from_the_week(log_of):
    when = [ubx.utc(i) for i in range(-66, -60)]
    log = log_of(*(ubx.posllh(t) for t in when))
    assert log.gnss[0].origin.epoch == "log"
    assert np.diff(log.gnss[0].time).tolist() == [250_000_000] * 5
    assert "no_date" in ids(log.notes)


def test_utc_before_the_leap_seconds_are_known_is_that_of_later_fixes(log_of):
    when = [ubx.utc(i) for i in range(6)]
    early = ubx.pvt(when[0] + timedelta(seconds=2), valid=3)  # the receiver is wrong by two seconds until it knows
    wrong = early[:6] + ubx.put(4, (0, "I", ubx.tow(when[0]))) + early[10:-2]
    log = log_of(ubx.frame(0x0107, wrong[6:]), *(ubx.pvt(t) for t in when[1:]))
    assert log.gnss[0].time.tolist() == [ubx.ns(t) for t in when]
    log = log_of(*(ubx.pvt(t, valid=3) for t in when))
    assert "utc_unresolved" in ids(log.notes)


def test_invalid_positions_are_counted(log_of):
    parts = [ubx.pvt(ubx.utc(i), flags3=i == 2) for i in range(4)] + [ubx.pvt(ubx.utc(4), place=(0, 0, 0))]
    (gnss,) = log_of(*parts).gnss
    assert len(gnss) == 3
    assert sorted(repairs(gnss).values()) == [1, 1]


def test_what_is_not_used_is_named(log_of):
    parts = [ubx.pvt(ubx.utc(i)) + ubx.frame(0x0135, bytes(20)) + ubx.frame(0x7733, b"") for i in range(3)]
    parts.append(ubx.sentence("GNTXT,01,01,02,ANTSTATUS=OK") + b"rubbish")
    notes = [note for note in log_of(*parts).notes if note.id == "unused"]
    assert any("NAV-SAT (3)" in note and "77-33 (3)" in note for note in notes)
    assert any("TXT (1)" in note for note in notes)
    assert any(note.id == "no_frame" and note.startswith("7 ") for note in log_of(*parts).notes)


def test_sentences_alone_between_frames_are_read(log_of):
    gga = [ubx.sentence(f"GNGGA,12000{i}.00,4723.8645,N,00832.7356,E,4,12,0.7,440.5,M,47.5,M,,") for i in range(4)]
    rmc = ubx.sentence("GNRMC,120000.00,A,4723.8645,N,00832.7356,E,1.0,90.0,070326,,,A")
    log = log_of(ubx.frame(0x0135, bytes(200)), rmc, *(g + ubx.frame(0x0213, bytes(40)) for g in gga))
    assert log.gnss[0].position[0, 2] == 488
    assert len(log.gnss[0]) == 4


def test_few_frames_among_many_sentences_are_used(log_of):
    many = ubx.sentence("GPGSV,3,1,11,03,03,111,00,04,15,270,00,06,01,010,00,13,06,292,00") * 10
    gga = "GNGGA,120000.00,4723.8645,N,00832.7356,E,4,12,0.7,440.5,M,47.5,M,,"
    log = log_of(*(many + ubx.sentence(gga) + ubx.pvt(ubx.utc(i)) for i in range(5)))
    assert log.provenance.format == "ubx"
    assert len(log.gnss[0]) == 5


def test_damage_costs_only_its_frame(log_of):
    frames = [bytearray(ubx.pvt(ubx.utc(i))) for i in range(5)]
    frames[2][40] ^= 1
    log = log_of(*map(bytes, frames))
    assert len(log.gnss[0]) == 4
    assert any(n.id == "checksum_failed" and n.startswith("1 ") for n in log.notes)
    frames[2][4:6] = b"\xff\xff"  # an absurd length
    assert len(log_of(*map(bytes, frames)).gnss[0]) == 4


def test_each_cut_gives_the_frames_before_it(tmp_path):
    data = b"".join(ubx.pvt(ubx.utc(i)) for i in range(4))
    for size in range(90, len(data), 23):
        path = tmp_path / "cut.ubx"
        path.write_bytes(data[:size])
        if size < 100:
            with pytest.raises(UnreadableLogError, match=r"cut\.ubx"):
                read(path)
        else:
            assert len(read(path).gnss[0]) == size // 100


def test_frames_across_blocks(monkeypatch, log_of):
    monkeypatch.setattr("imuwb.readers.bytes.source.BLOCK", 130)
    monkeypatch.setattr("imuwb.readers.bytes.source.PIECE", 70)
    parts = [ubx.pvt(ubx.utc(i)) + ubx.sentence("GNTXT,01,01,02,LONG ENOUGH TO BE CUT") for i in range(40)]
    log = log_of(*parts)
    assert log.gnss[0].time.tolist() == [ubx.ns(ubx.utc(i)) for i in range(40)]
    assert any("TXT (40)" in note for note in log.notes)
    assert "no_frame" not in ids(log.notes)


def test_a_frame_within_a_frame_is_payload():
    inner = ubx.pvt(ubx.utc(0))
    buffer = np.frombuffer(ubx.frame(0x0232, inner) + inner, np.uint8)
    frames = scan(buffer, last=True)
    assert frames.kind.tolist() == [0x0232, 0x0107]
    assert frames.failed == 0


def test_checksums_are_those_of_pyubx2():
    pyubx2 = pytest.importorskip("pyubx2")
    rng = np.random.default_rng(4)
    messages = [
        pyubx2.UBXMessage(b"\x01", b"\x43", 0, payload=rng.bytes(int(n))) for n in (0, 1, 254, 255, 256, 700, 3000)
    ]
    data = b"".join(m.serialize() for m in messages)
    frames = scan(np.frombuffer(data, np.uint8), last=True)
    assert frames.length.tolist() == [0, 1, 254, 255, 256, 700, 3000]


def test_a_real_walk_is_what_pyubx2_decodes():
    pyubx2 = pytest.importorskip("pyubx2")
    path = recording("data", "walk", "gnss_1730.ubx")
    log = read(path)
    (gnss,) = log.gnss
    assert (len(gnss), reader_of(path).format) == (536, "ubx")
    data, kinds, at = path.read_bytes(), [], 0
    while (at := data.find(b"\xb5\x62\x01\x07", at)) >= 0:
        kinds.append(pyubx2.UBXReader.parse(data[at : at + 100]))
        at += 100
    assert len(kinds) == 536
    lat, lon, height, hacc, vel_n, nano, carrier = np.array(
        [(m.lat, m.lon, m.height, m.hAcc, m.velN, m.nano, m.carrSoln) for m in kinds]
    ).T
    np.testing.assert_allclose(np.degrees(gnss.position[:, :2]), np.stack([lat, lon], 1), atol=1e-12)
    np.testing.assert_allclose(gnss.position[:, 2], height / 1000, atol=1e-9)
    np.testing.assert_allclose(gnss.position_sigma[:, 0], hacc / 1000, atol=1e-12)
    np.testing.assert_allclose(gnss.velocity[:, 0], vel_n / 1000, atol=1e-12)
    seconds = np.array([m.second + 60 * m.min + 3600 * m.hour for m in kinds])
    assert (gnss.time % (86_400 * 10**9) == seconds * 10**9 + nano.astype(np.int64)).all()
    assert (gnss.fix_type == carrier + 4).all()
    assert any("GGA (536)" in note and "RMC (536)" in note for note in log.notes)
