import numpy as np
import pytest

from imuwb.identification import stillness as judged


def stillness(axes, dt, begin=0.0):
    return judged({name: (begin + dt * np.arange(values.size), values) for name, values in axes.items()})


def still(n=60_000, seed=0):
    return np.random.default_rng(seed).standard_normal(n)


def test_a_still_record_has_no_disturbance():
    for seed in range(20):
        found = stillness({"a": still(seed=seed), "b": still(seed=seed + 100)}, 0.01)
        assert found.disturbances == ()
        assert (found.quiet_start, found.quiet_end, found.moving) == (0.0, 599.99, False)


def test_a_shock_is_found_with_its_axis_and_the_longer_quiet_part():
    values = still()
    values[20_000:20_050] += 40
    found = stillness({"a": values, "b": still(seed=1)}, 0.01)
    assert len(found.disturbances) == 1
    shock = found.disturbances[0]
    assert shock.start <= 200 < shock.end <= 202
    assert shock.axes == ("a",)
    assert found.quiet_start >= 200.5
    assert found.quiet_end == 599.99


def test_a_moving_record_is_no_static_record():
    values = still()
    values[:40_000] *= 30
    values[:40_000] += 50 * np.sin(np.arange(40_000) / 80)
    assert stillness({"a": values}, 0.01).moving


@pytest.mark.parametrize("frequency", [0.2, 1.0, 3.0])
def test_the_quiet_part_of_a_moving_record_is_found(frequency):
    """Still to 100 s, then 30 deg/s back and forth to 300 s: most of it moves, and is not what a second is judged by."""
    time = np.arange(30_000) / 100
    moving = time >= 100
    rate = 0.1 * still(30_000) + np.where(moving, 30 * np.sin(2 * np.pi * frequency * (time - 100)), 0)
    found = stillness({"a": rate, "b": still(30_000, seed=1)}, 0.01)
    assert found.moving
    assert (found.quiet_start, found.quiet_end) == (0, pytest.approx(100, abs=1.5))
    assert [d.axes for d in found.disturbances] == [("a",)]


def test_slow_drift_is_no_motion():
    drift = np.cumsum(still(seed=4)) * 0.003
    assert stillness({"a": still() + drift}, 0.01).disturbances == ()


def test_axes_may_have_clocks_gaps_and_a_start_of_their_own():
    fast, slow = still(120_000), still(30_000, seed=1)
    fast_time, slow_time = 50 + np.arange(120_000) / 200, 50 + np.arange(30_000) / 50
    fast_time[60_000:] += 1000  # a gap after 300 s
    slow_time[15_000:] += 1000
    slow[(slow_time > 1400) & (slow_time < 1401)] += 30
    found = judged({"fast": (fast_time, fast), "slow": (slow_time, slow)})
    assert len(found.disturbances) == 1
    assert found.disturbances[0].axes == ("slow",)
    assert found.disturbances[0].start == 1400
    assert found.quiet_start == 50
    assert found.quiet_end == 1400


def test_seconds_without_samples_cost_nothing_and_are_no_blocks():
    time = np.arange(6000) / 100
    time[50:] += 1.7e9  # a clock that is set: decades lie between
    found = judged({"a": (time, still(6000))})
    assert found.disturbances == ()
    assert [tuple(map(round, span)) for span in found.recorded] == [(0, 1), (1_700_000_000, 1_700_000_060)]


def test_most_of_what_is_recorded_counts_not_what_is_left_out():
    values = still(6000)
    values[2000:] *= 30
    values[2000:] += 50 * np.sin(np.arange(4000) / 80)
    time = np.arange(6000) / 100 + np.where(np.arange(6000) < 1000, 0, 1000)
    assert judged({"a": (time, values)}).moving


@pytest.mark.parametrize(("rows", "rate"), [(900, 100), (500, 2)], ids=["short", "slow"])
def test_too_little_is_not_judged(rows, rate):
    assert stillness({"a": still(rows)}, 1 / rate) is None


def test_a_slow_axis_is_left_out_beside_a_fast_one():
    found = judged({"fast": (np.arange(3000) / 100, still(3000)), "slow": (np.arange(30) * 1.0, 50 * still(30))})
    assert found is not None
    assert found.disturbances == ()


def spans(axes, rate):
    return [(d.start, d.end) for d in stillness(axes, 1 / rate).disturbances]


@pytest.mark.parametrize(("times", "disturbed"), [(2.4, False), (3.6, True)])
def test_a_second_of_three_times_the_usual_scatter_is_disturbed(times, disturbed):
    values = still(20_000)
    values[5000:5100] *= times
    assert spans({"a": values}, 100) == ([(50.0, 51.0)] if disturbed else [])


@pytest.mark.parametrize(
    ("rate", "offset", "disturbed"), [(16, 1.4, False), (16, 2.7, True), (100, 0.75, False), (100, 1.3, True)]
)
def test_a_mean_off_by_eight_standard_errors_and_a_usual_deviation_is_disturbed(rate, offset, disturbed):
    """Eight standard errors of a second are two deviations at 16 Hz, but less than one at 100 Hz."""
    values = still(200 * rate)
    values[50 * rate : 51 * rate] += offset
    assert spans({"a": values}, rate) == ([(50.0, 51.0)] if disturbed else [])


@pytest.mark.parametrize(("apart", "count"), [(8, 1), (10, 1), (12, 2)])
def test_disturbances_up_to_ten_seconds_apart_are_one(apart, count):
    values = still(20_000)
    for begin in (50, 51 + apart):
        values[100 * begin : 100 * begin + 100] += 30
    assert len(spans({"a": values}, 100)) == count


@pytest.mark.parametrize(("share", "moving"), [(0.22, False), (0.28, True)])
def test_a_record_disturbed_in_more_than_half_of_its_seconds_moves(share, moving):
    """Each of two axes is disturbed for a quarter of the time, not the same quarter, so both are still mostly."""
    a, b = still(20_000), still(20_000, seed=1)
    part = int(share * 20_000)
    a[:part] *= 10
    b[-part:] *= 10
    assert stillness({"a": a, "b": b}, 0.01).moving == moving


@pytest.mark.parametrize(("size", "excess"), [(0.0, 0.0), (5.0, 24 / 199), (30.0, 899 / 199)])
def test_the_excess_is_what_disturbances_add_to_the_mean_square(size, excess):
    values = still(19_900)
    if size:
        values = np.insert(values, 5000, np.tile([1.0, -1.0], 50) * size)  # in one of 200 seconds
    found = stillness({"a": values}, 0.01)
    assert found.excess == pytest.approx(excess, rel=0.05, abs=1e-9)
    assert found.spoilt == (size == 30)


def test_steps_between_seconds_count_too():
    values = still(20_000)
    values[5000:5200] += 20
    assert stillness({"a": values, "b": still(20_000)}, 0.01).excess > 100
