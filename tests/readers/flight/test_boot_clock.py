"""Clocks that start anew at each reboot run on, by Unix time where a message tells it and by the recorder's elsewhere."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from imuwb.readers import ReadOptions, read
from imuwb.readers.flight.boot_clock import boot_clock

SECOND = 10**9
NOW = 1_714_564_800 * SECOND
BEFORE_2000 = 946_684_799 * SECOND


def clock_of(boot, recorded, unix=None):
    """Return the clock of messages a byte apart; times in s, the recorder's and Unix time from now on."""
    boot, recorded = (np.array(values, np.float64) for values in (boot, recorded))
    told = np.zeros(boot.size, np.int64) if unix is None else np.array(unix, np.int64)
    place = np.arange(boot.size, dtype=np.int64)
    return boot_clock(place, (boot * SECOND).astype(np.int64), NOW + (recorded * SECOND).astype(np.int64), told)


def seconds(clock, place, boot):
    """Return Unix time of boot times at places in the file, in s from now on."""
    times = clock.unix(np.array(place, np.int64), (np.array(boot, np.float64) * SECOND).astype(np.int64))
    return ((times - NOW) / SECOND).tolist()


def test_the_recorders_time_is_used_where_no_message_tells_another():
    clock = clock_of([10, 11, 12], [0, 1, 2])
    assert not clock.known
    assert (clock.ahead, clock.reboots) == (0, 0)
    assert seconds(clock, [0, 1, 2], [10, 11, 12.5]) == [0, 1, 2.5]


def test_messages_that_arrive_late_do_not_move_the_clock():
    clock = clock_of(range(20), [i + 3 * (i % 5 == 0) for i in range(20)])
    assert seconds(clock, [0], [0]) == [0]


def test_unix_time_counts_before_the_recorders():
    unix = [0, NOW + 3601 * SECOND, 0]
    clock = clock_of([10, 11, 12], [0, 1, 2], unix)
    assert clock.known
    assert clock.ahead == 3600 * SECOND
    assert seconds(clock, [0, 1, 2], [10, 11, 12]) == [3600, 3601, 3602]


@pytest.mark.parametrize("told", [0, 1, 10**15, BEFORE_2000])
def test_dates_before_2000_are_not_believed(told):
    clock = clock_of([10, 11], [0, 1], [told, told])
    assert not clock.known
    assert seconds(clock, [0, 1], [10, 11]) == [0, 1]


def test_a_wrong_date_does_not_spoil_the_right_ones():
    unix = [BEFORE_2000, NOW + 3601 * SECOND, NOW + 3602 * SECOND]
    assert seconds(clock_of([10, 11, 12], [0, 1, 2], unix), [0], [10]) == [3600]


def test_each_reboot_begins_a_run_of_its_own():
    clock = clock_of([100, 101, 1, 2, 50, 3], [0, 1, 20, 21, 69, 200])
    assert clock.reboots == 2
    assert clock.start.tolist() == [0, 2, 5]
    assert seconds(clock, range(6), [100, 101, 1, 2, 50, 3]) == [0, 1, 20, 21, 69, 200]


def test_messages_between_those_of_the_clock_belong_to_the_run_before():
    boot, recorded = np.array([100, 1]) * SECOND, NOW + np.array([0, 20]) * SECOND
    clock = boot_clock(np.array([1000, 2000]), boot, recorded, np.zeros(2, np.int64))
    assert seconds(clock, [5, 1999, 2000, 9999], [100, 105, 1, 2]) == [0, 5, 20, 21]


@pytest.mark.parametrize(("back", "reboots"), [(4.9, 0), (5.1, 1)])
def test_a_step_back_of_more_than_five_seconds_is_a_reboot(back, reboots):
    assert clock_of([100, 101, 101 - back, 103], [0, 1, 2, 3]).reboots == reboots


def test_a_run_without_unix_time_goes_by_the_recorder_and_what_it_lacks():
    unix = [NOW + 3600 * SECOND, 0, 0, 0]
    clock = clock_of([100, 101, 1, 2], [0, 1, 20, 21], unix)
    assert seconds(clock, [0, 1, 2, 3], [100, 101, 1, 2]) == [3600, 3601, 3620, 3621]


def test_no_messages_make_a_clock_that_adds_nothing():
    clock = clock_of([], [])
    assert (clock.reboots, clock.ahead, clock.known) == (0, 0, False)
    assert clock.unix(np.array([0, 7]), np.array([5, 6])).tolist() == [5, 6]


@pytest.mark.slow
@given(st.lists(st.integers(7, 1000), min_size=1, max_size=6), st.integers(-(10**6), 10**6))
def test_whatever_reboots_time_is_what_it_was(lengths, ahead):
    boot = [i for length in lengths for i in range(length)]
    true = np.arange(len(boot))
    told = NOW + (true + ahead) * SECOND
    clock = clock_of(boot, true, np.where(np.array(boot) % 3 == 0, told, 0))
    assert clock.reboots == len(lengths) - 1
    assert clock.ahead == ahead * SECOND
    assert seconds(clock, true, boot) == (true + ahead).tolist()


# A real flight


@pytest.fixture(scope="module")
def flight(shared):
    return read(shared / "tlog" / "pymavlink_flight.tlog")


@pytest.fixture(scope="module")
def recorded(shared):
    return read(shared / "tlog" / "pymavlink_flight.tlog", ReadOptions(time_source="log"))


def streams(log):
    return *(imu.angular_rate for imu in log.imus), *log.gnss, *log.references


def test_a_flight_with_four_reboots_is_one_log(flight):
    assert any(note.id == "reboots" and "system 1, component 1: 4 " in note for note in flight.notes)
    assert len(streams(flight)) == 4
    for stream in streams(flight):
        assert np.diff(stream.time).min() > 0
        assert len(stream) > 6300
    assert all(whole.origin.repairs == () for whole in (*flight.imus, *flight.gnss, *flight.references))


def test_a_flight_lasts_as_long_as_its_recording(flight, recorded):
    for stream in streams(recorded):
        assert (stream.time[-1] - stream.time[0]) / SECOND == pytest.approx(2435, abs=1)
    for stream in streams(flight):  # the first messages had waited for two seconds when they were recorded
        assert (stream.time[-1] - stream.time[0]) / SECOND == pytest.approx(2437, abs=1)


def test_no_row_of_a_flight_is_moved_far_by_its_reboots(flight, recorded):
    for ours, theirs in zip(streams(flight), streams(recorded), strict=True):
        assert len(ours) == len(theirs)
        ahead = (ours.time - theirs.time) / SECOND
        assert np.median(ahead) == pytest.approx(2.1, abs=0.2)  # of Unix time over the recorder's
        assert np.abs(ahead - np.median(ahead)).max() < 2
