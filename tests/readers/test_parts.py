"""A part that is read alone is the part of the whole log, in every container and with every fault of the clock."""

from collections import defaultdict

import numpy as np
import pytest
from mcap.reader import make_reader

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import SECOND, Origin
from imuwb.notes import ids
from imuwb.readers import Batch, ReadOptions, read
from imuwb.readers.containers import bag_part, mcap_part, sqlite_part
from imuwb.readers.flight import dataflash_part
from imuwb.readers.part_rows import PartRows
from imuwb.readers.text import csv_part
from imuwb.selection import Part
from tests.readers import part_logs
from tests.readers.flight import dataflash_writer, ulog_writer
from tests.readers.part_logs import FAULTS, T, assert_alike, parts_of, samples

CONTAINERS = {
    "mcap": part_logs.as_mcap, "loose.mcap": part_logs.as_loose_mcap, "db3": part_logs.as_db3, "bag": part_logs.as_bag,
    "indexed.bag": part_logs.as_indexed_bag, "csv": part_logs.as_csv,
}  # fmt: skip


@pytest.fixture(scope="module")
def written(fresh, ros):
    """Return a function that writes a log of samples in a container."""

    def write(container, made, **options):
        return CONTAINERS[container](fresh(f"log.{container.rpartition('.')[2]}"), ros, made, **options)

    return write


@pytest.mark.parametrize(
    ("container", "fault"),
    [("mcap", "late"), ("mcap", "set back"), ("csv", "repeated"), ("db3", "gap"), ("indexed.bag", "late"),
     *(pytest.param("db3", fault, marks=pytest.mark.slow) for fault in FAULTS if fault != "gap"),
     *(pytest.param("indexed.bag", fault, marks=pytest.mark.slow) for fault in FAULTS if fault != "late"),
     *(pytest.param("mcap", fault, marks=pytest.mark.slow) for fault in FAULTS if fault not in ("late", "set back")),
     *(pytest.param("csv", fault, marks=pytest.mark.slow) for fault in FAULTS if fault != "repeated"),
     *(pytest.param(container, "late", marks=pytest.mark.slow) for container in ("loose.mcap", "bag"))],
)  # fmt: skip
def test_a_part_is_the_part_of_the_whole(written, container, fault):
    path = written(container, samples(fault, seed=3))
    whole = read(path)
    for part in parts_of(whole, 2, seed=len(fault)):
        found = assert_alike(path, part, whole)
        assert found is None or part == Part() or "part" in ids(found.notes)


def test_even_times_of_a_part_are_near_those_of_the_whole(written):
    path = written("csv", part_logs.bursts())
    whole, found = read(path).imus[0].angular_rate, read(path, part=Part(start="30", end="40"))
    part = found.imus[0].angular_rate
    row = round(float(part.value[0, 0]) * 1e4)
    assert abs(len(part) - 1000) <= 1
    assert np.abs(part.time - whole.time[row : row + len(part)]).max() < 0.02 * SECOND
    assert any("even times" in note for note in found.notes if getattr(note, "id", "") == "part")


def test_a_stated_rate_counts_from_the_first_row(written):
    path, options = written("csv", samples("lost")), ReadOptions(rate=10.0)
    assert_alike(path, Part(start="20", end="30"), read(path, options), options)


@pytest.fixture
def searched(monkeypatch):
    """Search small text files as large ones."""
    for name, value in {"FEWEST": 0, "PLACES": 16, "LOOKED_AT": 512, "FINE": 256}.items():
        monkeypatch.setattr(csv_part, name, value)


@pytest.mark.parametrize(
    "fault", ["late", *(pytest.param(fault, marks=pytest.mark.slow) for fault in FAULTS if fault != "late")]
)
def test_a_part_of_a_text_log_is_found_by_its_time(written, searched, fault):
    path = written("csv", samples(fault, seed=4))
    whole = read(path)
    for part in parts_of(whole, 4, seed=1):
        assert_alike(path, part, whole)


def test_only_rows_of_the_part_of_a_text_log_are_parsed(written, searched, monkeypatch):
    path, rows = written("csv", samples()), []
    parse = csv_part.blocks

    def counted(*given, span):
        for block, bytes_read in parse(*given, span=span):
            rows.append(block.num_rows)
            yield block, bytes_read

    monkeypatch.setattr(csv_part, "blocks", counted)
    found = assert_alike(path, Part(start="50", end="51"), read(path))
    assert len(found.imus[0].angular_rate) == 10
    # 12 s of the beginning, the part, and 10 s before and after it, and what is looked at: of 800 rows.
    assert 320 < sum(rows) < 700


@pytest.mark.parametrize("source", ["log", pytest.param("publish", marks=pytest.mark.slow)])
def test_a_part_by_other_times(written, source):
    path, options = written("mcap", samples("late")), ReadOptions(time_source=source)
    whole = read(path, options)
    for part in parts_of(whole, 3):
        assert_alike(path, part, whole, options)


