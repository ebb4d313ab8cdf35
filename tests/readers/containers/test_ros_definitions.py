"""Recordings without definitions are read with those that the user gives, or with those of common packages that fit."""

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from imuwb.readers.containers import ros_idl
from imuwb.readers.containers.decoders import decoder_of
from imuwb.readers.containers.messages import Channel, Messages, Schema
from imuwb.readers.containers.ros_definitions import Definitions
from imuwb.ros import definitions

from .db3_writer import write_db3

T = 1_714_564_800 * 10**9
RATE, FORCE = (0.1, 0.2, 0.3), (0.5, 0.25, 9.75)
KIND = "my_imu/msg/Wrapped"
CODES = {
    "uint64": "Q", "uint32": "I", "uint16": "H", "uint8": "B", "int32": "i", "float64": "d", "float32": "f", "bool": "?",
}  # fmt: skip
WRAPPED = "std_msgs/Header header\nsensor_msgs/Imu imu\nStatus status  # a type of the same package\nstring label\n"
STATUS = "uint8 OK=0\nuint8 code\nfloat32 voltage\n"
IDL = """
// generated
#include "sensor_msgs/msg/Imu.idl"
module my_imu { module msg {
  typedef float float__2[2];
  module Wrapped_Constants { const uint8 OK = 0; };
  @verbatim (language="comment", text="a text; with { braces }" "and more")
  struct Wrapped {
    std_msgs::msg::Header header;
    @unit (value="m/s")
    sensor_msgs::msg::Imu imu;
    my_imu::msg::Status status;
    string label;
  };
  struct Status { uint8 code; float voltage; };
}; };
"""


