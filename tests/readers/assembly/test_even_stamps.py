"""Stamps as recorders make them, from even samples whose times are known."""

import numpy as np
import pytest

from imuwb.readers.assembly.even_stamps import even_stamps, spread_stamps
from imuwb.readers.assembly.sample_times import Clock, sample_times
from imuwb.sampling import sampling
from imuwb.units import SECOND


def nanoseconds(seconds):
    return np.rint(np.asarray(seconds) * SECOND).astype(np.int64)


def even(rate, rows, seed=0):
    """Return the times of even samples, s."""
    return np.random.default_rng(seed).uniform(0, 1) + np.arange(rows) / rate


def in_bursts(time, rng, rows, step, scatter=0.0):
    """Return the stamps of samples that arrive some at a time, after the last of them."""
    stamps, first, free = np.empty(time.size), 0, 0.0
    while first < time.size:
        last = min(first + int(rng.integers(rows[0], rows[1] + 1)), time.size)
        steps = step * (1 + scatter * rng.uniform(-1, 1, last - first))
        stamps[first:last] = max(time[last - 1], free) + np.cumsum(steps)
        free, first = stamps[last - 1], last
    return nanoseconds(stamps)


def assert_even(stamps, time, cause, *, within, lost=0):
    """Assert that stamps become the times of the samples, apart from one delay for all."""
    found = even_stamps(stamps)
    assert found is not None
    assert (found.cause, found.lost) == (cause, lost)
    assert (np.diff(found.time) > 0).all()
    off = found.time / SECOND - time
    assert np.abs(off - np.median(off)).max() < within
    return found


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("rate", "rows", "step", "scatter"),
    [
        (100, (2, 7), 0.0019, 0),  # a serial line
        (99.3, (4, 4), 0.0019, 0),  # always as many
        (1000, (16, 16), 5e-5, 0.3),  # a USB converter that waits for 16 ms
        (250, (60, 140), 4e-4, 0.5),  # a radio that pauses for half a second
        (400, (1, 3), 1e-4, 0),
    ],
)
def test_samples_that_arrive_in_bursts_are_even(rate, rows, step, scatter, seed):
    time = even(rate, 6000, seed)
    stamps = in_bursts(time, np.random.default_rng(seed), rows, step, scatter)
    found = assert_even(stamps, time, "arrival", within=max(0.6, 0.1 * rows[1]) / rate)
    clock = sampling(found.time)
    assert clock.rate == pytest.approx(rate, rel=1e-3)
    assert clock.gaps == ()


def test_lost_samples_are_gaps_among_samples_that_arrive_in_bursts():
    time = np.delete(even(100, 6000), [*range(2000, 2003), 4000])
    stamps = in_bursts(time, np.random.default_rng(1), (2, 7), 0.0019)
    clock = sampling(assert_even(stamps, time, "arrival", within=0.0301, lost=4).time)
    assert clock.missing == pytest.approx(0.04, abs=1e-3)


@pytest.mark.parametrize(
    ("rate", "tick"),
    [
        (300, 0.001),
        (1600, 0.001),
        (100, 1.0),
        (99.3, 1.0),
        (128, 0.01),
        (100, 1 / 64),
        (100, 0.008),
        (100, 0.009),
        (100, 0.0055),
    ],
)
def test_a_coarse_clock_is_made_fine(rate, tick):
    time = even(rate, 12_000)
    found = assert_even(nanoseconds(np.floor(time / tick) * tick), time, "coarse", within=0.02 / rate)
    assert sampling(found.time).rate == pytest.approx(rate, rel=1e-4)


@pytest.mark.parametrize("seed", range(12))
def test_the_ticks_of_a_clock_are_no_lost_samples(seed):
    rng = np.random.default_rng(seed)
    rate = 100 * (1 + rng.uniform(-0.01, 0.01))
    time = even(rate, 8000, seed)
    found = assert_even(nanoseconds(np.floor(time)), time, "coarse", within=0.8 / rate)
    assert sampling(found.time).rate == pytest.approx(rate, rel=2e-4)


def test_lost_samples_of_a_coarse_clock_are_gaps_of_whole_samples():
    kept = np.random.default_rng(2).random(20_000) > 0.005
    time = even(300, 20_000)[kept]
    found = assert_even(nanoseconds(np.floor(time * 1000) / 1000), time, "coarse", within=0.1 / 300, lost=(~kept).sum())
    assert sampling(found.time).rate == pytest.approx(300, rel=1e-4)


