"""Messages of PX4's logs equal those that pyulog finds; damage costs what it hits."""

import bisect
import itertools
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.readers.flight.ulog_records import ULogFile, layout, segments, walk
from imuwb.readers.flight.ulog_streams import WANTED
from tests.readers.flight import ulog_writer as px4

FILES = ("pyulog_sample.ulg", "pyulog_sample_appended_multiple.ulg", "pyulog_sample_log_small.ulg", "roboto_test.ulg")
INNER, OUTER = "uint8_t a;float b;", "uint64_t timestamp;inner[2] parts;inner one;uint16_t[3] list;"


def taken(data, wanted=WANTED):
    log = ULogFile()
    log.take(np.frombuffer(data, np.uint8), frozenset(wanted))
    return log


def topic(log, name):
    ((_, columns),) = log.topics(name)
    return columns


@pytest.fixture(scope="module", params=FILES)
def real(request, shared):
    path = shared / "ulog" / request.param
    columns, told = px4.heard(path)
    names = frozenset(name for name, _ in columns)
    return taken(path.read_bytes(), names), columns, told


@pytest.mark.slow
def test_every_topic_and_column_equals_pyulogs(real):
    log, columns, _ = real
    names = {name for name, _ in columns}
    found = {(name, instance): fields for name in names for instance, fields in log.topics(name)}
    assert found.keys() == columns.keys()
    assert len(found) > 5
    for key, fields in columns.items():
        wanted = {name: values for name, values in fields.items() if "_padding" not in name}
        assert found[key].keys() == wanted.keys(), key
        for name, values in wanted.items():
            np.testing.assert_array_equal(found[key][name], values, err_msg=f"{key}.{name}")
            assert values.ndim != 1 or found[key][name].dtype.kind in (values.dtype.kind, "u")


def test_dropouts_are_pyulogs(real):
    log, _, told = real
    assert log.dropouts == [one.duration for one in told.dropouts]
    assert log.misfits == 0


@given(st.data())
@settings(deadline=None, max_examples=60)
def test_every_type_is_what_struct_unpacks(data):
    kinds = data.draw(st.lists(st.sampled_from(list(px4.TYPES)), min_size=1, max_size=6))
    counts = data.draw(st.lists(st.sampled_from([0, 1, 3]), min_size=len(kinds), max_size=len(kinds)))
    text = "".join(
        f"{kind}{f'[{n}]' if n else ''} f{i};" for i, (kind, n) in enumerate(zip(kinds, counts, strict=True))
    )
    sizes = [struct.calcsize(px4.TYPES[kind]) * max(n, 1) for kind, n in zip(kinds, counts, strict=True)]
    rows = [data.draw(st.binary(min_size=sum(sizes), max_size=sum(sizes))) for _ in range(3)]
    log = taken(
        px4.HEADER + px4.flags() + px4.defined("any", text) + px4.added("any", 7)
        + b"".join(px4.message("D", b"\x07\0" + row) for row in rows), {"any"},
    )  # fmt: skip
    columns = topic(log, "any")
    for i, (kind, n, size) in enumerate(zip(kinds, counts, sizes, strict=True)):
        at = sum(sizes[:i])
        code = "B" if kind == "bool" else px4.TYPES[kind]
        told = np.array([struct.unpack(f"<{max(n, 1)}{code}", row[at : at + size]) for row in rows])
        np.testing.assert_array_equal(columns[f"f{i}"], told if n else told[:, 0])


def test_types_within_types_and_arrays_of_them_have_dotted_names(fresh):
    body = struct.pack("<QBfBfBf3H", 5, 1, 1.5, 2, 2.5, 3, 3.5, 7, 8, 9)
    data = px4.HEADER + px4.flags() + px4.defined("outer", OUTER) + px4.defined("inner", INNER) + px4.added("outer", 3)
    data += px4.message("D", b"\x03\0" + body) * 2
    columns = topic(taken(data, {"outer"}), "outer")
    flat = {name: np.ravel(values[0]).tolist() for name, values in columns.items()}
    assert flat == {
        "timestamp": [5], "parts[0].a": [1], "parts[0].b": [1.5], "parts[1].a": [2], "parts[1].b": [2.5], "one.a": [3],
        "one.b": [3.5], "list": [7, 8, 9],
    }  # fmt: skip
    path = fresh("log.ulg")
    path.write_bytes(data)
    told = px4.heard(path)[0]["outer", 0]
    assert told.keys() == columns.keys()
    for name, values in told.items():
        np.testing.assert_array_equal(columns[name], values)


