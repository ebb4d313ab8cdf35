import string

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap_ros2._dynamic import generate_dynamic, serialize_dynamic

from imuwb.readers.bytes.gather import gather
from imuwb.readers.containers.ros_layout import Jump, LayoutField, UnknownLayoutError, groups, plan

INTEGERS = {
    f"{sign}int{bits}": st.integers(*((0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)))
    for sign in ("u", "")
    for bits in (8, 16, 32, 64)
}
PRIMITIVES = {
    **INTEGERS,
    "bool": st.booleans(),
    "float32": st.floats(width=32, allow_nan=False),
    "float64": st.floats(allow_nan=False),
}


def gathered(steps, wanted, wire, *messages):
    """Return {row: {path: value}} of messages laid one behind another at odd places."""
    start, length, buffer = [], [], b"\xff"
    for message in messages:
        start.append(len(buffer))
        length.append(len(message))
        buffer += message + b"\xff"
    data = np.frombuffer(buffer, np.uint8)
    start, length = np.array(start, np.int64), np.array(length, np.int64)
    rows = {}
    for group in groups(steps, wanted, wire, data, start, length):
        columns = {p.name: gather(data, start[group.rows] + p.offset, p.kind, p.count) for p in group.places}
        for i, row in enumerate(group.rows):
            rows[int(row)] = {path: columns[path][i].tolist() for path in wanted}
    return rows


# The plan


def test_nested_fields_have_dotted_paths_and_strings_are_jumps(ros):
    steps = plan("sensor_msgs/msg/Imu", ros.imu_2)
    assert steps[:3] == (
        LayoutField("header.stamp.sec", "i4", 0),
        LayoutField("header.stamp.nanosec", "u4", 0),
        Jump("header.frame_id", 1, 1),
    )
    assert LayoutField("angular_velocity_covariance", "f8", 9) in steps
    assert [s.path for s in steps[-4:]] == [
        *(f"linear_acceleration.{a}" for a in "xyz"),
        "linear_acceleration_covariance",
    ]


def test_a_bare_header_of_ros_1_is_std_msgs(ros):
    steps = plan("sensor_msgs/Imu", ros.imu_1)
    assert [s.path for s in steps[:4]] == ["header.seq", "header.stamp.sec", "header.stamp.nanosec", "header.frame_id"]


@pytest.mark.parametrize(
    ("line", "step"),
    [
        ("float64 x", LayoutField("x", "f8", 0)),
        ("  float32[3]   x  # metres", LayoutField("x", "f4", 3)),
        ("float64 x 1.5", LayoutField("x", "f8", 0)),
        ("byte x", LayoutField("x", "u1", 0)),
        ("double x", LayoutField("x", "f8", 0)),
        ("uint16[] x", Jump("x", 2, 2)),
        ("uint16[<=7] x", Jump("x", 2, 2)),
        ("string x", Jump("x", 1, 1)),
        ("string<=9 x", Jump("x", 1, 1)),
        ('string x "a = b"', Jump("x", 1, 1)),
    ],
)
def test_one_line(line, step):
    assert plan("a/B", line) == (step,)


@pytest.mark.parametrize("line", ["", "# float64 x", "int8 NONE=-1", "int8 NONE = -1", 'string NAME="float64 x"'])
def test_lines_without_a_field(line):
    assert plan("a/B", line) == ()


@pytest.mark.parametrize("line", ["string[] names", "wstring name", "a/C[] parts", "a/C[<=3] parts", "a/C[65] parts"])
def test_a_plan_ends_before_what_has_no_common_place(line):
    text = f"float64 before\n{line}\nfloat64 behind\n===\nMSG: a/C\nfloat64 x\n"
    assert [s.path for s in plan("a/B", text)] == ["before"]


def test_a_short_array_of_messages_is_spread():
    assert [s.path for s in plan("a/B", "C[2] parts\n===\nMSG: a/C\nfloat64 x\n")] == ["parts.0.x", "parts.1.x"]


def test_a_type_that_is_not_defined_is_named():
    with pytest.raises(UnknownLayoutError, match="type 'Foo', used in a/B, is not defined"):
        plan("a/B", "Foo x")


def test_a_definition_without_end_is_refused():
    with pytest.raises(UnknownLayoutError, match="levels"):
        plan("a/B", "B again")


def test_a_definition_that_doubles_without_end_is_refused():
    nests = "".join(f"===\nMSG: a/C{i}\n" + f"C{i + 1}[64] x\n" * 4 for i in range(8))
    with pytest.raises(UnknownLayoutError, match="too many"):
        plan("a/B", f"C0 x\n{nests}===\nMSG: a/C8\nfloat64 x\n")


# The bytes


@pytest.mark.parametrize("code", [0, 1, 6, 7, None])
@pytest.mark.parametrize("frame", ["", "a", "imu", "imu_link", "a_rather_long_name"])
def test_every_wire_form_and_frame_length(ros, code, frame):
    wire = "ros1" if code is ros.ROS_1 else "cdr"
    steps = plan("sensor_msgs/Imu", ros.imu_1 if wire == "ros1" else ros.imu_2)
    wanted = (
        "header.stamp.sec",
        "header.stamp.nanosec",
        "angular_velocity.y",
        "linear_acceleration.z",
        "orientation_covariance",
    )
    message = ros.imu(5_000_000_007, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), frame, code)
    values = gathered(steps, wanted, wire, message)[0]
    assert list(values.values()) == [5, 7, 2.0, 6.0, [0, 1, 2, 3, 4, 5, 6, 7, 8]]


