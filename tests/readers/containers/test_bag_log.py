"""Bags of ROS 1 are read like the same messages elsewhere, in every compression, and as far as they are whole."""

import re
import struct
import tracemalloc

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read
from imuwb.readers.bytes import source
from imuwb.readers.containers import bag_log, bag_records
from tests.readers.repairs import repairs

from .bag_writer import MAGIC, PACK, Topic, chunk, connection, fields, message, record, write_bag

T = 1_714_564_800 * 10**9
COUNT = 40


@pytest.fixture(scope="module")
def imu(ros):
    """Return a function that gives the payload of the i-th message, its stamp a microsecond before its record's time."""
    return lambda i: ros.imu(T + i - 1000, (float(i), 0.5, 0.25), (0, -1, 9.8), code=ros.ROS_1)


@pytest.fixture(scope="module")
def some(imu):
    """Return a function that gives the messages from ``first`` on, as records."""
    return lambda first, count=4: b"".join(message(0, T + i, imu(i)) for i in range(first, first + count))


@pytest.fixture(scope="module")
def declared(ros):
    return connection(0, ros.imu_1)


@pytest.fixture(scope="module")
def by_hand(fresh):
    def write(*records):
        path = fresh("log.bag")
        path.write_bytes(MAGIC + b"".join(records))
        return path

    return write


def numbers(log):
    """Return which of the messages were read."""
    if not log.imus:
        return []
    (imu,) = log.imus
    assert imu.angular_rate.value[:, 0].tolist() == (imu.angular_rate.time - T + 1000).tolist()
    return (imu.angular_rate.time - T + 1000).tolist()


# Whole bags


@pytest.mark.slow
@pytest.mark.parametrize("compression", PACK)
@pytest.mark.parametrize("size", [1, 2000, 1 << 20])
def test_every_compression_is_read(fresh, imu, compression, size):
    topic = Topic([(T + i, imu(i)) for i in range(COUNT)])
    path = write_bag(fresh("log.bag"), topic, compression=compression, chunk=size)
    assert path.read_bytes().count(b"op=\x05") == {1: COUNT, 2000: 7, 1 << 20: 1}[size]
    log = read(path)
    assert numbers(log) == list(range(COUNT))
    assert log.notes == ()
    assert log.imus[0].specific_force.value.tolist() == [[0, 1, -9.8]] * COUNT
    assert (log.provenance.format, log.imus[0].name, log.imus[0].origin.epoch) == ("bag", "/imu", "unix")


@pytest.mark.parametrize(("time_source", "late"), [("header", 0), ("log", 1000), ("publish", 1000)])
def test_the_time_that_is_asked_for_counts(by_hand, declared, some, time_source, late):
    (imu,) = read(by_hand(declared, some(0)), ReadOptions(time_source=time_source)).imus
    assert (imu.angular_rate.time - T + 1000).tolist() == [i + late for i in range(4)]


def test_messages_outside_of_chunks_and_chunks_may_mix(by_hand, declared, some):
    assert numbers(read(by_hand(declared, some(0), chunk(some(4), "lz4"), some(8), chunk(some(12), "bz2")))) == [
        *range(16)
    ]


def test_two_connections_of_one_topic_are_one_stream(fresh, imu):
    parts = [Topic([(T + i, imu(i)) for i in range(k, COUNT, 2)], callerid=f"/node{k}") for k in range(2)]
    path = write_bag(fresh("log.bag"), *parts)
    assert path.read_bytes().count(b"callerid=/node") == 4
    log = read(path)
    assert numbers(log) == list(range(COUNT))
    assert log.notes == ()


@pytest.mark.parametrize("step", [1000, 100_000_000])
def test_two_connections_of_one_topic_keep_the_files_order(fresh, ros, step):
    def payload(i):
        return ros.imu(T + i * step, (float(i), 0, 0), (0, 0, 9.8), code=ros.ROS_1)

    parts = [Topic([(T + i * step, payload(i)) for i in range(k, COUNT, 2)], callerid=f"/node{k}") for k in range(2)]
    (imu,) = read(write_bag(fresh("log.bag"), *parts)).imus
    assert imu.angular_rate.value[:, 0].tolist() == list(range(COUNT))
    assert (imu.angular_rate.time - T).tolist() == [i * step for i in range(COUNT)]
    assert imu.origin.repairs == ()


def test_two_topics_are_two_streams(fresh, imu):
    topics = [Topic([(T + i, imu(i)) for i in range(k)], f"/imu{k}") for k in (3, 5)]
    log = read(write_bag(fresh("log.bag"), *topics, compression="lz4"))
    assert {imu.name: len(imu.angular_rate) for imu in log.imus} == {"/imu3": 3, "/imu5": 5}