def test_padding_inside_counts_and_is_no_field():
    text = "uint64_t timestamp;uint8_t a;uint8_t[3] _padding0;float b;"
    data = px4.HEADER + px4.flags() + px4.topic("any", 1, text, [{"timestamp": 1, "a": 2, "b": 2.5, "_padding0": 255}])
    columns = topic(taken(data, {"any"}), "any")
    assert {name: values.tolist() for name, values in columns.items()} == {"timestamp": [1], "a": [2], "b": [2.5]}


@pytest.mark.parametrize("padding", [0, 3])
def test_padding_at_the_end_may_be_left_out_or_not(padding):
    text = "uint64_t timestamp;uint8_t a;uint8_t[3] _padding0;"
    body = struct.pack("<HQB", 1, 77, 5) + bytes(padding)
    log = taken(px4.HEADER + px4.flags() + px4.topic("any", 1, text, []) + px4.message("D", body) * 2, {"any"})
    assert topic(log, "any")["a"].tolist() == [5, 5]
    assert log.misfits == 0


def test_what_stands_before_an_unknown_type_is_read():
    text = "uint64_t timestamp;uint8_t a;nobody_knows b;float c;"
    data = px4.HEADER + px4.flags() + px4.defined("any", text) + px4.added("any", 1)
    data += px4.message("D", struct.pack("<HQB", 1, 77, 5) + bytes(20))
    assert topic(taken(data, {"any"}), "any").keys() == {"timestamp", "a"}


@pytest.mark.parametrize(
    "formats", [{}, {"any": ""}, {"any": "any a;"}, {"any": "nobody a;"}, {"any": "uint8_t;"}, {"any": "?? a;"}]
)
def test_a_definition_of_nothing_gives_nothing(formats):
    assert layout("any", formats) == ((), 0)


def test_messages_shorter_than_their_topic_are_counted():
    text = "uint64_t timestamp;float a;"
    data = px4.HEADER + px4.flags() + px4.topic("any", 1, text, [{"timestamp": 1, "a": 2}])
    log = taken(data + px4.message("D", struct.pack("<HQ", 1, 9)) * 3, {"any"})
    assert topic(log, "any")["timestamp"].tolist() == [1]
    assert log.misfits == 3


def test_instances_and_numbers_are_kept_apart():
    text = "uint64_t timestamp;"
    data = px4.HEADER + px4.flags() + px4.defined("any", text) + b"".join(px4.added("any", 9 - i, i) for i in range(3))
    data += b"".join(px4.data(9 - i, text, timestamp=10 * i + j) for j in range(4) for i in range(3))
    found = {i: columns["timestamp"].tolist() for i, columns in taken(data, {"any"}).topics("any")}
    assert found == {i: [10 * i + j for j in range(4)] for i in range(3)}


def test_dropouts_are_counted():
    assert taken(px4.HEADER + px4.flags() + px4.dropout(5) + px4.dropout(1000)).dropouts == [5, 1000]


# Damage


BLOCKS = [(kind, size) for kind in ("random", "zeros", "ones") for size in (1, 500, 5000)]


