"""Records of ArduPilot's binary logs equal those that pymavlink finds; damage costs what it hits."""

import bisect
import itertools
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.readers.flight.dataflash_records import formats
from imuwb.readers.flight.dataflash_streams import WANTED
from imuwb.readers.flight.dataflash_tables import LAYOUT, Tables
from tests.readers.flight import dataflash_writer as log

FILES = ("ardusub_small.BIN", "mavparser_00000081.BIN", "pymavlink_test.BIN")
RANGES = {"b": (-128, 127), "B": (0, 255), "M": (0, 255), "h": (-(2**15), 2**15 - 1), "H": (0, 2**16 - 1)} | {
    "i": (-(2**31), 2**31 - 1), "I": (0, 2**32 - 1), "q": (-(2**63), 2**63 - 1), "Q": (0, 2**64 - 1),
}  # fmt: skip


def tables_of(data, wanted=WANTED, pieces=()):
    """Return the tables of a whole log, taken at once or in pieces that end at some places."""
    buffer = np.frombuffer(data, np.uint8)
    tables = Tables(formats(buffer), wanted)
    rest = b""
    edges = [0, *pieces, len(data)]
    for a, b in itertools.pairwise(edges):
        part = np.frombuffer(rest + data[a:b], np.uint8)
        rest = part[tables.take(part, last=b == len(data)) :].tobytes()
    return tables


def plain(value):
    """Return what pymavlink gives of a field as numbers."""
    return [ord(c) for c in value] if isinstance(value, str) else value


@pytest.fixture(scope="module", params=FILES)
def real(request, shared):
    path = shared / "dataflash" / request.param
    return tables_of(path.read_bytes()), log.heard(path)


@pytest.mark.slow
def test_every_record_that_pymavlink_finds_is_found(real):
    tables, wanted = real
    found = {name: next(iter(t.values())).shape[0] for name in WANTED if (t := tables.table(name)) is not None}
    assert found == {name: len(messages) for name, messages in wanted.items() if name in WANTED}
    assert sum(found.values()) > 80


def test_every_column_equals_pymavlinks(real):
    tables, wanted = real
    compared = 0
    for name in WANTED & wanted.keys():
        columns = tables.table(name)
        columns.pop(LAYOUT, None)
        assert list(columns) == wanted[name][0].get_fieldnames()
        for field, values in columns.items():
            told = [plain(getattr(message, field)) for message in wanted[name]]
            if values.ndim == 2 and values.dtype == np.uint8:  # text
                assert [bytes(row).split(b"\0")[0] for row in values] == [bytes(text) for text in told]
            else:
                np.testing.assert_allclose(values, np.array(told), rtol=1e-13, err_msg=f"{name}.{field}")
            compared += values.size
    assert compared > 1000


@given(data=st.data(), letters=st.text(st.sampled_from("abBhHiIfdgnNZcCeELMqQ"), min_size=1, max_size=9))
@settings(deadline=None, max_examples=60)
def test_each_letter_is_what_struct_unpacks(data, letters):
    size = struct.calcsize("<" + "".join(log.STRUCT[letter] for letter in letters))
    letters = letters if size < 252 else "QdL"
    kind = log.Format(9, "ANY", letters, ",".join("abcdefghi"[: len(letters)]))
    values = tuple(
        data.draw(st.lists(st.integers(*RANGES["h"]), min_size=32, max_size=32)) if letter == "a"
        else "x" if letter in "nNZ"
        else data.draw(st.integers(*RANGES[{"c": "h", "C": "H", "e": "i", "E": "I", "L": "i"}[letter]]))
        / 10 ** log.DECIMALS[letter] if letter in log.DECIMALS
        else data.draw(st.integers(*RANGES[letter])) if letter in RANGES
        else data.draw(st.floats(width={"f": 32, "d": 64, "g": 16}[letter], allow_nan=False))
        for letter in letters
    )  # fmt: skip
    tables = tables_of(log.binary([*log.declared(kind), (kind, values), (kind, values)]), {"ANY"})
    columns = tables.table("ANY")
    for letter, value, column in zip(letters, values, columns.values(), strict=True):
        assert column.shape[0] == 2
        if letter in "nNZ":
            assert column[0].tobytes().rstrip(b"\0") == b"x"
        elif letter in log.DECIMALS:
            np.testing.assert_allclose(column, value, rtol=1e-12, atol=0)
        else:
            np.testing.assert_array_equal(column[0], value)
    assert tables.skipped == 0


def test_a_format_that_comes_late_counts_for_what_stood_before():
    rows = [log.imu(i) for i in range(10)]
    tables = tables_of(log.binary([*log.declared(log.GPS), *rows[:5], *log.declared(log.IMU), *rows[5:]]))
    assert tables.table("IMU")["TimeUS"].tolist() == [values[0] for _, values in rows]
    assert tables.skipped == 0


