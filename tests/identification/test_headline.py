from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

import imuwb.identification
from imuwb.identification import allan, fit_allan, identify
from imuwb.notes import ids
from imuwb.statistics import Coefficient
from imuwb.stochastic import FlickerNoise, GaussMarkov, RandomWalk, Sinusoid, WhiteNoise

DT = 0.02
N, WALK = 0.005, 0.004


def record(*processes, n=30_000, seed=2):
    rng = np.random.default_rng(seed)
    return sum(process.sample(n, DT, rng) for process in processes)


@pytest.fixture(scope="module")
def walk():
    """Return 600 s of white noise, a random walk, and a line at 3.7 Hz."""
    return record(WhiteNoise(N), RandomWalk(WALK), Sinusoid(0.02, 3.7))


@pytest.fixture(scope="module")
def noise(walk):
    return identify(walk, DT, choose=True)


@pytest.mark.slow
def test_one_line_finds_the_noise_that_was_made(noise):
    assert noise.headline == "likelihood"
    assert set(noise.estimators) == {"allan", "likelihood", "wavelet"}
    for coefficients in noise.estimators.values():
        for letter, truth in (("N", N), ("K", WALK)):
            c = coefficients[letter]
            assert c.lower < truth < c.upper
            assert c.value == pytest.approx(truth, rel=0.02 if letter == "N" else 0.25)
    assert noise.coefficients is noise.likelihood.coefficients
    assert noise.agree
    assert noise.differences == ()
    assert noise.stationarity.stationary
    assert noise.choice.best.name == "N + K"
    assert {"AR(1)", "AR(3)"} <= {candidate.name for candidate in noise.choice.candidates}
    assert noise.notes == ()


def test_a_line_is_in_the_sum_and_not_in_the_noise(noise):
    (line,) = noise.lines
    assert line.frequency == pytest.approx(3.7, abs=0.01)
    assert 0.02 * np.sinc(3.7 * DT) in line.amplitude
    kinds = [type(term) for term in noise.processes.terms]
    assert kinds.count(Sinusoid) == 1
    assert {WhiteNoise, RandomWalk} <= set(kinds)


def test_the_parts_are_those_of_the_single_functions(walk, noise):
    curve = allan(walk, DT)
    np.testing.assert_array_equal(noise.curve.deviation, curve.deviation)
    assert noise.allan.coefficients == fit_allan(curve, noise.lines).coefficients
    assert noise.mean == walk.mean()
    assert (noise.n, noise.dt, noise.level) == (30_000, DT, 0.95)


def test_what_is_not_asked_for_is_left_out(walk):
    plain = identify(walk, DT, lines=False, estimators=False)
    assert plain.lines == ()
    assert (plain.likelihood, plain.wavelet, plain.stationarity, plain.choice) == (None, None, None, None)
    assert (plain.headline, plain.notes) == ("allan", ())
    assert plain.processes == plain.allan.processes


@pytest.mark.slow
def test_a_gauss_markov_process_that_is_clearly_best_is_the_sum():
    noise = identify(record(WhiteNoise(0.001), GaussMarkov(0.05, 1.0), n=20_000, seed=0), DT, choose=True)
    clear, close = (replace(noise, choice=replace(noise.choice, clear=c)) for c in (True, False))
    assert (clear.prefers_gauss_markov, close.prefers_gauss_markov) == (True, False)
    (term,) = [term for term in clear.processes.terms if isinstance(term, GaussMarkov)]
    assert term.sigma == pytest.approx(0.05, rel=0.1)
    assert term.Tc == pytest.approx(1.0, rel=0.2)
    assert close.processes == close.likelihood.identified


def test_estimators_that_contradict_each_other_are_named(noise):
    far = {**noise.wavelet.coefficients, "N": Coefficient(2 * N, 1.9 * N, 2.1 * N)}
    odd = replace(noise, wavelet=replace(noise.wavelet, coefficients=far))
    assert odd.differences == ("N: allan and wavelet", "N: likelihood and wavelet")
    assert not odd.agree
    touching = {**far, "N": Coefficient(2 * N, noise.coefficients["N"].upper, 3 * N)}
    assert (
        "N: likelihood and wavelet"
        not in replace(noise, wavelet=replace(noise.wavelet, coefficients=touching)).differences
    )


