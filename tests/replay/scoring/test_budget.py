"""The error budget against closed forms of a car that drives straight on, and against its own sum."""

from types import SimpleNamespace

import pytest

from imuwb.navigation import drift
from imuwb.replay import Outage, budget, events_of, model_named, prepare, run, sweep

from .. import made  # noqa: TID252 - tests are no package that has a name

N = (2e-4, 2e-3)


@pytest.fixture(scope="module")
def found():
    drive = made.town(240, 3, model=made.error_model(white=N, slow=(1e-4, 3e-3)))
    model = model_named("full", drive.model, interval=0.02)
    prepared = prepare(drive.log, model)
    solution = run(model, prepared)
    outages = sweep(prepared, model, 30.0)[::30]
    return SimpleNamespace(
        solution=solution, outages=outages, budget=budget(solution, events_of(solution, outages), 30.0)
    )


def of(found, source):
    return found.budget.variance[found.budget.sources.index(source)]


def test_the_parts_are_all_of_it(found):
    b = found.budget
    assert b.elapsed.tolist() == list(range(1, 31))
    assert b.variance.sum(axis=0) == pytest.approx(b.total, rel=1e-9)
    assert (b.variance[:-1] >= 0).all()
    assert b.sources[-1] == "in common"
    assert len(set(b.sources)) == len(b.sources)
    assert {
        "gyro turn-on bias, at the start",
        "gyro Gauss-Markov bias, at the start",
        "accelerometer white noise",
    } <= set(b.sources)


def test_white_noise_that_comes_in(found):
    """Twice N² t³/3 of an accelerometer, twice (g N)² t⁵/20 of a gyro (Groves, eq. 5.109 and 5.112)."""
    t = found.budget.elapsed
    assert of(found, "accelerometer white noise")[4:] == pytest.approx(2 * N[1] ** 2 * t[4:] ** 3 / 3, rel=0.15)
    assert of(found, "gyro white noise")[9:] == pytest.approx(2 * (9.81 * N[0]) ** 2 * t[9:] ** 5 / 20, rel=0.25)


def test_what_is_there_at_the_start(found):
    t = found.budget.elapsed
    covariance = found.solution.track.covariance[events_of(found.solution, found.outages)]
    place, speed = ((covariance[:, i, i] + covariance[:, i + 1, i + 1]).mean() for i in (0, 3))
    tilt = (covariance[:, 6, 6] + covariance[:, 7, 7]).mean()
    assert of(found, "position at the start") == pytest.approx(place, rel=1e-3)
    assert of(found, "velocity at the start")[4:] == pytest.approx(speed * t[4:] ** 2, rel=0.15)
    assert of(found, "tilt at the start")[4:] == pytest.approx(tilt * (9.81 * t[4:] ** 2 / 2) ** 2, rel=0.15)


def test_one_outage_has_the_filters_own_sigma(found):
    events = events_of(found.solution, [Outage(150.0, 30.0)])
    covariance = drift(found.solution, events, 30.0).covariance[0]
    assert budget(found.solution, events, 30.0).total == pytest.approx(covariance[:, 0, 0] + covariance[:, 1, 1])
