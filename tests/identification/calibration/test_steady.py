import numpy as np
import pytest

from imuwb.identification.calibration import shared, steady

DT, SPAN = 0.02, np.full(3, 9.8)


def staircase(levels, seconds=20.0, ramp=1.0, sigma=0.02, seed=0):
    """Return levels joined by ramps in column 0, noise on all three, and the rows (first, end) of each level."""
    parts, rows, at = [], [], 0
    for i, level in enumerate(levels):
        if i:
            parts.append(np.linspace(levels[i - 1], level, round(ramp / DT)))
            at += parts[-1].size
        parts.append(np.full(round(seconds / DT), float(level)))
        rows.append((at, at + parts[-1].size))
        at += parts[-1].size
    values = np.zeros((at, 3))
    values[:, 0] = np.concatenate(parts)
    return values + sigma * np.random.default_rng(seed).standard_normal(values.shape), rows


def test_each_level_is_one_stretch_within_its_rows():
    values, rows = staircase([0, 3, 9, 0, -9])
    found = steady(values, DT, 5.0, SPAN)
    assert len(found) == 5
    for (a, b), (first, end) in zip(found, rows, strict=True):
        assert first <= a < b <= end
        assert (b - a) > 0.85 * (end - first)


def test_levels_without_noise_are_found_too():
    values, _ = staircase([0, 3, 9], sigma=0.0)
    assert len(steady(values, DT, 5.0, SPAN)) == 3


def test_noise_alone_is_one_stretch():
    values = np.random.default_rng(1).standard_normal((5000, 3))
    ((first, end),) = steady(values, DT, 10.0, 100 * np.ones(3))
    assert end - first > 4900


def test_a_knock_parts_a_stretch():
    values = 0.02 * np.random.default_rng(2).standard_normal((4000, 3))
    values[2000:2020, 1] += 3
    found = steady(values, DT, 5.0, SPAN)
    assert len(found) == 2
    assert found[0][1] <= 2000
    assert found[1][0] >= 2020


def test_a_slow_drift_is_no_position():
    values = 0.02 * np.random.default_rng(3).standard_normal((4000, 3))
    values[:, 2] += np.linspace(0, 1.0, 4000)
    assert steady(values, DT, 10.0, SPAN) == []


def test_what_moves_all_the_time_has_none():
    t = np.arange(4000) * DT
    values = np.stack([np.sin(t), np.cos(0.7 * t), np.sin(1.3 * t)], axis=1)
    assert steady(values, DT, 5.0, np.ones(3)) == []


@pytest.mark.parametrize("count", [0, 10, 99])
def test_too_few_samples_have_none(count):
    assert steady(np.zeros((count, 3)), DT, 1.0, SPAN) == []


def test_shorter_stretches_are_left_out():
    values, _ = staircase([0, 3, 9], seconds=4.0)
    assert steady(values, DT, 5.0, SPAN) == []


def test_spans_that_lie_in_both_lists():
    a, b = [(0.0, 10.0), (12.0, 20.0)], [(1.0, 13.0), (15.0, 16.0), (19.0, 30.0)]
    assert shared(a, b) == [(1.0, 10.0), (12.0, 13.0), (15.0, 16.0), (19.0, 20.0)]
    assert shared(a, []) == []


def test_a_small_step_within_the_noise_of_samples_parts_stretches():
    values = 0.02 * np.random.default_rng(4).standard_normal((4000, 3))
    values[2000:, 0] += 0.06
    found = steady(values, DT, 5.0, SPAN)
    assert [(a < 2000) == (b <= 2025) for a, b in found] == [True, True]


def test_a_hand_may_wander_within_the_tolerance():
    values, rows = staircase([0, 9.8, 0], seconds=15.0, sigma=0.001)
    values[:, 1] += 0.03 * (np.arange(len(values)) * DT % 4 > 2)
    assert steady(values, DT, 5.0, SPAN) == []
    found = steady(values, DT, 5.0, SPAN, 0.05)
    assert [any(a <= f and e <= b for a, b in rows) for f, e in found] == [True] * 3


def test_a_shake_about_the_same_mean_parts_a_stretch():
    values = 0.02 * np.random.default_rng(5).standard_normal((4000, 3))
    shake = 4 * values[2000:2100].reshape(4, 25, 3)
    values[2000:2100] = (shake - shake.mean(axis=1, keepdims=True)).reshape(100, 3)
    found = steady(values, DT, 5.0, SPAN)
    assert [(a < 2000, b <= 2025) for a, b in found] == [(True, True), (False, False)]


@pytest.mark.parametrize(("drift", "is_steady"), [(0.1, True), (0.3, False)])
def test_halves_may_differ_by_a_hundredth_of_the_span(drift, is_steady):
    values = 0.02 * np.random.default_rng(6).standard_normal((4000, 3))
    values[:, 2] += np.linspace(0, drift, 4000)
    assert len(steady(values, DT, 10.0, SPAN)) == int(is_steady)


def test_rounding_of_a_sensor_without_noise_parts_no_stretch():
    values = np.zeros((4000, 3))
    values.reshape(160, 25, 3)[::4] += 1e-10
    ((first, end),) = steady(values, DT, 10.0, SPAN)
    assert end - first > 3900
