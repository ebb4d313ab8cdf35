import numpy as np
import pytest
from scipy import signal

from imuwb.identification import find_lines, fit_cosine_spectrum, fit_likelihood, spectrum_without
from imuwb.identification.likelihood.fit import TERMS, explained
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.identification.spectral.lines import Line
from imuwb.statistics import Estimate
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, RateRamp, Sinusoid, WhiteNoise

DT = 0.01
TRUTH = {"N": 0.005, "B": 0.004, "K": 2e-3}
NOISE = WhiteNoise(0.005) + FlickerNoise(0.004) + RandomWalk(2e-3)


def fit(process, n=2**15, seed=0, **options):
    return fit_likelihood(process.sample(n, DT, np.random.default_rng(seed)), DT, **options)


@pytest.mark.slow
def test_intervals_contain_the_truth_about_as_often_as_they_say():
    found = [fit(NOISE, 2**14, seed).coefficients for seed in range(15)]
    inside = [
        (c[letter].lower or 0.0) < truth < c[letter].upper for c in found for letter, truth in TRUTH.items()
    ]  # fmt: skip
    assert sum(inside) >= 40  # of 45; 42.75 on average
    assert np.median([c["N"].value for c in found]) == pytest.approx(0.005, rel=0.01)
    assert np.median([c["B"].value or 0.0 for c in found]) == pytest.approx(0.004, rel=0.1)


@pytest.mark.slow
def test_narrower_levels_hold_it_less_often():
    found = [fit(WhiteNoise(1.0), n=2048, seed=seed, level=0.5).coefficients["N"] for seed in range(20)]
    assert 5 <= sum(c.lower < 1 < c.upper for c in found) <= 15


def test_terms_that_are_not_there_get_a_limit():
    nothing, limits = 0, []
    for seed in range(12):
        found = fit(WhiteNoise(0.005), 2**14, seed)
        absent = [found.coefficients[letter] for letter in "QBKR"]
        nothing += sum(c.value is None for c in absent)
        limits.append([c.upper for c in absent])
        for c in absent:
            assert c.upper > 0
            assert c.lower is None if c.value is None else c.lower is not None
        for letter in "BKR":  # what is likeliest to be there by chance is not said to be sure
            assert not found.coefficients[letter].lower
        assert [type(term) for term in found.identified.terms] == [WhiteNoise]
    assert nothing >= 24
    assert (np.array(limits) < [1e-4, 3e-3, 2e-3, 1e-4]).all()


@pytest.mark.slow
def test_limits_lie_above_what_is_there():
    """A walk too weak to be seen at all: its limit is above it in at least 95 % of records, one-sided."""
    found = [fit(WhiteNoise(0.005) + RandomWalk(1e-4), 2**14, seed).coefficients["K"] for seed in range(15)]
    assert sum(c.upper > 1e-4 for c in found) >= 13
    assert sum(c.value is None for c in found) >= 5


def test_quantization_is_found():
    found = fit(Quantization(2e-4) + WhiteNoise(0.005)).coefficients
    assert found["Q"].lower < 2e-4 < found["Q"].upper
    assert found["Q"].upper - found["Q"].lower < 0.1 * 2e-4


def test_a_ramp_is_found_with_its_sign():
    for ramp in (3e-4, -3e-4):
        found = fit(WhiteNoise(0.005) + RateRamp(ramp))
        assert found.coefficients["R"].lower < 3e-4 < found.coefficients["R"].upper
        (term,) = [term for term in found.processes.terms if isinstance(term, RateRamp)]
        assert pytest.approx(ramp, rel=0.1) == term.R
        assert term in found.identified.terms
        assert found.coefficients["K"].value is None or found.coefficients["K"].lower == 0


@pytest.mark.slow
def test_a_walk_is_not_taken_for_a_ramp():
    found = [fit(WhiteNoise(0.005) + RandomWalk(2e-3), 2**14, seed) for seed in range(12)]
    assert sum(f.coefficients["R"].value is not None for f in found) <= 1
    assert all(f.coefficients["K"].lower < 2e-3 < f.coefficients["K"].upper * 1.3 for f in found)


def test_after_a_filter_the_sum_is_fitted_below_its_corner():
    corner = 12.0
    taps = signal.butter(2, corner, fs=1 / DT)
    for seed in range(3):
        values = (WhiteNoise(0.005) + FlickerNoise(0.002)).sample(2**16, DT, np.random.default_rng(seed))
        found = fit_likelihood(signal.lfilter(*taps, values)[1000:], DT)
        assert 1.0 < found.highest < corner
        assert found.coefficients["N"].value == pytest.approx(0.005, rel=0.05)
    assert fit_likelihood(values, DT).highest > 49


@pytest.mark.slow
def test_the_sum_explains_the_record_it_made():
    probabilities = [fit(NOISE, 2**13, seed).probability for seed in range(12)]
    assert min(probabilities) > 1e-3
    assert 0.2 < np.mean(probabilities) < 0.8
    values = NOISE.sample(2**15, DT, np.random.default_rng(0))
    bump = signal.lfilter(*signal.iirpeak(0.4, 4.0, fs=1 / DT), values) * 3
    assert fit_likelihood(values + bump, DT).probability < 1e-3


def test_a_misfit_widens_intervals():
    values = WhiteNoise(0.005).sample(2**15, DT, np.random.default_rng(0))
    bump = signal.lfilter(*signal.iirpeak(0.4, 4.0, fs=1 / DT), values) * 2
    plain, bent = (fit_likelihood(v, DT).coefficients["N"] for v in (values, values + bump))
    assert np.log(bent.upper / bent.lower) > 1.5 * np.log(plain.upper / plain.lower)


