"""Recordings in SQLite hold what the same messages hold in MCAP, with definitions of their own or without."""

import sqlite3
import time
from contextlib import closing

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read, reader_of
from imuwb.readers.containers import sqlite_rows
from imuwb.ros import definition

from .db3_writer import NEW, OLD, write_db3

T = 1_714_564_800 * 10**9
IMU, FIX, TEMPERATURE = "sensor_msgs/msg/Imu", "sensor_msgs/msg/NavSatFix", "sensor_msgs/msg/Temperature"
TWIST, ODOMETRY, IMAGE = "geometry_msgs/msg/TwistStamped", "nav_msgs/msg/Odometry", "sensor_msgs/msg/Image"


@pytest.fixture(scope="module")
def store():
    typesys = pytest.importorskip("rosbags.typesys", reason="rosbags, which writes recordings, is not installed")
    return typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)


@pytest.fixture(scope="module")
def recording(store):
    """Return {topic: (type, [(time, payload)])} of a small drive."""
    kinds = store.types
    zero = kinds["geometry_msgs/msg/Vector3"]
    pack = store.serialize_cdr

    def header(t):
        stamp = kinds["builtin_interfaces/msg/Time"](t // 10**9, t % 10**9)
        return kinds["std_msgs/msg/Header"](stamp, "base")

    def imu(t, i):
        turn, nine = kinds["geometry_msgs/msg/Quaternion"](0, 0, 0, 1), np.arange(9.0)
        rate, force = zero(i / 100, 0.25, -0.5), zero(0.125, -0.25, 9.8 + i / 1000)
        return kinds[IMU](header(t), turn, nine, rate, nine, force, nine)

    def fix(t, i):
        covariance = np.array([4.0, 0, 0, 0, 9.0, 0, 0, 0, 25.0]) if i % 2 else np.zeros(9)
        return kinds[FIX](
            header(t), kinds["sensor_msgs/msg/NavSatStatus"](0, 1), 47.3 + i * 1e-5, 8.5, 450.0, covariance, 2
        )

    def twist(t, i):
        return kinds[TWIST](header(t), kinds["geometry_msgs/msg/Twist"](zero(i, 2.0, 3.0), zero(0, 0, 0)))

    def odometry(t, i):
        pose = kinds["geometry_msgs/msg/Pose"](
            kinds["geometry_msgs/msg/Point"](0, 0, 0), kinds["geometry_msgs/msg/Quaternion"](0, 0, 0, 1)
        )
        still = kinds["geometry_msgs/msg/Twist"](zero(7.0 + i, 0, 0), zero(0, 0, 0))
        return kinds[ODOMETRY](
            header(t), "wheels", kinds["geometry_msgs/msg/PoseWithCovariance"](pose, np.zeros(36)),
            kinds["geometry_msgs/msg/TwistWithCovariance"](still, np.zeros(36)),
        )  # fmt: skip

    found = {}
    for topic, kind, make, step, count in (
        ("/imu", IMU, imu, 10, 100), ("/fix", FIX, fix, 200, 5), ("/fix_velocity", TWIST, twist, 200, 5),
        ("/odom", ODOMETRY, odometry, 50, 20),
        ("/imu/temperature", TEMPERATURE, lambda t, i: kinds[TEMPERATURE](header(t), 20.0 + i, 0.0), 500, 3),
    ):  # fmt: skip
        times = [T + i * step * 10**6 for i in range(count)]
        found[topic] = kind, [(t + 777, bytes(pack(make(t, i), kind))) for i, t in enumerate(times)]
    return found


@pytest.fixture(scope="module")
def by_hand(fresh):
    """Return a function that writes a database as rosbag2 does."""

    def write(topics, tables=OLD, definitions=(), page=4096):
        return write_db3(fresh("log.db3"), topics, tables, definitions, page)

    return write


def assert_same(one, other):
    assert [imu.name for imu in one.imus] == [imu.name for imu in other.imus]
    for a, b in zip(one.imus, other.imus, strict=True):
        for quantity in ("angular_rate", "specific_force", "temperature"):
            np.testing.assert_array_equal(getattr(a, quantity).time, getattr(b, quantity).time)
            np.testing.assert_array_equal(getattr(a, quantity).value, getattr(b, quantity).value)
        assert a.origin == b.origin
    assert len(one.gnss) == len(other.gnss) == 1
    for column in ("time", "position", "velocity", "position_sigma", "fix_type"):
        np.testing.assert_array_equal(getattr(one.gnss[0], column), getattr(other.gnss[0], column))
    assert [speed.value.tolist() for speed in one.speeds] == [speed.value.tolist() for speed in other.speeds]


@pytest.mark.slow
def test_what_rosbags_writes_equals_the_same_messages_in_mcap(store, recording, fresh, mcap):
    from rosbags.rosbag2 import Writer

    folder = fresh("drive")
    with Writer(folder, version=8) as writer:
        for topic, (kind, messages) in recording.items():
            to = writer.add_connection(topic, kind, typestore=store)
            for t, payload in messages:
                writer.write(to, t, payload)
    found = read(folder / "drive.db3")
    told = read(
        mcap.write(
            *(mcap.Topic(messages, topic, kind, definition(kind)) for topic, (kind, messages) in recording.items())
        )
    )
    assert found.provenance.format == "db3"
    assert_same(found, told)
    assert sorted(found.notes) == sorted(told.notes)


def test_without_definitions_ours_are_used(recording, by_hand):
    found = read(by_hand(recording))
    imu, (gnss,), (speed,) = found.imu(), found.gnss, found.speeds
    assert imu.name == "/imu"
    assert imu.angular_rate.time.tolist() == [T + i * 10**7 for i in range(100)]  # the header's, not the recorder's
    np.testing.assert_array_equal(imu.angular_rate.value, [[i / 100, -0.25, 0.5] for i in range(100)])  # FLU is FRD now
    np.testing.assert_array_equal(imu.specific_force.value[:, :2], [[0.125, 0.25]] * 100)
    np.testing.assert_allclose(imu.specific_force.value[:, 2], -9.8 - np.arange(100) / 1000)
    np.testing.assert_allclose(np.degrees(gnss.position[:, 0]), 47.3 + np.arange(5) * 1e-5)
    np.testing.assert_array_equal(gnss.position_sigma, [[3, 2, 5] if i % 2 else [np.nan] * 3 for i in range(5)])
    np.testing.assert_array_equal(gnss.velocity, [[2, i, -3] for i in range(5)])
    assert speed.value.tolist() == [7.0 + i for i in range(20)]
    assert imu.temperature.value.tolist() == [20, 21, 22]


def test_definitions_that_the_recording_holds_are_used(recording, by_hand, store):
    kinds = [kind for kind, _ in recording.values()]
    rows = [(kind, "ros2msg", store.generate_msgdef(kind, ros_version=2)[0]) for kind in kinds]
    assert_same(read(by_hand(recording, NEW, rows)), read(by_hand(recording)))


def test_a_type_of_ones_own_is_read_by_the_recordings_definition(recording, by_hand):
    own = {"/mine": ("my_msgs/msg/Motion", recording["/imu"][1])}
    found = read(by_hand(own, NEW, [("my_msgs/msg/Motion", "ros2msg", definition(IMU))]))
    assert len(found.imu().angular_rate) == 100
    without = read(by_hand(own, NEW))
    assert without.imus == ()
    assert len(without.notes) == 1


@pytest.mark.parametrize("encoding", ["ros2idl", "unknown"])
def test_a_definition_in_another_language_is_not_used(recording, by_hand, encoding):
    found = read(by_hand(recording, NEW, [(IMU, encoding, "module sensor_msgs { };")]))
    assert len(found.imu().angular_rate) == 100


def test_topics_of_unknown_types_are_noted(recording, by_hand):
    found = read(by_hand({**recording, "/camera": (IMAGE, [(T + i, b"\0\1\0\0pixels") for i in range(7)])}))
    assert len(found.imu().angular_rate) == 100
    (note,) = (note for note in found.notes if "/camera" in note)
    assert "7 messages of sensor_msgs/msg/Image" in note
    assert "--messages" not in note  # it has no quantity, whatever its definition


def test_the_recorders_time_counts_where_it_is_asked_for(recording, by_hand):
    found = read(by_hand(recording), ReadOptions(time_source="log"))
    assert found.imu().angular_rate.time.tolist() == [t for t, _ in recording["/imu"][1]]


def test_some_thousand_messages_come_in_pieces(recording, by_hand, monkeypatch):
    whole = read(by_hand(recording))
    monkeypatch.setattr(sqlite_rows, "ROWS", 7)
    seen = []
    parts = read(by_hand(recording), progress=lambda done, size: seen.append(done / size))
    assert_same(parts, whole)
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1, abs=0.1)
    assert len(seen) > 15


