"""Rows that are joined as they come are those of all batches."""

from itertools import pairwise

import numpy as np
import pytest

from imuwb.readers import Batch
from imuwb.readers.assembly.growing import Growing, GrowingRows


@pytest.mark.parametrize("share", [0.0, 1e-6, 0.3, 1.0])
@pytest.mark.parametrize("sizes", [[3], [0, 5], [200_000, 1], [100_000] * 7, [1, 300_000, 2, 400_000]])
def test_all_rows_are_there_in_their_order(sizes, share):
    column, at = Growing(), np.cumsum([0, *sizes])
    for first, last in pairwise(at):
        rows = np.arange(first, last, dtype=np.float64)
        column.add(np.stack([rows, -rows], axis=1), share)
    found = column.taken()
    np.testing.assert_array_equal(found[:, 0], np.arange(at[-1]))
    np.testing.assert_array_equal(found[:, 1], -np.arange(at[-1]))


def test_numbers_of_another_kind_are_kept():
    column = Growing()
    for value in (1, 2, np.nan, 4):
        column.add(np.full(100_000, value), 0.1)
    np.testing.assert_array_equal(column.taken()[::100_000], [1, 2, np.nan, 4])


def test_a_single_piece_is_not_copied():
    column, rows = Growing(), np.arange(1_000_000)
    column.add(rows, 0.5)
    assert column.taken() is rows


def test_columns_keep_their_kinds():
    batches = [Batch("imu", "imu", np.arange(i, i + 100_000), {"temperature": np.ones(100_000)}) for i in range(5)]
    rows = GrowingRows(batches[0], 0)
    for batch in batches:
        rows.add(batch)
    time, columns = rows.taken()
    assert time.dtype == np.int64
    assert time.size == columns["temperature"].size == 500_000
