"""Work on long records: in blocks, and by one thread at a time."""

import threading

import numpy as np

from imuwb.arrays import LARGE, all_finite, alone, blocks_of


def test_blocks_cover_all_rows_once():
    rows = np.concatenate([np.arange(1_000_000)[part] for part in blocks_of(1_000_000)])
    np.testing.assert_array_equal(rows, np.arange(1_000_000))
    assert list(blocks_of(0)) == []


def test_a_number_that_is_not_finite_is_found_anywhere():
    values = np.zeros((600_000, 2))
    assert all_finite(values)
    values[599_999, 1] = np.inf
    assert not all_finite(values)


def test_work_on_a_long_record_may_contain_such_work_and_excludes_other_threads():
    done = []

    def work():
        with alone(LARGE + 1), alone(LARGE + 1):
            done.append("inside")

    with alone(LARGE + 1):
        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        thread.join(0.05)
        assert done == []
    thread.join(10)
    assert done == ["inside"]
    with alone(LARGE):  # a shorter one waits for none
        assert not threading.Thread(target=work).is_alive()