def test_messages_that_are_none_are_left_out(recording, by_hand):
    path = by_hand(recording)
    with closing(sqlite3.connect(path)) as base:
        rows = [(1, T, "text"), (1, -5, b"\0\1\0\0"), ("one", T, b""), (1, 2**63 - 1, b""), (99, T, b"\0\1\0\0")]
        base.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", rows)
        base.execute("INSERT INTO topics VALUES(77, x'ff00', 5, 'cdr', '')")
        base.commit()
    found = read(path)
    assert len(found.imu().angular_rate) == 100
    assert any("channel 99" in note for note in found.notes)


def test_names_with_odd_letters_do_no_harm(recording, by_hand, fresh):
    path = fresh("a ? b#c%41.db3")
    path.write_bytes(by_hand(recording).read_bytes())
    assert len(read(path).imu().angular_rate) == 100


def test_reading_changes_nothing(recording, by_hand):
    path = by_hand(recording)
    before = path.read_bytes()
    read(path)
    assert path.read_bytes() == before
    assert [one.name for one in path.parent.iterdir()] == [path.name]


# Other databases, and damaged ones


@pytest.mark.parametrize(
    ("tables", "why"),
    [
        ("CREATE TABLE people(name TEXT)", "no recording of ROS 2"),
        ("CREATE TABLE topics(name TEXT)", "no message can be read"),
        ("CREATE TABLE topics(id, name, type, serialization_format)", "no such table: messages"),
        (
            "CREATE TABLE topics(id, name, type, serialization_format); CREATE TABLE messages(a)",
            "no message can be read",
        ),
        (OLD, "empty"),
        (NEW, "empty"),
    ],
)
def test_a_database_without_messages_is_refused(fresh, tables, why):
    path = fresh("log.db3")
    with closing(sqlite3.connect(path)) as base:
        base.executescript(tables)
    with pytest.raises(UnreadableLogError, match=why):
        read(path)


