"""DataFlash logs that are cut or damaged: what is whole is read, what is not is counted."""

import itertools
import math
import time
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import read, reader_of
from imuwb.readers.bytes import source
from tests.readers.flight import dataflash_writer as log
from tests.readers.flight.dataflash_writer import assert_same, imus

MICRO, SECOND = 1000, 10**9
UTC_OF_FIRST_FIX = (datetime(1980, 1, 6, tzinfo=UTC) + timedelta(weeks=log.WEEK, seconds=100_000 - 18)).timestamp()


def test_values_that_no_sensor_puts_out_are_left_out_and_counted(dataflash_of):
    rows = [log.imu(i) for i in range(20)]
    rows[7], rows[9] = log.imu(7, rate=(1e35, 0, 0)), log.imu(9, rate=(0, 201.0, 0))
    found = dataflash_of([*log.declared(), *rows])
    assert len(found.imu().angular_rate) == 18
    assert np.abs(found.imu().angular_rate.value).max() < 1
    assert [r.count for r in found.imu().origin.repairs] == [2]


def test_impossible_temperatures_speeds_and_heights_do_not_come_out(dataflash_of):
    rows = [log.imu(i) for i in range(20)]
    rows[7] = (log.IMU, (*rows[7][1][:-1], 1e35))
    rows += [log.fix(i, **({"Spd": 1e35} if i == 2 else {})) for i in range(5)]
    rows += [(log.POS, (log.START + i, 47.3, 8.5, 1e35 if i == 2 else 400.0, 0.0, 0.0)) for i in range(5)]
    found = dataflash_of([*log.declared(), *rows])
    assert np.abs(found.imu().temperature.value).max() < 1000
    assert np.nanmax(np.abs(found.gnss[0].velocity)) < 1e5
    assert np.abs(found.references[0].position).max() < 1e6


def test_an_attitude_that_is_no_number_costs_its_own_rows_only(dataflash_of):
    kind = log.Format(136, "ATT", "Qfff", "TimeUS,Roll,Pitch,Yaw")
    rows = [(kind, (log.START + 1000 * i, 0.0, 0.0, math.nan if i == 5 else 10.0)) for i in range(50)]
    rows += [(log.POS, (log.START + 1000 * i, 47.3, 8.5, 400.0, 0.0, 0.0)) for i in range(50)]
    found = dataflash_of([*log.declared(kind, log.POS), *rows])
    assert len(found.references[0]) >= 47


@pytest.mark.parametrize("size", [1, 500, 5000])
def test_a_damaged_block_in_a_flight_is_counted_and_nothing_of_it_comes_out(dataflash_of, size):
    whole, rows = dataflash_of(log.flight()), log.flight()
    half = len(rows) // 2
    before, behind = log.binary(rows[:half]), log.binary(rows[half:])
    found = dataflash_of(before + np.random.default_rng(7).bytes(size) + behind)
    for imu, sound in zip(found.imus, whole.imus, strict=True):
        assert len(sound.angular_rate) - len(imu.angular_rate) <= 1
        assert set(imu.angular_rate.time.tolist()) <= set(sound.angular_rate.time.tolist())
        assert set(imu.angular_rate.value[:, 0]) <= set(sound.angular_rate.value[:, 0])
    assert len(whole.gnss[0]) - len(found.gnss[0]) <= 1
    (note,) = (note for note in found.notes if note.id == "no_record")
    assert size <= int(note.split()[0]) <= size + rows[half - 1][0].size


def test_cut_anywhere_the_whole_prefix_is_used(dataflash_of):
    rows = log.flight(20)
    data, ends = log.binary(rows), list(itertools.accumulate(kind.size for kind, _ in rows))
    for cut in np.random.default_rng(5).integers(len(log.binary(log.declared())), len(data), 40):
        wanted = [row for row, end in zip(rows, ends, strict=True) if end <= cut and row[0] is log.IMU]
        found = dataflash_of(data[:cut])
        assert sum(len(imu.angular_rate) for imu in found.imus) == len(wanted)
        rest = cut - max(end for end in ends if end <= cut)
        assert [note.split()[0] for note in found.notes if note.id == "no_record"] == [str(rest)] * bool(rest)


