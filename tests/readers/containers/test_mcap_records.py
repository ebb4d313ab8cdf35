import struct
import zlib

import lz4.frame
import numpy as np
import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, IndexType

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import read
from imuwb.readers.containers import mcap_records
from imuwb.readers.containers.mcap_records import MAGIC, Recording, walk

T = 1_714_564_800 * 10**9
COUNT = 40
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, ATTACHMENT, METADATA, DATA_END = 2, 3, 4, 5, 6, 9, 12, 15
PACK = {"": bytes, "zstd": zstandard.compress, "lz4": lz4.frame.compress}


def record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def message(channel, time, payload):
    return record(MESSAGE, struct.pack("<HIQQ", channel, 0, time, time) + payload)


def chunk(records, compression="", size=None, crc=None, packed=None):
    packed = PACK[compression](records) if packed is None else packed
    size = len(records) if size is None else size
    crc = zlib.crc32(records) if crc is None else crc
    head = struct.pack("<QQQI", 0, 0, size, crc)
    return record(CHUNK, head + text(compression) + struct.pack("<Q", len(packed)) + packed)


@pytest.fixture(scope="module")
def declared(ros):
    definition = struct.pack("<I", len(ros.imu_2)) + ros.imu_2.encode()
    schema = record(SCHEMA, struct.pack("<H", 1) + text("sensor_msgs/msg/Imu") + text("ros2msg") + definition)
    return schema + record(CHANNEL, struct.pack("<HH", 1, 1) + text("/imu") + text("cdr") + struct.pack("<I", 0))


@pytest.fixture(scope="module")
def some(ros):
    """Return a function that gives the messages from ``first`` on, as records."""

    def messages(first, count=4):
        stamps = range(first, first + count)
        return b"".join(message(1, T + i, ros.imu(T + i, (float(i), 0, 0), (0, 0, 9.8))) for i in stamps)

    return messages


@pytest.fixture(scope="module")
def by_hand(fresh):
    def write(*records, end=True):
        path = fresh("log.mcap")
        path.write_bytes(
            MAGIC + b"".join(records) + (record(DATA_END, bytes(4)) + record(FOOTER, bytes(20)) + MAGIC if end else b"")
        )
        return path

    return write


def numbers(log):
    """Return which of the messages were read."""
    if not log.imus:
        return []
    (imu,) = log.imus
    assert imu.angular_rate.value[:, 0].tolist() == (imu.angular_rate.time - T).tolist()
    return (imu.angular_rate.time - T).tolist()


LAYOUTS = {
    "unchunked": {"use_chunking": False},
    "none": {"compression": CompressionType.NONE},
    "lz4": {"compression": CompressionType.LZ4},
    "zstd": {"compression": CompressionType.ZSTD},
    "small chunks": {"compression": CompressionType.ZSTD, "chunk_size": 2000},
    "no summary": {
        "compression": CompressionType.ZSTD, "index_types": IndexType.NONE, "repeat_channels": False,
        "repeat_schemas": False, "use_statistics": False, "use_summary_offsets": False, "enable_crcs": False,
    },
}  # fmt: skip


@pytest.fixture(params=LAYOUTS)
def whole(request, mcap, ros):
    messages = [(T + i, ros.imu(T + i, (float(i), 0, 0), (0, 0, 9.8))) for i in range(COUNT)]
    return mcap.write(mcap.Topic(messages), **LAYOUTS[request.param])


@pytest.mark.slow
def test_every_layout_is_read(whole):
    log = read(whole)
    assert numbers(log) == list(range(COUNT))
    assert log.notes == ()


