"""A receiver's correlated position error: three states of the filter, and its estimate from the innovations."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.geodesy.earth import ned_scale
from imuwb.log import SECOND
from imuwb.navigation.filter_model import Settings
from imuwb.navigation.smoother import smoothed
from imuwb.replay import budget, estimate_gnss_correlation, prepare, run, usual_in_motion
from imuwb.simulation import GnssErrors, Receiver

from .. import made  # noqa: TID252 - tests are no package that has a name

SIGMA, TIME = 1.5, 30.0
ERRORS = GnssErrors(position_sigma=(SIGMA, SIGMA, 2 * SIGMA), position_time=TIME)
SETTLED = 20  # fixes


def correlated(model, sigma=SIGMA, time=TIME):
    return replace(model, settings=replace(model.settings, gnss_correlation=(sigma, time)))


def driven(seed, errors=ERRORS, seconds=300):
    receiver = Receiver(position_sigma=(0.5, 0.5, 1.0), errors=errors or GnssErrors())
    drive = made.town(seconds, 3, seed=seed, receiver=receiver)
    drive.prepared = prepare(drive.log, drive.model)
    return drive


@pytest.fixture(scope="module")
def drives():
    found = [driven(seed) for seed in range(1, 7)]
    for drive in found:
        drive.without = run(drive.model, drive.prepared)
        drive.solution = run(correlated(drive.model), drive.prepared, smooth=True)
    return found


def true_error(drive, time, position):
    """Return the errors of positions, (m, 3) m NED."""
    truth = drive.log.references[0]
    known = (truth.time - drive.log.zero) / SECOND
    true = np.stack([np.interp(time, known, truth.position[:, k]) for k in range(3)], axis=1)
    return (position - true) * ned_scale(position[:, 0], position[:, 2])


def nees(drive, solution):
    """Return the mean NEES of the position over its degrees of freedom."""
    error = true_error(drive, solution.time, solution.position)[SETTLED:]
    covariance = solution.track.covariance[solution.events][SETTLED:, :3, :3]
    return np.einsum("ei,eij,ej->e", error, np.linalg.inv(covariance), error).mean() / 3


def lag_one(solution):
    """Return the correlation of each normalised innovation of position with the next one, (3,)."""
    z = (solution.track.innovation / solution.track.deviation)[solution.events][SETTLED:, :3]
    return (z[1:] * z[:-1]).mean(axis=0) / (z * z).mean(axis=0)


def test_innovations_and_errors_are_those_that_the_filter_expects(drives):
    own = np.mean([np.nanmean(d.solution.fix_nis[SETTLED:], axis=0) / 3 for d in drives], axis=0)
    assert own == pytest.approx([1.0, 1.0], abs=0.1)
    assert np.mean([lag_one(d.solution) for d in drives], axis=0) == pytest.approx(np.zeros(3), abs=0.08)
    # The position's error itself is correlated over half a minute: few independent errors in each drive.
    assert 0.6 < np.mean([nees(d, d.solution) for d in drives]) < 1.5


def test_without_the_states_the_filter_is_too_sure(drives):
    own = np.mean([np.nanmean(d.without.fix_nis[SETTLED:, 0]) / 3 for d in drives])
    assert own < 0.7
    assert np.mean([lag_one(d.without) for d in drives], axis=0).min() > 0.4
    assert np.mean([nees(d, d.without) for d in drives]) > 4


def test_smoothed_positions_have_their_sigmas(drives):
    scores = []
    for d in drives:
        s = smoothed(d.solution)
        scores.append(np.mean((true_error(d, s.time, s.position) / s.sigma[:, :3])[SETTLED:] ** 2))
        assert (s.sigma[:, :3] <= d.solution.sigma[:, :3] * (1 + 1e-6)).all()
    assert 0.5 < np.mean(scores) < 1.6


def test_the_states_decay_between_fixes(drives):
    solution = drives[0].solution
    places, events = solution.tables.receiver, solution.events
    k = 50
    before, after = events[k], events[k - 1]
    h = solution.time[k] - solution.time[k - 1]
    a = np.exp(-h / TIME)
    track = solution.track
    own = np.ix_(places, places)
    assert track.before.axes[before][places - 9] == pytest.approx(a * track.axes[after][places - 9], rel=1e-9)
    noise = np.diag(np.square([SIGMA, SIGMA, 2 * SIGMA]) * (1 - a**2))
    expected = a**2 * track.covariance[after][own] + noise
    np.testing.assert_allclose(track.before.covariance[before][own], expected, rtol=1e-9, atol=1e-12)
    transition = track.before.transition[before]
    np.testing.assert_allclose(transition[own], a * np.eye(3), rtol=1e-9, atol=1e-15)
    assert not transition[:9, places].any()  # the receiver's error moves no other state
    whole = transition @ track.covariance[after] @ transition.T
    np.testing.assert_allclose(track.before.covariance[before][:9, places], whole[:9, places], rtol=1e-6, atol=1e-9)


def test_the_start_knows_that_the_first_fix_has_the_error(drives):
    solution = drives[0].solution
    start = solution.track.covariance[solution.alignment.event]
    places = solution.tables.receiver
    variance = np.square([SIGMA, SIGMA, 2 * SIGMA])
    assert np.diagonal(start)[places] == pytest.approx(variance)
    assert start[[0, 1, 2], places] == pytest.approx(variance)
    assert np.diagonal(start)[:3] == pytest.approx(variance + np.square([0.5, 0.5, 1.0]), rel=1e-6)
    assert np.linalg.eigvalsh(start).min() > 0


@pytest.mark.parametrize("scale", [(0.0, 0.0), (0.01, 0.02)])
def test_the_states_have_names_and_follow_those_of_the_axes(scale):
    model = replace(made.town(90).model, scale_factor=scale)
    plain, more = model.states(0.02), correlated(model).states(0.02)
    assert [name for name in more if name not in plain] == [
        f"receiver: position error {axis}, m" for axis in ("north", "east", "down")
    ]
    tables, start = correlated(model).tables(0.02)
    assert [more[i] for i in tables.receiver] == [name for name in more if name.startswith("receiver")]
    assert np.diagonal(start)[tables.receiver - 9] == pytest.approx([SIGMA**2, SIGMA**2, 4 * SIGMA**2])
    of_scale = [i for i, name in enumerate(more) if name.endswith("scale factor")]
    assert np.flatnonzero(tables.scale).tolist() == [i - 9 for i in of_scale]
    assert not model.tables(0.02)[0].receiver.any()


def test_the_budget_names_the_error(drives):
    solution = drives[0].solution
    found = budget(solution, solution.events[[100, 150]], 10.0)
    share = dict(zip(found.sources, found.variance, strict=True))
    # The error of the receiver alone moves no vehicle: it acts through the position at the start.
    assert share["correlated error of the receiver, at the start"] == pytest.approx(np.zeros(10))


@pytest.mark.parametrize("correlation", [(1.0, 0.0), (0.0, 60.0), (-1.0, 60.0), (1.0, -60.0)])
def test_half_an_error_is_refused(correlation):
    model = replace(made.town(90).model, settings=Settings(gnss_correlation=correlation))
    with pytest.raises(UsageError, match="correlation time"):
        model.tables(0.02)


def test_the_error_is_found_from_the_innovations(drives):
    drive = drives[0]
    found = estimate_gnss_correlation(drive.prepared, [drive.model, usual_in_motion(drive.model)], 0.99)
    assert found.shown
    assert found.gain > 100
    assert found.sigma.lower < SIGMA < found.sigma.upper
    assert found.sigma.value == pytest.approx(SIGMA, rel=0.05)
    assert found.time.lower < TIME < found.time.upper
    assert TIME / 2 < found.time.value < 2 * TIME
    assert found.fixes > 200


def test_an_error_that_exceeds_what_the_fixes_state_is_found():
    drive = driven(3, replace(ERRORS, claim=(3.0, 1.0)))
    found = estimate_gnss_correlation(drive.prepared, [drive.model], 0.95)
    assert found.shown
    assert found.sigma.value == pytest.approx(SIGMA, rel=0.5)
    before, after = (
        nees(drive, run(m, drive.prepared))
        for m in (drive.model, correlated(drive.model, found.sigma.value, found.time.value))
    )
    assert after < before / 4


def test_independent_errors_show_none():
    drive = driven(2, None)
    found = estimate_gnss_correlation(drive.prepared, [drive.model], 0.95)
    assert not found.shown
    assert found.gain < 3