def test_a_topic_that_is_no_measurement_is_noted(by_hand, declared, some):
    other = connection(1, "string data\n", "/chat", "std_msgs/String")
    log = read(by_hand(declared, other, some(0), message(1, T, struct.pack("<I", 2) + b"hi")))
    assert numbers(log) == [0, 1, 2, 3]
    assert ids(log.notes) == ("unused",)
    assert "/chat: 1 message of std_msgs/String" in log.notes[0]


@pytest.mark.parametrize("block", [1, 100, 5000])
@pytest.mark.parametrize("compression", [None, *PACK])
def test_small_blocks_give_what_one_does(by_hand, declared, some, monkeypatch, block, compression):
    body = some(0, COUNT) if compression is None else chunk(some(0, 20), compression) + chunk(some(20, 20), compression)
    path = by_hand(declared, body, b"cut")
    whole = read(path)
    monkeypatch.setattr(source, "BLOCK", block)
    assert numbers(read(path)) == numbers(whole) == list(range(COUNT))
    assert read(path).notes == whole.notes


# The same run in another container


def test_the_bag_of_a_real_run_equals_its_mcap(shared):
    bag = read(shared / "mcap" / "robot_localization_test1.bag")
    mcap = read(shared / "mcap" / "husky_test1_ros1msg_lz4.mcap")
    ((ours,), (theirs,)) = bag.imus, mcap.imus
    for quantity in ("angular_rate", "specific_force"):
        assert getattr(ours, quantity).time.tolist() == getattr(theirs, quantity).time.tolist()
        assert getattr(ours, quantity).value.tolist() == getattr(theirs, quantity).value.tolist()
    ((ours,), (theirs,)) = bag.gnss, mcap.gnss
    assert ours.time.tolist() == theirs.time.tolist()
    assert ours.position.tolist() == theirs.position.tolist()
    ((ours,), (theirs,)) = bag.speeds, mcap.speeds
    assert (ours.name, ours.time.tolist(), ours.value.tolist()) == (
        theirs.name,
        theirs.time.tolist(),
        theirs.value.tolist(),
    )
    assert [len(bag.imus[0].angular_rate), len(bag.gnss[0]), len(bag.speeds[0])] == [11_865, 989, 3952]


@pytest.mark.slow
def test_the_bag_of_a_real_run_is_what_rosbags_reads(shared):
    rosbag1 = pytest.importorskip("rosbags.rosbag1", reason="rosbags, which reads bags, is not installed")
    path = shared / "mcap" / "robot_localization_test1.bag"
    (ours,) = read(path, ReadOptions(time_source="log")).gnss
    with rosbag1.Reader(path) as reader:
        rows = [(time, data) for c, time, data in reader.messages() if c.topic == "/fix"]
    assert ours.time.tolist() == [time for time, _ in rows]
    at = [16 + struct.unpack_from("<I", data, 12)[0] + 3 for _, data in rows]  # behind the header and the status
    theirs = [struct.unpack_from("<3d", data, a) for a, (_, data) in zip(at, rows, strict=True)]
    np.testing.assert_allclose(ours.position, np.array(theirs) * [np.pi / 180, np.pi / 180, 1], rtol=1e-14)


# Damage


