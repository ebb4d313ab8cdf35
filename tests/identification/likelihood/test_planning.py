"""Predicted widths of intervals against records that are fitted, and against the laws that they obey."""

import math

import numpy as np
import pytest

from imuwb.identification import fit_likelihood, model_of_fits, plan_record
from imuwb.identification.likelihood.planning import hours_needed, rate_enough, reached
from imuwb.stochastic import AxisModel, FlickerNoise, ImuErrorModel, RandomWalk, RateRamp, Sum, WhiteNoise

NOISE = WhiteNoise(1.0) + FlickerNoise(0.5) + RandomWalk(0.1)
RATE = 10.0
HOUR = 3600


def test_records_reach_the_predicted_widths():
    n, letters, noise = 2**13, "NK", WhiteNoise(1.0) + RandomWalk(0.3)
    found = {letter: [] for letter in letters}
    for seed in range(16):
        fit = fit_likelihood(noise.sample(n, 1 / RATE, np.random.default_rng(seed)), 1 / RATE)
        for letter in letters:
            c = fit.coefficients[letter]
            found[letter].append((c.upper - c.lower) / 2 / c.value if c.value and c.lower else math.nan)
    for letter, reach in reached(noise, RATE, n / RATE / HOUR, letters=letters).items():
        assert np.nanmean(found[letter]) == pytest.approx(reach.width, rel=0.25), letter


def test_white_noise_narrows_with_the_root_of_the_number_of_samples():
    white = Sum((WhiteNoise(2.0),))
    short, long = (reached(white, rate, hours, letters="N")["N"].width for rate, hours in ((10.0, 1.0), (20.0, 8.0)))
    assert short / long == pytest.approx(4.0, rel=0.02)
    alone = 1.96 / math.sqrt(2 * 10 * HOUR)  # the Cramér-Rao bound of N, nothing else being estimated
    assert alone <= short <= 3 * alone


def test_the_needed_length_reaches_the_wanted_width():
    hours = hours_needed(NOISE, "K", 0.2, RATE)
    assert reached(NOISE, RATE, hours)["K"].width == pytest.approx(0.2, rel=0.01)
    assert hours_needed(NOISE, "K", 0.2, RATE, most=hours / 2) is None
    assert hours_needed(Sum((WhiteNoise(1.0),)), "B", 0.5, RATE) is None
    assert hours_needed(NOISE + RateRamp(1e-9), "K", 0.2, RATE) == hours  # other processes are left out


def test_a_slower_rate_is_enough_for_slow_terms_only():
    assert rate_enough(NOISE, {"K": 0.2}, RATE) < rate_enough(NOISE, {"N": 0.01}, RATE) == RATE


def test_a_record_too_short_for_a_likelihood_is_refused():
    with pytest.raises(ValueError, match="256"):
        reached(NOISE, RATE, 0.001)


def test_a_limit_stands_for_an_absent_term_and_rules_no_length():
    axes = {"gyro_x": AxisModel(NOISE), "gyro_y": AxisModel(Sum((WhiteNoise(1.0),)), limits={"K": 0.01})}
    plan = plan_record(ImuErrorModel("m", axes), {"N": 0.05, "B": 0.2, "K": 0.2}, RATE)
    needs = {(need.axis, need.letter): need for need in plan.needs}
    limited, absent = needs["gyro_y", "K"], needs["gyro_y", "B"]
    assert (limited.at_limit, limited.known, absent.known, absent.hours) == (True, True, False, None)
    assert limited.hours > plan.hours == max(needs["gyro_x", letter].hours for letter in "BK")
    assert 0 < absent.at_length.limit < 1.0
    assert plan_record(ImuErrorModel("m", axes), {"N": 0.05}, RATE, hours=2.0).hours == 2.0


def test_a_short_record_gives_what_it_shows_and_limits():
    x = Sum((WhiteNoise(1.0),)).sample(4096, 1 / RATE, np.random.default_rng(3))
    own = model_of_fits("r", {"gyro_x": fit_likelihood(x, 1 / RATE)}).axes["gyro_x"]
    assert [term.name for term in own.processes.terms] == ["white_noise"]
    assert set(own.limits) == {"Q", "B", "K"}