@pytest.fixture(scope="module")
def wrapped(ros):
    """Return messages of a type of one's own: an IMU inside."""

    def payload(i):
        stamp = T + i * 10**7
        header = [("i", stamp // 10**9), ("I", stamp % 10**9), ("str", "imu")]
        return ros.encode([*header, *ros.imu_items(stamp, RATE, FORCE), ("B", 1), ("f", 3.3), ("str", "$VNYMR")])

    return [(T + i * 10**7, payload(i)) for i in range(20)]


@pytest.fixture(scope="module")
def log(fresh, wrapped):
    return write_db3(fresh("log.db3"), {"/imu": (KIND, wrapped)})


def files(folder, texts):
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return folder


def assert_read(found):
    imu = found.imu()
    assert imu.angular_rate.time.tolist() == [T + i * 10**7 for i in range(20)]
    np.testing.assert_array_equal(imu.angular_rate.value, [np.array(RATE) * (1, -1, -1)] * 20)
    np.testing.assert_array_equal(imu.specific_force.value, [np.array(FORCE) * (1, -1, -1)] * 20)
    assert found.notes == ()


def test_a_type_without_its_definition_is_named_with_the_remedy(log):
    found = read(log)
    assert found.imus == ()
    assert ids(found.notes) == ("unused",)
    assert all(text in found.notes[0] for text in ("/imu", KIND, "20 messages", "--messages"))


@pytest.mark.parametrize(
    "texts",
    [
        {"src/my_imu/msg/Wrapped.msg": WRAPPED, "src/my_imu/msg/Status.msg": STATUS, "src/other/msg/Status.msg": "string x\n"},
        {"src/my_imu/msg/Wrapped.msg": f"{WRAPPED}{'=' * 80}\nMSG: my_imu/Status\n{STATUS}"},
        {"Wrapped.msg": WRAPPED, "Status.msg": STATUS},  # no package: the name alone counts
        {"my_imu/msg/Wrapped.idl": IDL},
        {"my_imu/msg/Wrapped.msg": WRAPPED, "my_imu/msg/Status.msg": STATUS, "sensor_msgs/msg/Image.msg": "uint8[] data\n"},
    ],
)  # fmt: skip
def test_a_folder_of_definitions_is_used(log, tmp_path, texts):
    assert_read(read(log, ReadOptions(messages=files(tmp_path, texts))))


@pytest.mark.parametrize("part", ["my_imu", "my_imu/msg"])
def test_the_folder_may_be_that_of_the_package_or_of_its_messages(log, tmp_path, part):
    folder = files(tmp_path, {"my_imu/msg/Wrapped.msg": WRAPPED, "my_imu/msg/Status.msg": STATUS})
    assert_read(read(log, ReadOptions(messages=folder / part)))


def test_one_file_is_enough_if_it_has_all(log, tmp_path):
    text = WRAPPED.replace("Status status", "uint8 code\nfloat32 voltage")
    assert_read(read(log, ReadOptions(messages=files(tmp_path, {"Wrapped.msg": text}) / "Wrapped.msg")))


def test_a_part_that_is_not_given_is_named(log, tmp_path):
    folder = files(tmp_path, {"my_imu/msg/Wrapped.msg": WRAPPED})
    (note,) = read(log, ReadOptions(messages=folder)).notes
    assert all(text in note for text in ("'Status'", "my_imu/Wrapped", "--messages"))


@pytest.mark.parametrize(
    "text", [WRAPPED.replace("string label", "float64[3] more"), WRAPPED.replace("string label", "")]
)
def test_a_definition_that_does_not_fit_the_messages_is_not_used(log, tmp_path, text):
    folder = files(tmp_path, {"my_imu/msg/Wrapped.msg": text, "my_imu/msg/Status.msg": STATUS})
    found = read(log, ReadOptions(messages=folder))
    assert found.imus == ()
    assert "fits" in found.notes[0]


@pytest.mark.parametrize("names", [(), ("notes.txt",)])
def test_a_folder_without_definitions_is_refused(log, tmp_path, names):
    files(tmp_path, dict.fromkeys(names, "x"))
    with pytest.raises(UsageError, match="messages"):
        read(log, ReadOptions(messages=tmp_path))
    with pytest.raises(UsageError, match=r"nowhere"):
        read(log, ReadOptions(messages=tmp_path / "nowhere"))


def test_messages_are_read_in_mcap_without_definitions(mcap, wrapped, ros, tmp_path):
    own = mcap.Topic(wrapped, "/own", KIND, "", "")
    known = mcap.Topic([(T, ros.imu(T, RATE, FORCE))], "/imu", "sensor_msgs/msg/Imu", "", "")
    path = mcap.write(own, known)
    assert [imu.name for imu in read(path).imus] == ["/imu"]
    folder = files(tmp_path, {"my_imu/msg/Wrapped.msg": WRAPPED, "my_imu/msg/Status.msg": STATUS})
    assert [imu.name for imu in read(path, ReadOptions(messages=folder)).imus] == ["/own", "/imu"]


def test_the_definition_in_the_log_counts_before_that_of_the_user(mcap, ros, tmp_path):
    topic = mcap.Topic([(T, ros.imu(T, RATE, FORCE))])
    folder = files(tmp_path, {"sensor_msgs/msg/Imu.msg": "float64 x\n"})
    assert len(read(mcap.write(topic), ReadOptions(messages=folder)).imus) == 1


def test_mcap_holds_definitions_in_the_other_language(mcap, wrapped):
    rule = "=" * 80
    text = (
        f"{rule}\nIDL: my_imu/msg/Wrapped\n{IDL}\n{rule}\nIDL: std_msgs/msg/Header\nmodule std_msgs {{ module msg {{\n"
    )
    text += "struct Header { builtin_interfaces::msg::Time stamp; string frame_id; }; }; };\n"
    assert_read(read(mcap.write(mcap.Topic(wrapped, "/imu", KIND, text, "ros2idl"))))


def test_no_option_is_left_unsaid_where_a_format_has_no_messages(text_log, tmp_path):
    path = text_log("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n" + "".join(f"{i},0.1,0.2,0.3\n" for i in range(9)))
    found = read(path, ReadOptions(messages=files(tmp_path, {"a/msg/B.msg": "float64 x\n"})))
    assert "options_unused" in ids(found.notes)


@pytest.mark.parametrize("form", range(5))
@pytest.mark.parametrize("padding", [0, 3])
def test_the_form_of_a_message_that_fits_its_size_is_used(ros, form, padding):
    lines = [line.split() for line in list(definitions("px4_msgs/SensorGps"))[form].splitlines()]
    payload = np.frombuffer(ros.encode([(CODES[kind], 0) for kind, _ in lines]) + bytes(padding), np.uint8)
    zero = np.zeros(1, np.int64)
    messages = Messages(payload, zero, zero, zero, zero, zero + payload.size, 0)
    schema = Schema("px4_msgs/msg/SensorGps", "none", b"")
    decoder = decoder_of(Channel("/gps", "cdr", 1), schema, Definitions())
    assert list(decoder.fields(messages, zero)) == [name for _, name in lines]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("module a { module msg { struct B { sequence<double, 3> x; long long y[2][2]; string<9> z; }; }; };",
         {"a/B": "float64[<=3] x\nint64[2][2] y\nstring z\n"}),
        ("module a { module msg { typedef double double__9[9]; struct B { double__9 x; unsigned long long y; }; }; };",
         {"a/B": "float64[9] x\nuint64 y\n"}),
        ("module a { module msg { struct B { unsigned short x; boolean y, z; octet w; }; }; };",
         {"a/B": "uint16 x\nbool y\nbool z\nbyte w\n"}),
        ("module a { module msg { enum E { ONE, TWO }; union U switch (long) { case 1: long x; }; struct B { short x; }; }; };",
         {"a/B": "int16 x\n"}),
        ("float64 x\nfloat64 y\n", {}), ("", {}), ("module a {", {}), ("struct B { double", {}), ('@verbatim(text="', {}),
    ],
)  # fmt: skip
def test_the_other_language(text, found):
    assert ros_idl.converted(text) == found
