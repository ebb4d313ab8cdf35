"""The thresholds of a replay, each from both sides, on values made by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from imuwb.errors import UsageError
from imuwb.navigation.tables import FIX, Events
from imuwb.replay import Outage, choose, own_outages, summarize, sweep, without_overlap
from imuwb.replay.outages import check_outages, events_of
from imuwb.replay.scoring.choice import log_likelihood
from imuwb.replay.scoring.scores import scores

from . import made


def prepared(time, sigma=1.0, kind=None, start=0.0, last=200.0):
    """Return what outages need of a log: its fixes, and the end of the IMU's samples."""
    time = np.asarray(time, float)
    n = time.size
    variance = np.ones((n, 6)) * np.broadcast_to(sigma, n)[:, None] ** 2
    events = Events(np.arange(n), np.full(n, FIX), np.zeros(n), np.zeros((n, 6)), variance)
    gnss = SimpleNamespace(fix_type=None if kind is None else np.broadcast_to(kind, n))
    corrections = SimpleNamespace(fix=np.arange(n), time=time, events=events)
    measurement = SimpleNamespace(time=np.arange(0, last, 0.01) + 0.01, interval=0.01)
    return SimpleNamespace(
        corrections=corrections, gnss=gnss, measurement=measurement, start_time=start, fix_time=time, events=np.arange(n)
    )  # fmt: skip


MODEL = SimpleNamespace(settings=SimpleNamespace(settling=20.0))


def without(begin, end, step=1.0):
    time = np.arange(0, 150, step)
    return time[(time <= begin) | (time >= end)]


# Outages of the log itself


@pytest.mark.parametrize(("length", "own"), [(3.0, False), (3.5, True)])
def test_an_own_outage_is_longer_than_three_seconds(length, own):
    found = own_outages(prepared(without(100.0, 100.0 + length, 0.5)), MODEL)
    assert found == ((Outage(100.0, 3.0),) if own else ())


@pytest.mark.parametrize(("length", "own"), [(10.0, False), (15.0, True)])
def test_an_own_outage_is_longer_than_two_and_a_half_intervals(length, own):
    found = own_outages(prepared(without(100.0, 100.0 + length, 5.0)), MODEL)
    assert found == ((Outage(100.0, length),) if own else ())


@pytest.mark.parametrize(("sigma", "own"), [(2.9, False), (3.1, True)])
def test_a_degraded_fix_has_more_than_three_usual_sigmas(sigma, own):
    time = np.arange(0.0, 150)
    inside = (time > 100) & (time < 110)
    assert bool(own_outages(prepared(time, np.where(inside, sigma, 1.0)), MODEL)) == own
    assert own_outages(prepared(time, 1.0, np.where(inside, 3, 6)), MODEL) == (Outage(100.0, 10.0),)


@pytest.mark.parametrize(("begin", "own"), [(19.0, False), (20.0, True)])
def test_an_own_outage_begins_after_settling(begin, own):
    assert bool(own_outages(prepared(without(begin, begin + 10)), MODEL)) == own


def test_a_sweep_has_at_most_one_outage_a_second():
    starts = [o.start for o in sweep(prepared(np.arange(0, 150, 0.2)), MODEL, 5.0)]
    assert np.diff(starts) == pytest.approx(1.0)
    assert starts[0] == pytest.approx(20.0)
    near = [o.start for o in sweep(prepared(np.arange(0, 150, 0.96)), MODEL, 5.0)]
    assert np.diff(near) == pytest.approx(0.96)
    far = [o.start for o in sweep(prepared(np.arange(0, 150, 0.94)), MODEL, 5.0)]
    assert np.diff(far) == pytest.approx(1.88)


@pytest.mark.parametrize(("late", "possible"), [(2.4, True), (2.6, False)])
def test_an_outage_begins_within_two_and_a_half_intervals_of_a_fix(late, possible):
    log = prepared(without(100.0, 110.0))
    if possible:
        check_outages(log, MODEL, [Outage(100.0 + late, 5.0)])
    else:
        with pytest.raises(UsageError, match=r"100\.0 s"):
            check_outages(log, MODEL, [Outage(100.0 + late, 5.0)])


@pytest.mark.parametrize(("early", "event"), [(0.0005, 100), (0.002, 99)])
def test_a_fix_a_millisecond_late_still_precedes_an_outage(early, event):
    log = prepared(np.arange(0.0, 150))
    assert events_of(log, [Outage(100.0 - early, 5.0)]).tolist() == [event]