@pytest.mark.parametrize("block", [64, 1000, 4096])
@pytest.mark.parametrize("kind", ["bytes", "damaged"])
def test_small_blocks_give_the_same_log(dataflash_of, monkeypatch, block, kind):
    data = log.binary(log.flight())
    if kind == "damaged":
        data = data[:3000] + b"\xa3\x95\x83" * 50 + data[3000:]
    whole = dataflash_of(data)
    monkeypatch.setattr(source, "BLOCK", block)
    monkeypatch.setattr(source, "PIECE", 64)
    parts = dataflash_of(data)
    assert_same(parts, whole)
    assert parts.notes == whole.notes


def test_a_format_on_the_edge_of_a_block_is_found(dataflash_of, monkeypatch):
    monkeypatch.setattr(source, "BLOCK", 1000)
    monkeypatch.setattr(source, "PIECE", 1000)
    rows = [log.imu(i) for i in range(50)]
    head = log.binary(log.declared(log.GPS))
    filler = log.binary([log.fix(i) for i in range(20)])
    filler = filler[: (1000 - len(head) - 40) // log.GPS.size * log.GPS.size]
    data = head + filler
    assert len(data) < 1000 < len(data) + 89
    found = dataflash_of(data + log.binary([*log.declared(log.IMU)[1:], *rows]))
    assert len(found.imu().angular_rate) == 50


@pytest.mark.parametrize("lacks", ["seqno", "x", "smp_cnt", "Id", "Label", "Mult", "FmtType", "UnitIds"])
def test_a_format_that_lacks_a_field_does_not_stop_the_reading(dataflash_of, lacks):
    kinds = [
        log.Format(f.number, f.name, f.letters, ",".join("other" if x == lacks else x for x in f.labels.split(",")))
        for f in log.ALL
    ]
    batch = [
        (log.ISBH, (0, 1, 1, 0, 100, 32, log.START, 1000.0)), (log.ISBD, (0, 1, 0, [1] * 32, [2] * 32, [3] * 32)),
        (log.FMTU, (0, log.IMU.number, "s#EEEooo-", "F-FFF000-")), (log.UNIT, (0, ord("E"), "rad/s")),
        (log.MULT, (0, ord("F"), 1.0)),
    ]  # fmt: skip
    found = dataflash_of([*log.declared(*kinds), *batch, *(log.imu(i) for i in range(5))])
    assert len(imus(found)["IMU.0"].angular_rate) == 5


@pytest.mark.parametrize("kind", [log.IMU, log.GPS, log.POS, log.XKF1], ids=lambda kind: kind.name)
def test_an_array_in_place_of_a_number_does_not_stop_the_reading(dataflash_of, kind):
    # One bit makes n, four bytes, of f, a number of as many.
    rows = [
        (k, (*v[:3], v[3].replace("f", "n"), v[4]) if k is log.FMT and v[0] == kind.number else v)
        for k, v in log.flight()
    ]
    assert dataflash_of(rows).notes


def test_an_imu_without_an_axis_is_noted(dataflash_of):
    kind = log.Format(131, "IMU", "Qfffff", "TimeUS,GyrX,GyrY,AccX,AccY,AccZ")
    found = dataflash_of([*log.declared(kind, log.GPS), (kind, (1, 0, 0, 0, 0, 0)), log.fix(0), log.fix(1)])
    assert found.imus == ()
    assert "missing_axis" in ids(found.notes)


def test_a_batch_that_is_whole_is_read_in_the_order_of_its_numbers(dataflash_of):
    data = [(log.ISBD, (0, 7, k, [32 * k + j for j in range(32)], [0] * 32, [-5] * 32)) for k in (1, 0)]
    head = (log.ISBH, (0, 7, 1, 2, 100, 64, 3_000_000, 1000.0))
    (imu,) = dataflash_of([*log.declared(), head, *data, (log.MSG, (0, "x"))]).imus
    assert imu.name == "ISB.2"
    assert imu.specific_force is None
    assert imu.angular_rate.value[:, 0].tolist() == [i / 100 for i in range(64)]
    assert imu.angular_rate.time.tolist() == [3 * SECOND + i * 10**6 for i in range(64)]


def test_less_than_a_record_is_refused(fresh):
    path = fresh("log.bin")
    path.write_bytes(log.binary(log.declared())[:40])
    with pytest.raises(UnreadableLogError):
        read(path)


def test_the_leading_bytes_decide(fresh):
    path = fresh("log.csv")
    path.write_bytes(b"\0junk" + log.binary(log.flight(2)))
    assert reader_of(path).format == "dataflash"


def test_flipped_bits_never_raise_anything_else(fresh):
    data, rng, read_well = log.binary(log.flight(8)), np.random.default_rng(11), 0
    path = fresh("log.bin")
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
