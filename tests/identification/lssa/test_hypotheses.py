import numpy as np
import pytest
from scipy import signal, stats

from imuwb.identification.lssa import is_autoregressive, is_random_walk

RARE = 1e-4


def series(seed, alpha=(), n=4000):
    w = np.random.default_rng(seed).standard_normal(n + 500)
    return signal.lfilter([1], [1, *alpha], w)[500:]


@pytest.mark.parametrize("alpha", [(-0.9,), (0.5,), (-1.2, 0.5), (-0.6, 0.3)])
def test_coefficients_and_errors_are_the_theorys(alpha):
    n = 100_000
    found = is_autoregressive(series(1, alpha, n), len(alpha))
    # AR(1): (1 - a²)/n; AR(2): (1 - a2²)/n both (Box and Jenkins)
    expected = np.sqrt((1 - alpha[-1] ** 2) / n)
    assert found.sigma == pytest.approx([expected] * len(alpha), rel=0.02)
    assert found.alpha == pytest.approx(alpha, abs=4 * expected)
    assert found.coefficient == (-found.alpha[0] if len(alpha) == 1 else None)
    assert found.correlations.freedom == 20
    assert found.p_value == min(1.0, 2 * min(found.correlations.probability, found.octaves.probability))


def test_errors_of_a_higher_order_are_the_scatter_of_estimates():
    alpha = (-1.1, 0.5, -0.2)
    found = [is_autoregressive(series(s, alpha), 3) for s in range(200)]
    scatter = np.std([f.alpha for f in found], axis=0)
    assert np.mean([f.sigma for f in found], axis=0) == pytest.approx(scatter, rel=4 / np.sqrt(2 * 200))


@pytest.mark.slow
def test_true_structures_are_refused_as_often_as_the_level_says():
    walk = sum(not is_random_walk(np.cumsum(series(s)), 0.95).tenable for s in range(400))
    ar = sum(not is_autoregressive(series(s, (-0.9,)), 1, 0.95).tenable for s in range(400))
    for refused in (walk, ar):
        assert stats.binom.sf(refused - 1, 400, 0.05) > RARE
        assert refused > 2  # two tests together are a little shy, not blind


@pytest.mark.parametrize(
    ("tested", "said"),
    [
        (lambda: is_random_walk(np.cumsum(series(1))), "a random walk is tenable (p = "),
        (lambda: is_random_walk(series(2)), "not a random walk (p < 0.0001, at the 1 % level)"),
        (lambda: is_autoregressive(series(3, (-0.8,)), 1), "AR(1) is tenable (p = "),
        (lambda: is_autoregressive(series(4, (-1.2, 0.5)), 1), "not AR(1) (p < 0.0001"),
        (lambda: is_autoregressive(series(5) + 0.1 * np.cumsum(series(6)), 1), "not AR(1) (p < 0.0001"),
        (lambda: is_autoregressive(series(7, (-1.2, 0.5)), 2), "AR(2) is tenable (p = "),
    ],
)
def test_words_say_what_the_series_is(tested, said):
    assert tested().verdict.startswith(said)


def test_words_give_the_papers_coefficient_with_its_interval():
    found = is_autoregressive(series(3, (-0.8,), 40_000), 1)
    half = 1.96 * np.sqrt((1 - 0.8**2) / 40_000)
    assert f"C = {found.coefficient:.4f} ± {half:.4f}" in found.verdict
    assert found.coefficient == pytest.approx(0.8, abs=2 * half)


def test_octaves_show_a_slow_drift():
    found = is_autoregressive(series(5) + 0.02 * np.cumsum(series(6)), 1)
    assert found.octaves.probability < RARE
    assert found.octave_power[0] > 5
    assert found.octave_frequency[0] == pytest.approx((1 * 4) ** 0.5 / 3999)  # four frequencies in the lowest octave
    assert np.average(found.octave_power, weights=np.diff([0, *np.rint(_ends(found))])) == pytest.approx(1, abs=0.05)
    assert (np.diff(found.octave_frequency) > 0).all()


def _ends(found):
    """Return the last frequency's index of each octave: 4, 8, 16 ... half the rate."""
    count = found.octave_power.size
    return [*(4 * 2**k for k in range(count - 1)), 1999]


@pytest.mark.parametrize("values", [np.ones(1000), np.arange(100.0) % 7])
def test_nothing_to_test_says_so(values):
    with pytest.raises(ValueError, match=r"constant|samples"):
        is_random_walk(values)
    with pytest.raises(ValueError, match=r"constant|samples"):
        is_autoregressive(values, 1)
