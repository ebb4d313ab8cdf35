"""Frames and their fields are those that pymavlink finds, whatever lies between them and wherever the log is cut."""

import math
from collections import Counter
from itertools import accumulate

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.readers.bytes.gather import gather
from imuwb.readers.flight.mavlink_fields import LAYOUTS, decoded
from imuwb.readers.flight.mavlink_frames import STAMP, scan

from .mavlink_writer import T, frame, heard, heartbeat, mavlink, numbered, record, spoilt

#: and the frames that pymavlink calls bad
REAL = {"ardusub_pymavlink_bug_2023-04-18": 1967, "ardusub_small": 4, "pymavlink_flight": 0}
THEIR_NAME = {"satellites": "satellites_visible"}
INTEGERS = {
    f"{sign}int{bits}_t": st.integers(*((0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)))
    for sign in ("u", "")
    for bits in (8, 16, 32, 64)
}
KINDS = {**INTEGERS, "float": st.floats(width=32, allow_nan=False)}


def scanned(data, last=True):
    return scan(np.frombuffer(data, np.uint8), last=last)


def in_blocks(data, *cuts):
    """Return the frames' places in the file, and the counts, as read in blocks that end at the cuts."""
    places, counts, rest, offset = [], Counter(), b"", 0
    for a, b in zip((0, *cuts), (*cuts, len(data)), strict=True):
        block = rest + data[a:b]
        found = scanned(block, last=b == len(data))
        places += (offset + found.record).tolist()
        counts += Counter(failed=found.failed, unknown=found.unknown, skipped=found.skipped)
        rest, offset = block[found.end :], offset + found.end
    counts["skipped"] += len(rest)
    return places, dict(counts)


def place(records, which):
    """Return where some of the records begin."""
    starts = [0, *accumulate(map(len, records))]
    return [starts[i] for i in which]


# The frames of real logs, and of any


def told(data):
    """Return (recorder's time, message, system, component) of each frame."""
    found = scanned(data)
    stamps = gather(np.frombuffer(data, np.uint8), found.record, ">u8")
    columns = stamps, found.number, found.system, found.component
    return list(zip(*(column.tolist() for column in columns), strict=True)), found


@pytest.mark.slow
@pytest.mark.parametrize("name", REAL)
def test_every_frame_that_pymavlink_decodes_is_found_and_no_other(shared, name):
    path = shared / "tlog" / f"{name}.tlog"
    ours, _ = told(path.read_bytes())
    theirs = [(t, m.get_msgId(), m.get_srcSystem(), m.get_srcComponent()) for t, m in heard(path)]
    assert Counter(number for _, number, *_ in ours) == Counter(number for _, number, *_ in theirs)
    assert ours == theirs


@pytest.mark.parametrize(("name", "failed"), REAL.items())
def test_frames_that_pymavlink_calls_bad_are_counted(shared, name, failed):
    found = scanned((shared / "tlog" / f"{name}.tlog").read_bytes())
    assert (found.failed, found.unknown) == (failed, 0)


SOME = ("HEARTBEAT", "SCALED_IMU", "ATTITUDE", "GPS2_RAW", "HIL_SENSOR", "EKF_STATUS_REPORT", "RAW_IMU", "WIND")
BYTE = st.integers(0, 255)


@st.composite
def frames(draw):
    version = draw(st.sampled_from([1, 2]))
    options = {"version": version, "signed": version == 2 and draw(st.booleans())}
    return frame(draw(st.sampled_from(SOME)), system=draw(BYTE), component=draw(BYTE), **options)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.integers(1, 10**6), frames()), min_size=1, max_size=8))
def test_any_frames_one_behind_the_other_are_those_of_pymavlink(fresh, rows):
    data = b"".join(record(T + stamp, one) for stamp, one in rows)
    path = fresh("log.tlog")
    path.write_bytes(data)
    ours, found = told(data)
    assert ours == [(t, m.get_msgId(), m.get_srcSystem(), m.get_srcComponent()) for t, m in heard(path)]
    assert len(ours) == len(rows)
    assert (found.failed, found.unknown, found.skipped, found.end) == (0, 0, 0, len(data))


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("signed", [False, True])
def test_payloads_lie_behind_the_header_and_signatures_behind_them(version, signed):
    one = frame("ATTITUDE", version=version, signed=signed and version == 2, yaw=1.5, yawspeed=2.5)
    found = scanned(record(T, one) * 3)
    assert found.record.tolist() == [0, len(one) + 8, 2 * len(one) + 16]
    assert (found.payload - found.record).tolist() == [STAMP + (6 if version == 1 else 10)] * 3
    assert found.length.tolist() == [28] * 3


