import numpy as np
import pytest
from scipy import optimize

from imuwb.identification.lssa import (
    Constituents,
    Noise,
    Peak,
    adjust,
    drifting_lines,
    extract,
    least_squares_spectrum,
)
from imuwb.identification.lssa.peaks import _groups, _Line
from imuwb.statistics import Estimate

BOTH = pytest.mark.parametrize("noise", [Noise(), Noise("local")], ids=["white", "local"])
DT = 0.01


def lines(time, values, noise, known=None, **options):
    return extract(
        least_squares_spectrum(adjust(time, values, known or Constituents(), noise, interval=DT)), **options
    ).peaks


@BOTH
def test_a_line_is_found_whole(record, noise):
    made = record((7.3, 0.5))
    (peak,) = lines(made.time + 1000.0, made.values, noise)
    assert peak.frequency.value == pytest.approx(7.3, abs=4 * (peak.frequency.upper - peak.frequency.value) / 2)
    assert peak.amplitude.value == pytest.approx(0.5, abs=4 * np.sqrt(2 / 8000))
    assert peak.phase.value == pytest.approx(0.5, abs=4 * 2 * np.sqrt(2 / 8000) / 0.5)  # at the first sample
    assert peak.amplitude.upper - peak.amplitude.lower == pytest.approx(2 * 1.96 * np.sqrt(2 / 8000), rel=0.1)
    # Cramér and Rao: frequency sqrt(6/n)/(pi T A/sigma), the phase at one end twice that at a known frequency
    assert peak.frequency.upper - peak.frequency.value == pytest.approx(
        1.96 * np.sqrt(6 / 8000) / (np.pi * 80 * 0.5), rel=0.1
    )
    assert peak.phase.upper - peak.phase.value == pytest.approx(1.96 * 2 * np.sqrt(2 / 8000) / 0.5, rel=0.1)
    assert peak.significant
    assert peak.in_both_halves
    assert peak.percent == pytest.approx(100 * 0.125 / 1.125, rel=0.15)


def test_the_fit_is_the_likelihoods_and_its_intervals_are_its_curvature(record):
    made = record((7.3, 0.4), n=2000)
    (peak,) = lines(made.time, made.values, Noise())
    trend = np.column_stack([np.ones(2000), made.time])

    def misfit(x):
        rest = made.values - x[1] * np.cos(2 * np.pi * x[0] * made.time + x[2])
        return rest - trend @ np.linalg.lstsq(trend, rest, rcond=None)[0]

    best = optimize.least_squares(misfit, (7.3, 0.4, 0.5), x_scale=(1e-3, 0.1, 0.1), xtol=1e-14, ftol=1e-14)
    sigma = np.sqrt(np.diagonal(np.linalg.inv(best.jac.T @ best.jac)) * 2 * best.cost / 1998)
    halves = (
        peak.frequency.upper - peak.frequency.value, peak.amplitude.upper - peak.amplitude.value, peak.phase.upper - peak.phase.value
    )  # fmt: skip
    off = np.array((peak.frequency.value, peak.amplitude.value, peak.phase.value)) - best.x
    assert np.abs(off / sigma).max() < 0.01
    assert halves == pytest.approx(tuple(1.959964 * sigma), rel=0.01)


@BOTH
def test_two_near_lines_are_two(record, noise):
    made = record((7.3, 1.0), (7.35, 1.0))  # four cycles over the record
    found = sorted(lines(made.time, made.values, noise), key=lambda p: p.frequency.value)
    assert [p.frequency.value for p in found] == pytest.approx([7.3, 7.35], abs=0.001)
    assert [p.amplitude.value for p in found] == pytest.approx([1, 1], abs=0.08)


@BOTH
@pytest.mark.parametrize("strength", [10.0, 100.0])
def test_side_lobes_of_a_strong_line_are_no_lines(record, noise, strength):
    made = record((7.3033, strength))
    (peak,) = lines(made.time, made.values, noise)
    assert peak.amplitude.value == pytest.approx(strength, abs=0.08)


@BOTH
@pytest.mark.parametrize(
    "kept", [lambda t: t % 1.0 > 0.3, lambda t: (t < 25) | (t > 55), lambda t: np.random.default_rng(5).random(t.size) > 0.5]
)  # fmt: skip
def test_side_lobes_of_gaps_are_no_lines_and_take_nothing_off(record, noise, kept):
    made = record((7.3, 3.0))
    keep = kept(made.time)
    (peak,) = lines(made.time[keep], made.values[keep], noise)
    assert peak.frequency.value == pytest.approx(7.3, abs=0.001)
    assert peak.amplitude.value == pytest.approx(3, abs=0.09)


@pytest.mark.parametrize("scale", [1e-12, 1e12])
@BOTH
def test_units_do_not_matter(record, noise, scale):
    made = record((7.3, 1.0))
    (peak,), (scaled,) = (lines(made.time, x * made.values, noise) for x in (1, scale))
    assert (scaled.amplitude.lower / scale, scaled.amplitude.upper / scale) == pytest.approx(
        (peak.amplitude.lower, peak.amplitude.upper), rel=1e-6
    )
    assert (scaled.frequency.lower, scaled.frequency.upper) == pytest.approx(
        (peak.frequency.lower, peak.frequency.upper), rel=1e-9
    )
    assert scaled.frequency.upper > scaled.frequency.lower + 1e-5
    assert (scaled.phase.lower, scaled.phase.upper) == pytest.approx((peak.phase.lower, peak.phase.upper), rel=1e-6)


