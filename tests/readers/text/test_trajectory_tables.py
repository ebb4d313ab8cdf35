"""Trajectories without a header line: TUM, KITTI and KF-GINS; and what is no such table."""

from datetime import UTC, datetime

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.geodesy import euler_of_rotation
from imuwb.geodesy.local_track import LocalTrack
from imuwb.log import SECOND, Log, Reference
from imuwb.readers import read_trajectory

NOON = datetime(2026, 3, 4, 12, tzinfo=UTC)
TURN = "0.70710678 0 0 0.70710678"  # a quarter turn about x, the scalar last


def test_tum(text_log):
    track = read_trajectory(text_log(f"# t x y z q\n1700000001.5 1 2 3 {TURN}\n1700000000.25 0 0 0 0 0 0 1\n", "a.tum"))
    assert isinstance(track, LocalTrack)
    assert track.time.tolist() == [1_700_000_000_250_000_000, 1_700_000_001_500_000_000]
    assert track.position.tolist() == [[0, 0, 0], [1, 2, 3]]
    assert np.degrees(euler_of_rotation(track.rotation[1])) == pytest.approx([90, 0, 0], abs=1e-5)


def test_tum_with_commas(text_log):
    track = read_trajectory(text_log("0,1,2,3,0,0,0,1\n1,2,3,4,0,0,0,1\n", "a.txt"))
    assert track.position[1].tolist() == [2, 3, 4]


POSES = "1 0 0 0 0 1 0 0 0 0 1 0\n0 -1 0 5 1 0 0 6 0 0 1 7\n"


def test_poses_of_kitti_with_their_times(text_log):
    poses = text_log(POSES, "00.txt")
    times = text_log("10.5\n11.5\n", "t.txt")
    track = read_trajectory(poses, times)
    assert track.time.tolist() == [10_500_000_000, 11_500_000_000]
    assert track.position[1].tolist() == [5, 6, 7]
    assert np.degrees(euler_of_rotation(track.rotation[1])) == pytest.approx([0, 0, 90])
    with pytest.raises(UsageError, match=r"--truth-times"):
        read_trajectory(poses)
    poses.with_name("times.txt").write_text("0\n1\n", "utf-8")
    assert read_trajectory(poses).time[1] == SECOND
    with pytest.raises(UsageError, match=r"need 2 rows"):
        read_trajectory(poses, text_log("0\n1\n2\n", "t.txt"))


NAV = "{} 302400.5 30 114 20 1 2 3 1 -2 270\n{} 302401.5 30.00001 114 20 1 2 3 1 -2 270\n"


def test_kf_gins_with_its_week_and_its_sigmas(text_log):
    week = (NOON - datetime(1980, 1, 6, tzinfo=UTC)).days // 7
    path = text_log(NAV.format(week, week), "KF_GINS_Navresult.nav")
    assert read_trajectory(path).position_sigma is None
    path.with_name("KF_GINS_STD.txt").write_text("302400 1 2 3 .1 .2 .3 1 2 3\n302402 3 2 3 .1 .2 .3 1 2 3\n", "utf-8")
    track = read_trajectory(path)
    assert isinstance(track, Reference)
    assert track.time[0] == (int(NOON.timestamp()) - 18) * SECOND + SECOND // 2
    assert np.degrees(track.position[0, :2]) == pytest.approx([30, 114])
    assert track.velocity[0].tolist() == [1, 2, 3]
    assert np.degrees(track.attitude[0]) == pytest.approx([1, -2, 270])
    assert track.position_sigma[0] == pytest.approx([1.5, 2, 3])
    assert np.degrees(track.attitude_sigma[0]) == pytest.approx([1, 2, 3])


def test_kf_gins_takes_the_week_of_the_drive(text_log):
    path = text_log(NAV.format(0, 0), "a.nav")
    assert read_trajectory(path).time[0] == 302_400 * SECOND + SECOND // 2
    near = int(NOON.timestamp()) * SECOND
    assert read_trajectory(path, near=near).time[0] == near - 18 * SECOND + SECOND // 2


def test_a_log_is_read_as_a_log(text_log):
    log = read_trajectory(text_log("time_s,latitude_deg,longitude_deg,height_m\n0,45,7,1\n1,45,7,1\n"))
    assert isinstance(log, Log)
    assert len(log.gnss) == 1
    weeks = "% GPST latitude(deg) longitude(deg) height(m) Q\n2300 1.0 45 7 1 1\n2300 2.0 45 7 1 1\n"
    assert read_trajectory(text_log(weeks, "a.pos")).gnss[0].fix_type.tolist() == [6, 6]


@pytest.mark.parametrize(
    ("text", "error", "words"),
    [
        ("1 2 3\n4 5 6\n", UsageError, "3 numbers and no header line"),
        ("0 1 2 3 1 1 1 1\n1 1 2 3 1 1 1 1\n", UnreadableLogError, "no quaternion"),
        ("0 0 0 0 0 0 0 1\n1 0 0 x 0 0 0 1\n", UnreadableLogError, "not like the others"),
        ("0 0 0 0 0 0 0 1\n1 0 0\n", UnreadableLogError, "not like the others"),
        ("0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n", UnreadableLogError, "the same time"),
        ("nan 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n", UnreadableLogError, "1 rows of finite"),
        ("1e12 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", UnreadableLogError, "no time in seconds"),
        ("0 302400 130 114 20 1 2 3 1 2 3\n0 302401 130 114 20 1 2 3 1 2 3\n", UnreadableLogError, "KF-GINS"),
        ("", UnreadableLogError, "empty"),
    ],
)
def test_what_is_no_trajectory(text_log, text, error, words):
    with pytest.raises(error, match=words):
        read_trajectory(text_log(text, "a.txt"))


def test_only_poses_need_times(text_log):
    with pytest.raises(UsageError, match="leave it out"):
        read_trajectory(text_log("0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "a.tum"), text_log("0\n1\n", "t.txt"))


def test_no_rotation_is_no_pose(text_log):
    path = text_log("1 1 1 0 0 1 0 0 0 0 1 0\n" * 2, "a.txt")
    with pytest.raises(UnreadableLogError, match="no rotation"):
        read_trajectory(path, text_log("0\n1\n", "t.txt"))
