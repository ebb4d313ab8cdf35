"""When a topic is recognised, from when its times count, and what a fix states."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.readers import ReadOptions
from imuwb.readers.containers.messages import Channel, Messages, Schema
from imuwb.readers.containers.ros_layout import UnknownLayoutError, plan
from imuwb.readers.containers.topics import Topics

IMU = {
    "angular_velocity": {"x": 0.1, "y": 0.2, "z": 0.3},
    "linear_acceleration": {"x": 0.0, "y": 0.0, "z": 9.8},
}
FIX = {"latitude": 45.0, "longitude": 9.0, "altitude": 100.0}


def messages(payloads, time=0):
    """Return payloads as messages of one channel, a nanosecond apart."""
    packed = [payload if isinstance(payload, bytes) else json.dumps(payload).encode() for payload in payloads]
    length = np.array([len(payload) for payload in packed])
    stamps = time + np.arange(len(packed))
    numbers = np.ones(len(packed), np.uint16)
    return Messages(
        np.frombuffer(b"".join(packed), np.uint8), numbers, stamps, stamps, np.cumsum(length) - length, length, 0
    )


def topics(**options):
    container = SimpleNamespace(channels={1: Channel("/topic", "json", 0)}, schemas={}, above_sea=set())
    return Topics(container, ReadOptions(**options))


@pytest.mark.parametrize(("before", "recognised"), [(99, True), (100, False)])
def test_a_topic_without_a_known_field_is_given_up_after_a_hundred_messages(before, recognised):
    found = topics()
    assert list(found.batches(messages([{"other": 1}] * before))) == []
    assert [batch.kind for batch in found.batches(messages([IMU]))] == ["imu"] * recognised


@pytest.mark.parametrize(("damaged", "recognised"), [(15, True), (16, False)])
def test_sixteen_messages_are_tried_for_their_fields(damaged, recognised):
    batches = list(topics().batches(messages([b"\xff"] * damaged + [IMU] * 3)))
    assert [batch.time.size for batch in batches] == [3] * recognised


@pytest.mark.parametrize(("time", "epoch"), [(10**17, "log"), (10**17 + 1, "unix")])
def test_times_count_from_1970_after_march_1973(time, epoch):
    (batch,) = topics(time_source="log").batches(messages([IMU], time))
    assert batch.origin.epoch == epoch


@pytest.mark.parametrize(("status", "fix_type"), [(-2, None), (-1, [1]), (0, [3]), (1, [4]), (2, [4])])
def test_the_status_of_a_fix_is_a_fix_type_if_it_is_known(status, fix_type):
    (batch,) = topics().batches(messages([{**FIX, "status": {"status": status}}]))
    found = batch.columns.get("fix_type")
    assert (None if found is None else found.tolist()) == fix_type


def test_sigmas_of_a_fix_are_north_east_down():
    covariance = [1.0, 0, 0, 0, 4.0, 0, 0, 0, 9.0]  # east, north, up
    (batch,) = topics().batches(messages([{**FIX, "position_covariance": covariance}]))
    assert batch.columns["position_sigma"].tolist() == [[2, 1, 3]]


def test_sigmas_of_a_receiver_s_velocity_are_north_east_down():
    covariance = [0.0] * 36
    covariance[0], covariance[7], covariance[14] = 1.0, 4.0, 9.0  # east, north, up
    velocity = {"twist": {"linear": {"x": 10.0, "y": 20.0, "z": 30.0}}, "covariance": covariance}
    schema = Schema("geometry_msgs/TwistWithCovarianceStamped", "none", b"")
    container = SimpleNamespace(channels={1: Channel("/gps/vel", "json", 1)}, schemas={1: schema}, above_sea=set())
    found = Topics(container, ReadOptions())
    (batch,) = found.batches(messages([velocity]))
    assert batch.columns["velocity"].tolist() == [[20, 10, -30]]
    assert batch.columns["velocity_sigma"].tolist() == [[2, 1, 3]]


@pytest.mark.parametrize(("seconds", "own"), [(9_199_999_999, True), (9_200_000_001, False)])
def test_a_stamp_that_int64_cannot_hold_is_none(seconds, own):
    stamped = {**IMU, "header": {"stamp": {"sec": seconds, "nanosec": 0}}}
    (batch,) = topics().batches(messages([stamped], 7))
    assert batch.time.tolist() == [seconds * 10**9 if own else 7]


@pytest.mark.parametrize(("count", "beyond"), [(64, True), (65, False)])
def test_an_array_of_up_to_64_messages_is_walked_through(count, beyond):
    definition = f"P[{count}] points\nfloat64 after\n{'=' * 80}\nMSG: a/P\nfloat64 x\n"
    assert ("after" in [step.path for step in plan("a/Cloud", definition)]) == beyond


def test_an_array_of_a_million_numbers_is_damage():
    assert plan("a/B", "uint8[999999] x\n")
    with pytest.raises(UnknownLayoutError, match="100000"):
        plan("a/B", "uint8[1000000] x\n")
