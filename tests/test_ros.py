"""Definitions of our own equal those that rosbags has, field for field."""

import re

import pytest

from imuwb import ros
from imuwb.readers.containers import ros_layout

#: packages that rosbags knows
PACKAGES = ("builtin_interfaces", "std_msgs", "geometry_msgs", "sensor_msgs", "nav_msgs")
MESSAGES = [name for name in ros.known() if name.startswith(tuple(f"{package}/" for package in PACKAGES))]
KINDS = {"float64": "f8", "float32": "f4", "bool": "u1", "octet": "u1"} | {
    f"{u}int{8 * n}": f"{u or 'i'}{n}" for u in ("u", "") for n in (1, 2, 4, 8)
}


@pytest.fixture(scope="module")
def store():
    typesys = pytest.importorskip("rosbags.typesys", reason="rosbags, which knows ROS messages, is not installed")
    return typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)


def told(store, name, prefix=""):
    """Return (path, type, count) of a message's numbers and strings as rosbags' typestore has them."""
    for field, (kind, what) in store.get_msgdef(name).fields:
        path = f"{prefix}{field}"
        if kind.name == "BASE":
            yield path, what[0], 0
        elif kind.name == "NAME":
            yield from told(store, what, f"{path}.")
        else:
            assert kind.name == "ARRAY"
            (inner, base), count = what
            assert inner.name == "BASE"
            yield path, base[0], count


def ros_2(name):
    return name.replace("/", "/msg/")


@pytest.mark.parametrize("name", MESSAGES)
def test_a_definition_is_that_of_rosbags(store, name):
    plan = ros_layout.plan(name, ros.definition(name))
    wanted = list(told(store, ros_2(name)))
    assert [step.path for step in plan] == [path for path, _, _ in wanted]
    for step, (path, kind, count) in zip(plan, wanted, strict=True):
        if isinstance(step, ros_layout.Jump):
            assert (step.path, kind, step.size) == (path, "string", 1)
        else:
            assert (step.path, step.kind, step.count) == (path, KINDS[kind], count)


def test_rosbags_takes_the_definitions_for_the_same_messages(store):
    from rosbags.typesys import get_types_from_msg

    for name in MESSAGES:
        for part, (_, parsed) in get_types_from_msg(ros.definition(name), ros_2(name)).items():
            assert parsed == store.fielddefs[part][1], name


@pytest.mark.parametrize("name", ros.known())
def test_every_form_of_every_message_is_whole(name):
    forms = list(ros.definitions(name))
    assert forms
    assert len(set(forms)) == len(forms)
    for text in forms:
        steps, whole = ros_layout.whole_plan(name, text)
        assert whole or "string[]" in text
        assert steps
    assert len({step.path for step in steps}) == len(steps)


def test_every_type_that_a_message_contains_is_known():
    kinds = {
        field.split()[0].partition("[")[0]
        for forms in ros.known().values()
        for text in forms
        for field in text.split(";")
    }
    assert {kind for kind in kinds if "/" in kind} <= ros.known().keys()
    assert {kind for kind in kinds if "/" not in kind} <= {*KINDS, "string"}
    assert all(re.fullmatch(r"\w+(\[\d*\])?", kind) for kind in kinds if "/" not in kind)


def test_a_message_that_has_changed_has_its_newest_form_first():
    newest, *older = ros.definitions("px4_msgs/msg/SensorGps")
    assert len(older) == 4
    assert "antenna_offset_x" in newest
    assert all("antenna_offset_x" not in text for text in older)
    assert [("latitude_deg" in text) for text in (newest, *older)] == [True, True, True, False, False]


def test_the_header_of_ros_1_is_a_form_of_its_own():
    first, second = ros.definitions("sensor_msgs/Temperature")
    assert ("seq" in first, "seq" in second) == (False, True)


@pytest.mark.parametrize("name", ["sensor_msgs/msg/Image", "Imu", "", "sensor_msgs/Imu/msg/"])
def test_of_other_messages_there_is_none(name):
    assert not ros.definition(name)


def test_the_name_may_lack_msg():
    assert ros.definition("sensor_msgs/Imu") == ros.definition("sensor_msgs/msg/Imu")
