"""The whole filter against a plain one in numpy, its coarser covariance, and its consistency with the truth."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.navigation.alignment import align
from imuwb.navigation.corrections import corrections_of
from imuwb.navigation.filter import solve
from imuwb.navigation.filter_model import Aids, FilterModel, Installation, Settings
from imuwb.navigation.outages import drift
from imuwb.navigation.tables import FIX, SPEED, STRAIGHT
from imuwb.simulation import Odometer, Receiver, drive, mixed_route

from .. import ecef  # noqa: TID252 - tests are no package that has a name
from . import drives
from .plain import Plain

pytestmark = pytest.mark.slow

LEVER = (1.0, 0.3, -1.2)


def model_of(every, **settings):
    return FilterModel(
        "mixed", drives.mixed().error_model, scale_factor=(2e-3, 3e-3), installation=Installation(lever_arm=LEVER),
        settings=Settings(every=every, **settings), aids=Aids(straight=0.2, still=0.05, speed=0.1),
    )  # fmt: skip


@pytest.fixture(scope="module")
def town():
    model = model_of(1)
    log = drive(model.error_model, mixed_route(210, 2), 5, receiver=Receiver(lever_arm=LEVER), odometer=Odometer())
    return drives.prepared(model, log=log)


def test_a_plain_filter_says_the_same(town):
    model = model_of(1, gate=1e9)
    short = SimpleNamespace(**vars(town))
    keep = town.corrections.time < town.corrections.time[town.alignment.event] + 90
    events = type(town.corrections.events)(*(x[keep] for x in town.corrections.events))
    short.corrections = type(town.corrections)(events, town.corrections.time[keep], town.corrections.fix[keep])
    assert {FIX, SPEED, STRAIGHT} <= set(events.kind[town.alignment.event :])
    solution = solve(model, short.measurement, short.corrections, short.alignment)
    tables, at = solution.tables, short.alignment.event
    expected = list(Plain(short, tables, LEVER, solution.track.axes[at], solution.track.covariance[at]).run())
    assert len(expected) > 200
    for e, state, x, P in expected:
        sigma = np.sqrt(np.diag(P))
        error = drives.errors(solution.track.state[e, :10], state)
        assert np.abs(error[:3]).max() < 1e-6, e
        assert np.abs(error / sigma[:9]).max() < 1e-8
        assert np.abs((solution.track.axes[e] - x) / sigma[9:]).max() < 1e-8
        assert np.abs((solution.track.covariance[e] - P) / np.outer(sigma, sigma)).max() < 1e-9


def test_every_tenth_covariance_says_nearly_the_same(town):
    fine, coarse = (solve(model_of(m), town.measurement, town.corrections, town.alignment) for m in (1, 10))
    apart = (fine.position - coarse.position) * drives.scale(fine.position[0])
    late = fine.time > fine.time[0] + 20
    print(
        "M=10: rms",
        np.sqrt((apart[late] ** 2).mean()),
        "sigma",
        np.abs(coarse.sigma[late, :9] / fine.sigma[late, :9] - 1).max(),
    )
    assert np.sqrt((apart[late] ** 2).mean()) < 0.01
    assert np.abs(coarse.sigma[late, :9] / fine.sigma[late, :9] - 1).max() < 0.02


# Against the truth


def truth_at(log, time):
    (reference,) = log.references
    at = log.seconds(reference.time)
    return np.stack([np.interp(time, at, x) for x in reference.position.T], axis=1)


@pytest.fixture(scope="module")
def study():
    """Return six drives of 20 minutes that the filter's own model made, each with outages of 30 s that do not overlap."""
    model, found = FilterModel("matched", drives.plain(), settings=Settings(every=10)), []
    for seed in range(6):
        made = drives.prepared(model, mixed_route(1200, seed), seed)
        solution = solve(model, made.measurement, made.corrections, made.alignment)
        begin = np.arange(solution.time[0] + 90, solution.time[-1] - 31, 40.0)
        out = drift(solution, solution.events[np.searchsorted(solution.time, begin)], 30.0)
        error = (out.state[:, -1, :3] - truth_at(made.log, out.time[:, -1])) * drives.scale(out.state[0, 0, :3])
        found.append((solution, error, out))
    return found