@pytest.mark.parametrize(("code", "at"), [(1, 8), (7, 4)])
def test_doubles_align_to_eight_in_cdr_and_to_four_in_xcdr2(ros, code, at):
    steps = plan("a/B", "int32 n\nfloat64 x")
    message = ros.encode([("i", 1), ("d", 2.5)], code)
    assert len(message) == 4 + at + 8
    assert gathered(steps, ("n", "x"), "cdr", message) == {0: {"n": 1, "x": 2.5}}


def test_an_empty_sequence_pads_nothing(ros):
    steps = plan("a/B", "float64[] before\nuint8 n\nfloat64 x")
    messages = [ros.encode([("d[]", before), ("B", 9), ("d", 2.5)]) for before in ([], [1.0], [1.0, 2.0], [])]
    assert gathered(steps, ("n", "x"), "cdr", *messages) == {i: {"n": 9, "x": 2.5} for i in range(4)}


@pytest.mark.parametrize("header", [b"\x00\x02\x00\x00", b"\x00\x0b\x00\x00", b"\x01\x01\x00\x00", b"\x00", b""])
def test_an_encapsulation_nobody_knows_is_in_no_group(header):
    steps = plan("a/B", "float64 x")
    assert gathered(steps, ("x",), "cdr", header + bytes(8) * bool(header[3:])) == {}


@pytest.mark.parametrize("wire", ["cdr", "ros1"])
def test_a_message_that_is_cut_anywhere_is_in_no_group_and_spoils_no_other(ros, wire):
    code = 1 if wire == "cdr" else ros.ROS_1
    steps = plan("sensor_msgs/Imu", ros.imu_2 if wire == "cdr" else ros.imu_1)
    whole = ros.imu(1, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), code=code)
    cuts = [whole[:n] for n in range(0, len(whole) - 72, 3)]
    assert list(gathered(steps, ("linear_acceleration.z",), wire, *cuts, whole)) == [len(cuts)]


@pytest.mark.parametrize("count", [2**32 - 1, 2**31, 1000])
def test_a_length_that_does_not_fit_is_in_no_group(ros, count):
    steps = plan("a/B", "float64[] before\nfloat64 x")
    bad = ros.encode([("I", count), ("d", 1.0), ("d", 2.0)])
    assert gathered(steps, ("x",), "cdr", bad) == {}


@given(st.lists(st.binary(max_size=60), max_size=6))
def test_any_bytes_are_read_within_their_message(messages):
    steps = plan("a/B", "string a\nfloat64[] b\nuint16 c\nuint8[] d\nfloat64 e")
    rows = gathered(steps, ("c", "e"), "cdr", *(b"\x00\x01\x00\x00" + m for m in messages))
    assert all(len(messages[row]) >= 18 for row in rows)


@st.composite
def definitions(draw):
    """Return a definition of one nested message and some messages of it."""
    lines, fields = {"B": [], "C": []}, {"B": {}, "C": {}}
    for owner in ("C", "B"):
        for name in string.ascii_lowercase[: draw(st.integers(1, 6))]:
            kind = draw(st.sampled_from([*PRIMITIVES, "string", *(["a/C"] if owner == "B" else [])]))
            array = draw(st.sampled_from(["", "", "[3]", "[]"])) if kind in PRIMITIVES else ""
            lines[owner].append(f"{kind}{array} {name}")
            fields[owner][name] = kind, array

    def message(owner):
        return {name: value(*form) for name, form in fields[owner].items()}

    def value(kind, array):
        if kind == "a/C":
            return message("C")
        one = st.text(string.ascii_letters, max_size=9) if kind == "string" else PRIMITIVES[kind]
        count = {"": None, "[3]": 3, "[]": draw(st.integers(0, 3))}[array]
        return draw(one) if count is None else draw(st.lists(one, min_size=count, max_size=count))

    text = "\n".join(lines["B"]) + "\n" + "=" * 80 + "\nMSG: a/C\n" + "\n".join(lines["C"]) + "\n"
    return text, [message("B") for _ in range(draw(st.integers(1, 4)))]


def dig(message, path):
    for name in path.split("."):
        message = getattr(message, name)
    return list(message) if hasattr(message, "__len__") else message


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(definitions())
def test_every_field_of_any_message_is_what_the_generic_decoder_reads(case):
    text, messages = case
    encode, decode = serialize_dynamic("a/msg/B", text)["a/msg/B"], generate_dynamic("a/msg/B", text)["a/msg/B"]
    packed = [encode(message) for message in messages]
    steps = plan("a/msg/B", text)
    wanted = tuple(step.path for step in steps if isinstance(step, LayoutField))
    if not wanted:
        return
    rows = gathered(steps, wanted, "cdr", *packed)
    decoded = [decode(data) for data in packed]
    assert rows == {i: {path: dig(m, path) for path in wanted} for i, m in enumerate(decoded)}
