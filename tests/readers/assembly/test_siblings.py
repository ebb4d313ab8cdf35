"""Velocities and temperatures find the stream that they are of, and are left out with a note where they find none."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.log import GnssStream
from imuwb.notes import ids
from imuwb.readers import read
from imuwb.readers.assembly.siblings import sibling, with_fix_rows
from tests.readers.containers.bag_writer import FIX, TWIST, Topic, typestore, write_bag

T = 1_714_564_800 * 10**9
STEP = 100_000_000


def receiver(count=20, name="/fix", velocity=None, **parts):
    time = T + STEP * np.arange(count)
    position = np.stack([np.linspace(0.8, 0.9, count), np.zeros(count), np.arange(count)], axis=1)
    return GnssStream(name, time, position, velocity, **parts)


def joined(gnss, time, topic="/fix_velocity"):
    """Return the receiver with velocities whose north counts the times."""
    time = np.array(time, np.int64)
    velocity = np.stack([np.arange(time.size), np.zeros(time.size), np.ones(time.size)], axis=1)
    (found,), note = with_fix_rows((gnss,), topic, time, {"velocity": velocity})
    return found, note


# Names


@pytest.mark.parametrize(
    ("topic", "names", "found"),
    [
        ("/vel", ["/fix"], "/fix"),
        ("/gps/vel", ["/imu/a", "/gps/a"], "/gps/a"),
        ("/a/b/vel", ["/a/c/fix", "/a/b/fix"], "/a/b/fix"),
        ("/vel", ["/a/fix", "/b/fix"], None),
        ("/c/vel", ["/a/fix", "/b/fix"], None),
        ("/vel", [], None),
    ],
)
def test_the_sibling_shares_most_of_the_path(topic, names, found):
    assert sibling(topic, names) == found


# Times


def test_each_fix_takes_the_velocity_nearest_in_time():
    gnss = receiver(4)
    time = T + np.array([-40, 30, 60, 105, 220, 260, 300]) * 1_000_000
    found, note = joined(gnss, time)
    assert found.velocity[:, 0].tolist() == [1, 3, 4, 6]
    assert note.id == "fix_rows_joined"
    assert note.startswith("/fix_velocity: ")
    assert found.origin.repairs == ()


@pytest.mark.parametrize("off", [-51, -50, 0, 50, 51])
def test_within_half_an_interval_and_no_further(off):
    gnss = receiver()
    time = gnss.time + np.where(np.arange(20) == 10, off * 1_000_000, 0)
    found, _ = joined(gnss, time)
    assert len(found) == 20
    assert np.isfinite(found.velocity[:, 0]).tolist() == [i != 10 or abs(off) <= 50 for i in range(20)]


@pytest.mark.parametrize("missing", [[3], [0], [19], [5, 6]])
def test_of_few_fixes_without_a_velocity_it_is_unknown(missing):
    kept = [i for i in range(20) if i not in missing]
    gnss = receiver(fix_type=np.arange(20), position_sigma=np.ones((20, 3)))
    found, note = joined(gnss, gnss.time[kept])
    assert found.time.tolist() == gnss.time.tolist()
    assert found.position.tolist() == gnss.position.tolist()
    assert found.fix_type.tolist() == list(range(20))
    assert found.velocity[kept, 0].tolist() == list(range(len(kept)))
    assert np.isnan(found.velocity[missing]).all()
    assert note.id == "fix_rows_joined"
    assert f"{len(missing)} fixes" in note


def test_where_many_fixes_have_none_the_velocity_is_left_out():
    gnss = receiver()
    found, note = joined(gnss, gnss.time[:17])
    assert found is gnss
    assert note.id == "fix_rows_left_out"
    assert "17 of 20 fixes" in note


@pytest.mark.parametrize("count", [1, 2])
def test_one_velocity_is_enough_for_one_fix(count):
    found, _ = joined(receiver(1), T + STEP * np.arange(count))
    assert found.velocity[:, 0].tolist() == [0]


def test_a_receiver_that_has_a_velocity_keeps_it():
    gnss = receiver(velocity=np.full((20, 3), 7.0))
    found, note = joined(gnss, gnss.time)
    assert found is gnss
    assert note.id == "fix_rows_left_out"


def test_of_two_receivers_only_the_sibling_gets_it():
    streams = receiver(name="/a/fix"), receiver(name="/b/fix")
    found, note = with_fix_rows(streams, "/b/vel", streams[0].time, {"velocity": np.ones((20, 3))})
    assert [gnss.velocity is None for gnss in found] == [True, False]
    assert [gnss.name for gnss in found] == ["/a/fix", "/b/fix"]
    assert note.id == "fix_rows_joined"
    assert re.match(r"/b/vel: .* /b/fix", note)


def test_no_receivers_get_none():
    streams, note = with_fix_rows((), "/vel", np.array([T]), {"velocity": np.ones((1, 3))})
    assert (streams, note.id) == ((), "fix_rows_left_out")


# In logs


@pytest.fixture(scope="module")
def messages():
    """Return functions that make messages of ROS 1 and put them on the wire, by rosbags."""
    store = typestore()
    types = store.types

    def header(i):
        time = types["builtin_interfaces/msg/Time"](*divmod(T + STEP * i, 10**9))
        return types["std_msgs/msg/Header"](seq=i, stamp=time, frame_id="gps")

    def fix(i):
        status = types["sensor_msgs/msg/NavSatStatus"](status=0, service=1)
        return types[FIX](header(i), status, 45.0, 90.0, 100.0 + i, np.diag([1.0, 4, 9]).ravel(), 2)

    def twist(i, x, y, z):
        vector = types["geometry_msgs/msg/Vector3"]
        return types[TWIST](header(i), types["geometry_msgs/msg/Twist"](vector(x, y, z), vector(7, 8, 9)))

    def topic(name, schema, rows):
        wire = [(T + STEP * i, bytes(store.serialize_ros1(row, schema))) for i, row in rows]
        return Topic(wire, name, schema)

    return SimpleNamespace(
        fixes=lambda name="/fix", count=20: topic(name, FIX, [(i, fix(i)) for i in range(count)]),
        twists=lambda name, count=20: topic(name, TWIST, [(i, twist(i, 1.0 + i, 2.0, 3.0)) for i in range(count)]),
        definition=lambda schema: store.generate_msgdef(schema)[0],
    )


@pytest.fixture(scope="module", params=["bag", "mcap"])
def logged(request, fresh, mcap, messages):
    """Return a function that reads topics out of a bag, or out of an MCAP file."""

    def log(*topics):
        if request.param == "bag":
            return read(write_bag(fresh("log.bag"), *topics, compression="lz4"))
        return read(
            mcap.write(*(
                mcap.Topic(
                    t.messages, t.topic, t.schema.replace("/msg/", "/"), messages.definition(t.schema), "ros1msg", "ros1"
                )
                for t in topics
            ))
        )  # fmt: skip

    return log


@pytest.mark.parametrize("topic", ["/fix_velocity", "/gps/vel", "/ublox/twist"])
def test_fixes_and_their_velocities_become_one_stream_in_ned(logged, messages, topic):
    log = logged(messages.fixes(), messages.twists(topic))
    (gnss,) = log.gnss
    assert gnss.name == "/fix"
    assert gnss.velocity.tolist() == [[2, 1 + i, -3] for i in range(20)]
    np.testing.assert_allclose(gnss.position, [[np.pi / 4, np.pi / 2, 100 + i] for i in range(20)], rtol=1e-15)
    assert gnss.position_sigma.tolist() == [[2, 1, 3]] * 20
    assert gnss.time.tolist() == [T + STEP * i for i in range(20)]
    assert log.speeds == ()
    assert ids(log.notes) == ("fix_rows_joined",)
    assert log.notes[0].startswith(f"{topic}: ")


@pytest.mark.parametrize("topic", ["/cmd_vel", "/wheels/twist"])
def test_a_velocity_of_the_body_is_a_speed(logged, messages, topic):
    log = logged(messages.fixes(), messages.twists(topic))
    (speed,) = log.speeds
    assert (speed.name, speed.value.tolist()) == (topic, [1.0 + i for i in range(20)])
    assert speed.time.tolist() == [T + STEP * i for i in range(20)]
    assert log.gnss[0].velocity is None


def test_fixes_behind_the_last_velocity_have_none(logged, messages):
    log = logged(messages.fixes(), messages.twists("/fix_velocity", 19))
    (gnss,) = log.gnss
    assert np.isfinite(gnss.velocity[:, 0]).tolist() == [True] * 19 + [False]
    assert ids(log.notes) == ("fix_rows_joined",)
    assert "1 fixes" in log.notes[0]


def test_a_velocity_for_half_the_fixes_is_left_out(logged, messages):
    log = logged(messages.fixes(), messages.twists("/fix_velocity", 10))
    assert len(log.gnss[0]) == 20
    assert log.gnss[0].velocity is None
    assert ids(log.notes) == ("fix_rows_left_out",)
    assert "10 of 20 fixes" in log.notes[0]


def test_a_velocity_alone_is_left_out_with_a_note(logged, messages):
    log = logged(messages.twists("/fix_velocity"))
    assert log.gnss == ()
    assert ids(log.notes) == ("fix_rows_left_out",)


def test_a_prefix_makes_no_receiver(logged, messages):
    assert [speed.name for speed in logged(messages.twists("/prefix/cmd_vel")).speeds] == ["/prefix/cmd_vel"]
