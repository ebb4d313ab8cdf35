"""ArduPilot's logs as text hold what the binary ones do; lines that are damaged are counted."""

import time

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import read, reader_of
from imuwb.readers.bytes import source
from imuwb.readers.flight import dataflash_text
from imuwb.readers.flight.dataflash_text import TextTables
from tests.readers.flight import dataflash_writer as log

STATED = [
    (log.FMTU, (0, log.IMU.number, "s#EEEooo-", "F-000000-")), (log.UNIT, (0, ord("E"), "deg/s")),
    (log.UNIT, (0, ord("o"), "m/s/s")), (log.MULT, (0, ord("0"), 1.0)),
]  # fmt: skip


@pytest.fixture(scope="module")
def both(fresh):
    """Return a function that reads rows written as text and as bytes."""

    def read_both(rows):
        paths = fresh("log.log"), fresh("log.bin")
        for path, data in zip(paths, (log.text(rows), log.binary(rows)), strict=True):
            path.write_bytes(data)
        return tuple(read(path) for path in paths)

    return read_both


@pytest.fixture(scope="module")
def written(fresh):
    """Return a function that reads a text log."""

    def read_back(data):
        path = fresh("log.log")
        path.write_bytes(data)
        return read(path)

    return read_back


def test_text_equals_binary(both):
    text, binary = both(log.flight())
    assert text.notes == binary.notes
    for one, other in zip(text.imus, binary.imus, strict=True):
        assert one.name == other.name
        for axis, (times, values) in other.axes().items():
            np.testing.assert_array_equal(one.axes()[axis][0], times)
            np.testing.assert_allclose(one.axes()[axis][1], values, rtol=1e-12)
        np.testing.assert_allclose(one.temperature.value, other.temperature.value, rtol=1e-12)
    (one,), (other,) = text.gnss, binary.gnss
    assert one.name == other.name
    np.testing.assert_array_equal(one.time, other.time)
    np.testing.assert_array_equal(one.fix_type, other.fix_type)
    for column in ("position", "velocity", "position_sigma", "velocity_sigma"):
        np.testing.assert_allclose(getattr(one, column), getattr(other, column), rtol=1e-7)
    (one,), (other,) = text.references, binary.references
    np.testing.assert_array_equal(one.time, other.time)
    for column in ("position", "velocity", "attitude"):
        np.testing.assert_allclose(getattr(one, column), getattr(other, column), rtol=1e-9)


def test_every_line_that_pymavlink_finds_is_found(fresh):
    reader = pytest.importorskip("pymavlink.DFReader", reason="pymavlink, which reads ArduPilot's logs, is not there")
    path = fresh("log.log")
    path.write_bytes(log.text(log.flight()))
    told, names = reader.DFReader_text(str(path)), ("IMU", "GPS", "GPA", "POS", "XKF1", "ATT")
    rows = {name: [] for name in names}
    while (message := told.recv_msg()) is not None:
        if message.get_type() in rows:
            rows[message.get_type()].append(message)
    told.filehandle.close()
    tables = TextTables(names)
    tables.take(path.read_bytes().split(b"\n"))
    for name in names:
        columns = tables.table(name)
        assert list(columns) == rows[name][0].get_fieldnames()
        for field, values in columns.items():
            np.testing.assert_array_equal(values, [getattr(message, field) for message in rows[name]])
    assert tables.bad == 0


@pytest.mark.parametrize("change", [lambda t: t.replace(b", ", b","), lambda t: t.replace(b"\n", b"\r\n")])
def test_spaces_and_line_ends_do_not_matter(written, change):
    plain = log.text(log.flight(10))
    whole, found = written(plain), written(change(plain))
    np.testing.assert_array_equal(found.imu().angular_rate.time, whole.imu().angular_rate.time)
    np.testing.assert_array_equal(found.gnss[0].position, whole.gnss[0].position)
    assert found.notes == whole.notes


