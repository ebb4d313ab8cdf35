"""The clock of a log from the time tag that RTKLIB's stream server writes beside it."""

import struct

import numpy as np
import pytest

from imuwb.notes import ids
from imuwb.readers import ReadOptions, read

COLUMNS = ("ax_g", "ay_g", "az_g", "gx_deg_s", "gy_deg_s", "gz_deg_s", "time_ms")
START, LEAP, TRUE_RATE = 1_752_003_261, 18, 1.0002
BOOT = 261_906  #: ms


def written(folder, *, seconds=90, end=b"\n", received_end=b"\n", late=(2, 30), rest=0.25, cut=0):
    """Write a log of 50 Hz, and its tag; a piece of three lines arrives up to 30 ms late."""
    rng = np.random.default_rng(1)
    lines = [b"0.1,0.0,1.0,0.%02d,0.0,0.0,%d" % (i % 90, BOOT + 20 * i) for i in range(seconds * 50)]
    path = folder / "imu.csv"
    path.write_bytes(b"".join(line + end for line in lines)[cut:])
    sizes = np.cumsum([len(line) + len(received_end) for line in lines]) - cut
    tag = b"TIMETAG RTKLIB demo5".ljust(60, b"\0") + struct.pack("<IId", 77, START + LEAP, rest)
    for row in range(2, len(lines), 3):
        tick = round(1000 + 20 * row * TRUE_RATE + rng.uniform(*late))
        tag += struct.pack("<II", tick, sizes[row])
    (folder / "imu.csv.tag").write_bytes(tag)
    return path


def taken(path, **options):
    return read(path, ReadOptions(columns=COLUMNS, **options))


@pytest.mark.parametrize("received_end", [b"\n", b"\r\n"])
def test_a_tag_gives_time_and_rate(tmp_path, received_end):
    """The server may have received line ends that the log no longer has."""
    log = taken(written(tmp_path, received_end=received_end))
    time = log.imus[0].angular_rate.time
    assert log.imus[0].origin.epoch == "unix"
    assert "time_tag" in ids(log.notes)
    true = START + 0.25 + 1.0 + 0.02 * np.arange(time.size) * TRUE_RATE
    assert np.abs(time / 1e9 - true).max() < 0.006


def test_a_short_log_keeps_the_rate_of_its_own_clock(tmp_path):
    time = taken(written(tmp_path, seconds=20)).imus[0].angular_rate.time
    assert np.unique(np.diff(time)).tolist() == [20_000_000]


def test_a_log_that_is_cut_is_not_taken_for_one_with_other_line_ends(tmp_path):
    path = written(tmp_path)
    whole = taken(path).imus[0].angular_rate.time
    path.write_bytes(path.read_bytes()[:-30_000])
    part = taken(path).imus[0].angular_rate.time
    assert np.abs(part - whole[: part.size]).max() < 2_000_000


def test_a_stated_epoch_overrides_the_tag(tmp_path):
    log = taken(written(tmp_path), epoch="boot")
    assert log.imus[0].angular_rate.time[0] == BOOT * 1_000_000
    assert "time_tag" not in ids(log.notes)


@pytest.mark.parametrize("how", ["few", "jumbled", "magic", "short"])
def test_a_tag_that_does_not_fit_is_not_used(tmp_path, how):
    path = written(tmp_path, seconds=20 if how == "few" else 90)
    tag = path.with_name("imu.csv.tag")
    content = tag.read_bytes()
    if how == "few":
        content = content[: 76 + 8 * 5]
    elif how == "jumbled":
        records = np.frombuffer(content[76:], "<u4").reshape(-1, 2).copy()
        records[:, 0] *= 3
        content = content[:76] + records.tobytes()
    elif how == "magic":
        content = b"TAG" + content[3:]
    else:
        content = content[:70]
    tag.write_bytes(content)
    log = taken(path)
    assert log.imus[0].angular_rate.time[0] == BOOT * 1_000_000
    assert log.imus[0].origin.epoch == "log"
    assert ("time_tag_unused" in ids(log.notes)) == (how in ("few", "jumbled"))


@pytest.mark.parametrize(
    ("name", "start"), [("walk/imu_1730.csv", 1756402240.961), ("drive/imu_1934.csv", 1752003261.854)]
)
def test_a_real_tag(shared, name, start):
    """The author of these logs gave their first rows the time at which the server began (GPS time)."""
    time = taken(shared / name).imus[0].angular_rate.time / 1e9
    assert 0 <= time[0] + LEAP - start < 0.15  # the first piece arrives 113 and 131 ms after the start