def test_innovations_of_a_matched_filter_are_as_large_as_it_says(study):
    for solution, _, _ in study:
        nis = solution.track.nis[solution.events[1:]]
        n = np.isfinite(nis[:, 0]).sum()
        assert solution.track.used[solution.events[1:]].all()
        assert nis.mean(axis=0) == pytest.approx(3, abs=3.5 * np.sqrt(6 / n))
        white = solution.track.innovation[solution.events[1:]] / solution.track.deviation[solution.events[1:]]
        later = np.nanmean(white[1:] * white[:-1], axis=0)
        assert np.abs(later).max() < 4 / np.sqrt(n)


def test_errors_behind_outages_are_as_large_as_it_says(study):
    nees = []
    for _, error, out in study:
        assert out.sound.all()
        nees.append(np.einsum("si,sij,sj->s", error[:, :2], np.linalg.inv(out.covariance[:, -1, :2, :2]), error[:, :2]))
    nees = np.concatenate(nees)
    print("outages", nees.size, "NEES/2", nees.mean() / 2, "within 95 %", (nees < 5.991).mean())
    assert nees.size > 120
    assert 0.7 < nees.mean() / 2 < 1.4
    assert 0.88 < (nees < 5.991).mean() <= 1


def test_the_likelihood_is_that_of_the_innovations(study):
    solution = study[0][0]
    v = solution.track.innovation[solution.events]
    s = solution.track.deviation[solution.events]
    first = np.isfinite(s[:, 0])
    each = (-np.log(s) - (v / s) ** 2 / 2)[first].sum(axis=1)
    row = solution.corrections.fix[solution.events][first]
    assert solution.log_likelihood_of(0, int(row[-1])) == pytest.approx(each.sum(), rel=1e-9)
    assert solution.log_likelihood_of(int(row[5]), int(row[80])) == pytest.approx(each[5:81].sum(), rel=1e-9)
    assert solution.log_likelihood_of(int(row[-1]) + 1, 10**6) == 0
    assert np.isfinite(v[1:]).all()


def test_the_likelihood_counts_velocities_of_their_own_time(town):
    model = replace(model_of(10), installation=Installation(lever_arm=LEVER, velocity_delay=0.3))
    found = corrections_of(town.log, town.log.gnss[0], town.measurement, town.stills, model)
    solution = solve(model, town.measurement, found, align(town.measurement, found, town.stills, model))
    track, fix = solution.track, found.fix
    rows = fix[solution.events[20]], fix[solution.events[70]]
    chosen = [
        e for e in range(fix.size) if found.events.kind[e] == FIX and rows[0] <= max(fix[e], -1 - fix[e]) <= rows[1]
    ]
    assert len(chosen) == 2 * (rows[1] - rows[0] + 1)
    z = track.innovation[chosen] / track.deviation[chosen]
    expected = -np.nansum(np.log(track.deviation[chosen])) - np.nansum(z**2) / 2
    assert solution.log_likelihood_of(*map(int, rows)) == pytest.approx(expected, rel=1e-9)


# What cannot be run


def test_what_is_no_number_ends_the_run_and_says_when(town):
    made = SimpleNamespace(**vars(town))
    angle = made.measurement.samples.angle.copy()
    angle[made.alignment.sample + 1000] = np.nan
    measurement = replace(made.measurement, samples=made.measurement.samples._replace(angle=angle))
    with pytest.raises(MissingDataError, match=r"mixed: at \d+\.\d s a state or a variance"):
        solve(model_of(10), measurement, made.corrections, made.alignment)


def test_the_start_is_where_it_is_told(town):
    solution = solve(model_of(10), town.measurement, town.corrections, town.alignment)
    assert solution.events[0] == town.alignment.event
    assert solution.position[0] == pytest.approx(town.alignment.position, abs=1e-15)
    assert solution.euler[0] == pytest.approx(town.alignment.euler, abs=1e-12)
    assert solution.velocity[0] == pytest.approx(town.alignment.velocity)
    assert ecef.cartesian(solution.position).shape == (solution.events.size, 3)