OTHER = log.Format(log.IMU.number, "IMU", "Qffffff", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ")


@pytest.mark.parametrize("pieces", [(), (700,), (1000, 1010, 1100), range(90, 2000, 7)])
def test_a_format_that_replaces_another_of_its_number_counts_from_its_place_on(pieces):
    """Two logs of different firmware in one file: numbers have other records in the second."""
    again = [log.Format(log.GPS.number, "ATT", log.ATT.letters, log.ATT.labels), OTHER]
    rows = [(OTHER, (10**9 + i, *[77.0] * 6)) for i in range(5)]
    turned = [(again[0], (10**9 + i, *[5.0] * 6)) for i in range(3)]
    data = log.binary([
        *log.declared(), *(log.imu(i) for i in range(5)), log.fix(0), *log.declared(*again), *rows, *turned,
    ])  # fmt: skip
    tables = tables_of(data, pieces=[p for p in pieces if p < len(data)])
    imu = tables.table("IMU")
    assert imu["TimeUS"].tolist() == [log.imu(i)[1][0] for i in range(5)] + [10**9 + i for i in range(5)]
    assert imu["GyrX"].tolist() == [log.imu(i)[1][2] for i in range(5)] + [77.0] * 5
    np.testing.assert_array_equal(imu["I"], [0] * 5 + [np.nan] * 5)
    assert len(tables.table("GPS")["TimeUS"]) == 1
    assert tables.table("ATT")["Yaw"].tolist() == [5.0] * 3
    assert (tables.skipped, len(tables.labels_of("IMU"))) == (0, 2)
    assert dict(tables.counts) == {"FMT": 16, "IMU": 10, "GPS": 1, "ATT": 3}


def test_two_numbers_of_one_name_are_read_in_the_order_of_the_file():
    other = log.Format(200, "IMU", "QBffffff", "TimeUS,I,AccX,AccY,AccZ,GyrX,GyrY,GyrZ")
    rows = [log.imu(i) if i % 3 else (other, (log.START + 40_000 * i, 0, 4, 5, 6, 1, 2, 3)) for i in range(30)]
    tables = tables_of(log.binary([*log.declared(log.IMU, other), *rows]), {"IMU"})
    imu = tables.table("IMU")
    assert imu["TimeUS"].tolist() == [log.START + 40_000 * i for i in range(30)]
    assert imu["GyrX"][::3].tolist() == [1] * 10
    assert np.isnan(imu["T"]).tolist() == [i % 3 == 0 for i in range(30)]


def test_formats_that_change_for_ever_end():
    rows = [one for i in range(300) for one in (*log.declared((log.IMU, OTHER)[i % 2])[1:], log.fix(i))]
    tables = tables_of(log.binary([*log.declared(), *rows]))
    assert len(tables.layouts) <= 16 + 64
    assert len(tables.table("GPS")["TimeUS"]) == 300


@pytest.mark.parametrize("size", [1, 500, 5000])
@pytest.mark.parametrize("kind", ["random", "zeros", "heads", "torn"])
def test_a_damaged_block_costs_no_more_than_the_record_before_it(size, kind):
    rows = [log.imu(i) for i in range(400)]
    before, behind = log.binary([*log.declared(), *rows[:200]]), log.binary(rows[200:])
    garbage = {
        "random": np.random.default_rng(size).bytes(size), "zeros": bytes(size),
        "heads": (b"\xa3\x95\x83" * size)[:size], "torn": (log.binary(rows)[7:] * 2)[:size],
    }[kind]  # fmt: skip
    if kind == "torn" and size == 5000:
        garbage = b"".join(log.binary([row])[:30] for row in rows)[:size]
    tables = tables_of(before + garbage + behind)
    times = set(tables.table("IMU")["TimeUS"].tolist())
    outside = {values[0] for _, values in rows}
    # The record before damage cannot be told from a cut one, unless the damage begins like a record.
    assert times >= outside - {rows[199][1][0]}
    rate = tables.table("IMU")["GyrX"]
    assert np.abs(rate).max() < 1
    used = sum(len(log.binary([row])) for row in log.declared()) + rate.size * log.IMU.size
    assert tables.skipped == len(before + garbage + behind) - used


def test_cut_anywhere_the_whole_records_before_the_cut_are_found():
    rows = log.flight(20)
    sizes = [kind.size for kind, _ in rows]
    data, ends = log.binary(rows), list(itertools.accumulate(sizes))
    for cut in np.random.default_rng(3).integers(90, len(data), 200):
        tables = tables_of(data[:cut])
        whole = bisect.bisect_right(ends, cut)
        assert tables.records == whole
        assert tables.skipped == cut - ends[whole - 1]


@pytest.mark.slow
@given(st.lists(st.integers(0, len(log.binary(log.flight(10)))), max_size=8).map(sorted))
@settings(deadline=None, max_examples=60)
def test_pieces_give_what_the_whole_gives(pieces):
    data = log.binary(log.flight(10))
    damaged = data[:2000] + b"\xa3\x95damage" + data[2000:]
    for one in (data, damaged):
        whole, parts = tables_of(one), tables_of(one, pieces=[p for p in pieces if p < len(one)])
        assert (parts.records, parts.skipped) == (whole.records, whole.skipped)
        for name in ("IMU", "GPS", "POS"):
            for field, column in whole.table(name).items():
                np.testing.assert_array_equal(column, parts.table(name)[field])


@pytest.mark.parametrize(
    "body",
    [
        b"", b"\x09\x08IMU!Q" + bytes(79), b"\x09\x0bANY\0Q?" + bytes(78), b"\x09\x0cANY\0Q" + bytes(79),
    ],
)  # fmt: skip
def test_what_only_looks_like_a_format_is_none(body):
    assert 9 not in formats(np.frombuffer(b"\xa3\x95\x80" + body, np.uint8))


def test_a_format_with_the_right_size_is_one():
    assert formats(np.frombuffer(b"\xa3\x95\x80\x09\x0bANY\0Q" + bytes(79), np.uint8))[9].size == 11