@pytest.mark.parametrize("compression", PACK)
def test_cut_anywhere_what_was_whole_is_used(fresh, imu, compression):
    topic = Topic([(T + i, imu(i)) for i in range(COUNT)])
    data = write_bag(fresh("log.bag"), topic, compression=compression, chunk=3000).read_bytes()
    path, most = fresh("cut.bag"), 0
    body = data.index(b"op=\x05")
    for size in sorted({13, 14, 500, 4109, *range(body, len(data), max(1, len(data) // 40)), len(data) - 1}):
        path.write_bytes(data[:size])
        try:
            found = numbers(read(path))
        except UnreadableLogError as error:
            assert "no message can be read" in str(error)  # noqa: PT017 - either may be right
            found = []
        assert found == list(range(len(found)))
        assert len(found) >= most  # a longer file never gives less
        most = len(found)
    assert most == COUNT


def test_messages_before_the_cut_are_counted_to_the_byte(by_hand, declared, some):
    one = len(some(0, 1))
    for size in range(one, 4 * one, 25):
        path = by_hand(declared, some(0, 5)[:size])
        log = read(path)
        assert numbers(log) == list(range(size // one))
        begins = len(MAGIC + declared) + size // one * one
        figures = [[int(number) for number in re.findall(r"\d+", note)] for note in log.notes if note.id == "cut"]
        assert figures == [[path.stat().st_size, begins]] * bool(size % one)


@pytest.mark.parametrize(("compression", "least"), [("none", 600), ("bz2", 200), ("lz4", 500)])
def test_a_chunk_that_is_cut_gives_its_whole_messages(by_hand, declared, some, compression, least):
    noise = message(9, T, np.random.default_rng(1).bytes(1_000_000))  # packing cannot make it small
    data = chunk(some(0, 600) + noise, compression)
    found = numbers(read(by_hand(declared, data[:-200_000])))
    assert found == list(range(len(found)))
    assert least <= len(found) <= 600


@pytest.mark.slow
@pytest.mark.parametrize("compression", ["bz2", "lz4"])
def test_a_chunk_that_does_not_unpack_is_left_out_with_a_note(by_hand, declared, some, compression):
    bad = bytearray(chunk(some(4), compression))
    at = len(bad) - len(PACK[compression](some(4)))
    bad[at + 5] ^= 0xFF
    log = read(by_hand(declared, chunk(some(0), compression), bytes(bad), chunk(some(8), compression)))
    assert numbers(log) == [0, 1, 2, 3, 8, 9, 10, 11]
    (note,) = log.notes
    at += len(MAGIC + declared + chunk(some(0), compression))
    assert note.startswith(f"chunk at byte {at} left out: {compression} cannot unpack it (")


@pytest.mark.parametrize("compression", PACK)
@pytest.mark.parametrize("lie", [-1, 1, 1000, 10**6])
def test_a_chunk_that_lies_about_its_size_is_left_out(by_hand, declared, some, compression, lie):
    log = read(by_hand(declared, some(0), chunk(some(4), compression, len(some(4)) + lie)))
    assert numbers(log) == [0, 1, 2, 3]
    assert len(log.notes) == 1
    assert f" {len(some(4)) + lie} are stated" in log.notes[0]


@pytest.mark.parametrize("compression", PACK)
@pytest.mark.parametrize("size", [2**30 + 1, 2**32 - 1])
def test_a_chunk_that_claims_to_be_enormous_is_not_unpacked(by_hand, declared, some, compression, size):
    path = by_hand(declared, chunk(some(0), compression), chunk(some(4), compression, size))
    tracemalloc.start()
    log = read(path)
    assert tracemalloc.get_traced_memory()[1] < 50 << 20
    tracemalloc.stop()
    assert numbers(log) == [0, 1, 2, 3]
    assert re.search(f"{size} bytes .* {2**30}$", log.notes[0])


def test_a_cut_chunk_that_claims_to_be_enormous_is_not_unpacked(by_hand, declared, some):
    log = read(by_hand(declared, some(0), chunk(some(4, 100), "lz4", 2**32 - 1)[:-10]))
    assert numbers(log) == [0, 1, 2, 3]


def test_a_compression_nobody_knows_is_named(by_hand, declared, some):
    bad = record(b"12345", op=b"\x05", compression=b"brotli", size=struct.pack("<I", 5))
    log = read(by_hand(declared, some(0), bad))
    assert numbers(log) == [0, 1, 2, 3]
    assert re.search("'brotli'.* zstd, lz4, bz2 and none", log.notes[0])


def test_bytes_behind_a_chunks_last_record_are_noted(by_hand, declared, some):
    log = read(by_hand(declared, chunk(some(0) + b"junk!")))
    assert numbers(log) == [0, 1, 2, 3]
    assert (log.notes[0].id, " 5 bytes" in log.notes[0]) == ("chunk_end", True)


def test_a_connection_without_a_type_is_left_out_with_its_messages(by_hand, declared, some, imu):
    bad = record(fields(topic=b"/imu"), op=b"\x07", conn=struct.pack("<I", 5), topic=b"/imu")
    log = read(by_hand(declared, bad, some(0), message(5, T, imu(9))))
    assert numbers(log) == [0, 1, 2, 3]
    assert ids(log.notes) == ("damaged_record", "undeclared")
    assert log.notes[1].startswith("1 messages of channel 5,")


@pytest.mark.parametrize("header", [{}, {"conn": b"\0"}, {"conn": bytes(8)}])
def test_a_connection_without_a_number_is_left_out(by_hand, declared, some, header):
    bad = record(fields(type=b"a/B", message_definition=b""), op=b"\x07", topic=b"/b", **header)
    log = read(by_hand(bad, declared, some(0)))
    assert numbers(log) == [0, 1, 2, 3]
    assert ids(log.notes) == ("damaged_record",)


def test_a_connection_may_lack_its_inner_topic(ros, by_hand, some):
    inner = fields(type=b"sensor_msgs/Imu", message_definition=ros.imu_1.encode())
    declared = record(inner, op=b"\x07", conn=bytes(4), topic=b"/outer")
    assert read(by_hand(declared, some(0))).imus[0].name == "/outer"


def test_a_connection_without_a_definition_is_noted(by_hand, declared, some, imu):
    bare = record(fields(type=b"my_msgs/Own", topic=b"/bare"), op=b"\x07", conn=struct.pack("<I", 5), topic=b"/bare")
    log = read(by_hand(declared, bare, some(0), message(5, T, imu(9))))
    assert numbers(log) == [0, 1, 2, 3]
    assert ids(log.notes) == ("unused",)
    assert "/bare: 1 message of my_msgs/Own" in log.notes[0]
    assert "--messages" in log.notes[0]


def test_a_connection_of_a_known_type_needs_no_definition(by_hand, some):
    bare = record(fields(type=b"sensor_msgs/Imu", topic=b"/imu"), op=b"\x07", conn=bytes(4), topic=b"/imu")
    assert numbers(read(by_hand(bare, some(0)))) == [0, 1, 2, 3]


@pytest.mark.parametrize("header", [{}, {"conn": bytes(4)}, {"time": bytes(8)}, {"conn": bytes(3), "time": bytes(8)}])
def test_a_message_without_its_connection_or_time_is_left_out(by_hand, declared, some, imu, header):
    assert numbers(read(by_hand(declared, some(0), record(imu(9), op=b"\x02", **header), some(4)))) == list(range(8))


def test_a_message_that_is_too_short_is_left_out_and_counted(by_hand, declared, some, imu):
    log = read(by_hand(declared, some(0), message(0, T, imu(9)[:100])))
    assert numbers(log) == [0, 1, 2, 3]
    assert repairs(log.imus[0]) == {"no_fit": 1}


@pytest.mark.parametrize("records", [(), (bytes(8),), (b"\xff" * 100,)])
def test_a_bag_without_messages_is_refused(by_hand, records):
    with pytest.raises(UnreadableLogError, match="no message can be read: "):
        read(by_hand(*records))


def test_a_bag_of_an_older_version_is_none():
    assert not bag_log.probe(b"#ROSBAG V1.2\n" + bytes(100))


@pytest.mark.parametrize("digits", [20, 5000])
def test_a_definition_of_an_impossible_array_is_no_crash(ros, by_hand, declared, some, imu, digits):
    bad = connection(5, f"float64[{'9' * digits}] a\nstring b\n{ros.imu_1}", "/bad")
    assert numbers(read(by_hand(declared, bad, some(0), message(5, T, imu(9))))) == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("schema", "lines"), [("a/MotorTemperature", "float64[4] temperature"), ("a/Fence", "float64[2] latitude\nfloat64[2] longitude")]
)  # fmt: skip
def test_arrays_are_not_the_numbers_of_their_name(by_hand, declared, some, schema, lines):
    payload = struct.pack("<4d", 1, 2, 3, 4)
    log = read(by_hand(declared, connection(5, lines, "/other", schema), some(0), message(5, T, payload)))
    assert numbers(log) == [0, 1, 2, 3]
    assert log.gnss == ()


def test_flipped_bits_give_a_result_or_an_error_of_ours(fresh, declared, some):
    chance, path = np.random.default_rng(1), fresh("log.bag")
    chunks = (chunk(declared + some(0), "lz4"), chunk(some(4), "bz2"), chunk(some(8)))
    sound, count = MAGIC + declared + b"".join(chunks) + some(12), 0
    for _ in range(60):
        damaged = bytearray(sound)
        for _ in range(chance.integers(1, 6)):
            damaged[chance.integers(len(MAGIC), len(sound))] ^= 1 << int(chance.integers(8))
        path.write_bytes(damaged)
        try:
            log = read(path)
        except UnreadableLogError:
            continue
        count += 1
        assert sum(len(imu.angular_rate) for imu in log.imus) <= 16
    assert count > 50


# The parts


def test_walking_finds_every_whole_record(some):
    first, second = message(7, T, b"abc"), record(b"", op=b"\x04")
    found = bag_records.walk(np.frombuffer(first + second + b"\x05\x00", np.uint8))
    assert found.opcode.tolist() == [2, 4]
    assert found.length.tolist() == [3, 0]
    assert found.data.tolist() == [len(first) - 3, len(first + second)]
    assert (found.connection >= 0).tolist() == (found.time >= 0).tolist() == [True, False]
    assert found.end == len(first + second)


@pytest.mark.parametrize("data", [b"", b"\x05", b"\xff" * 8, b"\xff" * 100, message(7, T, b"abc")[:-1]])
def test_walking_finds_nothing_where_nothing_is_whole(data):
    found = bag_records.walk(np.frombuffer(data, np.uint8))
    assert found.opcode.size == found.end == 0


@pytest.mark.parametrize("compression", ["none", "lz4"])
def test_bytes_read_grow_to_the_files_end(by_hand, declared, some, compression):
    path = by_hand(declared, *(chunk(some(20 * i, 20), compression) for i in range(5)))
    seen = [messages.bytes_read for messages in bag_records.Bag(path).messages()]
    assert len(seen) == 5
    assert seen == sorted(seen)
    assert seen[-1] <= path.stat().st_size
