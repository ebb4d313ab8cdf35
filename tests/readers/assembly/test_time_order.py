"""How far a row may be from others before its time is repaired, and how."""

import numpy as np
import pytest

from imuwb.readers.assembly.time_order import in_order
from imuwb.units import SECOND


def repaired(time):
    """Return the numbers of the rows in order, and {id: count} of the repairs."""
    repairs = []
    time = np.asarray(time, np.int64)
    ordered, columns = in_order(time, {"row": np.arange(time.size)}, repairs)
    assert (np.diff(ordered) >= 0).all()
    return columns["row"].tolist(), {repair.what.id: repair.count for repair in repairs}


def with_steps_back(steps, rows):
    """Return times, 0.1 s apart, of a clock that is set back evenly so many times."""
    segment = np.arange(rows) * (steps + 1) // rows
    return np.arange(rows) * (SECOND // 10) - segment * 1000 * SECOND


@pytest.mark.parametrize(("back", "repairs"), [(SECOND, {"out_of_order": 15}), (SECOND + 1, {"set_back": 1})])
def test_a_second_back_is_late_and_more_is_a_clock_set_back(back, repairs):
    time = np.arange(30) * (SECOND * 3 // 10)
    time[15:] -= back + SECOND * 3 // 10
    found = repaired(time)[1]
    assert found.keys() == repairs.keys()
    assert found.get("set_back") == repairs.get("set_back")


@pytest.mark.parametrize("more", [0, 1])
@pytest.mark.parametrize("end", [0, -1])
@pytest.mark.parametrize(("step", "far"), [(SECOND // 10, 86_400 * SECOND), (1000 * SECOND, 10 * 10_000 * SECOND)])
def test_a_first_or_last_row_is_damaged_beyond_a_day_and_ten_durations(step, far, end, more):
    time = np.arange(12) * step
    time[end] = time[1] - far - more if end == 0 else time[-2] + far + more
    assert repaired(time)[1] == ({"lone_time": 1} if more else {})


@pytest.mark.parametrize(("rows", "repairs"), [(11, {}), (12, {"lone_time": 1})])
def test_among_few_rows_none_is_called_damaged(rows, repairs):
    time = np.arange(rows) * (SECOND // 10)
    time[0] = -(10**6) * SECOND
    assert repaired(time)[1] == repairs


@pytest.mark.parametrize(("steps", "rows"), [(1, 50), (10, 220), (10, 999), (12, 1200), (20, 2000)])
def test_a_clock_may_be_set_back_ten_times_or_once_in_a_hundred_rows(steps, rows):
    order, repairs = repaired(with_steps_back(steps, rows))
    assert (order, repairs) == (list(range(rows)), {"set_back": steps})


@pytest.mark.parametrize(("steps", "rows"), [(11, 220), (13, 1299), (21, 2000)])
def test_rows_that_step_back_more_often_are_in_no_order(steps, rows):
    order, repairs = repaired(with_steps_back(steps, rows))
    assert set(repairs) == {"out_of_order"}
    assert order[-1] < rows // steps  # the first segment is the latest


def test_a_time_that_int64_holds_with_its_differences_is_possible():
    assert repaired([2**62 - 2, 2**62 - 1, 2**62, 2**62 + 1]) == ([0, 1], {"impossible_time": 2})
    assert repaired([-(2**62), 1 - 2**62, 2 - 2**62]) == ([1, 2], {"impossible_time": 1})


def test_a_few_rows_that_cannot_be_continued_are_sorted():
    assert repaired([2**62 - 1, -(2**62) + 1, 0]) == ([1, 2, 0], {"out_of_order": 2})