@pytest.mark.slow
def test_a_gap_is_bridged_and_the_longest_part_is_used(walk):
    kept = np.r_[0:10_000, 12_000:30_000]
    time = np.rint(kept * DT * 1e9).astype(np.int64)
    noise = identify(walk[kept], DT, averaging_times="log:20", time=time, breaks=(10_000,))
    alone = identify(walk[12_000:], DT, averaging_times="log:20")
    assert noise.coefficients == alone.coefficients
    assert noise.mean == alone.mean
    assert noise.curve.averaging_time[-1] > alone.curve.averaging_time[-1]
    assert noise.allan.coefficients["N"].lower < N < noise.allan.coefficients["N"].upper


@pytest.mark.slow
def test_without_a_part_of_half_the_record_there_is_an_allan_fit_only(walk):
    pieces = identify(walk, DT, breaks=(10_000, 20_000))
    assert ids(pieces.notes) == ("gaps",)
    assert pieces.allan.coefficients["N"].value == pytest.approx(N, rel=0.05)
    assert (pieces.lines, pieces.likelihood, pieces.stationarity) == ((), None, None)
    half = identify(walk, DT, breaks=(15_000,))
    assert half.likelihood is not None


def test_below_a_filters_band_the_noise_is_that_before_the_filter(walk):
    smooth = signal.sosfilt(signal.butter(2, 8, fs=1 / DT, output="sos"), walk)
    noise = identify(smooth, DT, band=2.0)
    assert ids(noise.notes) == ("no-wavelet",)
    assert noise.lines == ()  # 3.7 Hz is above
    assert noise.likelihood.highest <= 2.0
    assert noise.allan.shortest >= 10.0
    assert noise.coefficients["N"].lower < N < noise.coefficients["N"].upper


def test_a_record_too_short_for_a_part_names_the_part():
    noise = identify(record(WhiteNoise(N), n=120), DT, choose=True)
    assert ids(noise.notes) == ("no-likelihood", "no-wavelet", "no-stationarity", "no-choice")
    assert noise.headline == "allan"
    tiny = identify(record(WhiteNoise(N), n=6), DT)
    assert ids(tiny.notes)[0] == "no-fit"
    assert tiny.coefficients["N"].upper == np.inf
    assert tiny.processes.terms == ()


def test_a_finer_or_faster_curve_leaves_the_fits_as_they_are(walk, noise):
    fine = identify(walk, DT, averaging_times="log:60", fast=True, estimators=False)
    assert fine.curve.factor.size > noise.curve.factor.size
    assert fine.allan.coefficients == noise.allan.coefficients


def test_what_is_no_record_is_refused():
    with pytest.raises(ValueError, match="not finite"):
        identify(np.array([1.0, np.nan, 2.0]), DT)


def test_results_print_themselves_in_a_few_lines(walk, noise):
    text = str(noise)
    assert repr(noise) == text
    assert "likelihood" in text
    assert "3.7" in text
    assert len(text) < 1500
    parts = (
        noise.curve, noise.allan, noise.likelihood, noise.wavelet, noise.stationarity, noise.choice, noise.choice.best,
        imuwb.identification.power_spectrum(walk, DT), imuwb.identification.wavelet_variance(walk, DT),
        imuwb.identification.fit_spectrum(imuwb.identification.power_spectrum(walk, DT)),
        imuwb.identification.autocorrelation(walk, DT), imuwb.identification.fit_autoregressive(walk, DT, 3),
        imuwb.identification.cosine_spectrum(walk, DT), imuwb.identification.burg(walk, 3),
        imuwb.identification.stillness({"x": (DT * np.arange(walk.size), walk)}), noise.lines[0], noise.allan.regions[0],
    )  # fmt: skip
    for part in parts:
        assert len(str(part)) < 700, type(part)
        assert "array(" not in repr(part), type(part)
        assert "\n" not in str(part)


def test_flicker_is_found():
    noise = identify(record(WhiteNoise(N), FlickerNoise(0.004), n=60_000, seed=3), DT)
    assert noise.coefficients["B"].lower < 0.004 < noise.coefficients["B"].upper


def test_a_line_of_one_half_is_left_out_of_the_fits_and_of_the_model():
    values = record(WhiteNoise(N), Sinusoid(0.01, 3.7))
    part = values.size // 2
    values[part:] += Sinusoid(0.02, 11.0).sample(part, DT, np.random.default_rng(5))
    for options in ({}, {"estimators": False}):
        noise = identify(values, DT, **options)
        assert [round(line.frequency, 1) for line in noise.lines] == [3.7]
        assert [round(line.frequency, 1) for line in noise.passing] == [11.0]
        lines = [term for term in noise.processes.terms if isinstance(term, Sinusoid)]
        assert [round(term.frequency, 1) for term in lines] == [3.7]
        assert noise.coefficients["N"].lower < N < noise.coefficients["N"].upper
        assert "passing-lines" in ids(noise.notes)
