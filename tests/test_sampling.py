import numpy as np
import pytest

from imuwb.sampling import sampling

MS = 1_000_000


@pytest.mark.parametrize("rate", [30.0, 100.0, 199.9, 700.0, 800.0, 900.0, 950.0, 1000.0])
def test_stamps_cut_to_milliseconds_have_their_rate_and_no_gap(rate):
    time = np.unique((np.arange(20_000) * 1000 / rate).astype(np.int64)) * MS
    found = sampling(time)
    assert found.rate == pytest.approx(rate, rel=2e-3)
    assert found.gaps == ()


@pytest.mark.parametrize("share", [0.01, 0.05, 0.2])
def test_missing_samples_are_gaps_and_no_slower_rate(share):
    kept = np.random.default_rng(1).random(20_000) > share
    found = sampling((np.arange(20_000, dtype=np.int64) * 10 * MS)[kept])
    assert found.rate == pytest.approx(100, rel=1e-6)
    assert found.missing == pytest.approx(0.01 * (~kept).sum(), rel=0.01)


def test_a_gap_in_rounded_stamps_is_found():
    time = (np.arange(20_000) * 1000 / 700).astype(np.int64) * MS
    found = sampling(np.concatenate([time[:9000], time[9100:]]))
    assert len(found.gaps) == 1
    assert found.gaps[0][1] == pytest.approx(0.144, abs=2e-3)
    assert found.breaks == (9000,)
    assert found.rate == pytest.approx(700, rel=2e-3)


def test_jitter_is_the_scatter_of_the_steps():
    rng = np.random.default_rng(0)
    time = np.sort((np.arange(5000) * 10 + rng.normal(0, 1, 5000)) * MS).astype(np.int64)
    assert sampling(time).jitter == pytest.approx(0.1 * 2**0.5, rel=0.05)
    assert sampling(np.arange(100) * MS).jitter == 0


def test_fewer_than_two_samples_have_no_rate():
    assert sampling(np.zeros(1, np.int64)).rate is None


@pytest.mark.parametrize("rows", [22, 3002])
def test_steps_that_take_turns_are_no_gaps(rows):
    rng = np.random.default_rng(0)
    steps = np.where(np.arange(rows) % 2, 380, 620) * MS + rng.integers(-5, 6, rows) * MS  # one more short than long
    found = sampling(np.cumsum(steps))
    assert found.gaps == ()
    assert found.rate == pytest.approx(2, rel=0.02)


def test_a_missing_sample_among_steps_that_take_turns_is_a_gap():
    time = np.cumsum(np.where(np.arange(3000) % 2, 620, 380)) * MS
    assert 1500 in sampling(np.delete(time, 1500)).breaks


def test_a_sample_that_is_missing_every_now_and_then_is_no_uneven_clock():
    time = np.arange(20_000) * 10 * MS
    assert len(sampling(time[np.arange(time.size) % 101 != 50]).gaps) == 198


@pytest.mark.parametrize(("step", "gaps"), [(149, 0), (151, 2)])
def test_a_step_of_more_than_one_and_a_half_intervals_is_a_gap(step, gaps):
    steps = np.full(200, 100 * MS)
    steps[[50, 70]] = step * MS
    assert len(sampling(np.cumsum(steps)).gaps) == gaps


@pytest.mark.parametrize(("long", "gaps"), [(175, False), (185, True)])
def test_an_uneven_clock_has_steps_of_up_to_1_8_intervals(long, gaps):
    steps = np.where(np.arange(3001) % 2, long, 200 - long) * MS
    assert bool(sampling(np.cumsum(steps)).gaps) == gaps


def test_a_few_gaps_in_rounded_stamps_leave_the_rate():
    time = (np.arange(20_000) * 1000 / 950).astype(np.int64) * MS
    kept = np.ones(time.size, bool)
    for start in range(1000, 17_000, 2000):  # eight gaps, in 4 % of the sums
        kept[start : start + 50] = False
    found = sampling(time[kept])
    assert len(found.gaps) == 8
    assert found.rate == pytest.approx(950, rel=2e-3)


def test_one_sample_missing_of_many_is_a_gap():
    assert sampling(np.delete(np.arange(20_000) * 10 * MS, 7000)).breaks == (7000,)


def test_a_clock_prints_itself_in_a_line():
    text = str(sampling(np.delete(np.arange(1000) * 10 * MS, [40, 41, 700])))
    assert text.startswith("100 Hz, 2 gaps (longest 0.03 s), jitter ")