def test_a_line_in_one_half_only_is_not_in_both(record):
    made = record()
    values = made.values + np.cos(2 * np.pi * 7.3 * made.time) * (made.time < 40)
    found = lines(made.time, values, Noise())
    assert found[0].significant
    assert not found[0].in_both_halves


def test_a_forced_line_is_not_found_again(record):
    made = record((7.3, 3.0), (12.0, 0.4))
    (peak,) = lines(made.time, made.values, Noise(), Constituents(forced=(7.3,)))
    assert peak.frequency.value == pytest.approx(12.0, abs=0.01)


@pytest.mark.parametrize("cycles", [6.0, 6.3, 7.0])
def test_a_line_at_the_edge_of_what_has_neighbours_has_an_interval(record, cycles):
    made = record((cycles / 80, 5.0))
    (peak,) = lines(made.time, made.values, Noise("local"))
    assert peak.amplitude.lower < 5 < peak.amplitude.upper
    assert peak.amplitude.upper - peak.amplitude.lower > 0.01


@BOTH
def test_a_line_without_noise_does_no_harm(noise):
    time = np.arange(4000) * DT
    peak, *rounding = lines(time, np.cos(2 * np.pi * 7.3 * time), noise)
    assert all(other.amplitude.value < 1e-9 for other in rounding)
    assert peak.amplitude.value == pytest.approx(1, abs=1e-6)
    assert np.isfinite([peak.percent, peak.exceedance, peak.phase.lower, peak.phase.upper]).all()


def test_at_most_as_many_lines_as_asked_for(record):
    made = record(*((3.0 + 2 * k, 1.0) for k in range(6)))
    assert len(lines(made.time, made.values, Noise(), most=4)) == 4
    assert lines(made.time, made.values, Noise(), most=0) == ()


def wandering(n, seed=3):
    rng = np.random.default_rng(seed)
    frequency = 6.0 + np.interp(
        np.arange(n), np.arange(0, n + 999, 500), 0.002 * rng.standard_normal(n // 500 + 2).cumsum()
    )
    return np.cos(2 * np.pi * np.cumsum(frequency) * DT) + 0.5 * rng.standard_normal(n)


@pytest.mark.slow
def test_a_line_that_wanders_is_one_drifting_line():
    n = 100_000
    values = wandering(n)
    peaks = lines(np.arange(n) * DT, values, Noise("local"))
    assert len(peaks) > 1
    drifting, steady = drifting_lines(values, DT, peaks)
    assert len(drifting) == 1
    assert steady == ()
    assert drifting[0].frequency == pytest.approx(6, abs=0.05)
    assert drifting[0].amplitude.value == pytest.approx(1, abs=0.1)
    assert drifting[0].in_both_halves


@pytest.mark.slow
def test_a_pure_line_stays_steady():
    n = 100_000
    time = np.arange(n) * DT
    values = 0.3 * np.cos(2 * np.pi * 6 * time) + np.random.default_rng(4).standard_normal(n)
    peaks = lines(time, values, Noise("local"))
    assert drifting_lines(values, DT, peaks) == ((), peaks)
    assert len(peaks) == 1


def test_no_two_lines_are_within_three_cycles_of_each_other(record):
    made = record((7.3, 1.0), (7.3 + 1.5 / 80, 1.0))
    frequency = np.sort([p.frequency.value for p in lines(made.time, made.values, Noise())])
    assert (np.diff(frequency) * 80 > 2.5).all()


def test_lines_within_eight_cycles_are_fitted_together():
    group = _groups([_Line(cycles / 80, 1.0, 0.0, 9.0, 0.0) for cycles in (100.0, 107.5, 116.0)], 80.0)
    assert [len(part) for part in group] == [2, 1]


def test_a_weak_line_in_the_leakage_of_a_strong_one_is_found_in_its_residual(record):
    made = record((7.3033, 100.0), (7.9, 0.2))
    assert [p.frequency.value for p in lines(made.time, made.values, Noise())] == pytest.approx([7.3033, 7.9], abs=2e-3)


def test_a_weak_line_is_in_both_halves(record):
    made = record((7.3, 0.12))  # an exceedance of about 14 in each half
    (peak,) = lines(made.time, made.values, Noise())
    assert peak.in_both_halves


@pytest.mark.parametrize(
    ("share", "away", "is_steady"), [(0.7, 0.0, True), (0.35, 0.0, False), (0.7, 1.5, True), (0.7, 2.5, False)]
)
def test_a_steady_sinusoid_near_a_line_with_half_of_its_power_makes_it_steady(share, away, is_steady):
    time = np.arange(20_000) * DT
    values = np.cos(2 * np.pi * 7.3 * time) + np.random.default_rng(5).standard_normal(time.size)
    (line,), _ = drifting_lines(values, DT, ())
    frequency, amplitude = line.frequency + away * line.resolution, line.amplitude.value * share**0.5
    made = (Estimate(x, x, x) for x in (frequency, amplitude, 0.0))
    drifting, steady = drifting_lines(values, DT, [Peak(*made, 50.0, 20.0, 1e-9, True, True)])
    assert (len(drifting), len(steady)) == ((0, 1) if is_steady else (1, 1 if away > 2 else 0))
