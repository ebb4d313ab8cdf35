import numpy as np
import pytest
from scipy import stats

from imuwb.identification.temperature import Record, dependence, heterogeneity, over_temperature, set_point_of
from imuwb.identification.temperature.dependence import DRAWS, _drawn, depends
from imuwb.identification.temperature.pooled import pooled, settled
from imuwb.stochastic import FlickerNoise, Sum, WhiteNoise

DT = 0.01


def chamber(sizes, seed, n=20_000, flicker=0.0):
    rng = np.random.default_rng(seed)
    return [
        set_point_of([Record(Sum((WhiteNoise(size), FlickerNoise(flicker))[: 1 + (flicker > 0)]).sample(n, DT, rng), 0.0, 10.0 * k)], DT)
        for k, size in enumerate(sizes)
    ]  # fmt: skip


def test_heterogeneity_is_the_weighted_sum_of_squares():
    values, sigmas = np.array([1.0, 2.0, 4.0]), np.array([1.0, 0.5, 2.0])
    weights = [1, 4, 0.25]
    mean = sum(w * v for w, v in zip(weights, values, strict=True)) / sum(weights)
    by_hand = sum(w * (v - mean) ** 2 for w, v in zip(weights, values, strict=True))
    found = heterogeneity(values, sigmas, 0.05)
    assert found.statistic == pytest.approx(by_hand)
    assert found.p_value == pytest.approx(stats.chi2.sf(by_hand, 2))
    assert found.critical == pytest.approx(stats.chi2.ppf(0.95, 2))
    assert found.depends == (by_hand > found.critical)
    assert heterogeneity(values[:1], sigmas[:1]) is None


def test_the_score_test_of_n_is_that_of_its_estimates():
    points = settled(chamber([0.005, 0.00505, 0.0049, 0.005], 2))[0]
    score = depends(points, "N")
    values = np.log([p.coefficients["N"].value for p in points])
    sigmas = np.array([np.log(p.coefficients["N"].upper / p.coefficients["N"].lower) / (2 * 1.96) for p in points])
    wald = heterogeneity(values, sigmas)
    assert score.statistic == pytest.approx(wald.statistic, rel=0.1)
    assert score.common.lower < 0.005 < score.common.upper
    assert score.common.upper / score.common.lower - 1 == pytest.approx(2 * 1.96 / (2 * 80_000) ** 0.5, rel=0.15)
    assert score.distribution == "chi-square(3)"


def test_a_change_of_a_tenth_is_found_and_none_is_not():
    assert depends(chamber(np.linspace(0.005, 0.0055, 5), 2), "N").depends is True
    assert depends(chamber([0.005] * 5, 3), "N").p_value > 1e-4


def test_a_test_whose_degrees_of_freedom_vanish_is_refused(monkeypatch):
    points = chamber([0.005] * 3, 4)
    monkeypatch.setattr(
        dependence, "_common", lambda *_: (1e-12, np.array([1e11, 2e10, -1e10]), np.array([1e12, 2e12, 1e12]))
    )
    found = depends(points, "K")
    assert (found.statistic, found.critical, found.depends) == (None, None, None)
    assert "degrees of freedom" in found.distribution


def test_the_law_of_an_unsure_coefficient_is_drawn_and_wider():
    points = chamber([0.005] * 6, 4, flicker=0.002)
    found = depends(points, "B")
    assert found.distribution.startswith("simulated")
    assert found.critical > stats.chi2.ppf(0.95, 5)  # skewed: a longer tail
    assert 1 / (DRAWS + 1) <= found.p_value <= 1
    assert found.common.lower < 0.002 < found.common.upper


@pytest.mark.slow
def test_a_flicker_that_grows_is_found():
    rng = np.random.default_rng(5)
    points = [
        set_point_of([Record(Sum((WhiteNoise(0.005), FlickerNoise(b))).sample(40_000, DT, rng), 0.0, t)], DT)
        for t, b in ((-20.0, 0.002), (20.0, 0.004), (60.0, 0.012))
    ]
    assert depends(points, "B").depends is True
    law = over_temperature(points).laws["B"]
    assert law.function is not None
    assert law.function.kind == "piecewise"


def test_what_is_not_there_has_no_test_but_a_limit_better_than_any():
    points = chamber([0.005] * 6, 6)
    found = depends(points, "K", pooled(points)["K"])
    assert found.depends is None
    assert found.p_value is None
    assert 0 < found.common.upper < min(p.coefficients["K"].upper for p in points)
    assert depends(points[:1], "N") is None
    with pytest.raises(ValueError, match="1 set-points; .* two"):
        over_temperature(points[:1])


@pytest.mark.slow
def test_a_limit_that_all_temperatures_give_together_holds():
    rng = np.random.default_rng(7)
    sensor, held = Sum((WhiteNoise(0.005), FlickerNoise(0.0006))), []
    for _ in range(15):
        points = [set_point_of([Record(sensor.sample(4000, DT, rng), 0.0, 1.0 * k)], DT) for k in range(5)]
        held.append(pooled(points)["B"].upper >= 0.0006)
    assert stats.binom.cdf(sum(held), 15, 0.95) > 1e-4


@pytest.mark.slow
def test_size_of_the_test_of_n():
    found = [depends(chamber([0.005] * 3, 100 + seed, n=2000), "N").depends for seed in range(25)]
    assert stats.binom.sf(sum(map(bool, found)) - 1, 25, 0.05) > 1e-4


@pytest.mark.parametrize("letter", ["N", "B"])
def test_the_critical_value_is_exceeded_as_often_as_the_size_of_the_test(letter):
    """The critical value at the size of a statistic's own p value is that statistic: of chi-square, and of simulated draws."""
    points = chamber([0.005] * 4, 4, flicker=0.002)
    found = depends(points, letter)
    assert found.distribution.startswith("chi-square" if letter == "N" else "simulated")
    assert depends(points, letter, size=found.p_value).critical == pytest.approx(found.statistic, rel=5e-3)
    assert found.depends == (found.statistic > found.critical)


def test_simulated_statistics_of_many_degrees_are_chi_square():
    drawn = _drawn(np.full(4, 1e6), np.ones(4))
    assert stats.kstest(drawn, stats.chi2(3).cdf).pvalue > 1e-4
    few = _drawn(np.full(4, 8.0), np.ones(4))
    assert few.mean() == pytest.approx(3, abs=0.15)  # of unit variances about one mean
