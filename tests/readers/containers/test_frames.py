"""Two IMUs on one topic, which only the frame in the header tells apart."""

import numpy as np
import pytest

from imuwb.readers import read
from tests.readers.repairs import repairs

from .bag_writer import Topic, write_bag
from .db3_writer import write_db3

T, STEP, COUNT = 1_714_564_800 * 10**9, 10_000_000, 200
FRAMES = ("left", "right_foot")
RNG = np.random.default_rng(5)
RATES = RNG.normal(0, 0.1, (2, COUNT, 3))


def messages(ros, later, frames=FRAMES, code=1):
    """Return messages of two IMUs in turn, the second later by so many ns."""
    return [
        (
            T + i * STEP + k * later,
            ros.imu(T + i * STEP + k * later, tuple(RATES[k, i]), (0.0, 0.0, 9.8), frames[k], code),
        )
        for i in range(COUNT)
        for k in range(2)
    ]


def written(kind, fresh, mcap, rows, ros):
    if kind == "bag":
        return write_bag(fresh("log.bag"), Topic(rows))
    if kind == "db3":
        return write_db3(fresh("log.db3"), {"/imu": ("sensor_msgs/msg/Imu", rows)})
    topic = (
        mcap.Topic(rows)
        if kind == "mcap"
        else mcap.Topic(rows, "/imu", "sensor_msgs/Imu", ros.imu_1, "ros1msg", "ros1")
    )
    return mcap.write(topic, chunk_size=5000)


@pytest.mark.parametrize("later", [0, 3_000_000, STEP // 2])
@pytest.mark.parametrize("kind", ["bag", "db3", "mcap", "mcap of ROS 1"])
def test_imus_of_one_topic_are_parted_by_their_frames(fresh, mcap, ros, kind, later):
    code = ros.ROS_1 if kind in ("bag", "mcap of ROS 1") else 1
    log = read(written(kind, fresh, mcap, messages(ros, later, code=code), ros))
    assert [imu.name for imu in log.imus] == [f"/imu.{frame}" for frame in FRAMES]
    for k, imu in enumerate(log.imus):
        assert imu.angular_rate.time.tolist() == [T + i * STEP + k * later for i in range(COUNT)]
        np.testing.assert_array_equal(imu.angular_rate.value, RATES[k] * [1, -1, -1])
        assert repairs(imu) == {}


@pytest.mark.parametrize("code", [0, 1])
def test_a_topic_of_one_frame_keeps_its_name(mcap, ros, code):
    (imu,) = read(mcap.write(mcap.Topic(messages(ros, STEP // 2, ("imu", "imu"), code)))).imus
    assert imu.name == "/imu"
    assert imu.angular_rate.time.size == 2 * COUNT
