"""Topics that are not used are named by their types, in a line for each reason."""

from imuwb.notes import ids
from imuwb.readers import read
from imuwb.readers.containers.unused_topics import MOST_NAMES, MOST_TYPES, Unused, unused_topics

from .db3_writer import write_db3

T = 1_714_564_800 * 10**9
IMAGE, IMU = "sensor_msgs/msg/Image", "sensor_msgs/msg/Imu"


def test_two_hundred_topics_give_a_few_lines(fresh, ros):
    topics = {"/imu": (IMU, [(T + i, ros.imu(T + i, (0.1, 0, 0), (0, 0, 9.8))) for i in range(30)])}
    topics |= {f"/camera_{i}/image": (IMAGE, [(T, b"\0\1\0\0"), (T + 1, b"\0\1\0\0")]) for i in range(100)}
    topics |= {f"/own_{i}": (f"own_msgs/msg/Kind{i}", [(T, b"\0\1\0\0")]) for i in range(50)}
    topics |= {f"/text_{i}": ("std_msgs/msg/String", [(T, ros.encode([("str", "hello")]))]) for i in range(50)}
    log = read(write_db3(fresh("log.db3"), topics))
    assert ids(log.notes) == ("unused", "unused")
    common, own = log.notes
    assert "/camera_0/image, /camera_1/image" in common
    assert f"and {100 - MOST_NAMES} more: 200 messages of {IMAGE}" in common
    assert "50 messages of std_msgs/msg/String" in common
    assert "--messages" not in common
    assert "/own_0: 1 message of own_msgs/msg/Kind0" in own
    assert f"{50 - MOST_TYPES} topics of {50 - MOST_TYPES} other types" in own
    assert "--messages" in own


def test_each_reason_is_a_line(fresh):
    topics = [
        Unused("/a", "x/A", 1, "one"),
        Unused("/b", "x/B", 2, "two"),
        Unused("/c", "x/A", 3, "one"),
        Unused("/d", "", 4, "one"),
    ]
    texts = [remark.text for remark in unused_topics(topics)]
    assert texts == [
        "not used: /a, /c: 4 messages of x/A, /d: 4 messages of no schema (one)",
        "not used: /b: 2 messages of x/B (two)",
    ]


def test_nothing_unused_gives_nothing():
    assert list(unused_topics([])) == []