@pytest.mark.parametrize(
    ("kind", "size"),
    [pytest.param(*block) for block in BLOCKS],
)
def test_a_damaged_block_costs_no_more_than_the_messages_beside_it(kind, size):
    parts = [px4.combined(200), px4.combined(200, first=200)]
    garbage = {"random": np.random.default_rng(size).bytes(size), "zeros": bytes(size), "ones": b"\xff" * size}[kind]
    log = taken(px4.HEADER + px4.flags() + parts[0] + garbage + parts[1])
    found = topic(log, "sensor_combined")
    times = set(found["timestamp"].tolist())
    outside = {px4.START + 5000 * i for i in range(400)}
    assert times <= outside
    assert len(outside - times) <= 2
    assert np.abs(found["gyro_rad"]).max() < 1
    lost = len(outside - times) * len(px4.data(1, px4.COMBINED))
    assert size <= log.skipped + 1
    assert log.skipped <= size + lost + len(
        px4.defined("sensor_combined", px4.COMBINED) + px4.added("sensor_combined", 1)
    )


def cuts(data):
    """Yield what is taken of a log cut at 200 places, how many messages were whole, and where they end."""
    _, at, size, skipped = walk(np.frombuffer(data, np.uint8)[16:])
    assert skipped == 0
    ends = (at + size + 16).tolist()
    assert ends[-1] == len(data)
    for cut in np.random.default_rng(3).integers(80, len(data), 200):
        whole = bisect.bisect_right(ends, cut)
        yield taken(data[:cut]), int(cut), whole, ends[whole - 1]


def test_cut_anywhere_the_whole_messages_before_the_cut_are_used():
    data = px4.HEADER + px4.flags() + px4.combined(400)
    for log, _, whole, _ in cuts(data):
        found = topic(log, "sensor_combined")["timestamp"].tolist() if whole > 3 else []
        assert found == [px4.START + 5000 * i for i in range(whole - 3)]


def test_cut_anywhere_the_bytes_behind_the_last_whole_message_are_counted():
    for log, cut, whole, end in cuts(px4.flight()):
        assert (log.messages, log.skipped) == (whole, cut - end)


@pytest.mark.parametrize("cut", [0, 1, 20])
def test_data_appended_behind_an_end_that_is_cut_is_found(fresh, cut):
    first, second = px4.combined(50), px4.combined(50, first=50)
    behind = px4.added("sensor_combined", 1) + second[len(px4.combined(0)) :]  # pyulog wants it again
    offset = len(px4.HEADER + px4.flags() + first) - cut
    data = (px4.HEADER + px4.flags(offset) + first)[:offset] + behind
    assert segments(np.frombuffer(data, np.uint8)) == [(16, offset), (offset, len(data))]
    log = taken(data)
    lost = [49] if cut else []
    wanted = [px4.START + 5000 * i for i in range(100) if i not in lost]
    assert topic(log, "sensor_combined")["timestamp"].tolist() == wanted
    assert log.skipped == (len(px4.data(1, px4.COMBINED)) - cut if cut else 0)
    path = fresh("log.ulg")
    path.write_bytes(data)
    pyulog = pytest.importorskip("pyulog", reason="pyulog, which reads PX4's logs, is not installed")
    told = pyulog.ULog(str(path))
    assert np.concatenate([one.data["timestamp"] for one in told.data_list]).tolist() == wanted


@pytest.mark.parametrize("offset", [0, 5, 10**9, 2**64 - 1])
def test_places_of_appended_data_that_cannot_be_are_not_used(offset):
    data = px4.HEADER + px4.flags(offset) + px4.combined(10)
    assert segments(np.frombuffer(data, np.uint8)) == [(16, len(data))]
    assert taken(data).messages == 13


@given(st.binary(max_size=200))
@settings(deadline=None)
def test_walking_any_bytes_accounts_for_each(data):
    _, _, size, skipped = walk(np.frombuffer(data, np.uint8))
    assert int((size + 3).sum()) + skipped == len(data)


def test_messages_of_types_that_are_not_used_are_passed_over():
    others = [px4.message(kind, b"some content") for kind in "IMPQLCSRX"]
    data = px4.HEADER + px4.flags() + px4.combined(5) + b"".join(others)
    pairs = list(itertools.pairwise(others))
    assert taken(data).skipped == 0
    assert taken(data + b"".join(a + b for a, b in pairs)).messages == 8 + 9 + 16
