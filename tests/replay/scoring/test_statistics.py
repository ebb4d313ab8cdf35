"""Statistics of outages against enumeration, plain numpy, Monte Carlo and the paper's own figures."""

import tomllib
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from imuwb.replay import HORIZONS, compare, drift_curve, effective_count, summarize, verdict
from imuwb.replay.scoring.overlap import block_length
from imuwb.replay.scoring.scores import Scores
from imuwb.replay.scoring.statistics import quantile, resampled, sign_flip

from .. import made  # noqa: TID252 - tests are no package that has a name

TABLES = Path(__file__).resolve().parents[4] / "shared" / "papers" / "tables.toml"


def most_apart(start, duration):
    """Return the largest number of outages that do not overlap, by trying every set."""
    start = np.sort(start)
    best = 0
    for chosen in product((False, True), repeat=start.size):
        kept = start[np.array(chosen)]
        if (np.diff(kept) >= duration - 1e-6).all():
            best = max(best, kept.size)
    return best


@pytest.mark.parametrize("seed", range(4))
def test_effective_count_is_the_largest_set_apart(seed):
    start = np.random.default_rng(seed).uniform(0, 100, 10)
    for duration in (2.0, 7.5, 20.0, 60.0, 200.0):
        assert effective_count(start, duration) == most_apart(start, duration)


def test_a_quarter_of_an_hour_holds_fifteen_minutes():
    assert effective_count(np.arange(0.0, 900 - 60 + 1), 60.0) == 15
    assert effective_count(np.zeros(0), 60.0) == 0
    assert effective_count(np.array([0.0, 60.0 - 1e-9]), 60.0) == 2  # a rounding is no overlap


def test_a_block_is_as_long_as_an_outage_in_a_long_log():
    assert block_length(np.arange(600.0), 60.0) == 60
    assert block_length(np.arange(600.0) * 5, 60.0) == 12
    assert block_length(np.arange(20.0) * 100, 60.0) == 1
    assert block_length(np.zeros(1), 60.0) == 1


@pytest.mark.parametrize("count", [61, 100, 852])
def test_a_block_is_as_long_as_an_outage_in_a_short_log(count):
    assert block_length(np.arange(float(count)), 60.0) == 60


def test_blocks_are_neighbours_drawn_with_equal_chance():
    rows = resampled(50, 7)
    assert rows.shape == (1000, 50)
    assert (rows >= 0).all()
    assert (rows < 50).all()
    inside = (np.arange(1, 50) % 7) != 0
    assert (np.diff(rows, axis=1)[:, inside] == 1).all()
    first = np.bincount(rows[:, ::7].ravel(), minlength=44)
    assert first.size == 44
    assert stats.chisquare(first).pvalue > 1e-3
    assert np.array_equal(rows, resampled(50, 7))  # the same each time


def moving(rng, count, width):
    """Return neighbours that share all but a share of what makes them, as outages that overlap do."""
    noise = rng.standard_normal(count + width)
    total = np.cumsum(noise)
    return np.abs(total[width:] - total[:-width])


def held(count, width, block, tries=40):
    truth = stats.halfnorm.ppf(0.5) * np.sqrt(width)
    rng = np.random.default_rng(5)
    rows = resampled(count, block)
    found = [quantile(moving(rng, count, width), 0.5, rows, 0.95) for _ in range(tries)]
    return np.mean([q.lower <= truth <= q.upper for q in found])


@pytest.mark.slow
def test_intervals_hold_the_median_where_blocks_are_many():
    count, width = 900, 10
    assert held(count, width, width) > 0.86
    assert held(count, width, 1) < 0.8  # neighbours taken as independent


def test_intervals_hold_less_of_fifteen_blocks_and_still_most():
    assert 0.65 < held(450, 30, 30) < 0.98


