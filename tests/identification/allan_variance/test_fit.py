from dataclasses import replace

import numpy as np
import pytest

from imuwb.identification import allan, find_lines, fit_allan
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, RateRamp, Sinusoid, WhiteNoise

DT = 0.01


def fit(process, n=400_000, seed=0, lines=False):
    values = process.sample(n, DT, np.random.default_rng(seed))
    return fit_allan(allan(values, DT), find_lines(values, DT) if lines else ())


def test_finds_what_is_there_and_limits_what_is_not():
    found = fit(WhiteNoise(0.005) + FlickerNoise(0.002)).coefficients
    assert found["N"].value == pytest.approx(0.005, rel=0.01)
    assert found["B"].lower < 0.002 < found["B"].upper
    for letter in "QKR":
        assert found[letter].value is None
        assert found[letter].lower is None
        assert found[letter].upper > 0


@pytest.mark.slow
def test_all_five_terms_at_once():
    truth = {"Q": 2e-4, "N": 0.005, "B": 0.004, "K": 1e-3, "R": 3e-5}
    process = Quantization(2e-4) + WhiteNoise(0.005) + FlickerNoise(0.004) + RandomWalk(1e-3) + RateRamp(3e-5)
    found = fit(process, n=1_000_000).coefficients
    for letter in "QN":
        assert found[letter].lower < truth[letter] < found[letter].upper
    for letter in "BKR":  # long-time terms share few degrees of freedom: found, or limited above the truth
        assert found[letter].upper > truth[letter] * 0.8


@pytest.mark.slow
def test_a_line_is_taken_into_the_sum():
    values = (WhiteNoise(0.002) + Sinusoid(0.05, 0.56)).sample(600_000, DT, np.random.default_rng(2))
    lines = find_lines(values, DT)
    assert len(lines) == 1
    assert lines[0].frequency == pytest.approx(0.56, abs=2e-3)
    assert 0.05 in lines[0].amplitude
    with_line, without = fit_allan(allan(values, DT), lines), fit_allan(allan(values, DT))
    assert with_line.coefficients["N"].value == pytest.approx(0.002, rel=0.02)
    assert with_line.misfit < without.misfit


def test_white_noise_has_no_lines():
    records = [WhiteNoise(1.0).sample(100_000, DT, np.random.default_rng(seed)) for seed in range(40)]
    assert sum(bool(find_lines(values, DT)) for values in records) <= 2


def test_slopes_of_pure_processes():
    for process, letter, slope in (
        (WhiteNoise(1.0), "N", -0.5),
        (RandomWalk(1.0), "K", 0.5),
        (FlickerNoise(1.0), "B", 0.0),
    ):
        region = next(r for r in fit(process, seed=5).regions if r.letter == letter)
        assert region.slope.lower - 0.02 < slope < region.slope.upper + 0.02
        assert region.nominal == slope


@pytest.mark.slow
def test_correlation_time_is_the_middle_of_the_flat_part():
    true = WhiteNoise(0.005) + FlickerNoise(0.004) + RandomWalk(2e-4)
    found = fit(true, n=2_000_000)
    tau = np.geomspace(0.1, 1e4, 2000)
    deviation = np.sqrt(true.allan_variance(tau, 0.01))
    flat = tau[deviation < 1.05 * deviation.min()]
    tc = found.correlation_time
    assert (tc.lower, tc.upper) == pytest.approx((flat[0], flat[-1]), rel=0.4)
    assert tc.value == pytest.approx((tc.lower + tc.upper) / 2)
    assert found.gauss_markov_time == pytest.approx(tc.value / 1.8926)


def test_every_axis_with_bias_instability_has_a_correlation_time_or_a_bound():
    found = fit(WhiteNoise(0.005) + FlickerNoise(0.004))
    assert found.coefficients["B"].value is not None
    assert found.correlation_time.lower > 1
    white = fit(WhiteNoise(0.005))
    assert (white.correlation_time, white.gauss_markov_time) == (None, None)


@pytest.mark.parametrize("frequency", [5.0, 20.0, 40.0])
def test_a_fast_line_is_taken_off_as_it_was_sampled(frequency):
    values = (WhiteNoise(1e-3) + Sinusoid(0.05 / np.sinc(frequency * DT), frequency)).sample(
        1_000_000, DT, np.random.default_rng(0)
    )
    found = fit_allan(allan(values, DT), find_lines(values, DT))
    assert found.shortest == DT
    assert found.coefficients["N"].value == pytest.approx(1e-3, rel=0.01)
    assert found.lines[0].amplitude == pytest.approx(0.05 / np.sinc(frequency * DT), rel=0.02)


@pytest.mark.slow
def test_a_point_far_below_the_fit_is_not_explained():
    # With some twenty degrees of freedom, a twentieth of the expected variance is only three standard deviations away.
    curve = allan(WhiteNoise(1.0).sample(20_000, DT, np.random.default_rng(0)), DT)
    deviation = curve.deviation.copy()
    deviation[-4] /= 20**0.5
    assert fit_allan(curve).probability > 1e-2
    assert fit_allan(replace(curve, deviation=deviation)).probability < 1e-3


def test_a_sensor_filter_moves_the_start_of_the_fit():
    from scipy import signal

    values = WhiteNoise(0.01).sample(400_000, DT, np.random.default_rng(7))
    smooth = signal.sosfilt(signal.butter(2, 8, fs=1 / DT, output="sos"), values)
    found = fit_allan(allan(smooth, DT))
    assert found.shortest > 5 * DT
    assert found.coefficients["N"].value == pytest.approx(0.01, rel=0.03)


def test_a_constant_channel_is_refused():
    with pytest.raises(ValueError, match="constant"):
        fit_allan(allan(np.ones(1000), DT))


def test_three_octaves_are_needed():
    with pytest.raises(ValueError, match="^2 averaging times .* at least 3"):
        fit_allan(allan(np.arange(6.0) % 2, DT))


@pytest.mark.slow
def test_times_at_which_a_filter_shows_are_left_out():
    curve = allan(WhiteNoise(0.01).sample(400_000, DT, np.random.default_rng(8)), DT)
    bent = replace(curve, deviation=np.where(curve.averaging_time < 1, 0.9 * curve.deviation, curve.deviation))
    found = fit_allan(bent, shortest=1.0)
    assert found.shortest == curve.averaging_time[curve.averaging_time >= 1][0]
    assert found.coefficients["N"].lower < 0.01 < found.coefficients["N"].upper
    assert fit_allan(curve, shortest=0.0).coefficients == fit_allan(curve).coefficients


def test_too_few_times_above_a_filter_are_named():
    curve = allan(WhiteNoise(0.01).sample(10_000, DT, np.random.default_rng(9)), DT)
    with pytest.raises(ValueError, match="averaging times .* 30 s.* at least 5"):
        fit_allan(curve, shortest=30.0)
