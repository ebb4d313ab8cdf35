import numpy as np
import pytest

from imuwb.identification.likelihood.fit import TERMS
from imuwb.identification.temperature import Record, set_point_of
from imuwb.identification.temperature.pooled import _climbed, pooled
from imuwb.stochastic import FlickerNoise, Quantization, Sum, WhiteNoise

DT, SIZES = 0.01, (0.004, 0.005, 0.007)
B, Q = 0.003, 5e-5


@pytest.fixture(scope="module")
def points():
    rng = np.random.default_rng(1)
    sums = [Sum((WhiteNoise(n), FlickerNoise(B), Quantization(Q))) for n in SIZES]
    return [set_point_of([Record(s.sample(20_000, DT, rng), 0.0, 10.0 * k)], DT) for k, s in enumerate(sums)]


def deviance_with(points, found, sizes):
    """Return the deviance of all, with the N and K that are likeliest for each."""
    total = 0.0
    for point in points:
        held = np.array(
            [sizes.get(letter, found[letter].value or 0.0) ** 2 if letter in "QB" else 0.0 for letter in TERMS]
        )
        best = point.problem.solve([list(TERMS).index(x) for x in "NK"], ramp=point.ramped, held=held)
        total += best.deviance
    return total


def test_it_is_the_likeliest_of_all_together(points):
    found = pooled(points, own=["K"])
    least = deviance_with(points, found, {})
    for letter in ("Q", "B"):
        assert found[letter].value is not None
        for factor in (0.9, 0.97, 1.03, 1.1):
            assert deviance_with(points, found, {letter: factor * found[letter].value}) > least - 1e-3
    assert found["B"].lower < B < found["B"].upper
    assert found["Q"].lower < Q < found["Q"].upper


def test_a_limit_lies_where_the_likelihood_has_fallen(points):
    found = pooled(points)
    assert found["K"].value is None
    assert 0 < found["K"].upper < min(p.coefficients["K"].upper for p in points)


def test_what_is_each_temperatures_own_is_not_common(points):
    assert set(pooled(points)) == {"Q", "B", "K"}
    assert set(pooled(points, own=["B"])) == {"Q", "K"}


def test_a_limit_is_one_sided_at_the_level(points):
    """There the deviance of all, with the other terms likeliest, is larger by 1.645 squared."""
    letters = list(TERMS)
    limit = pooled(points)["K"].upper
    start = np.array([[(p.coefficients[letter].value or 0.0) ** 2 for letter in TERMS] for p in points])
    common, mine = [letters.index(x) for x in "QBK"], [letters.index("N")]
    start[:, common] = np.median(start[:, common], axis=0)
    best = _climbed(points, start, common, mine)
    held = best.squares.copy()
    held[:, letters.index("K")] = limit**2
    held = _climbed(points, held, [letters.index(x) for x in "QB"], mine)
    assert held.deviance - best.deviance == pytest.approx(1.645**2, rel=0.1)
