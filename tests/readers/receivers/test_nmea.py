"""NMEA sentences: positions, heights, dates, velocities and sigmas; what stands between them, and damage."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from imuwb.errors import ImuwbError
from imuwb.notes import ids
from imuwb.readers import read, reader_of
from tests.readers.receivers.ubx_writer import frame, ns, sentence
from tests.readers.repairs import repairs
from tests.recordings import recording

START = datetime(2026, 12, 31, 23, 59, 58, tzinfo=UTC)
KNOT = 1852 / 3600


def at(i, start=START):
    return start + i * timedelta(milliseconds=200)


def clock(when):
    return f"{when:%H%M%S}.{when.microsecond // 10_000:02d}"


def gga(when, talker="GN", place="4723.8645,N,00832.7356,E", quality=4, height="440.5,M,47.5,M"):
    return sentence(f"{talker}GGA,{clock(when)},{place},{quality},12,0.71,{height},1.2,0123")


def rmc(when, talker="GN", speed="10.0", course="90.0", state="A"):
    return sentence(f"{talker}RMC,{clock(when)},{state},4723.8645,N,00832.7356,E,{speed},{course},{when:%d%m%y},,,A")


def gst(when, sigmas="0.011,0.022,0.033"):
    return sentence(f"GNGST,{clock(when)},1.0,0.02,0.01,30.0,{sigmas}")


def vtg(speed="10.0", course="90.0"):
    return sentence(f"GNVTG,{course},T,,M,{speed},N,18.5,K,A")


def test_fixes_over_the_end_of_a_day_and_a_year(log_of):
    log = log_of(*(rmc(at(i)) + gga(at(i)) + gst(at(i)) for i in range(20)))
    (gnss,) = log.gnss
    assert log.provenance.format == "nmea"
    assert gnss.time.tolist() == [ns(at(i)) for i in range(20)]
    assert np.degrees(gnss.position[0, :2]) == pytest.approx([47 + 23.8645 / 60, 8 + 32.7356 / 60], abs=1e-13)
    assert gnss.position[:, 2].tolist() == [488.0] * 20
    np.testing.assert_allclose(gnss.velocity[:, :2], [[0, 10 * KNOT]] * 20, atol=1e-12)
    assert np.isnan(gnss.velocity[:, 2]).all()
    np.testing.assert_allclose(gnss.position_sigma, [[0.011, 0.022, 0.033]] * 20, rtol=1e-15)
    assert gnss.fix_type.tolist() == [6] * 20
    assert gnss.origin.epoch == "unix"
    assert not gnss.origin.above_sea


@pytest.mark.parametrize("order", [0, 1])
def test_a_date_alone_in_zda_and_after_its_fix(log_of, order):
    def zda(when):
        return sentence(f"GPZDA,{clock(when)},{when:%d,%m,%Y},00,00")

    log = log_of(*(b"".join([gga(at(i)), zda(at(i))][:: 1 - 2 * order]) for i in range(20)))
    assert log.gnss[0].time.tolist() == [ns(at(i)) for i in range(20)]


def test_one_date_serves_fixes_of_other_days(log_of):
    log = log_of(rmc(at(0)), *(gga(at(10 * i)) for i in range(20)))
    assert log.gnss[0].time.tolist() == [ns(at(10 * i)) for i in range(20)]


def test_without_a_date_times_count_from_midnight(log_of):
    log = log_of(*(gga(at(i)) for i in range(20)))
    midnight = ns(START.replace(hour=0, minute=0, second=0))
    assert log.gnss[0].time.tolist() == [ns(at(i)) - midnight for i in range(20)]
    assert log.gnss[0].origin.epoch == "log"
    assert not log.gnss[0].origin.repairs
    assert "no_date" in ids(log.notes)


@pytest.mark.parametrize(
    ("quality", "expected"), [(0, 1), (1, 3), (2, 4), (3, 3), (4, 6), (5, 5), (6, 1), (7, 1), (8, 3)]
)
def test_qualities(log_of, quality, expected):
    log = log_of(*(rmc(at(i)) + gga(at(i), quality=quality) for i in range(3)))
    assert [gnss.fix_type.tolist() for gnss in log.gnss] == ([[expected] * 3] if expected > 1 else [])
    assert ("no_fix" in ids(log.notes)) == (expected == 1)


def test_south_and_west(log_of):
    log = log_of(*(rmc(at(i)) + gga(at(i), place="0030.0000,S,17959.9940,W") for i in range(3)))
    assert np.degrees(log.gnss[0].position[0, :2]) == pytest.approx([-0.5, -179.9999], abs=1e-12)


def test_heights_without_a_separation_are_above_the_sea(log_of):
    log = log_of(*(rmc(at(i)) + gga(at(i), height="440.5,M,,M") for i in range(3)))
    assert log.gnss[0].position[:, 2].tolist() == [440.5] * 3
    assert log.gnss[0].origin.above_sea
    log = log_of(*(rmc(at(i)) + gga(at(i), height="440.5,M,,M" if i == 1 else "440.5,M,47.5,M") for i in range(3)))
    assert log.gnss[0].position[:, 2].tolist() == [488] * 3
    assert "separation_interpolated" in ids(log.notes)


def test_gns_and_rmc_are_read_where_there_is_no_gga(log_of):
    def gns(when):
        return sentence(f"GNGNS,{clock(when)},4723.8645,N,00832.7356,E,RNF,12,0.71,440.5,47.5,1.2,0123")

    log = log_of(*(rmc(at(i)) + gns(at(i)) for i in range(3)))
    assert log.gnss[0].fix_type.tolist() == [6] * 3
    assert log.gnss[0].position[:, 2].tolist() == [488] * 3
    log = log_of(*(rmc(at(i), state="AV"[i % 2]) for i in range(3)))
    assert (log.gnss[0].fix_type.tolist(), repairs(log.gnss[0])["no_fix"]) == ([3, 3], 1)
    assert "no_height" in ids(log.notes)


def test_velocity_of_vtg(log_of):
    def zda(when):
        return sentence(f"GPZDA,{clock(when)},{when:%d,%m,%Y},00,00")

    log = log_of(*(gga(at(i)) + zda(at(i)) + vtg(speed=f"{i}.0", course="180.0") for i in range(5)))
    np.testing.assert_allclose(log.gnss[0].velocity[:, :2], [[-i * KNOT, 0] for i in range(5)], atol=1e-12)


def test_a_course_that_is_not_stated(log_of):
    speeds = ["0.0", "0.1", "10.0"]
    log = log_of(*(rmc(at(i), speed=s, course="" if i < 2 else "0.0") + gga(at(i)) for i, s in enumerate(speeds)))
    np.testing.assert_allclose(log.gnss[0].velocity[:, :2], [[0, 0], [np.nan] * 2, [10 * KNOT, 0]], atol=1e-12)


def test_two_talkers_at_the_same_times(log_of):
    parts = [rmc(at(i)) + gga(at(i), "GP", quality=1) + (gga(at(i), "GN") if i != 2 else b"") for i in range(5)]
    log = log_of(*parts)
    assert log.gnss[0].fix_type.tolist() == [6, 6, 3, 6, 6]
    assert any(note.id == "unused" and "GP" in note for note in log.notes)


def test_before_the_first_fix(log_of):
    def zda(when):
        return sentence(f"GPZDA,{clock(when)},{when:%d,%m,%Y},00,00")

    empty = [gga(at(i), place=",,,", quality=0, height=",M,,M") + zda(at(i)) for i in range(3)]
    log = log_of(*empty, *(gga(at(i)) + zda(at(i)) for i in range(3, 6)))
    assert log.gnss[0].time.tolist() == [ns(at(i)) for i in range(3, 6)]
    assert repairs(log.gnss[0])["no_position"] == 3
    log = log_of(*empty)
    assert not log.gnss
    assert "no_position" in ids(log.notes)


@pytest.mark.parametrize(
    "stamp", ["1767225598.123 ", "2026-12-31T23:59:58.123Z,", "[23:59:58.123] ", "1767225598123,COM3,"]
)
def test_stamps_of_a_host(log_of, stamp):
    log = log_of(*(stamp.encode() + part for i in range(20) for part in (rmc(at(i)), gga(at(i)))))
    assert log.gnss[0].time.tolist() == [ns(at(i)) for i in range(20)]
    assert any(n.id == "host_stamp" and n.startswith("40 ") for n in log.notes)
    assert "no_frame" not in ids(log.notes)


def test_binary_between_sentences(log_of):
    rtcm = b"\xd3\x00\x13" + bytes(range(128, 150))
    log = log_of(*(rmc(at(i)) + rtcm + gga(at(i)) for i in range(20)))
    assert len(log.gnss[0]) == 20
    assert any(n.id == "no_frame" and n.startswith("500 ") for n in log.notes)


def test_what_is_not_used_is_named(log_of):
    more = sentence("GPGSV,1,1,00") + sentence("PUBX,00,1") + vtg()
    notes = " ".join(log_of(*(rmc(at(i)) + gga(at(i)) + more for i in range(20))).notes)
    assert all(name in notes for name in ("GSV (20)", "PUBX (20)", "VTG (20)"))


def test_wrong_checksums_and_cut_sentences(log_of):
    parts = [rmc(at(i)) + gga(at(i)) for i in range(5)]
    parts[2] = parts[2].replace(b"440.5", b"441.5")
    log = log_of(*parts, gga(at(5))[:-20])
    assert log.gnss[0].time.tolist() == [ns(at(i)) for i in (0, 1, 3, 4)]
    assert any(n.id == "nmea_checksum_failed" and n.startswith("1 ") for n in log.notes)
    log = log_of(*parts, sentence("GNGGA,120000.00,4723.8645,N"))
    assert any(n.id == "nmea_short" and n.startswith("1 ") for n in log.notes)


def test_sentences_without_checksums(log_of):
    lines = [part.partition(b"*")[0] + b"\r\n" for i in range(20) for part in (rmc(at(i)), gga(at(i)))]
    log = log_of(*lines, gga(at(20))[:50])
    assert log.gnss[0].time.tolist() == [ns(at(i)) for i in range(20)]
    assert "unchecked" in ids(log.notes)


def test_times_that_are_none(log_of):
    odd = [
        sentence(f"GNGGA,{time},4723.8645,N,00832.7356,E,4,12,0.7,440.5,M,47.5,M,,")
        for time in ("", "x1", "246000.00", "-1", "inf")
    ]
    log = log_of(rmc(at(0)), *(gga(at(i)) for i in range(5)), *odd)
    assert len(log.gnss[0]) == 5
    assert repairs(log.gnss[0])["no_time"] == 5


def test_sentences_across_blocks(monkeypatch, log_of):
    monkeypatch.setattr("imuwb.readers.bytes.source.BLOCK", 130)
    monkeypatch.setattr("imuwb.readers.bytes.source.PIECE", 70)
    log = log_of(*(rmc(at(i)) + gga(at(i)) for i in range(40)))
    assert log.gnss[0].time.tolist() == [ns(at(i)) for i in range(40)]
    assert not log.notes


def test_each_cut_is_read_or_refused(tmp_path):
    data = b"".join(rmc(at(i)) + gga(at(i)) for i in range(4))
    path = tmp_path / "cut.nmea"
    for size in range(1, len(data), 41):
        path.write_bytes(data[:size])
        if size < len(rmc(at(0))) - 2:
            with pytest.raises(ImuwbError, match=r"cut\.nmea"):
                read(path)
        else:
            times = read(path).gnss[0].time.tolist()
            assert times == [ns(at(i)) for i in range(len(times))]


def test_a_log_of_frames_with_sentences_is_ubx(tmp_path):
    path = tmp_path / "log"
    path.write_bytes(frame(0x0135, bytes(3000)) + rmc(at(0)) + gga(at(0)))
    assert reader_of(path).format == "ubx"


def test_sentences_without_a_position_are_named(tmp_path):
    path = tmp_path / "log"
    path.write_bytes(sentence("GPGSV,1,1,00") * 3 + sentence("PUBX,00,1"))
    with pytest.raises(ImuwbError, match=r"GSV \(3\), PUBX \(1\)") as raised:
        read(path)
    assert raised.value.exit_code == 4


def test_columns_of_numbers_are_no_sentences(tmp_path):
    path = tmp_path / "log"
    path.write_bytes(gga(at(0)) + b"1,2,3,4,5,6,7\n" * 100)
    assert reader_of(path).format == "csv"


def test_the_sentences_of_a_real_walk_are_what_pynmeagps_decodes(tmp_path):
    pynmeagps = pytest.importorskip("pynmeagps")
    data = recording("data", "walk", "gnss_1730.ubx").read_bytes()
    lines = [part.split(b"\r\n")[0] for part in data.split(b"$")[1:]]
    lines = [b"$" + line + b"\r\n" for line in lines if line.startswith(b"GN") and b"*" in line]
    path = tmp_path / "walk.nmea"
    path.write_bytes(b"".join(lines))
    (gnss,) = read(path).gnss
    said = [m for line in lines if (m := pynmeagps.NMEAReader.parse(line)).msgID == "GGA"]
    assert len(gnss) == len(said) == 536
    np.testing.assert_allclose(np.degrees(gnss.position[:, 0]), [m.lat for m in said], atol=1e-9)
    np.testing.assert_allclose(gnss.position[:, 2], [m.alt + m.sep for m in said], atol=1e-9)
    fixes = read(recording("data", "walk", "gnss_1730.ubx")).gnss[0]
    assert np.abs(gnss.time - fixes.time).max() < 1_000_000
    assert np.abs(gnss.position - fixes.position).max() < 2e-3
    moving = np.isfinite(gnss.velocity[:, 0])  # the receiver states no course below its threshold of speed
    assert moving.sum() > 300
    np.testing.assert_allclose(gnss.velocity[moving, :2], fixes.velocity[moving, :2], atol=0.01)
