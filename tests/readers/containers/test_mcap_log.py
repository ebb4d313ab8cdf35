"""MCAP messages in any encoding become IMUs, fixes and temperatures."""

import json

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap_protobuf.writer import Writer as ProtobufWriter

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import read
from tests.readers.containers.imu_messages import FORCE, RATE, T, assert_imu, own
from tests.readers.repairs import repairs


@pytest.mark.parametrize("code", [0, 1, 6, 7])
def test_cdr_of_every_kind(mcap, ros, imus_of, code):
    messages = [(T + i, ros.imu(T + i, RATE, FORCE, code=code)) for i in range(3)]
    (imu,) = imus_of(mcap.Topic(messages))
    assert_imu(imu)
    assert imu.name == "/imu"
    assert imu.origin.epoch == "unix"
    assert imu.origin.frame.startswith("FLU (")
    assert repairs(imu) == {}


def test_ros_1(mcap, ros, imus_of):
    messages = [(T + i, ros.imu(T + i, RATE, FORCE, code=ros.ROS_1)) for i in range(3)]
    (imu,) = imus_of(mcap.Topic(messages, "/imu", "sensor_msgs/Imu", ros.imu_1, "ros1msg", "ros1"))
    assert_imu(imu)


def test_json(mcap, imus_of):
    def message(i):
        return json.dumps(
            {
                "header": {"stamp": {"sec": T // 10**9, "nanosec": i}, "frame_id": "imu"},
                "angular_velocity": dict(zip("xyz", RATE, strict=True)),
                "linear_acceleration": dict(zip("xyz", FORCE, strict=True)),
            },
        ).encode()

    topic = mcap.Topic([(T + 50, message(i)) for i in range(3)], "/imu", "Imu", "{}", "jsonschema", "json")
    assert_imu(imus_of(topic)[0])


@pytest.mark.parametrize("odd", [[], [1, 2], None, "one", {}])
def test_a_json_number_that_is_none_costs_its_message(mcap, imus_of, odd):
    messages = [(T, own(i, odd if i == 1 else 1.0)) for i in range(3)]
    (imu,) = imus_of(mcap.Topic(messages, "/imu", "Imu", "{}", "jsonschema", "json"))
    assert (imu.angular_rate.time - T).tolist() == [0, 2 * 10**9]
    assert repairs(imu) == {"no_fit": 1}


def test_a_json_array_of_another_length_costs_its_message(mcap):
    fix = {"latitude": 45.0, "longitude": 90.0, "altitude": 1.0}
    lengths = (9, 3, 9)
    messages = [
        (T + i, json.dumps({**fix, "position_covariance": [4.0] * length}).encode()) for i, length in enumerate(lengths)
    ]
    (gnss,) = read(mcap.write(mcap.Topic(messages, "/fix", "Fix", "{}", "jsonschema", "json"))).gnss
    assert gnss.time.tolist() == [T, T + 2]
    assert gnss.position_sigma.tolist() == [[2.0] * 3] * 2
    assert repairs(gnss)["no_fit"] == 1


def test_json_that_is_none_is_left_out_and_counted(mcap, imus_of):
    good = {
        "angular_velocity": dict(zip("xyz", RATE, strict=True)),
        "linear_acceleration": dict(zip("xyz", FORCE, strict=True)),
    }
    messages = [(T, b"{oops"), (T + 1, json.dumps(good).encode()), (T + 2, b"{}")]
    (imu,) = imus_of(mcap.Topic(messages, "/imu", "", "", "", "json"))
    assert imu.angular_rate.time.tolist() == [T + 1]
    assert repairs(imu) == {"no_fit": 2, "no_stamp": 1}


@pytest.fixture(scope="module")
def protobuf_imu():
    """Return a message class of one's own with nested vectors and a google-like timestamp."""
    file = descriptor_pb2.FileDescriptorProto(name="own.proto", package="own", syntax="proto3")
    kinds = {"double": 1, "int64": 3, "int32": 5, "message": 11}

    def add(name, **fields):
        message = file.message_type.add(name=name)
        for number, (field, kind) in enumerate(fields.items(), 1):
            nested = kind not in kinds
            extra = {"type_name": f".own.{kind}"} if nested else {}
            message.field.add(name=field, number=number, type=kinds["message" if nested else kind], label=1, **extra)

    add("Vector", x="double", y="double", z="double")
    add("Stamp", seconds="int64", nanos="int32")
    add("Motion", timestamp="Stamp", angular_velocity="Vector", linear_acceleration="Vector")
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("own.Motion"))


def test_protobuf(protobuf_imu, fresh):
    path = fresh("log.mcap")
    with path.open("wb") as file:
        writer = ProtobufWriter(file)
        for i in range(3):
            message = protobuf_imu()
            message.timestamp.seconds, message.timestamp.nanos = T // 10**9, i
            for vector, values in ((message.angular_velocity, RATE), (message.linear_acceleration, FORCE)):
                vector.x, vector.y, vector.z = values
            writer.write_message("/imu", message, T + 90)
        writer.finish()
    assert_imu(read(path).imus[0])


def test_a_nested_imu_behind_strings_and_sequences(mcap, ros, imus_of):
    def thing(i):
        head = [("i", 1), ("I", 1), ("str", "outer"), ("str", "label" * i), ("d[]", [0.5] * (i % 2))]
        return ros.encode([*head, *ros.imu_items(T + i, RATE, FORCE)])

    topic = mcap.Topic([(T, thing(i)) for i in range(3)], "/thing", "own_msgs/msg/Thing", ros.thing_2)
    (imu,) = imus_of(topic)
    assert imu.name == "/thing"
    assert_imu(imu)


def test_frame_ids_of_several_lengths_in_one_channel(mcap, ros, imus_of):
    frames = ["", "a", "imu_link", "a", "something_long", ""]
    messages = [(T + i, ros.imu(T + i, (i, 0, 0), FORCE, frame)) for i, frame in enumerate(frames)]
    (imu,) = imus_of(mcap.Topic(messages))
    assert imu.angular_rate.time.tolist() == [T + i for i in range(6)]
    assert imu.angular_rate.value[:, 0].tolist() == [0, 1, 2, 3, 4, 5]


def test_frame_ids_of_several_lengths_do_not_move_slow_messages(mcap, ros, imus_of):
    times = [T + i * 10**9 for i in range(20)]
    messages = [(t, ros.imu(t, (i, 0, 0), FORCE, "a" * (1 + i))) for i, t in enumerate(times)]
    (imu,) = imus_of(mcap.Topic(messages))
    assert imu.angular_rate.time.tolist() == times
    assert imu.angular_rate.value[:, 0].tolist() == list(range(20))
    assert repairs(imu) == {}


def two(i):
    """Return a JSON message of second ``i`` that holds two IMUs."""
    part = {
        "angular_velocity": dict(zip("xyz", RATE, strict=True)),
        "linear_acceleration": dict(zip("xyz", FORCE, strict=True)),
    }
    return json.dumps({"stamp": {"sec": T // 10**9 + i, "nanosec": 0}, "left": part, "right": part}).encode()


def test_two_imus_of_one_message_share_the_repairs_as_notes(mcap):
    messages = [(T, b"{oops" if i == 1 else two(i)) for i in range(3)]
    log = read(mcap.write(mcap.Topic(messages, "/two", "Two", "{}", "jsonschema", "json")))
    assert [imu.name for imu in log.imus] == ["/two.left", "/two.right"]
    assert [len(imu.angular_rate) for imu in log.imus] == [2, 2]
    assert any(note.id == "no_fit" and note.startswith("/two: ") for note in log.notes)


def test_two_topics_are_two_imus(mcap, ros, imus_of):
    topics = [mcap.Topic([(T, ros.imu(T, RATE, FORCE))], name) for name in ("/a/imu", "/b/imu")]
    assert [imu.name for imu in imus_of(*topics)] == ["/a/imu", "/b/imu"]


def test_the_frame_that_is_stated_overrides_rep_145(mcap, ros, imus_of):
    (imu,) = imus_of(mcap.Topic([(T, ros.imu(T, RATE, FORCE))]), frame="FRD")
    assert imu.angular_rate.value[0].tolist() == list(RATE)
    assert imu.origin.frame.startswith("FRD (")


def fix(ros, status, covariance, latitude=45.0):
    head = [("i", T // 10**9), ("I", 5), ("str", "gps"), ("b", status), ("H", 1)]
    return ros.encode([*head, ("d", (latitude, 90.0, 120.5)), ("d", covariance), ("B", 2)])


@pytest.mark.parametrize(
    ("covariance", "sigma"),
    [
        ((1.0, 0, 0, 0, 4.0, 0, 0, 0, 9.0), [2.0, 1.0, 3.0]),  # east, north, up become north, east, down
        ((0.0,) * 9, None),  # unknown
        ((-1.0,) + (0.0,) * 8, None),  # absent
    ],
)
def test_a_fix_in_radians_with_its_sigma(mcap, ros, covariance, sigma):
    topic = mcap.Topic([(T, fix(ros, 0, covariance))], "/fix", "sensor_msgs/msg/NavSatFix", ros.fix_2)
    (gnss,) = read(mcap.write(topic)).gnss
    np.testing.assert_allclose(gnss.position, [[np.pi / 4, np.pi / 2, 120.5]], rtol=1e-15)
    assert (None if gnss.position_sigma is None else gnss.position_sigma.tolist()) == (sigma and [sigma])
    assert gnss.time.tolist() == [T + 5]


@pytest.mark.parametrize(("status", "kind"), [(-1, 1), (0, 3), (1, 4), (2, 4)])
def test_the_status_of_a_fix(mcap, ros, status, kind):
    topic = mcap.Topic([(T, fix(ros, status, (0.0,) * 9))], "/fix", "sensor_msgs/msg/NavSatFix", ros.fix_2)
    log = read(mcap.write(topic))
    assert [gnss.fix_type.tolist() for gnss in log.gnss] == ([[kind]] if kind > 1 else [])
    assert ("no_fix" in [note.id for note in log.notes]) == (kind == 1)


def test_a_fix_that_is_no_number_is_left_out_and_counted(mcap, ros):
    messages = [(T, fix(ros, -1, (0.0,) * 9, float("nan"))), (T, fix(ros, 0, (0.0,) * 9))]
    (gnss,) = read(mcap.write(mcap.Topic(messages, "/fix", "sensor_msgs/msg/NavSatFix", ros.fix_2))).gnss
    assert len(gnss) == 1
    assert repairs(gnss) == {"not_finite": 1}


def test_a_fix_without_height_is_noted(mcap):
    topic = mcap.Topic([(T, b'{"latitude": 45.0, "longitude": 90.0}')], "/fix", "Fix", "{}", "jsonschema", "json")
    (gnss,) = read(mcap.write(topic)).gnss
    assert gnss.position[0, 2] == 0
    assert repairs(gnss)["no_height"] == 1


def test_a_temperature_beside_an_imu(mcap, ros):
    warm = ros.encode([("i", T // 10**9), ("I", 0), ("str", "imu"), ("d", 31.5), ("d", 0.0)])
    log = read(
        mcap.write(
            mcap.Topic([(T, ros.imu(T, RATE, FORCE))], "/imu/data"),
            mcap.Topic([(T, warm)], "/imu/temperature", "sensor_msgs/msg/Temperature", ros.temperature_2),
        ),
    )
    assert log.imus[0].temperature.value.tolist() == [31.5]
    assert "temperature_joined" in ids(log.notes)


def test_temperatures_that_are_no_numbers_are_noted(mcap, ros):
    warm = [
        ros.encode([("i", T // 10**9), ("I", i), ("str", "imu"), ("d", t), ("d", 0.0)])
        for i, t in enumerate((20.0, float("nan")))
    ]
    log = read(
        mcap.write(
            mcap.Topic([(T, ros.imu(T, RATE, FORCE))], "/imu/data"),
            mcap.Topic([(T, w) for w in warm], "/imu/temperature", "sensor_msgs/msg/Temperature", ros.temperature_2),
        ),
    )
    assert log.imus[0].temperature.value.tolist() == [20.0]
    assert [(repair.what.id, repair.count) for repair in log.imus[0].temperature.repairs] == [("not_finite", 1)]


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"encoding": "flatbuffer"}, "'flatbuffer'"),
        ({"schema_encoding": "another", "schema": "my_msgs/msg/Own"}, "'another'"),
        ({"schema_encoding": "", "definition": "", "schema": "my_msgs/msg/Own"}, "--messages"),
        ({"schema_encoding": "", "definition": ""}, "fits"),
        ({"definition": "float64 a\n---\nfloat64 b\n"}, "service"),
        ({"definition": "Foo foo\n"}, "'Foo', used in sensor_msgs/Imu"),
        ({"encoding": "protobuf", "schema_encoding": "protobuf", "definition": b"\xff\xff"}, "schema"),
    ],
)
def test_a_channel_that_cannot_be_decoded_is_noted_with_its_count(mcap, change, why):
    log = read(mcap.write(mcap.Topic([(T, b"\x00\x01\x00\x00"), (T, b"")], **change)))
    assert log.imus == ()
    assert ids(log.notes) == ("unused",)
    assert log.notes[0].startswith("not used: /imu: 2 messages")
    assert why in log.notes[0]


def test_a_message_of_another_kind_is_noted(mcap, ros):
    topic = mcap.Topic([(T, ros.encode([("str", "hello")]))], "/chatter", "std_msgs/msg/String", "string data\n")
    (note,) = read(mcap.write(topic)).notes
    assert (note.id, "/chatter: 1 message of std_msgs/msg/String" in note) == ("unused", True)


def test_one_bad_channel_does_not_stop_another(mcap, ros):
    bad = mcap.Topic([(T, b"x")], "/bad", encoding="nobody_knows")
    log = read(mcap.write(bad, mcap.Topic([(T, ros.imu(T, RATE, FORCE))])))
    assert len(log.imus) == 1


def test_messages_that_are_too_short_are_left_out_and_counted(mcap, ros, imus_of):
    whole = ros.imu(T, RATE, FORCE)
    messages = [(T, whole[:50]), (T, whole), (T, b""), (T, whole[:3])]
    (imu,) = imus_of(mcap.Topic(messages))
    assert len(imu.angular_rate) == 1
    assert repairs(imu) == {"no_fit": 3}


def test_an_empty_recording_is_refused(mcap):
    with pytest.raises(UnreadableLogError, match="empty"):
        read(mcap.write(mcap.Topic([])))
