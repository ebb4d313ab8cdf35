"""Definitions of our own equal those that rosbags has, field for field."""

import pytest

from imuwb import ros
from imuwb.readers.containers import ros_layout

MESSAGES = (
    "sensor_msgs/msg/Imu", "sensor_msgs/msg/NavSatFix", "sensor_msgs/msg/Temperature", "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/msg/TwistWithCovarianceStamped", "nav_msgs/msg/Odometry",
)  # fmt: skip


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


def test_every_message_that_is_listed_is_compared():
    listed = {name for name in ros._MESSAGES if not name.startswith("imuwb_msgs")}  # noqa: SLF001
    assert {name.replace("/msg/", "/") for name in MESSAGES} == listed


@pytest.mark.parametrize("name", MESSAGES)
def test_a_definition_is_that_of_rosbags(store, name):
    plan = ros_layout.plan(name, ros.definition(name))
    wanted = list(told(store, name))
    assert len(wanted) >= 5
    assert [step.path for step in plan] == [path for path, _, _ in wanted]
    sizes = {
        "float64": "f8",
        "float32": "f4",
        **{f"{u}int{8 * n}": f"{u or 'i'}{n}" for u in ("u", "") for n in (1, 2, 4, 8)},
    }
    for step, (path, kind, count) in zip(plan, wanted, strict=True):
        if isinstance(step, ros_layout.Jump):
            assert (step.path, kind, step.size) == (path, "string", 1)
        else:
            assert (step.path, step.kind, step.count) == (path, sizes[kind], count)


@pytest.mark.parametrize("name", MESSAGES)
def test_rosbags_takes_the_definition_for_the_same_message(store, name):
    from rosbags.typesys import get_types_from_msg

    types = get_types_from_msg(ros.definition(name), name)
    for part, (_, parsed) in types.items():
        assert parsed == store.fielddefs[part][1]


@pytest.mark.parametrize("name", ["sensor_msgs/msg/Image", "Imu", "", "sensor_msgs/Imu/msg/"])
def test_of_other_messages_there_is_none(name):
    assert not ros.definition(name)


def test_the_name_may_lack_msg():
    assert ros.definition("sensor_msgs/Imu") == ros.definition("sensor_msgs/msg/Imu")
