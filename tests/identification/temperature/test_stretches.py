from itertools import pairwise

import numpy as np
import pytest

from imuwb.identification.temperature import smooth_temperature, stretches

RNG = np.random.default_rng(1)


def noisy(celsius):
    return celsius + 0.05 * RNG.standard_normal(celsius.size)


def test_a_steady_log_is_one_set_point():
    time = np.arange(0, 3600.0)
    cut, (only,) = stretches(time, noisy(np.full(time.size, -30.0)), 100.0)
    assert cut == "set-point"
    assert (only.start, only.end) == (0.0, 3599.0)
    assert only.celsius == pytest.approx(-30, abs=0.01)
    assert only.spread == pytest.approx(0.05, rel=0.1)
    assert only.rising is None


def test_plateaus_between_fast_changes_are_found_and_know_where_they_came_from():
    levels, dwell, change = (20.0, 40.0, 0.0), 3600, 300
    corners = [(k * (dwell + change) + edge, t) for k, t in enumerate(levels) for edge in (0, dwell)]
    time = np.arange(0, corners[-1][0] + 1.0)
    cut, found = stretches(time, noisy(np.interp(time, *zip(*corners, strict=True))), 100.0)
    assert cut == "plateaus"
    assert [s.celsius for s in found] == pytest.approx(levels, abs=0.1)
    assert [s.rising for s in found] == [None, True, False]
    for k, s in enumerate(found):
        begin = k * (dwell + change)
        assert begin - 30 <= s.start <= begin + 30
        assert begin + dwell - 30 <= s.end <= begin + dwell + 30


def test_a_log_that_settles_first_is_cut_to_its_plateau():
    time = np.arange(0, 7200.0)
    celsius = noisy(-30 + 15 * np.exp(-time / 300))
    cut, (only,) = stretches(time, celsius, 100.0)
    assert cut == "plateaus"
    assert only.start > 500
    assert only.celsius == pytest.approx(-30, abs=0.3)


def test_a_ramp_up_and_down_is_cut_into_bins_of_both_legs():
    time = np.arange(0, 7201.0)
    celsius = noisy(-20 + 40 * (1 - np.abs(time / 3600 - 1)))
    cut, found = stretches(time, celsius, 100.0)
    assert cut == "bins"
    assert sorted({s.nominal for s in found}) == [-17.5, -12.5, -7.5, -2.5, 2.5, 7.5, 12.5, 17.5]
    for s in found:
        inside = (time >= s.start) & (time <= s.end)
        assert abs(celsius[inside].mean() - s.nominal) < 0.3
        assert s.rising == (s.end < 3650)
        assert 400 < s.end - s.start < 500
    ends = [(s.start, s.end) for s in found]
    assert all(b[0] >= a[1] for a, b in pairwise(ends))


def test_nothing_is_cut_from_near_a_turn():
    time = np.arange(0, 7201.0)
    celsius = -20 + 40 * (1 - np.abs(time / 3600 - 1))
    (_, whole), (_, found) = (stretches(time, celsius, 100.0, around=around) for around in (0.0, 200.0))
    assert len(found) == len(whole)
    assert all(s.end < 3600 - 195 or s.start > 3600 + 195 for s in found)
    assert {(s.start, s.end) for s in whole} - {(s.start, s.end) for s in found} == {
        (s.start, s.end) for s in whole if abs(s.start - 3600) < 100 or abs(s.end - 3600) < 100
    }


def test_bins_widen_until_they_hold_enough():
    time = np.arange(0, 1001.0)
    celsius = np.linspace(-40, 60, time.size)
    widths = {rate: np.diff([s.nominal for s in stretches(time, celsius, rate)[1]])[0] for rate in (1000.0, 250.0, 1.0)}
    assert widths == {1000.0: 5.0, 250.0: 10.0, 1.0: 20.0}
    assert np.diff([s.nominal for s in stretches(time, celsius, 1000.0, "bins", 25.0)[1]])[0] == 25.0


def test_a_thermometer_is_smoothed_and_continued_to_the_ends():
    time = np.arange(0, 1000.0)
    true = 20 + 0.01 * time
    at = np.arange(100, 800, 0.01)
    found = smooth_temperature(time, true + 0.1 * RNG.standard_normal(time.size), at)
    assert np.abs(found - np.interp(at, time, true)).max() < 0.12
    np.testing.assert_allclose(smooth_temperature(time, true, at), 20 + 0.01 * at, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("span", "cut"), [(1.7, "set-point"), (2.5, "bins")])
def test_a_log_within_two_degrees_is_one_set_point(span, cut):
    time = np.arange(0, 3600.0)
    assert stretches(time, 20 + span * np.linspace(0, 1, time.size), 100.0)[0] == cut


@pytest.mark.parametrize(("dip", "turns"), [(1.5, False), (3.0, True)])
def test_a_ramp_that_goes_back_by_two_degrees_has_turned(dip, turns):
    corners, celsius = (0, 1800, 2100, 3900), (-20.0, 0.0, -dip, 20.0)
    time = np.arange(0, 3901.0)
    _, found = stretches(time, np.interp(time, corners, celsius), 100.0, "bins", 5.0)
    assert any(s.rising is False for s in found) == turns


@pytest.mark.parametrize(("held", "cut"), [(0.4, "bins"), (0.7, "plateaus")])
def test_plateaus_make_up_half_of_a_log(held, cut):
    time = np.arange(0, 7201.0)
    begin = 7200 * held
    celsius = np.interp(time, [0, begin, 7200], [20.0, 20.0, 60.0])
    assert stretches(time, celsius, 100.0)[0] == cut


@pytest.mark.parametrize(("minutes", "found"), [(8, 0), (14, 1)])
def test_a_plateau_lasts_three_times_as_long_as_the_log_takes_for_its_span(minutes, found):
    """The log takes 5 minutes for a degree."""
    time = np.arange(0, 12_001.0)
    celsius = np.interp(time, [0, 5000, 5000 + 60 * minutes, 12_000], [0.0, 20.0, 20.0, 40.0])
    longer = [s for s in stretches(time, celsius, 100.0, "plateaus")[1] if s.end - s.start > 500]
    assert len(longer) == found


def test_a_smoothed_thermometer_follows_a_bend():
    time = np.arange(0, 1000.0)
    found = smooth_temperature(time, 20 + (time / 300 - 1) ** 2, time)
    assert np.abs(found - 20 - (time / 300 - 1) ** 2).max() < 0.15