def test_a_line_is_left_out():
    quiet = WhiteNoise(0.005) + FlickerNoise(0.004)
    values = quiet.sample(2**16, DT, np.random.default_rng(4))
    loud = values + Sinusoid(0.05, 2.3).sample(2**16, DT, np.random.default_rng(5))
    lines = find_lines(loud, DT)
    assert [line.frequency for line in lines] == pytest.approx([2.3], abs=0.02)
    plain, without, with_line = fit_likelihood(values, DT), fit_likelihood(loud, DT), fit_likelihood(loud, DT, lines)
    for letter in "NB":
        assert with_line.coefficients[letter].value == pytest.approx(plain.coefficients[letter].value, rel=0.05)
    assert with_line.highest > 49
    assert without.highest < 2.3


def test_a_spectrum_at_hand_gives_the_same_fit():
    values = (NOISE + Sinusoid(0.05, 2.3)).sample(2**15, DT, np.random.default_rng(0))
    lines = find_lines(values, DT)
    whole, parted = fit_likelihood(values, DT, lines), fit_cosine_spectrum(spectrum_without(values, DT, lines))
    assert parted.coefficients == whole.coefficients
    assert spectrum_without(values, DT, lines).count.sum() < spectrum_without(values, DT).count.sum()


def test_a_line_over_all_the_lowest_coefficients_leaves_the_ramp_unknown():
    values = WhiteNoise(0.005).sample(2**14, DT, np.random.default_rng(4))
    found = fit_likelihood(values, DT, [Line(0.1, Estimate(1.0, 0.9, 1.1), 0.1, 0.1)])
    assert found.coefficients["R"].value is None
    assert found.coefficients["R"].upper == np.inf
    assert found.coefficients["N"].value == pytest.approx(0.005, rel=0.03)


def test_coefficients_scale_with_the_unit_and_with_time():
    values = NOISE.sample(2**13, DT, np.random.default_rng(0))
    plain, scaled, slow = (
        fit_likelihood(values, DT),
        fit_likelihood(values * 1e-5, DT),
        fit_likelihood(values, 100 * DT),
    )
    for letter, power in (("N", 1), ("B", 0), ("K", -1), ("R", -2)):
        expected = plain.coefficients[letter]
        for found, factor in ((scaled.coefficients[letter], 1e-5), (slow.coefficients[letter], 10.0**power)):
            assert found.upper == pytest.approx(expected.upper * factor, rel=0.02)
            if expected.value is not None:
                assert found.value == pytest.approx(expected.value * factor, rel=0.02)


def test_a_bias_does_not_matter():
    values = NOISE.sample(2**13, DT, np.random.default_rng(1))
    plain, biased = fit_likelihood(values, DT), fit_likelihood(values + 9.81, DT)
    assert biased.coefficients["N"].value == pytest.approx(plain.coefficients["N"].value, rel=1e-6)
    assert biased.deviance == pytest.approx(plain.deviance, abs=1e-3)


def test_what_cannot_be_fitted_is_refused_with_the_reason():
    with pytest.raises(ValueError, match="constant"):
        fit_likelihood(np.full(1000, 9.81), DT)
    with pytest.raises(ValueError, match="too few"):
        fit_likelihood(np.arange(255.0), DT)


def test_a_spectrum_is_fitted_up_to_the_frequency_that_is_asked_for():
    """White noise after a filter that, up to there, takes less than a hundredth."""
    taps = signal.butter(1, 25.0, fs=1 / DT)
    inside = []
    for seed in range(12):
        values = signal.lfilter(*taps, WhiteNoise(0.005).sample(2**15, DT, np.random.default_rng(seed)))[1000:]
        found = fit_cosine_spectrum(spectrum_without(values, DT), highest=2.5)
        assert found.highest <= 2.5
        inside.append(found.coefficients["N"].lower < 0.005 < found.coefficients["N"].upper)
    assert sum(inside) >= 10
    plain = fit_likelihood(values, DT)
    assert fit_cosine_spectrum(spectrum_without(values, DT), highest=1e9).coefficients == plain.coefficients


def test_too_little_below_that_frequency_is_refused():
    values = WhiteNoise(0.005).sample(2**13, DT, np.random.default_rng(0))
    with pytest.raises(ValueError, match=r"^\d+ bins .* 0.05 Hz.* 20$"):
        fit_cosine_spectrum(spectrum_without(values, DT), highest=0.05)


@pytest.mark.parametrize(("missing", "whole"), [(0.015, True), (0.15, False)])
def test_a_long_record_may_miss_a_density_by_two_hundredths(missing, whole):
    """Ten million coefficients show a deficit of 1.5 % above 36 Hz, as a real sensor has: only a far larger one is left out."""
    f = np.geomspace(0.01, 50.0, 200)
    power = np.where(f > 36, 1 - missing, 1.0)
    design = np.stack([make(1.0).power_spectral_density(f, DT) for make in TERMS.values()], axis=1)
    none = np.zeros(0)
    problem = LikelihoodProblem(
        none, none, np.zeros((4, 0, 0)), f, power, 1e7 * f / f.sum(), design, 0.0, np.zeros(1, np.int64)
    )
    assert (explained(problem)[0].frequency[-1] == 50.0) == whole
