import numpy as np
import pytest
from scipy import signal

from imuwb.identification import choose_model, find_lines, fit_autoregressive
from imuwb.identification.likelihood.cosine_spectrum import cosine_spectrum
from imuwb.identification.likelihood.model_choice import ModelCandidate, _ranked
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.stochastic import Autoregressive, FlickerNoise, GaussMarkov, Quantization, RandomWalk, Sinusoid, WhiteNoise

DT = 0.1


def choose(process, n=2**14, seed=0, **options):
    return choose_model(process.sample(n, DT, np.random.default_rng(seed)), DT, **options)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("process", "name"),
    [
        (WhiteNoise(0.3) + GaussMarkov(0.5, 5.0), "N + GM"),
        (WhiteNoise(0.3) + FlickerNoise(0.5), "N + B"),
        (WhiteNoise(0.3) + RandomWalk(0.03), "N + K"),
        (WhiteNoise(0.3), "N"),
        (Quantization(0.1) + WhiteNoise(0.3) + FlickerNoise(0.5), "Q + N + B"),
    ],
    ids=repr,
)
def test_the_sum_that_made_a_record_is_chosen(process, name):
    assert [choose(process, seed=seed).best.name for seed in range(3)].count(name) >= 2


@pytest.mark.slow
def test_what_is_chosen_has_the_values():
    found = choose(WhiteNoise(0.3) + GaussMarkov(0.5, 5.0), 2**16).best
    (gauss_markov,) = [term for term in found.processes.terms if isinstance(term, GaussMarkov)]
    (white,) = [term for term in found.processes.terms if isinstance(term, WhiteNoise)]
    assert pytest.approx(0.3, rel=0.02) == white.N
    assert gauss_markov.sigma == pytest.approx(0.5, rel=0.1)
    assert gauss_markov.Tc == pytest.approx(5.0, rel=0.2)
    assert found.parameters == 3


def test_criteria_penalise_parameters():
    found = choose(WhiteNoise(0.3) + FlickerNoise(0.5), 2**12)
    for candidate in found.candidates:
        assert candidate.aic == pytest.approx(candidate.deviance + 2 * candidate.parameters)
        assert candidate.bic == pytest.approx(candidate.deviance + candidate.parameters * np.log(2**12 - 1))
    assert [c.bic for c in found.candidates] == sorted(c.bic for c in found.candidates)
    assert found.best is found.candidates[0]
    counts = {c.name: c.parameters for c in found.candidates}
    assert counts["N"] == 1
    assert counts["N + GM"] == 3
    assert "N + GM + GM" not in counts  # two would but imitate the flicker, which is clearly better than one


def test_a_wider_sum_is_never_less_likely():
    found = choose(WhiteNoise(0.3) + GaussMarkov(0.5, 5.0), 2**13)
    deviance = {c.name: c.deviance for c in found.candidates}
    for narrow, wide in (("N", "N + B"), ("N + B", "N + B + K"), ("N + GM", "N + GM + GM"), ("N + GM", "N + GM + K")):
        assert deviance[wide] < deviance[narrow] + 0.05


def test_deviances_are_those_of_the_likelihood():
    values = (WhiteNoise(0.3) + FlickerNoise(0.5)).sample(2**12, DT, np.random.default_rng(0))
    problem = LikelihoodProblem.of(cosine_spectrum(values, DT), [WhiteNoise(1.0), FlickerNoise(1.0)])
    (found,) = choose_model(values, DT, sums=("NB",)).candidates
    white, flicker = found.processes.terms
    assert found.deviance == pytest.approx(problem.deviance(np.array([white.N, flicker.B]) ** 2), abs=1e-6)
    assert found.deviance == pytest.approx(problem.solve([0, 1], ramp=False).deviance, abs=1e-3)


def test_halves_are_judged_by_each_others_fit():
    values = (WhiteNoise(0.3) + FlickerNoise(0.5)).sample(2**12, DT, np.random.default_rng(0))
    (found,) = choose_model(values, DT, sums=("NB",)).candidates
    problems = [
        LikelihoodProblem.of(cosine_spectrum(half, DT), [WhiteNoise(1.0), FlickerNoise(1.0)])
        for half in np.split(values, 2)
    ]
    fits = [problem.solve([0, 1], ramp=False).squared for problem in problems]
    expected = problems[0].deviance(fits[1]) + problems[1].deviance(fits[0])
    assert found.out_of_sample == pytest.approx(expected, abs=0.01)


def test_a_clear_choice_is_called_clear():
    assert choose(WhiteNoise(0.3) + GaussMarkov(0.5, 5.0), 2**15, sums=("N", "NB", "NM", "NK")).clear
    assert not choose(WhiteNoise(0.3) + GaussMarkov(0.5, 5.0), 2**10).clear
    assert not choose(WhiteNoise(0.3), 2**12, sums=("N",)).clear


@pytest.mark.parametrize(("bic", "out", "clear"), [(9.9, 1.0, False), (10.1, 1.0, True), (10.1, -1.0, False)])
def test_a_difference_of_ten_is_clear_if_the_best_is_best_out_of_sample(bic, out, clear):
    best, other = (
        ModelCandidate(n, WhiteNoise(1.0) + RandomWalk(1.0), 1, 0.0, b, b, o)
        for n, b, o in (("N", 0.0, 0.0), ("K", bic, out))
    )
    choice = _ranked([other, best], 1.0)
    assert choice.best.name == "N"
    assert choice.clear == clear
    assert (choice.candidates[1].bic_excess, choice.candidates[1].out_of_sample_excess) == (bic, out)


@pytest.mark.slow
def test_quantization_is_tried_only_where_it_shows():
    assert not any("Q" in c.name for c in choose(WhiteNoise(0.3) + FlickerNoise(0.5), 2**13, seed=1).candidates)
    assert any("Q" in c.name for c in choose(Quantization(0.1) + WhiteNoise(0.3), 2**13).candidates)


def test_an_autoregressive_model_takes_part():
    truth = Autoregressive((-1.2, 0.7, -0.2), 0.3, DT)
    values = truth.sample(2**13, DT, np.random.default_rng(0))
    model = fit_autoregressive(values, DT, 3).process(3)
    found = choose_model(values, DT, sums=("N", "NB", "NM"), models=[model])
    assert found.best.name == "AR(3)"
    assert found.best.parameters == 4
    assert found.best.out_of_sample is None
    assert found.best.processes.terms == (model,)
    assert found.clear


def test_a_filters_band_is_left_out_of_the_judgement():
    values = (WhiteNoise(0.3) + FlickerNoise(0.5)).sample(2**15, DT, np.random.default_rng(0))
    bent = signal.lfilter(*signal.butter(2, 2.0, fs=1 / DT), values)[1000:]
    whole, part = choose_model(bent, DT), choose_model(bent, DT, highest=0.5)
    assert whole.highest > 4.8
    assert 0.45 < part.highest <= 0.5
    assert part.best.name == "N + B"
    assert whole.best.name != "N + B"


def test_lines_are_left_out():
    quiet = (WhiteNoise(0.3) + FlickerNoise(0.5)).sample(2**15, DT, np.random.default_rng(0))
    loud = quiet + Sinusoid(2.0, 1.7).sample(2**15, DT, np.random.default_rng(1))
    sums = ("N", "NB", "NM", "NMM")
    assert choose_model(loud, DT, sums=sums).best.name != "N + B"
    assert choose_model(loud, DT, find_lines(loud, DT), sums=sums).best.name == "N + B"


def test_short_records_are_refused():
    with pytest.raises(ValueError, match="^511 samples .* 512$"):
        choose_model(np.arange(511.0), DT)
