"""Poses of odometry: in a frame of their own, with their sigmas; and how one stream of a file is named."""

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.geodesy import euler_of_rotation
from imuwb.readers import describe, read, read_trajectory

TIME = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
HEADER = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
DEFINITION = ("=" * 80 + "\n").join((
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n",
    "MSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n",
    "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n",
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "MSG: geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\nfloat64[36] covariance\n",
    "MSG: geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n", HEADER, TIME,
))  # fmt: skip


@pytest.fixture(scope="module")
def path(ros, mcap):
    def message(k):
        square = np.diag([1.0, 4.0, 9.0, 1, 1, 1]).ravel()
        return ros.encode([
            ("i", 1_700_000_000 + k), ("I", 0), ("str", "odom"), ("str", "base"), ("d", (1.0 * k, 2.0, 3.0)),
            ("d", (0.0, 0.0, 2.0, 2.0)), ("d", tuple(square)), ("d", (5.0, 0, 0)), ("d", (0.0, 0, 0)), ("d", (0.0,) * 36),
        ])  # fmt: skip

    messages = [((1_700_000_000 + k) * 10**9, message(k)) for k in range(5)]
    return mcap.write(mcap.Topic(messages, "/odometry/filtered", "nav_msgs/msg/Odometry", DEFINITION))


def test_odometry_is_a_track_in_its_own_frame(path):
    (track,) = read(path).poses
    assert track.name == "/odometry/filtered"
    assert track.position[3].tolist() == [3.0, 2.0, 3.0]
    assert np.degrees(euler_of_rotation(track.rotation[0])) == pytest.approx([0, 0, 90])
    assert track.position_sigma[0].tolist() == [1.0, 2.0, 3.0]
    assert read(path).speeds[0].value[0] == 5.0


def test_a_summary_has_the_speed_and_the_poses(path):
    assert sorted(stream.kind for stream in describe(path).streams) == ["pose", "speed"]


def test_one_stream_of_a_file_by_its_name(path):
    assert len(read_trajectory(f"{path}#/odometry/filtered").poses) == 1
    with pytest.raises(UsageError, match="no trajectory 'gps'; the file has /odometry/filtered"):
        read_trajectory(f"{path}#gps")


def test_the_husky_has_odometries(shared):
    log = read_trajectory(shared / "mcap" / "robot_localization_test1.bag")
    assert log.poses
    assert all(np.isfinite(pose.position).all() for pose in log.poses)