def test_a_frame_whose_flags_nobody_knows_is_left_out(fresh):
    data = bytearray(frame("SCALED_IMU", time_boot_ms=5300, zacc=-1000))
    data[2] = 2
    crc = mavlink.x25crc(bytes(data[1:-2]) + bytes([mavlink.MAVLink_scaled_imu_message.crc_extra]))
    log = b"".join((*numbered(2), record(T + 200_000, bytes(data[:-2]) + crc.crc.to_bytes(2, "little")), *numbered(1)))
    path = fresh("log.tlog")
    path.write_bytes(log)
    assert scanned(log).number.size == len(list(heard(path)))


# Damage


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("at", [*range(1, 12)])
def test_one_flipped_bit_costs_one_frame(version, at):
    records = numbered(5, version=version)
    records[2] = spoilt(records[2], -at)
    found = scanned(b"".join(records))
    assert found.record.tolist() == place(records, [0, 1, 3, 4])
    assert (found.failed, found.unknown, found.skipped) == (1, 0, 0)


def test_a_signature_is_not_part_of_the_checksum():
    records = numbered(3, signed=True)
    records[1] = spoilt(records[1], -2)
    assert scanned(b"".join(records)).number.tolist() == [26] * 3


@pytest.mark.parametrize("last", [False, True])
def test_a_bad_last_frame_is_counted_as_any_other(last):
    records = [*numbered(3), spoilt(numbered(1)[0])]
    places, counts = in_blocks(b"".join(records), *([] if last else [100]))
    assert places == place(records, [0, 1, 2])
    assert counts == {"failed": 1, "skipped": 0}


@given(st.lists(st.lists(st.integers(0, 252), max_size=40), min_size=4, max_size=4))
def test_garbage_between_frames_is_skipped_and_counted(garbage):
    junk, records = [bytes(one) for one in garbage], numbered(3)
    data = junk[0] + b"".join(one + more for one, more in zip(records, junk[1:], strict=True))
    found = scanned(data)
    assert found.number.tolist() == [26] * 3
    assert found.record.tolist() == [data.index(one) for one in records]
    assert found.skipped + len(data) - found.end == sum(map(len, junk))
    assert found.failed == found.unknown == 0


@pytest.mark.parametrize("mark", [b"\xfd", b"\xfe"])
def test_garbage_that_looks_like_the_beginning_of_a_frame_costs_none(mark):
    junk, records = bytes(8) + mark + b"\xff" + bytes(20), numbered(12)
    found = scanned(junk + b"".join(records))
    assert found.number.tolist() == [26] * 12
    assert found.skipped == len(junk)


def test_the_time_between_two_frames_may_be_missing():
    records = numbered(3)
    data = records[0] + records[1][STAMP:] + records[2]
    assert scanned(data).record[0] == 0
    assert scanned(data).record[-1] == len(data) - len(records[2])


@pytest.mark.parametrize("signed", [False, True])
def test_cut_at_any_byte_all_whole_frames_are_found(signed):
    records = [heartbeat(signed=signed), *numbered(3, signed=signed), heartbeat(version=1), *numbered(3, version=1)]
    data, ends = b"".join(records), [0, *accumulate(map(len, records))]
    for size in range(len(data) + 1):
        found = scanned(data[:size])
        whole = sum(end <= size for end in ends[1:])
        assert found.record.tolist() == ends[:whole]
        assert found.failed == 0
        assert found.skipped + size - found.end == size - ends[whole]


@pytest.mark.parametrize("size", range(20))
def test_hardly_any_bytes_hold_no_frame(size):
    for last in (False, True):
        assert scanned((bytes(8) + b"\xfd" * 20)[:size], last).number.size == 0


@given(st.binary(max_size=600))
def test_any_bytes_are_accounted_for(data):
    found = scanned(data)
    assert 0 <= found.skipped <= found.end <= len(data)


# Blocks