def test_samples_that_share_the_stamp_of_their_packet_are_even():
    time = even(104, 6000)
    stamps = nanoseconds(time[np.minimum((np.arange(6000) // 4 + 1) * 4 - 1, 5999)])
    assert_even(stamps, time, "arrival", within=1e-3)


def test_late_stamps_of_a_sensor_whose_clock_drifts_follow_it():
    time = np.arange(400_000) / 100 * (1 + 2e-5 * np.arange(400_000) / 400_000)  # 80 ms in 4000 s
    stamps = nanoseconds(np.ceil(time * 62.5) / 62.5)
    assert_even(stamps, time, "coarse", within=0.005)


def test_stamps_that_scatter_about_even_times_are_evened_and_the_scatter_is_stated():
    time, rng = even(100, 20_000), np.random.default_rng(3)
    stamps = nanoseconds(time + rng.normal(0, 0.0015, time.size))
    found = assert_even(stamps, time, "jitter", within=2e-4)
    assert found.scatter == pytest.approx(0.0015, rel=0.05)


def test_samples_that_are_late_by_several_periods_are_even():
    time, rng = even(100, 20_000), np.random.default_rng(3)
    found = even_stamps(np.sort(nanoseconds(time + np.abs(rng.normal(0, 0.02, time.size)))))
    assert found is not None
    assert sampling(found.time).rate == pytest.approx(100, rel=1e-5)


def test_a_rounded_clock_is_even():
    time = even(152.35, 12_000)
    assert_even(nanoseconds(np.round(time, 3)), time, "jitter", within=1e-4)


@pytest.mark.parametrize(("batch", "rate", "pause"), [(1024, 1000, 0.5), (32, 1000, 0.068), (256, 4000, 2.5)])
@pytest.mark.parametrize("scatter", [0, 0.1])
def test_batches_of_a_sensor_keep_the_gaps_between_them(batch, rate, pause, scatter):
    starts = np.cumsum(np.random.default_rng(4).uniform(0, scatter, 60) + batch / rate + pause)
    stamps = nanoseconds((starts[:, None] + np.arange(batch) / rate).ravel())
    assert even_stamps(stamps) is None
    clock = sampling(stamps)
    assert clock.rate == pytest.approx(rate, rel=1e-6)
    assert len(clock.gaps) == 59


def bursts(rows, step, rate, count=6000, late=0.0):
    """Return stamps (ns) of even samples that arrive in bursts of some rows, a step (s) apart, each late by up to so many s."""
    last = (np.arange(count // rows) + 1) * rows / rate
    last += np.random.default_rng(8).uniform(0, late, last.size)
    return nanoseconds((last[:, None] + step * np.arange(rows)).ravel())


def repairs_of(stamps, *, exact=False):
    """Return the repairs of an IMU with such stamps."""
    found = []
    sample_times(stamps, {"angular_rate": np.zeros((stamps.size, 3))}, Clock("imu", exact), found)
    return found


@pytest.mark.parametrize("late", [0, 0.01])
@pytest.mark.parametrize(
    ("rows", "step", "rate"), [(10, 1e-5, 104), (12, 0.0019, 100), (25, 0.0011, 100), (16, 5e-5, 137), (8, 0.0007, 250)]
)
def test_bursts_of_one_size_are_arrivals_where_no_sensor_samples_so(rows, step, rate, late):
    found = even_stamps(bursts(rows, step, rate, late=late))
    assert found is not None
    assert found.cause == "arrival"
    assert sampling(found.time).rate == pytest.approx(rate, rel=1e-3)


@pytest.mark.parametrize("step", [0.001, 0.000_987])  # 0.987 ms: that of a sensor that is off by 1 %
def test_batches_that_may_be_arrivals_are_named_with_both_rates(step):
    stamps = bursts(32, step, 321 if step != 0.001 else 320)
    assert even_stamps(stamps) is None
    (repair,) = repairs_of(stamps)
    assert repair.what.id == "batches"
    assert all(text in repair.what for text in ("32", f"{1 / step:.4g} Hz", "--even"))


def test_batches_of_a_clock_of_the_sensor_are_not_doubted():
    assert not repairs_of(bursts(32, 0.001, 320), exact=True)
    assert not repairs_of(nanoseconds(even(100, 1000)))


@pytest.mark.parametrize("share", [0, 0.01, 0.05, 0.2])
def test_even_stamps_are_kept_whatever_is_lost(share):
    kept = np.random.default_rng(5).random(20_000) >= share
    assert even_stamps(nanoseconds(even(100, 20_000)[kept])) is None


def test_uneven_samples_are_not_called_even():
    rng = np.random.default_rng(6)
    assert even_stamps(nanoseconds(np.cumsum(rng.uniform(0.005, 0.015, 20_000)))) is None
    assert even_stamps(nanoseconds(np.cumsum(rng.exponential(0.01, 20_000)))) is None


@pytest.mark.parametrize("pause", [1.5, 5, 100])
def test_parts_between_pauses_are_even(pause):
    time = even(100, 3000)
    time = np.concatenate([time, time[-1] + pause + np.arange(3000) / 100])
    bursty = in_bursts(time, np.random.default_rng(7), (2, 7), 0.0019)
    for stamps in (bursty, nanoseconds(np.floor(time * 125) / 125), nanoseconds(np.floor(time * 2) / 2)):
        found = even_stamps(stamps)
        assert found is not None
        clock = sampling(found.time)
        assert clock.rate == pytest.approx(100, rel=1e-3)
        ((_, length),) = clock.gaps
        assert length == pytest.approx(pause, abs=0.52)


def test_few_rows_show_nothing():
    assert even_stamps(nanoseconds([0, 0, 0, 1, 1, 1, 2, 2, 2])) is None


def test_equal_stamps_are_spread_up_to_the_next_one():
    assert spread_stamps(np.array([0, 10, 10, 20, 40, 40])).tolist() == [0, 10, 15, 20, 40, 45]
    assert (np.diff(spread_stamps(np.zeros(5, np.int64))) > 0).all()


@pytest.mark.parametrize("tick", [4, 10, 128])  # 128 s: time since 1970 in single precision
def test_a_clock_that_ticks_more_rarely_than_a_recording_pauses_loses_nothing(tick):
    time = np.arange(60_000) / 100
    stamps = nanoseconds(np.floor(time / tick) * tick)
    found = []
    times, _ = sample_times(stamps, {"angular_rate": np.zeros((stamps.size, 3))}, Clock("imu"), found)
    assert times.size == stamps.size
    assert np.median(np.diff(times)) == pytest.approx(1e7, rel=0.01)
