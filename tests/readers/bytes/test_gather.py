"""Numbers picked out of bytes equal those that struct unpacks."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.readers.bytes import gather as module
from imuwb.readers.bytes.gather import alike, gather

KINDS = {
    "<u2": "<H",
    ">u2": ">H",
    "<u4": "<I",
    ">i4": ">i",
    "<i8": "<q",
    "<f4": "<f",
    "<f8": "<d",
    ">f8": ">d",
    "|u1": "<B",
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [0, 1, 3])
@settings(deadline=None)  # the first call compiles
@given(data=st.binary(max_size=200), places=st.lists(st.integers(0, 10**6), max_size=10))
def test_gathering_equals_unpacking_one_by_one(kind, count, data, places):
    size = np.dtype(kind).itemsize * max(count, 1)
    buffer = np.frombuffer(data + bytes(size), np.uint8)
    at = np.array([place % (len(data) + 1) for place in places], np.int64)
    found = gather(buffer, at, kind, count)
    one = struct.Struct(f"{KINDS[kind][0]}{max(count, 1)}{KINDS[kind][-1]}")
    wanted = np.array([one.unpack_from(buffer, place) for place in at]).reshape(-1, max(count, 1))
    assert found.dtype == np.dtype(kind)
    np.testing.assert_array_equal(found, wanted if count else wanted[:, 0])


@given(st.lists(st.integers(0, 3), max_size=20))
def test_rows_alike_are_each_row_once_under_its_key(keys):
    rows = np.arange(len(keys)) + 5
    found = dict(alike(np.array(keys, np.uint16), rows))
    assert set(found) == set(keys)
    assert all(keys[row - 5] == key for key, some in found.items() for row in some)
    assert sorted(row for some in found.values() for row in some) == rows.tolist()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [0, 3])
def test_few_numbers_are_gathered_without_the_compiler(monkeypatch, kind, count):
    rng = np.random.default_rng(0)
    buffer, at = rng.integers(0, 256, 500).astype(np.uint8), rng.integers(0, 400, 50)
    plain, compiled = (
        monkeypatch.setattr(module, "worth_compiling", lambda _, answer=answer: answer)
        or gather(buffer, at, kind, count)
        for answer in (False, True)
    )
    assert plain.tobytes() == compiled.tobytes()