def noisy():
    """Return a log with frames of both versions, a bad one, one of no dialect, and garbage."""
    unknown = bytearray(heartbeat())
    unknown[STAMP + 7 : STAMP + 10] = b"\xff\xff\xff"
    return b"".join((
        *numbered(2), spoilt(numbered(1)[0]), heartbeat(version=1), b"\0\1\2garbage\xfe\xfd", *numbered(2, signed=True),
        bytes(unknown), heartbeat(), *numbered(2, version=1),
    ))  # fmt: skip


def test_two_blocks_give_what_one_does_wherever_they_part():
    data = noisy()
    whole = in_blocks(data)
    assert len(whole[0]) == 8
    assert whole[1] == {"failed": 1, "unknown": 1, "skipped": 12}
    for cut in range(1, len(data)):
        assert in_blocks(data, cut) == whole, cut


@pytest.mark.parametrize("step", [1, 7, 20, 64, 289])
def test_small_blocks_give_what_one_does(step):
    data = noisy()
    assert in_blocks(data, *range(step, len(data), step)) == in_blocks(data)


def test_a_frame_with_a_wrong_length_that_ends_with_a_block_costs_no_other():
    records = numbered(8)
    damaged = bytearray(records[1])
    damaged[STAMP + 1] += 40  # now it seems to reach into the record behind the next
    records[1] = bytes(damaged)
    data, (begins,) = b"".join(records), place(records, [1])
    seems_to_end = begins + STAMP + 12 + damaged[STAMP + 1]
    assert in_blocks(data)[0] == place(records, [0, 2, 3, 4, 5, 6, 7])
    assert in_blocks(data, seems_to_end) == in_blocks(data)


# The fields


@st.composite
def alike(draw, kind):
    """Return some messages of one kind, many of their fields 0."""
    values = [st.just(0) | KINDS[name] for name in kind.fieldtypes]
    rows = draw(st.lists(st.tuples(st.sampled_from([1, 2]), st.tuples(*values)), min_size=1, max_size=4))
    return [(version, dict(zip(kind.fieldnames, row, strict=True))) for version, row in rows]


def test_all_messages_that_are_read_are_tested():
    assert set(LAYOUTS) == {2, 24, 26, 27, 30, 33, 105, 107, 116, 124, 129}
    assert all(mavlink.mavlink_map[number].msgname == layout.name for number, layout in LAYOUTS.items())


@pytest.mark.slow
@pytest.mark.parametrize("number", LAYOUTS)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_every_field_is_what_pymavlink_reads(number, data):
    layout = LAYOUTS[number]
    rows = data.draw(alike(mavlink.mavlink_map[number]))
    sent = [frame(layout.name, version=version, signed=version == 2, **values) for version, values in rows]
    log = b"".join(record(T, one) for one in sent)
    found = scanned(log)
    assert found.number.tolist() == [number] * len(rows)
    ours = decoded(layout, np.frombuffer(log, np.uint8), found.payload, found.length)
    theirs = [mavlink.MAVLink(None).decode(bytearray(one)) for one in sent]
    for name, values in ours.items():
        assert values.tolist() == [getattr(one, THEIR_NAME.get(name, name)) for one in theirs], name


@pytest.mark.parametrize("number", LAYOUTS)
def test_zeros_at_the_end_that_are_not_sent_are_put_back(number):
    layout = LAYOUTS[number]
    first = layout.fields[0].name
    log = record(T, frame(layout.name, **{first: 77})) + record(T, frame(layout.name))
    found = scanned(log)
    assert found.length.tolist() == [1, 1]
    values = decoded(layout, np.frombuffer(log, np.uint8), found.payload, found.length)
    assert values[first].tolist() == [77, 0]
    assert all(column.tolist() == [0, 0] for name, column in values.items() if name != first)


def test_a_float_that_is_no_number_stays_one():
    log = record(T, frame("ATTITUDE", roll=math.nan, pitch=math.inf, yaw=1.0))
    found = scanned(log)
    values = decoded(LAYOUTS[30], np.frombuffer(log, np.uint8), found.payload, found.length)
    assert np.isnan(values["roll"]).all()
    assert values["pitch"].tolist() == [math.inf]


def test_no_messages_have_no_fields():
    nothing = np.empty(0, np.int64)
    values = decoded(LAYOUTS[30], np.empty(0, np.uint8), nothing, nothing)
    assert {name: column.size for name, column in values.items()} == {
        "time_boot_ms": 0,
        "roll": 0,
        "pitch": 0,
        "yaw": 0,
    }
