"""High-rate batches: found by number and time, dated, and left out with a count where they cannot be."""

import numpy as np
import pytest

from imuwb.notes import ids
from imuwb.readers.flight.dataflash_batches import SIZE
from tests.readers.flight import dataflash_writer as log
from tests.readers.repairs import repairs

RATE, MUL = 4000.0, 1000
LENGTH = 64


def batch(number, start, *, kind=1, value=0, drop=(), late=20_000, **changes):
    """Return head and data of a batch whose x counts from a value."""
    head = {"TimeUS": start + late, "N": number % 65536, "type": kind, "instance": 2, "mul": MUL, "smp_cnt": LENGTH,
            "SampleUS": start, "smp_rate": RATE, **changes}  # fmt: skip
    rows = [(log.ISBH, tuple(head[name] for name in log.ISBH.labels.split(",")))]
    for part in range(LENGTH // SIZE):
        x = [value + part * SIZE + i for i in range(SIZE)]
        data = (start + late + 1000 * part, head["N"], part, x, [7] * SIZE, [-9] * SIZE)
        rows += [] if part in drop else [(log.ISBD, data)]
    return rows


def read_of(dataflash_of, *batches):
    return dataflash_of([*log.declared(), *(row for rows in batches for row in rows)])


def test_samples_are_counts_over_the_scale_from_the_time_of_the_first(dataflash_of):
    found = read_of(dataflash_of, batch(3, 9_000_000), batch(4, 9_500_000, kind=0, value=100))
    (imu,) = found.imus
    assert imu.name == "ISB.2"
    assert imu.angular_rate.value[:, 0].tolist() == [i / MUL for i in range(LENGTH)]
    assert imu.specific_force.value[:, 0].tolist() == [(100 + i) / MUL for i in range(LENGTH)]
    assert imu.angular_rate.time.tolist() == [9_000_000_000 + 250_000 * i for i in range(LENGTH)]
    assert ids(found.notes) == ("no_date",)


@pytest.mark.parametrize("sample", [0, 2**63, 1_000, 9_000_000 + 3 * 10**9])
def test_a_batch_without_its_own_time_is_dated_by_its_head(dataflash_of, sample):
    """The head is written when 32 samples are there; the reader cannot know the delay after."""
    (imu,) = read_of(dataflash_of, batch(0, 9_000_000_000, SampleUS=sample), batch(1, 9_001_000_000)).imus
    first = imu.angular_rate.time[0] / 1000 - 9_000_000_000
    assert first == pytest.approx(20_000 - SIZE / RATE * 1e6, abs=1)
    assert repairs(imu) == {"batch_time": LENGTH}
    assert imu.origin.repairs[0].effect == "time"


@pytest.mark.parametrize(
    "changes",
    [
        {"smp_rate": 0.0}, {"smp_rate": float("nan")}, {"smp_rate": float("inf")}, {"smp_rate": 1e-30}, {"smp_rate": -5.0},
        {"mul": 0}, {"smp_cnt": 0}, {"kind": 7}, {"TimeUS": 2**60},
    ],
    ids=str,
)  # fmt: skip
def test_a_batch_with_an_impossible_head_is_left_out_and_counted(dataflash_of, changes):
    found = read_of(dataflash_of, batch(0, 9_000_000, **changes), batch(1, 9_500_000, value=5))
    assert found.imu().angular_rate.value[0, 0] == 5 / MUL
    assert len(found.imu().angular_rate) == LENGTH
    assert ids(found.notes).count("impossible_batch") == 1


@pytest.mark.parametrize("drop", [(0,), (1,), (0, 1)])
def test_a_batch_that_lacks_data_is_left_out_and_counted(dataflash_of, drop):
    found = read_of(dataflash_of, batch(0, 9_000_000, drop=drop), batch(1, 9_500_000))
    assert len(found.imu().angular_rate) == LENGTH
    assert "cut_batch" in ids(found.notes)


def test_a_count_that_is_that_of_other_data_is_no_whole_batch(dataflash_of):
    rows = [*batch(0, 9_000_000, drop=(1,)), (log.ISBD, (9_030_000, 0, 5, *[[1] * SIZE] * 3))]
    found = read_of(dataflash_of, rows, batch(1, 9_500_000))
    assert len(found.imu().angular_rate) == LENGTH


def test_the_number_of_a_batch_begins_again(dataflash_of):
    numbers = (65535, 65536, 65535 + 65536, 2 * 65536)
    found = read_of(dataflash_of, *(batch(n, 9_000_000 + 500_000 * i, value=i) for i, n in enumerate(numbers)))
    assert found.imu().angular_rate.value[::LENGTH, 0].tolist() == [i / MUL for i in range(4)]
    assert "cut_batch" not in ids(found.notes)


def test_half_of_the_records_of_batches_is_named(dataflash_of):
    heads = [row for row in batch(0, 9_000_000) if row[0] is log.ISBH]
    found = dataflash_of([*log.declared(), log.imu(0), log.imu(1), *heads])
    (note,) = (note for note in found.notes if note.id == "unused")
    assert "ISBH (1)" in note


def test_batches_of_many_seeds_are_as_they_were_made(dataflash_of):
    for seed in range(5):
        rng = np.random.default_rng(seed)
        starts = 9_000_000 + np.cumsum(rng.integers(40_000, 400_000, 30))
        made = [
            batch(i, int(t), value=int(rng.integers(-9000, 9000)), kind=int(rng.integers(2)))
            for i, t in enumerate(starts)
        ]
        found = read_of(dataflash_of, *made)
        (imu,) = found.imus
        assert len(imu.angular_rate) + len(imu.specific_force) == 30 * LENGTH
        firsts = np.concatenate([imu.angular_rate.time[::LENGTH], imu.specific_force.time[::LENGTH]])
        assert sorted(firsts.tolist()) == [int(t) * 1000 for t in starts]