def test_the_leading_bytes_decide(recording, by_hand, fresh):
    path = fresh("log.csv")
    path.write_bytes(by_hand(recording).read_bytes())
    assert reader_of(path).format == "db3"


def attempt(path):
    """Return how many IMU messages are read; None where that is refused."""
    began = time.perf_counter()
    try:
        found = read(path)
    except (UnreadableLogError, UsageError) as error:
        assert str(path) in str(error)  # noqa: PT017 - either may be right
        return None
    finally:
        assert time.perf_counter() - began < 5
    return len(found.imu().angular_rate) if found.imus else 0


@pytest.mark.slow
def test_cut_anywhere_what_can_be_read_is_read_or_refused(recording, by_hand, fresh):
    data, path = by_hand(recording, page=512).read_bytes(), fresh("cut.db3")
    counts = []
    for cut in np.random.default_rng(3).integers(16, len(data), 60):
        path.write_bytes(data[:cut])
        counts.append(attempt(path))
    assert None in counts
    assert all(count is None or count <= 100 for count in counts)


def test_a_recording_that_lacks_its_end_gives_its_beginning(recording, by_hand, fresh, monkeypatch):
    data, path = by_hand(recording, page=512).read_bytes(), fresh("cut.db3")
    monkeypatch.setattr(sqlite_rows, "ROWS", 8)
    path.write_bytes(data[: len(data) * 9 // 10])
    found = read(path)
    assert 20 < len(found.imu().angular_rate) < 100
    assert "cut" in ids(found.notes)


def test_a_damaged_name_in_the_schema_is_refused_or_passed_over(recording, by_hand, fresh):
    data, path = by_hand(recording).read_bytes(), fresh("log.db3")
    data = data.replace(b"tablemessages", b"tablemess\xccges", 1)
    path.write_bytes(data.replace(b"CREATE TABLE messages", b"CREATE TABLX messages", 1))
    assert attempt(path) is None


@pytest.mark.slow
def test_flipped_bits_never_raise_anything_else(recording, by_hand, fresh):
    data, rng, path = by_hand(recording).read_bytes(), np.random.default_rng(14), fresh("log.db3")
    counts = []
    for i in range(60):
        damaged = np.frombuffer(data, np.uint8).copy()
        end = 4096 if i % 2 else damaged.size  # the first page says what tables there are
        damaged[rng.integers(16, end, 20)] ^= (1 << rng.integers(0, 8, 20)).astype(np.uint8)
        path.write_bytes(damaged.tobytes())
        counts.append(attempt(path))
    assert sum(bool(count) for count in counts) > 10
