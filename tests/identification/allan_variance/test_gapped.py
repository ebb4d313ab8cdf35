import numpy as np
import pytest

from imuwb.identification import allan
from imuwb.identification.allan_variance.gapped import bridged
from imuwb.stochastic import FlickerNoise, RandomWalk, WhiteNoise

NOISE = WhiteNoise(1.0) + FlickerNoise(0.3) + RandomWalk(0.01)


def thinned(n, seed, process=NOISE, share=0.05):
    rng = np.random.default_rng(seed)
    values = process.sample(n, 1.0, rng)
    place = np.flatnonzero(rng.random(n) >= share)
    return values[place], place - place[0]


@pytest.mark.parametrize("process", [WhiteNoise(1.0), FlickerNoise(1.0), RandomWalk(0.1)], ids=repr)
def test_nothing_is_biased_by_samples_missing_at_random(process):
    factors = 2 ** np.arange(9)
    draws = [bridged(*thinned(2048, seed, process), factors)[0] for seed in range(40)]
    expected = process.allan_variance(factors.astype(float), 1.0)
    error = np.std(draws, axis=0) / 40**0.5
    assert (np.abs(np.mean(draws, axis=0) - expected) < 4 * error).all()
    assert (error < 0.2 * expected).all()


def test_with_nothing_missing_it_is_the_allan_variance():
    factors = 2 ** np.arange(10)
    values = NOISE.sample(2048, 1.0, np.random.default_rng(0)) + 9.81
    variance, terms, clear = bridged(values, np.arange(2048), factors)
    curve = allan(values, 1.0, list(factors.astype(float)))
    np.testing.assert_allclose(variance, curve.deviation**2, rtol=1e-8)
    np.testing.assert_allclose(terms, curve.terms, atol=1)
    np.testing.assert_allclose(clear, 1, atol=1e-12)


def test_equals_the_means_of_blocks_written_out():
    values, place = thinned(200, 3, share=0.2)
    size, m = int(place[-1]) + 1, 12
    squares = []
    for k in range(size - 2 * m + 1):
        halves = [values[(place >= a) & (place < a + m)] for a in (k, k + m)]
        if min(half.size for half in halves) >= 0.8 * values.size / size * m:
            off = sum((1 / half.size - 1 / m) * half.var(ddof=1) for half in halves)
            squares.append(((halves[1].mean() - halves[0].mean()) ** 2, off))
    variance, terms, clear = bridged(values, place, np.array([m]))
    mean, off = np.mean(squares, axis=0)
    assert terms[0] == len(squares)
    assert variance[0] == pytest.approx((mean - off) / 2, rel=1e-9)
    assert clear[0] == pytest.approx(1 - off / mean, rel=1e-9)


def test_blocks_that_do_not_fit_have_no_variance():
    values, place = thinned(200, 0)
    variance, terms, _ = bridged(values, place, np.array([1, 64, 150]))
    assert np.isfinite(variance).tolist() == [True, True, False]
    assert terms[2] == 0