# Overlap


def test_outages_without_overlap_in_the_order_given():
    start, duration = np.array([50.0, 0.0, 30.0, 69.0, 80.0]), np.array([20.0, 30.0, 20.0, 5.0, 5.0])
    assert without_overlap(start, duration).tolist() == [0, 1, 2, 4]
    assert without_overlap(np.array([0.0, 10.0 - 5e-7]), 10.0).tolist() == [0, 1]
    assert without_overlap(np.array([0.0, 10.0 - 5e-6]), 10.0).tolist() == [0]
    assert without_overlap([], 10.0).size == 0


# Scores and statistics


def test_a_difference_of_covariances_stays_positive():
    """Against an own run that is as uncertain as the drift, one per cent of the variance is left."""
    track = made.track(np.zeros((3, 3)), np.zeros((3, 3)), 2, sigma=2.0)
    track = type(track)("own", "own", track.time, track.position, track.velocity, None, track.sigma)
    state = np.zeros((1, 1, 10))
    state[..., 6] = 1.0
    covariance = np.zeros((1, 1, 9, 9))
    covariance[..., 0, 0], covariance[..., 1, 1] = 16.0, 4.0
    found = scores(made.drift_of([0.0], np.array([[1.0]]), state, covariance), track).covariance[0, 0]
    assert found == pytest.approx(np.diag([12.0, 0.01 * 20.0]))


@pytest.mark.parametrize(("speed", "known"), [(0.9, False), (1.1, True)])
def test_a_share_of_the_distance_needs_a_metre_a_second(speed, known):
    distance = np.full((6, 30), speed * 30.0)
    of = made.scores(np.full(6, 3.0), np.arange(6) * 30.0, seconds=30, distance=distance)
    percent = summarize("m", 30.0, of, (30.0,), 1.0, 0.95).median_percent
    assert percent == (pytest.approx(100 * 3.0 / (speed * 30)) if known else None)


def test_the_likelihood_is_that_of_students_distribution():
    """Four degrees of freedom: a scale of half the covariance has that covariance."""
    of = made.scores(np.array([6.0, 0.0]), [0.0, 100.0], 2.0, seconds=60)
    student = stats.multivariate_t(shape=2.0 * np.eye(2), df=4)
    assert log_likelihood(of) == pytest.approx(student.logpdf([[6.0, 0.0], [0.0, 0.0]]))
    at_times = np.mean([student.logpdf([[6.0 * t / 60, 0.0], [0.0, 0.0]]) for t in (5, 30)], axis=0)
    assert log_likelihood(of, (5.0, 30.0)) == pytest.approx(at_times)


def test_a_choice_judges_the_end_and_not_the_first_seconds():
    """A filter of small early errors and a sigma that is too small at the end loses against one whose sigma is right."""
    start = np.arange(10) * 30.0
    drifts = made.scores(np.full(10, 9.0), start, sigma=3.0, seconds=30)
    honest = made.scores(np.full(10, 2.0), start, sigma=2.0, seconds=30)
    assert choose({"drifts": drifts, "honest": honest}, 30.0).chosen == "honest"


def test_a_few_bad_outages_do_not_decide_a_choice():
    start, end = np.arange(20) * 30.0, np.full(20, 2.0)
    spoiled = end.copy()
    spoiled[3] = 60.0
    good, poor = made.scores(spoiled, start, sigma=2.0, seconds=30), made.scores(3 * end, start, sigma=6.0, seconds=30)
    assert choose({"good": good, "poor": poor}, 30.0).chosen == "good"


@pytest.mark.parametrize(("count", "made_choice"), [(9, False), (10, True)])
def test_a_choice_needs_two_outages_a_fold(count, made_choice):
    start = np.arange(count) * 30.0
    good, bad = made.scores(np.ones(count), start, seconds=30), made.scores(np.full(count, 9.0), start, seconds=30)
    choice = choose({"bad": bad, "good": good}, 30.0)
    assert (choice is not None) == made_choice
    if choice is not None:
        assert (choice.chosen, choice.folds, choice.candidates[0].folds) == ("good", 5, 5)
        assert choice.unseen_median_end == pytest.approx(1.0)
    assert choose({"good": good}, 30.0) is None