@pytest.mark.slow
def test_cut_anywhere_what_was_whole_is_used(whole, fresh):
    data, path, most = whole.read_bytes(), fresh("cut.mcap"), 0
    for size in sorted({*range(8, len(data), max(1, len(data) // 60)), *range(8, 40), len(data) - 1}):
        path.write_bytes(data[:size])
        try:
            log = read(path)
        except UnreadableLogError as error:
            assert "no message can be read" in str(error)  # noqa: PT017 - either may be right
            found = []
        else:
            found = numbers(log)
        assert found == list(range(len(found)))
        assert len(found) >= most  # a longer file never gives less
        most = len(found)
    assert most == COUNT


def test_messages_before_the_cut_are_counted_to_the_byte(declared, some, by_hand):
    size = len(some(0, 1))
    log = read(by_hand(declared, some(0, 10)[: 7 * size + size // 2], end=False))
    assert numbers(log) == list(range(7))
    assert "cut" in ids(log.notes)


def test_a_small_chunk_that_is_cut_gives_its_whole_messages(declared, some, by_hand):
    assert numbers(read(by_hand(declared, chunk(some(0, 3))[:-10], end=False))) == [0, 1]


@pytest.mark.parametrize("compression", PACK)
def test_a_chunk_that_is_cut_gives_its_whole_messages(declared, some, by_hand, compression):
    rng = np.random.default_rng(1)
    noise = record(
        MESSAGE, struct.pack("<HIQQ", 9, 0, 0, 0) + rng.bytes(300_000)
    )  # so that packing cannot hide the cut
    data = chunk(some(0, 200) + noise + some(200, 200) + noise, compression)
    log = read(by_hand(declared, data[:-200_000], end=False))
    found = numbers(log)
    assert found == list(range(len(found)))
    assert 200 <= len(found) <= 400


def test_a_file_that_ends_between_records_is_noted(declared, some, by_hand):
    log = read(by_hand(declared, some(0), end=False))
    assert numbers(log) == [0, 1, 2, 3]
    assert "no_end_mark" in ids(log.notes)


def test_what_follows_the_end_mark_is_not_read(declared, some, by_hand):
    log = read(by_hand(declared, some(0), record(DATA_END, bytes(4)), some(4)))
    assert numbers(log) == [0, 1, 2, 3]


@pytest.mark.parametrize("compression", PACK)
def test_a_chunk_with_a_wrong_checksum_is_left_out_with_a_note(declared, some, by_hand, compression):
    bad = chunk(some(4), compression, crc=1)
    log = read(by_hand(declared, chunk(some(0), compression), bad, chunk(some(8), compression)))
    assert numbers(log) == [0, 1, 2, 3, 8, 9, 10, 11]
    (note,) = log.notes
    at = len(MAGIC + declared + chunk(some(0), compression)) + 9
    assert (note.id, f"byte {at} " in note) == ("chunk_left_out", True)


def test_a_checksum_of_zero_is_none(declared, some, by_hand):
    assert numbers(read(by_hand(declared, chunk(some(0), crc=0)))) == [0, 1, 2, 3]


@pytest.mark.parametrize("compression", PACK)
@pytest.mark.parametrize("lie", [-1, 1, 1000, 10**6])
def test_a_chunk_that_lies_about_its_size_is_left_out(declared, some, by_hand, compression, lie):
    bad = chunk(some(4), compression, size=len(some(4)) + lie)
    log = read(by_hand(declared, chunk(some(0)), bad))
    assert numbers(log) == [0, 1, 2, 3]
    assert ids(log.notes) == ("chunk_left_out",)


@pytest.mark.parametrize("compression", PACK)
def test_a_chunk_that_claims_to_be_enormous_is_not_unpacked(declared, some, by_hand, compression):
    log = read(by_hand(declared, chunk(some(0)), chunk(some(4), compression, size=2**40)))
    assert numbers(log) == [0, 1, 2, 3]
    assert f"{2**40} bytes" in log.notes[0]


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_packed_bytes_that_are_none_are_left_out(declared, some, by_hand, compression):
    log = read(by_hand(declared, chunk(some(0)), chunk(some(4), compression, packed=b"not packed at all" * 5)))
    assert numbers(log) == [0, 1, 2, 3]
    assert len(log.notes) == 1


def test_a_compression_nobody_knows_is_named(declared, some, by_hand):
    bad = record(CHUNK, struct.pack("<QQQI", 0, 0, 5, 0) + text("brotli") + struct.pack("<Q", 5) + b"12345")
    log = read(by_hand(declared, some(0), bad))
    assert numbers(log) == [0, 1, 2, 3]
    assert "'brotli'" in log.notes[0]


@pytest.mark.parametrize("content", [b"", b"short", bytes(28) + b"\xff\xff\xff\xff"])
def test_a_chunk_whose_header_is_damaged_is_left_out(declared, some, by_hand, content):
    log = read(by_hand(declared, some(0), record(CHUNK, content), some(4)))
    assert numbers(log) == list(range(8))
    assert len(log.notes) == 1


def test_bytes_behind_a_chunks_last_record_are_noted(declared, some, by_hand):
    log = read(by_hand(declared, chunk(some(0) + b"\x05junk")))
    assert numbers(log) == [0, 1, 2, 3]
    assert (log.notes[0].id, " 5 bytes" in log.notes[0]) == ("chunk_end", True)


def test_a_schema_inside_a_chunk_counts(declared, some, by_hand):
    assert numbers(read(by_hand(chunk(declared + some(0), "zstd")))) == [0, 1, 2, 3]


def test_messages_of_a_channel_nobody_declared_are_noted(declared, some, by_hand):
    log = read(by_hand(declared, some(0), message(77, T, b"x")))
    assert numbers(log) == [0, 1, 2, 3]
    assert len(log.notes) == 1
    assert (log.notes[0].id, "channel 77" in log.notes[0]) == ("undeclared", True)


@pytest.mark.parametrize("opcode", [SCHEMA, CHANNEL])
@pytest.mark.parametrize("content", [b"", b"\x01\x00\xff\xff\xff\xff", b"\x09\x00\x01\x00\x40\x00\x00\x00abc"])
def test_a_damaged_declaration_is_left_out_with_a_note(declared, some, by_hand, opcode, content):
    log = read(by_hand(record(opcode, content), declared, some(0)))
    assert numbers(log) == [0, 1, 2, 3]
    assert log.notes[0].id == "damaged_record"


def test_records_nobody_knows_are_passed_over(declared, some, by_hand):
    log = read(by_hand(record(0x80, b"private"), declared, some(0), record(0x09, bytes(100)), some(4)))
    assert numbers(log) == list(range(8))


@pytest.mark.parametrize("length", [2**63, 2**64 - 1, 10**9])
def test_a_record_that_claims_more_than_the_file_holds_ends_the_reading(declared, some, by_hand, length):
    log = read(by_hand(declared, some(0), struct.pack("<BQ", MESSAGE, length), some(4)))
    assert numbers(log) == [0, 1, 2, 3]
    assert log.notes[0].id == "cut"


def test_a_record_larger_than_a_block_is_passed_over(declared, some, by_hand):
    attachment = record(0x09, bytes(9 << 20))
    assert numbers(read(by_hand(declared, some(0), attachment, some(4)))) == list(range(8))


@pytest.mark.parametrize("data", [MAGIC, MAGIC + b"\x01", MAGIC + bytes(9)])
def test_a_file_of_little_more_than_its_magic_is_refused(fresh, data):
    path = fresh("log.mcap")
    path.write_bytes(data)
    with pytest.raises(UnreadableLogError, match="no message can be read"):
        read(path)


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(st.data())
def test_damaged_bytes_never_raise_anything_else(declared, some, fresh, data):
    sound = MAGIC + declared + chunk(some(0, 2), "zstd") + chunk(some(2, 2), "lz4") + chunk(some(4, 2)) + some(6, 2)
    damaged = bytearray(sound)
    for _ in range(data.draw(st.integers(1, 4))):
        damaged[data.draw(st.integers(len(MAGIC), len(sound) - 1))] = data.draw(st.integers(0, 255))
    path = fresh("log.mcap")
    path.write_bytes(damaged)
    try:
        log = read(path)
    except UnreadableLogError:
        return
    assert sum(len(triad) for imu in log.imus for triad in imu.sensors().values()) <= 16


# The parts


def test_walking_finds_every_whole_record():
    data = record(3, b"abc") + record(6, b"") + record(7, b"not read") + record(5, b"short") + record(9, b"x" * 300)
    opcode, content, length, end = walk(np.frombuffer(data + b"\x05\x00", np.uint8))
    assert opcode.tolist() == [3, 6, 9]  # kinds that are read, and whole messages
    assert content.tolist() == [9, 21, 61]
    assert length.tolist() == [3, 0, 300]
    assert end == len(data)


@pytest.mark.parametrize("data", [b"", b"\x05", b"\x05" * 8, b"\x05" + b"\xff" * 8, record(5, b"abc")[:-1]])
def test_walking_finds_nothing_where_nothing_is_whole(data):
    opcode, _, _, end = walk(np.frombuffer(data, np.uint8))
    assert opcode.size == end == 0


def test_bytes_read_grow_to_the_files_end(declared, some, by_hand):
    path = by_hand(declared, *(chunk(some(4 * i)) for i in range(5)))
    seen = [messages.bytes_read for messages in Recording(path).messages()]
    assert len(seen) == 5
    assert seen == sorted(seen)
    assert seen[-1] <= path.stat().st_size


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda data: data, ""),
        (lambda data: data[:-1], "end mark at byte"),
        (lambda data: data[:-8] + b"12345678", "end mark at byte"),
        (lambda data: data + b"more" * 5, "20 bytes after"),
        (lambda data: data[:-30], "index"),
    ],
    ids=["whole", "a byte short", "another mark", "more", "cut"],
)
def test_the_end_after_the_messages_is_checked(whole, change, text):
    whole.write_bytes(change(whole.read_bytes()))
    log = read(whole)
    assert numbers(log) == list(range(COUNT))
    assert [(note.id, text in note) for note in log.notes] == ([("end_damaged", True)] if text else [])


def test_damaged_metadata_are_noted(by_hand, declared, some):
    damaged = record(METADATA, text("imuwb") + struct.pack("<I", 50) + text("/fix") + struct.pack("<I", 99))
    log = read(by_hand(declared, damaged, some(0)))
    assert numbers(log) == [0, 1, 2, 3]
    assert ids(log.notes) == ("damaged_record",)


def attachment(name, media_type, data):
    content = struct.pack("<QQ", 0, 0) + text(name) + text(media_type) + struct.pack("<Q", len(data)) + data
    return record(ATTACHMENT, content + bytes(4))


def test_metadata_and_attachments_of_others_are_named_in_one_note(by_hand, declared, some):
    entries = text("driver") + text("1.2") + text("vehicle") + text("van")
    others = [
        record(METADATA, text("theirs") + struct.pack("<I", len(entries)) + entries),
        attachment("calibration.yaml", "text/yaml", bytes(100)),
        attachment("map", "", bytes(200_000)),
    ]
    log = read(by_hand(declared, *others, some(0)))
    assert numbers(log) == [0, 1, 2, 3]
    assert ids(log.notes) == ("unused",)
    for part in ("theirs (driver, vehicle)", "calibration.yaml (text/yaml, 100 bytes)", "map (200000 bytes)"):
        assert part in log.notes[0]


@pytest.mark.parametrize("size", [8, 30, 60])
def test_a_damaged_attachment_is_noted(by_hand, declared, some, size):
    whole = attachment("calibration.yaml", "text/yaml", bytes(100))
    log = read(by_hand(declared, record(ATTACHMENT, whole[9 : 9 + size]), some(0)))
    assert numbers(log) == [0, 1, 2, 3]
    assert len(log.notes) == 1


def test_records_are_found_the_same_with_and_without_the_compiler(declared, some, monkeypatch):
    buffer = np.frombuffer(declared + some(0, 20) + b"\x05\x00", np.uint8)
    found = []
    for answer in (False, True):
        monkeypatch.setattr(mcap_records, "worth_compiling", lambda _, answer=answer: answer)
        found.append([np.asarray(table).tolist() for table in walk(buffer)])
    assert found[0] == found[1]
    assert len(found[0][0]) > 20
