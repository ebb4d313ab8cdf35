"""MCAP messages decode as other libraries decode them, and recordings of others are read."""

import sys

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros1.decoder import DecoderFactory as Ros1Decoder
from mcap_ros2.decoder import DecoderFactory as Ros2Decoder
from mcap_ros2.writer import Writer as Ros2Writer

from imuwb.errors import UnreadableLogError
from imuwb.readers import read
from tests.readers.containers.imu_messages import T

HUSKY = ("json", "protobuf", "ros1msg_lz4", "ros2cdr_unchunked", "ros2cdr_zstd")


def random_messages(seed, count):
    rng = np.random.default_rng(seed)

    def vector():
        return dict(zip("xyz", (rng.normal(size=3) * 10.0 ** rng.integers(-9, 9)).tolist(), strict=True))

    for i in range(count):
        yield {
            "header": {"stamp": {"sec": T // 10**9, "nanosec": i * 4_999_999}, "frame_id": "f" * int(rng.integers(20))},
            "orientation": {**vector(), "w": 1.0},
            "orientation_covariance": rng.normal(size=9).tolist(),
            "angular_velocity": vector(),
            "angular_velocity_covariance": rng.normal(size=9).tolist(),
            "linear_acceleration": vector(),
            "linear_acceleration_covariance": rng.normal(size=9).tolist(),
        }  # fmt: skip


def decoded(path, factory):
    with path.open("rb") as file:
        messages = [m for _, _, _, m in make_reader(file, decoder_factories=[factory]).iter_decoded_messages()]
    rate, force = (
        np.array([[v.x, -v.y, -v.z] for v in (getattr(m, name) for m in messages)])
        for name in ("angular_velocity", "linear_acceleration")
    )
    return messages, rate, force


@pytest.mark.parametrize("seed", range(3))
def test_ros_2_equals_the_generic_decoder(ros, fresh, seed):
    path = fresh("log.mcap")
    with path.open("wb") as file:
        writer = Ros2Writer(file)
        schema = writer.register_msgdef("sensor_msgs/msg/Imu", ros.imu_2)
        for message in random_messages(seed, 200):
            writer.write_message("/imu", schema, message, T)
        writer.finish()
    messages, rate, force = decoded(path, Ros2Decoder())
    (imu,) = read(path).imus
    assert imu.angular_rate.time.tolist() == [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in messages]
    np.testing.assert_array_equal(imu.angular_rate.value, rate)
    np.testing.assert_array_equal(imu.specific_force.value, force)


def test_ros_1_equals_the_generic_decoder(mcap, ros):
    rng = np.random.default_rng(4)
    values = rng.normal(size=(50, 6))
    messages = [(T, ros.imu(T + i, tuple(v[:3]), tuple(v[3:]), "f" * (i % 7), ros.ROS_1)) for i, v in enumerate(values)]
    path = mcap.write(mcap.Topic(messages, "/imu", "sensor_msgs/Imu", ros.imu_1, "ros1msg", "ros1"))
    _, rate, force = decoded(path, Ros1Decoder())
    imus = read(path).imus  # one for each frame of the headers
    order = np.argsort(np.concatenate([imu.angular_rate.time for imu in imus]))
    np.testing.assert_array_equal(np.concatenate([imu.angular_rate.value for imu in imus])[order], rate)
    np.testing.assert_array_equal(np.concatenate([imu.specific_force.value for imu in imus])[order], force)


@pytest.mark.slow
def test_one_run_in_five_encodings_is_one_log(shared):
    logs = [read(shared / "mcap" / f"husky_test1_{name}.mcap") for name in HUSKY]
    first = logs[0]
    assert len(first.imus[0].angular_rate) == 11865
    for log in logs[1:]:
        (a,), (b,) = first.imus, log.imus
        for x, y in (
            (a.angular_rate.time, b.angular_rate.time),
            (a.angular_rate.value, b.angular_rate.value),
            (a.specific_force.value, b.specific_force.value),
            (first.gnss[0].time, log.gnss[0].time),
            (first.gnss[0].position, log.gnss[0].position),
        ):
            assert x.tobytes() == y.tobytes()


def test_every_odd_recording_is_read_or_refused(shared):
    paths = sorted((shared / "mcap" / "native").glob("*.mcap"))
    assert paths
    for path in paths:
        try:
            log = read(path)
        except UnreadableLogError as error:
            assert str(path) in str(error)  # noqa: PT017 - either is right, and both are checked
        else:
            assert log.notes or log.imus or log.gnss


def test_without_the_package_of_protobuf_the_log_says_what_to_install(mcap, monkeypatch):
    monkeypatch.setitem(sys.modules, "mcap_protobuf.decoder", None)
    topic = mcap.Topic([(T, b"\x08\x01")], schema="a.B", definition="", schema_encoding="protobuf", encoding="protobuf")
    assert "mcap-protobuf-support" in " ".join(read(mcap.write(topic)).notes)