@pytest.mark.parametrize(
    "rows", [pytest.param(rows, marks=pytest.mark.slow) for rows in (dataflash_writer.binary, dataflash_writer.text)]
)
def test_parts_of_a_dataflash_log(fresh, rows):
    path = fresh("log.bin")
    path.write_bytes(rows(dataflash_writer.flight(1000)))
    whole = read(path)
    for part in parts_of(whole, 3):
        assert_alike(path, part, whole)


def test_a_part_of_a_dataflash_log_is_found_by_its_time(fresh, monkeypatch):
    for name, value in {"FEWEST": 0, "PLACES": 8, "PIECE": 4096, "HEAD": 8192, "FINE": 2048}.items():
        monkeypatch.setattr(dataflash_part, name, value)
    rows = dataflash_writer.flight(2000)
    path, counts, streams = fresh("log.bin"), [], dataflash_part.batches_of
    path.write_bytes(dataflash_writer.binary(rows))
    whole = read(path)
    for part in parts_of(whole, 2, seed=5):
        assert_alike(path, part, whole)
    monkeypatch.setattr(
        dataflash_part, "batches_of", lambda tables, *rest: counts.append(tables.records) or streams(tables, *rest)
    )
    assert_alike(path, Part(start="50", end="51"), whole)
    assert len(counts) == 2
    assert 0 < counts[0] < counts[1] < 0.6 * len(rows)


@pytest.mark.slow
def test_parts_of_a_ulog(fresh):
    path = fresh("log.ulg")
    path.write_bytes(ulog_writer.flight())
    whole = read(path)
    for part in parts_of(whole, 3):
        assert_alike(path, part, whole)


def test_dates_limit_a_part(written):
    path = written("mcap", samples())
    part = Part(start="2024-05-01T12:00:20", end="2024-05-01T12:00:21.5Z")
    found = assert_alike(path, part, read(path))
    assert found.imus[0].angular_rate.time[0] == T + 20 * SECOND


def test_a_part_has_the_errors_of_the_whole(written):
    path = written("mcap", samples())
    with pytest.raises(MissingDataError, match="the log has: /a, /b"):
        read(path, part=Part(imu="nobody", end="1"))
    with pytest.raises(UsageError, match="'soon'"):
        read(path, part=Part(start="soon"))
    with pytest.raises(UsageError, match="after"):
        read(path, part=Part(start="5", end="4"))


def test_two_imus_are_joined_in_a_part(written):
    path = written("mcap", samples())
    found = assert_alike(path, Part(imu="/a+/b", start="40", end="50"), read(path))
    assert (len(found.imus[0].angular_rate), len(found.imus[0].specific_force)) == (100, 50)


def test_a_clock_set_back_is_read_as_a_whole(written):
    path = written("mcap", samples("set back"))
    assert any("whole" in note for note in read(path, part=Part(start="60", end="70")).notes if note.id == "part")


def test_only_chunks_of_the_part_are_read(written, monkeypatch):
    path = written("mcap", samples())
    unpacked, unpack = [], mcap_part.unpacked_chunk
    monkeypatch.setattr(mcap_part, "unpacked_chunk", lambda chunk: unpacked.append(len(chunk)) or unpack(chunk))
    assert_alike(path, Part(start="70", end="71"), read(path))
    with path.open("rb") as file:
        chunks = len(make_reader(file).get_summary().chunk_indexes)
    assert chunks > 40
    assert 0 < len(unpacked) < 0.5 * chunks


def test_only_chunks_of_the_part_of_a_bag_are_read(written, monkeypatch):
    path, made = written("indexed.bag", samples()), samples()
    unpacked, unpack = [], bag_part.unpack
    monkeypatch.setattr(bag_part, "unpack", lambda *given: unpacked.append(1) or unpack(*given))
    assert_alike(path, Part(start="70", end="71"), read(path))
    chunks = sum(sample.topic in ("/a", "/b") for sample in made) // 20
    assert chunks > 40
    assert 0 < len(unpacked) < 0.5 * chunks


def test_only_rows_of_the_part_of_a_database_are_read(written, monkeypatch):
    path, messages_of, rows = written("db3", samples()), sqlite_part.messages_of, []

    def counted(*given):
        for messages in messages_of(*given):
            rows.append(messages.start.size)
            yield messages

    monkeypatch.setattr(sqlite_part, "messages_of", counted)
    monkeypatch.setattr(sqlite_part, "TOGETHER", 20)
    assert_alike(path, Part(start="70", end="71"), read(path))
    assert 0 < sum(rows) < 0.5 * len(samples())


def test_rows_outside_the_part_are_not_kept():
    origin, values = Origin(epoch="log"), np.zeros((1000, 3))
    batches = [
        Batch(name, "imu", i * SECOND + np.arange(1000) * (SECOND // 1000), {"angular_rate": values}, origin)
        for i in range(500)
        for name in ("left", "right")
    ]
    rows = defaultdict(int)
    for batch in PartRows(Part("left", "200", "210")).kept(batches):
        rows[batch.stream] += batch.time.size
    # The part, 10 s before and after it, and the first 10 s.
    assert 40_000 <= rows["left"] < 41_100
    assert 10_000 <= rows["right"] < 11_100
