"""The table of checksum seeds is pymavlink's, of every dialect, and each of its seeds is believed."""

import pkgutil
import struct
from importlib import import_module

import numpy as np
import pytest

from imuwb.readers.flight.mavlink_frames import scan
from imuwb.readers.flight.mavlink_seeds import SEEDS

from .mavlink_writer import T, mavlink, record

pytestmark = pytest.mark.slow

TABLE = {number: {seeds} if isinstance(seeds, int) else set(seeds) for number, seeds in SEEDS.items()}
TWICE = [number for number, seeds in TABLE.items() if len(seeds) > 1]


def framed(number, seed, version=2):
    """Return a record of three bytes of payload, its checksum made with this seed."""
    head = [3, 0, 0, 9, 1, 1, *number.to_bytes(3, "little")] if version == 2 else [3, 9, 1, 1, number]
    crc = mavlink.x25crc(bytes([*head, 1, 2, 3]))
    crc.accumulate(bytes([seed]))
    return record(T, bytes([0xFD if version == 2 else 0xFE, *head, 1, 2, 3]) + struct.pack("<H", crc.crc))


def scanned(*records):
    return scan(np.frombuffer(b"".join(records), np.uint8), last=True)


@pytest.fixture(scope="module")
def theirs():
    """Return {number: seeds} of all dialects that pymavlink has."""
    found, package = {}, mavlink.__name__.rpartition(".")[0]
    for module in pkgutil.iter_modules(import_module(package).__path__):
        for number, kind in import_module(f"{package}.{module.name}").mavlink_map.items():
            found.setdefault(number, set()).add(kind.crc_extra)
    return found


def test_the_table_is_that_of_all_dialects(theirs):
    assert theirs == TABLE


def test_dialects_differ_and_the_table_holds_all_their_seeds(theirs):
    assert TWICE
    assert [number for number, seeds in theirs.items() if len(seeds) > 1] == TWICE
    assert max(map(len, TABLE.values())) == 3


@pytest.mark.parametrize("version", [1, 2])
def test_each_seed_of_each_message_is_accepted(version):
    pairs = [(number, seed) for number, seeds in TABLE.items() for seed in seeds if version == 2 or number < 256]
    found = scanned(*(framed(*pair, version) for pair in pairs))
    assert found.number.tolist() == [number for number, _ in pairs]
    assert (found.failed, found.unknown, found.skipped) == (0, 0, 0)


@pytest.mark.parametrize("version", [1, 2])
def test_no_other_seed_is_accepted(version):
    numbers = [number for number in TABLE if version == 2 or number < 256]
    wrong = [next(seed for seed in range(256) if seed not in TABLE[number]) for number in numbers]
    found = scanned(*(framed(number, seed, version) for number, seed in zip(numbers, wrong, strict=True)))
    assert found.number.tolist() == []
    assert (found.failed, found.unknown, found.skipped) == (len(numbers), 0, 0)


@pytest.mark.parametrize("number", [3, 65_535, 65_536, 2**24 - 1])
def test_a_message_of_no_dialect_is_counted_apart(number):
    found = scanned(framed(0, 50), framed(number, 50), framed(0, 50))
    assert found.number.tolist() == [0, 0]
    assert (found.failed, found.unknown, found.skipped) == (0, 1, 0)
