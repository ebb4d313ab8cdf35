"""The orientation of an IMU's messages: read where the message has one, FRD relative to NED, and written again."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from imuwb.geodesy import euler_of_quaternion
from imuwb.readers import ReadOptions, describe, read
from imuwb.selection import select
from imuwb.writers import write
from tests.recordings import recording

ROWS = 20
START = 1_700_000_000 * 10**9
STEP = 10**7
ANGLES = np.stack(
    [np.linspace(0, 170, ROWS), np.full(ROWS, 10.0), np.full(ROWS, -20.0)], axis=1
)  #: deg, yaw, pitch, roll
QUATERNIONS = Rotation.from_euler("ZYX", ANGLES, degrees=True).as_quat()
VARIANCE = (0.01, 0, 0, 0, 0.04, 0, 0, 0, 0.09)


def message(ros, row, quaternion, covariance, code=1):
    return ros.encode([
        *([("I", 7)] if code is ros.ROS_1 else []), ("i", 1_700_000_000), ("I", row * STEP), ("str", "imu"),
        ("d", tuple(quaternion)), ("d", tuple(map(float, covariance))), ("d", (0.1, 0.2, 0.3)), ("d", (0.0,) * 9),
        ("d", (0.0, 0.0, 9.8)), ("d", (0.0,) * 9),
    ], code)  # fmt: skip


def recorded(ros, mcap, quaternions=QUATERNIONS, covariances=(VARIANCE,) * ROWS):
    rows = [
        (START + k * STEP, message(ros, k, *row))
        for k, row in enumerate(zip(quaternions, covariances, strict=True))
    ]  # fmt: skip
    return mcap.write(mcap.Topic(rows))


def expected():
    """Return roll, pitch and heading, deg: REP 103 counts pitch and yaw the other way, and yaw from east."""
    return np.stack([ANGLES[:, 2], -ANGLES[:, 1], (90 - ANGLES[:, 0] + 180) % 360 - 180], axis=1)


def test_an_orientation_is_frd_relative_to_ned(ros, mcap):
    path = recorded(ros, mcap)
    (orientation,) = read(path).orientations
    assert orientation.name == "/imu"
    assert np.degrees(euler_of_quaternion(orientation.quaternion)) == pytest.approx(expected(), abs=1e-9)
    assert orientation.sigma[3] == pytest.approx([0.2, 0.1, 0.3])  # north, east, down
    assert orientation.origin.epoch == "unix"
    assert not orientation.origin.repairs
    assert [stream.kind for stream in describe(path).streams] == ["imu"]
    part = select(read(path), start="0.05", end="0.1")
    assert part.orientations[0].time.tolist() == part.imus[0].angular_rate.time.tolist()


def test_ros_1(ros, mcap):
    rows = [(START + k * STEP, message(ros, k, q, VARIANCE, ros.ROS_1)) for k, q in enumerate(QUATERNIONS)]
    topic = mcap.Topic(rows, "/imu", "sensor_msgs/Imu", ros.imu_1, "ros1msg", "ros1")
    (orientation,) = read(mcap.write(topic)).orientations
    assert np.degrees(euler_of_quaternion(orientation.quaternion)) == pytest.approx(expected(), abs=1e-9)


def test_json(mcap):
    def text(k):
        vector, turn = dict.fromkeys("xyz", 1.0), dict(zip("xyzw", QUATERNIONS[k], strict=True))
        return json.dumps({"angular_velocity": vector, "linear_acceleration": vector, "orientation": turn}).encode()

    rows = [(START + k * STEP, text(k)) for k in range(ROWS)]
    log = read(mcap.write(mcap.Topic(rows, "/imu", "Imu", "{}", "jsonschema", "json")))
    (orientation,) = log.orientations
    assert orientation.sigma is None
    assert np.degrees(euler_of_quaternion(orientation.quaternion)) == pytest.approx(expected(), abs=1e-9)
    assert sum(repair.count for repair in log.imus[0].origin.repairs) == ROWS  # no stamp, counted once


def test_axes_that_are_stated_as_frd_are_relative_to_ned(ros, mcap):
    (orientation,) = read(recorded(ros, mcap), ReadOptions(frame="FRD")).orientations
    own = np.stack([ANGLES[:, 2], ANGLES[:, 1], ANGLES[:, 0]], axis=1)
    assert np.degrees(euler_of_quaternion(orientation.quaternion)) == pytest.approx(own, abs=1e-9)


@pytest.mark.parametrize(
    ("quaternion", "first"),
    [(QUATERNIONS[5], -1), ((0, 0, 0, 1.0), 0), ((0, 0, 0, 0.0), 0), ((0.1, 0.2, 0.3, 0.4), 0), ((np.nan,) * 4, 0)],
    ids=["no orientation", "identity", "zero", "short", "nan"],
)
def test_an_orientation_that_is_not_set_is_none(ros, mcap, quaternion, first):
    log = read(recorded(ros, mcap, (quaternion,) * ROWS, ((first, *VARIANCE[1:]),) * ROWS))
    assert not log.orientations
    assert len(log.imus[0].angular_rate) == ROWS
    assert not log.notes


def test_rows_without_an_orientation_are_no_repair_of_the_imu(ros, mcap):
    covariances = [VARIANCE if k % 2 else (-1.0, *VARIANCE[1:]) for k in range(ROWS)]
    log = read(recorded(ros, mcap, covariances=covariances))
    assert len(log.orientations[0]) == ROWS // 2
    assert len(log.imus[0].angular_rate) == ROWS
    assert not log.imus[0].origin.repairs
    assert not log.notes


def test_mcap_keeps_orientations(ros, mcap, tmp_path):
    covariances = [VARIANCE if k % 2 else (-1.0, *VARIANCE[1:]) for k in range(ROWS)]
    log = read(recorded(ros, mcap, covariances=covariances))
    write(log, tmp_path / "again.mcap")
    (one,), (again,) = log.orientations, read(tmp_path / "again.mcap").orientations
    assert again.time.tolist() == one.time.tolist()
    assert np.abs((again.quaternion * one.quaternion).sum(axis=1)) == pytest.approx(1.0)
    assert again.sigma == pytest.approx(one.sigma)


@pytest.mark.parametrize("name", ["robot_localization_test1.bag", "husky_test1_ros2cdr_zstd.mcap"])
def test_the_husky_states_its_orientation(name):
    (orientation,) = read(recording("data", "mcap", name)).orientations
    assert len(orientation) == 11865
    assert np.degrees(orientation.sigma[0]) == pytest.approx([2.005, 2.005, 2.005], abs=0.001)