def flipped(differences, block):
    """Return the share of all signs of blocks whose sum is as far from 0."""
    parts = [sum(p) for p in np.array_split(differences, max(1, len(differences) // block))]
    totals = [
        abs(sum(s * p for s, p in zip(signs, parts, strict=True))) for signs in product((1, -1), repeat=len(parts))
    ]
    return np.mean([t >= abs(sum(parts)) - 1e-9 for t in totals])


@pytest.mark.parametrize(("count", "block"), [(7, 1), (10, 1), (40, 6), (12, 1), (5, 60), (23, 2)])
def test_sign_flip_is_the_enumeration(count, block):
    differences = np.random.default_rng(count).standard_normal(count) + 0.4
    assert sign_flip(differences, block) == pytest.approx(flipped(differences, block))


def test_sign_flip_draws_where_signs_are_too_many():
    differences = np.random.default_rng(2).standard_normal(16) + 0.35
    assert sign_flip(differences, 1) == pytest.approx(flipped(differences, 1), abs=0.01)
    assert sign_flip(np.ones(30), 1) == pytest.approx(1 / 20_000)  # never 0
    assert sign_flip(np.ones(4), 1) == 2 / 16


@pytest.mark.slow
def test_sign_flip_is_fair():
    rng = np.random.default_rng(8)
    p = np.array([sign_flip(moving(rng, 240, 20) - moving(rng, 240, 20), 20) for _ in range(120)])
    assert (p <= 0.05).mean() < 0.11


def published():
    if not TABLES.is_file():
        pytest.skip(f"{TABLES} is not there: the papers' figures are not part of the repository")
    with TABLES.open("rb") as file:
        return tomllib.load(file)


@pytest.mark.parametrize("part", ["max", "mean"])
@pytest.mark.parametrize("other", ["15AV", "18AV", "15AR", "27AR"])
def test_improvement_is_the_papers_percentage(part, other):
    tables = published()
    outages, claims = tables["quinchia2013"]["table9_10_outages"], tables["quinchia2013"]["claims"]
    start = np.arange(7) * 100.0
    one, against = (made.scores(outages[f"{part}_{name}"], start) for name in ("18AVWD", other))
    found = compare("18AVWD", one, other, against, 30.0, 0.95)
    assert found.improvement.value * 100 == pytest.approx(
        claims[f"{part}_vs"][other], abs=0.05
    )  # the cells are rounded
    assert found.improvement.lower < found.improvement.value < found.improvement.upper
    ratio = np.log((np.array(outages[f"{part}_18AVWD"]) + 1e-3) / (np.array(outages[f"{part}_{other}"]) + 1e-3))
    assert found.p_value == pytest.approx(flipped(ratio, 1))
    wins = np.array(outages[f"{part}_18AVWD"]) < np.array(outages[f"{part}_{other}"])
    assert found.win_rate == pytest.approx(wins.mean())
    assert (found.model, found.against, found.duration) == ("18AVWD", other, 30.0)


def test_the_papers_claim_rests_on_its_last_outage():
    tables = published()["quinchia2013"]["table9_10_outages"]
    start = np.arange(7) * 100.0
    of = {n: made.scores(tables[f"max_{n}"], start) for n in ("18AVWD", "15AV", "18AV")}
    share = {n: 1 - of["18AVWD"].horizontal[:, -1] / of[n].horizontal[:, -1] for n in ("15AV", "18AV")}
    assert np.median(share["15AV"]) == pytest.approx(0.206, abs=0.005)
    assert np.median(share["18AV"]) == pytest.approx(0.147, abs=0.005)


def test_compare_in_plain_numpy():
    rng = np.random.default_rng(1)
    a, b = rng.uniform(1, 9, 40), rng.uniform(1, 9, 40)
    found = compare("a", made.scores(a, np.arange(40) * 50.0), "b", made.scores(b, np.arange(40) * 50.0), 50.0, 0.9)
    assert found.median_difference.value == pytest.approx(np.median(a - b))
    assert found.improvement.value == pytest.approx(np.mean(1 - a / b))
    assert found.win_rate == np.mean(a < b)
    drawn = np.array([np.mean((1 - a / b)[rng.integers(0, 40, 40)]) for _ in range(4000)])
    assert found.improvement.lower == pytest.approx(np.quantile(drawn, 0.05), abs=0.25 * drawn.std())
    assert found.improvement.upper == pytest.approx(np.quantile(drawn, 0.95), abs=0.25 * drawn.std())


def test_compare_stands_an_error_of_nothing():
    found = compare("a", made.scores([0.0, 1.0], [0, 99]), "b", made.scores([0.0, 0.0], [0, 99]), 30.0, 0.95)
    assert np.isfinite([found.improvement.value, found.p_value, found.median_difference.value]).all()
    assert found.win_rate == 0.0


def test_compare_the_same_is_no_difference():
    one = made.scores(np.arange(1.0, 9), np.arange(8) * 40.0)
    found = compare("a", one, "b", one, 30.0, 0.95)
    assert (found.p_value, found.win_rate, found.improvement.value, found.median_difference.value) == (
        1.0,
        0.0,
        0.0,
        0.0,
    )


def correlated(count, seconds, seed):
    """Return scores of normal errors with a covariance that is no multiple of the unit matrix."""
    rng = np.random.default_rng(seed)
    shape = np.array([[4.0, 1.2], [1.2, 1.0]])
    errors = rng.standard_normal((count, seconds, 2)) @ np.linalg.cholesky(shape).T
    plain = made.scores(np.ones(count), np.arange(count) * float(seconds), seconds=seconds)
    return Scores(
        plain.start, plain.elapsed, errors, np.broadcast_to(shape, (count, seconds, 2, 2)), plain.vertical, plain.velocity,
        plain.heading, plain.distance,
    )  # fmt: skip


def test_summary_in_plain_numpy():
    found = correlated(300, 30, 3)
    s = summarize("m", 30.0, found, (5.0, 10.0, 30.0, 60.0), 1.25, 0.95)
    end = np.linalg.norm(found.north_east[:, -1], axis=1)
    largest = np.linalg.norm(found.north_east, axis=2).max(axis=1)
    assert (s.model, s.duration, s.count, s.effective_count, s.nis_per_dof) == ("m", 30.0, 300, 300, 1.25)
    for interval, values, share in (
        (s.median_end, end, 50), (s.p68_end, end, 68), (s.p95_end, end, 95), (s.median_max, largest, 50),
    ):  # fmt: skip
        assert interval.value == pytest.approx(np.percentile(values, share))
        assert interval.lower < interval.value < interval.upper
    assert s.median_vertical == pytest.approx(0.5)
    assert s.median_velocity == pytest.approx(0.1)
    assert s.median_heading == 0.0
    assert s.median_percent == pytest.approx(np.median(end / 600 * 100))
    assert [c.elapsed for c in s.consistency] == [5.0, 10.0, 30.0]
    inverse = np.linalg.inv(found.covariance[0, 0])
    for c in s.consistency:
        errors = found.north_east[:, int(c.elapsed) - 1]
        nees = np.einsum("si,ij,sj->s", errors, inverse, errors)
        assert c.nees_per_dof == pytest.approx(nees.mean() / 2)
        assert c.ratio == pytest.approx(np.sqrt(nees.mean() / 2))
        assert c.coverage95 == pytest.approx(np.mean(nees <= stats.chi2.ppf(0.95, 2)))
        assert (c.lower, c.upper) == pytest.approx(stats.chi2.ppf([0.025, 0.975], 600) / 600)
        assert c.lower < c.nees_per_dof < c.upper
        assert c.coverage95 == pytest.approx(0.95, abs=0.04)


def test_the_band_of_nees_holds_what_it_says():
    inside = []
    for seed in range(120):
        (c,) = summarize("m", 10.0, correlated(12, 10, seed), (10.0,), 1.0, 0.9).consistency
        inside.append(c.lower <= c.nees_per_dof <= c.upper)
    assert 0.84 < np.mean(inside) < 0.96


def test_summary_of_nothing_standing_and_without_heading():
    assert summarize("m", 30.0, made.scores([]), (5.0,), 1.0, 0.95) is None
    still = made.scores([1.0, 2.0], [0, 40], seconds=30, heading=np.nan, distance=np.full((2, 30), 3.0))
    s = summarize("m", 30.0, still, (60.0,), 1.0, 0.95)
    assert (s.median_percent, s.median_heading, s.consistency) == (None, None, ())
    turned = made.scores([1.0, 2.0, 3.0], [0, 40, 80], seconds=30, heading=-0.2)
    assert summarize("m", 30.0, turned, (), 1.0, 0.95).median_heading == pytest.approx(0.2)


def test_one_outage_has_no_certain_median():
    s = summarize("m", 30.0, made.scores([5.0], [0], seconds=30), (30.0,), 1.0, 0.95)
    assert s.median_end.value == pytest.approx(5.0)
    assert np.isnan([s.median_end.lower, s.median_end.upper]).all()
    assert verdict(s).id == "few-outages"
    assert verdict(s).startswith("1 outage that")


@pytest.mark.parametrize(("count", "apart"), [(4, 40.0), (5, 40.0), (200, 0.6), (210, 0.6)])
def test_below_five_outages_apart_there_is_no_interval(count, apart):
    """However many overlap: 200 at 0.6 s are last 119.4 s, which is 4 outages of 30 s; 210 last as long as 5."""
    rng = np.random.default_rng(count)
    start = np.arange(count) * apart
    one, other = (made.scores(rng.uniform(1, 9, count), start, seconds=30) for _ in range(2))
    s = summarize("m", 30.0, one, (30.0,), 1.0, 0.95)
    paired = compare("m", one, "n", other, 30.0, 0.95)
    known = s.effective_count >= 5
    assert known == (count in (5, 210))
    for interval in (s.median_end, s.p68_end, s.p95_end, s.median_max, paired.median_difference, paired.improvement):
        assert np.isfinite(interval.value)
        assert np.isfinite([interval.lower, interval.upper]).tolist() == [known, known]
    assert (verdict(s).id == "few-outages") == (not known)


@pytest.mark.parametrize("duration", [3.0, 45.0, 120.0])
def test_consistency_is_judged_at_the_end(duration):
    found = made.scores(np.ones(9), np.arange(9) * duration, seconds=int(duration))
    last = summarize("m", duration, found, tuple(sorted({*HORIZONS, duration})), 1.0, 0.95).consistency[-1]
    assert (last.elapsed, last.nees_per_dof) == (duration, pytest.approx(0.5))


@pytest.mark.parametrize(
    ("sigma", "verdict_id", "figure"),
    [(1.0, "sigma-right", "1.00"), (0.5, "sigma-small", "2.0 times"), (4.0, "sigma-large", "4.0 times")],
)
def test_verdicts(sigma, verdict_id, figure):
    found = made.scores(np.full(20, np.sqrt(2)), np.arange(20) * 30.0, sigma, seconds=30)
    note = verdict(summarize("m", 30.0, found, (5.0, 30.0), 1.0, 0.95))
    assert note.id == verdict_id
    assert figure in note
    assert "30 s" in note


def test_verdict_of_short_outages():
    found = made.scores(np.ones(3), np.arange(3) * 9.0, seconds=3)
    assert verdict(summarize("m", 3.0, found, (5.0,), 1.0, 0.95)).id == "no-horizon"


def test_drift_curve_in_plain_numpy():
    found = correlated(50, 4, 9)
    curve = drift_curve(found)
    assert curve.sigma == pytest.approx(np.median(np.sqrt(np.trace(found.covariance, axis1=2, axis2=3)), axis=0))
    assert curve.nees_per_dof == pytest.approx(found.nees.mean(axis=0) / 2)
    for name, share in (("median", 50), ("p68", 68), ("p95", 95)):
        assert getattr(curve, name) == pytest.approx(
            np.percentile(np.linalg.norm(found.north_east, axis=2), share, axis=0)
        )