@pytest.mark.parametrize("line", [b"IMU, 1, 2\n", b"IMU, 5100000, 0, x, 0, 0, 0, 0, -9.8, 30\n", b"GPS, \n"])
def test_lines_that_are_cut_or_no_numbers_are_counted(written, line):
    rows = log.text([log.imu(i) for i in range(10)])
    found = written(log.text(log.declared()) + rows + line * 3)
    assert len(found.imu().angular_rate) == 10
    assert any(note.id == "bad_line" and note.startswith("3 ") for note in found.notes)


def test_cut_anywhere_the_whole_lines_before_the_cut_are_used(written):
    head, rows = log.text(log.declared()), [log.text([log.imu(i)]) for i in range(30)]
    data = head + b"".join(rows)
    for cut in np.random.default_rng(5).integers(len(head), len(data), 40):
        found = written(data[:cut])
        whole = data[len(head) : cut].count(b"\n")
        count = len(found.imu().angular_rate) if found.imus else 0
        assert count in (whole, whole + 1)  # of a line cut in its last number nobody can tell
        assert (count == whole + 1) or (data[:cut].endswith(b"\n")) or "bad_line" in ids(found.notes)


@pytest.mark.parametrize("piece", [10, 333])
def test_small_pieces_give_the_same_log(written, monkeypatch, piece):
    data = log.text(log.flight(20))
    whole = written(data)
    monkeypatch.setattr(source, "PIECE", piece)
    monkeypatch.setattr(dataflash_text, "BATCH", 7)
    parts = written(data)
    np.testing.assert_array_equal(parts.imu().angular_rate.value, whole.imu().angular_rate.value)
    np.testing.assert_array_equal(parts.gnss[0].position, whole.gnss[0].position)
    assert parts.notes == whole.notes


def test_a_line_that_comes_before_its_format_is_not_used(written):
    found = written(
        log.text([*log.declared(log.GPS), log.imu(0), *log.declared(log.IMU), *(log.imu(i) for i in range(1, 4))])
    )
    assert len(found.imu().angular_rate) == 3


def test_a_sound_log_with_units_has_no_note_of_damage(both):
    text, binary = both([*log.declared(), *STATED, *(log.imu(i) for i in range(5))])
    assert text.notes == binary.notes


@pytest.mark.parametrize("stamp", [b"1e300", b"nan", b"inf"])
def test_a_time_that_cannot_be_costs_its_row(written, stamp):
    rows = log.text([log.imu(i) for i in range(20)])
    found = written(log.text(log.declared()) + rows + b"IMU, " + stamp + b", 0, 0, 0, 0, 0, 0, -9.8, 30\n")
    assert len(found.imu().angular_rate) == 20


@pytest.mark.parametrize("instance", [b"nan", b"inf"])
def test_an_instance_that_cannot_be_costs_its_row(written, instance):
    rows = log.text([log.imu(i) for i in range(20)])
    found = written(log.text(log.declared()) + rows + b"IMU, 6000000, " + instance + b", 0, 0, 0, 0, 0, -9.8, 30\n")
    assert len(found.imus[0].angular_rate) == 20


def test_the_leading_bytes_decide(fresh):
    path = fresh("log.csv")
    path.write_bytes(log.text(log.flight(2)))
    assert reader_of(path).format == "dataflash"


def test_flipped_bits_never_raise_anything_else(fresh):
    data, rng, read_well = log.text(log.flight(8)), np.random.default_rng(12), 0
    path = fresh("log.log")
    for _ in range(60):
        damaged = np.frombuffer(data, np.uint8).copy()
        damaged[rng.integers(0, damaged.size, 20)] ^= (1 << rng.integers(0, 8, 20)).astype(np.uint8)
        path.write_bytes(damaged.tobytes())
        began = time.perf_counter()
        try:
            found = read(path)
        except (UnreadableLogError, UsageError):
            continue
        finally:
            assert time.perf_counter() - began < 5
        read_well += bool(found.imus)
    assert read_well > 30
