"""Outages as branches are, bit for bit, runs of the filter that leave fixes out."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from imuwb.log import AXES
from imuwb.navigation import outages
from imuwb.navigation.filter import solve
from imuwb.navigation.filter_model import Aids, FilterModel, Installation, Settings
from imuwb.navigation.outages import drift, marks_of
from imuwb.navigation.tables import FIX, STRAIGHT, Events
from imuwb.simulation import Odometer, Receiver, drive, mixed_route
from imuwb.stochastic import Autoregressive, AxisModel, Constant, GaussMarkov, ImuErrorModel, Sum, WhiteNoise

from . import drives

EVERY, SECONDS = 10, 30.0
OFFSET = 0.237  #: s, of the receiver's stamps, so that no aid falls on a fix's sample
GM, AR = GaussMarkov(3e-4, 30.0), Autoregressive((-1.8, 0.85, -0.045), 1e-5, 0.01)
ORDERS = {
    9: [], 15: [Constant(2e-3)], 21: [GM, Constant(2e-3)], 18: [AR], 27: [AR],
}  # fmt: skip


def model_of(states, aids, every=EVERY):
    axes = {}
    for axis in AXES:
        more = ORDERS[states]
        if states == 18 and axis[0] == "a":
            more = []  # gyros of order 3, accelerometers of none
        axes[axis] = AxisModel(Sum((WhiteNoise(2e-4 if axis[0] == "g" else 2e-3), *more)))
    return FilterModel(
        f"{states}", ImuErrorModel("m", axes), aids=aids, settings=Settings(every=every),
        installation=Installation(lever_arm=(0.5, 0.1, -1.0), gnss_delay=OFFSET),
    )  # fmt: skip


NO_AIDS, ALL_AIDS = Aids(), Aids(straight=0.3, still=0.05, speed=0.3)


@pytest.fixture(scope="module")
def town():
    receiver = Receiver(lever_arm=(0.5, 0.1, -1.0), latency=OFFSET)
    return drive(model_of(21, NO_AIDS).error_model, mixed_route(300, 4), 3, receiver=receiver, odometer=Odometer())


def watched(found, marks):
    """Return corrections with an event that measures nothing after each of some samples."""
    extra = np.unique(marks) - 1
    old = found.events
    at = np.concatenate([old.at, extra])
    order = np.argsort(at, kind="stable")  # what counts at the same sample comes first

    def with_zeros(values, fill=0.0):
        return np.concatenate([values, np.full((extra.size, *values.shape[1:]), fill, values.dtype)])[order]

    events = Events(at[order], with_zeros(old.kind, STRAIGHT), *(with_zeros(x) for x in old[2:]))
    time = np.concatenate([found.time, np.full(extra.size, np.nan)])[order]
    return replace(found, events=events, time=time, fix=with_zeros(found.fix, -1))


def both(town, model, chosen=(10, 60, 110), seconds=SECONDS):
    """Return a drift from some fixes on, and for each the states and covariances of a run without its fixes."""
    made = drives.prepared(model, log=town)
    first = solve(model, made.measurement, made.corrections, made.alignment)
    marks = marks_of(first, first.events[list(chosen)], seconds)
    found = watched(made.corrections, marks)
    solution = solve(
        model,
        made.measurement,
        found,
        replace(made.alignment, event=int(np.searchsorted(found.events.at, made.alignment.sample - 1))),
    )
    assert np.array_equal(solution.position, first.position)
    out = drift(solution, solution.events[list(chosen)], seconds)
    runs = []
    for k in range(len(chosen)):
        begin, end = out.start[k], out.time[k, -1] + 0.5
        run = solve(model, made.measurement, found, solution.alignment, without=(begin, end))
        last = np.searchsorted(found.events.at, out.mark[k], side="left") - 1  # the last event up to each mark's sample
        assert np.array_equal(found.events.at[last] + 1, out.mark[k])
        runs.append((run.track.state[last, :10], run.track.covariance[last, :9, :9], run))
    return out, runs, solution


@pytest.mark.parametrize("aids", [NO_AIDS, ALL_AIDS], ids=["alone", "aided"])
@pytest.mark.parametrize("states", sorted(ORDERS))
def test_a_branch_is_a_run_without_its_fixes(town, states, aids):
    model = model_of(states, aids)
    out, runs, solution = both(town, model)
    assert solution.track.covariance.shape[1] == states
    assert out.sound.all()
    assert out.state.shape == (3, 30, 10)
    for k, (state, covariance, run) in enumerate(runs):
        assert np.array_equal(out.state[k], state)
        assert np.array_equal(out.covariance[k], covariance)
        assert not np.array_equal(
            out.state[k, -1, :3], solution.position[np.searchsorted(solution.time, out.time[k, -1])]
        )
        # It went astray, and the fixes that follow bring it back, if its model knows of the bias that there is.
        after = run.time > out.time[k, -1] + 20
        apart = (run.position[after] - solution.position[-after.sum() :]) * drives.scale(run.position[0])
        assert np.linalg.norm(apart[-1]) < (2 if states in {15, 21} else 50)


def test_a_branch_takes_the_aids_at_its_fixs_own_sample(town):
    model = replace(model_of(15, ALL_AIDS), installation=Installation(gnss_delay=0.0))
    out, runs, solution = both(town, model, chosen=(40,))
    at = solution.corrections.events.at[out.event[0]]
    assert (solution.corrections.events.at == at).sum() > 1
    assert np.array_equal(out.state[0], runs[0][0])


@pytest.mark.parametrize("aids", [NO_AIDS, ALL_AIDS], ids=["alone", "aided"])
def test_looking_at_marks_changes_nothing(town, aids, monkeypatch):
    """However often it is looked at: the end is that of a run that nobody looks at, before its next fix."""
    model = model_of(27, aids, 7)
    made = drives.prepared(model, log=town)
    plain = solve(model, made.measurement, made.corrections, made.alignment)
    chosen = plain.events[[10, 60, 110]]
    assert ((made.corrections.events.at[plain.events[[41, 91, 141]]] + 1) % 7).any()  # off the grid of the covariance
    for k, event in enumerate(chosen):
        (after,) = plain.events[np.flatnonzero(plain.events == event) + 31]
        begin, end = (float(made.measurement.time[made.corrections.events.at[e]]) for e in (event, after))
        outs = []
        for each in (0.013, 0.37, 1.0, 1e9):
            monkeypatch.setattr(outages, "EACH", each)
            outs.append(drift(plain, chosen[k : k + 1], end - begin))
        assert [o.elapsed.size > 1 for o in outs] == [True, True, True, False]
        run = solve(model, made.measurement, made.corrections, made.alignment, without=(begin, end), smooth=True)
        for out in outs:
            assert out.time[0, -1] == end
            assert np.array_equal(out.state[0, -1], run.track.before.state[after, :10])
            assert np.array_equal(out.covariance[0, -1], run.track.before.covariance[after, :9, :9])


@pytest.mark.parametrize("seconds", [30.0, 12.342, 0.4])
def test_marks_are_each_second_and_the_end_to_a_sample(town, seconds):
    model = model_of(15, NO_AIDS)
    made = drives.prepared(model, log=town)
    solution = solve(model, made.measurement, made.corrections, made.alignment)
    out = drift(solution, solution.events[[10, 60, 110]], seconds)
    expected = [*range(1, int(seconds) + 1)] + ([seconds] if seconds % 1 else [])
    assert out.elapsed.tolist() == expected
    assert np.array_equal(
        out.mark, made.corrections.events.at[out.event][:, None] + 1 + np.rint(out.elapsed * drives.HZ)
    )
    assert np.abs(out.time - out.start[:, None] - out.elapsed).max() <= 0.5 / drives.HZ + 1e-6
    assert out.time == pytest.approx(made.measurement.time[out.mark - 1], abs=0)


def test_outages_do_not_know_of_each_other(town):
    model = model_of(15, NO_AIDS)
    made = drives.prepared(model, log=town)
    solution = solve(model, made.measurement, made.corrections, made.alignment)
    events = solution.events[5:100]
    many = drift(solution, events, SECONDS)
    for k in (0, 50, 94):
        one = drift(solution, events[k : k + 1], SECONDS)
        assert np.array_equal(one.state[0], many.state[k])
        assert np.array_equal(one.covariance[0], many.covariance[k])
    rough = drift(solution, events, SECONDS, with_covariance=False)
    assert np.array_equal(rough.state, many.state)
    assert np.array_equal(rough.covariance[:, -1], solution.track.covariance[events][:, :9, :9])


def test_aids_keep_a_drift_small(town):
    ends = []
    for aids in (NO_AIDS, ALL_AIDS):
        out, _, solution = both(town, model_of(15, aids))
        at = town.seconds(town.references[0].time)
        truth = np.array([[np.interp(out.time[k, -1], at, x) for x in town.references[0].position.T] for k in range(3)])
        ends.append(np.abs((out.state[:, -1, :3] - truth) * drives.scale(truth[0])).max())
        sigma = np.sqrt(np.diagonal(out.covariance[:, -1], axis1=1, axis2=2))
        ends.append(sigma[:, :2].max())
        assert (solution.corrections.events.kind == FIX).sum() > 200
    assert ends[2] < ends[0]
    assert ends[3] < 0.5 * ends[1]


@pytest.mark.parametrize("states", [15, 21, 27])
def test_every_tenth_covariance_drifts_nearly_the_same(town, states):
    outs = []
    for every in (1, 10):
        model = replace(model_of(states, NO_AIDS, every), installation=Installation(gnss_delay=0.01))
        made = drives.prepared(model, log=town)
        solution = solve(model, made.measurement, made.corrections, made.alignment)
        outs.append(drift(solution, solution.events[20:150:10], 60.0))
    fine, coarse = outs
    assert np.array_equal(fine.mark, coarse.mark)
    apart = (coarse.state[:, -1, :3] - fine.state[:, -1, :3]) * drives.scale(fine.state[0, 0, :3])
    one, other = (np.sqrt(np.diagonal(o.covariance, axis1=2, axis2=3)) for o in (fine, coarse))
    print(states, "M=10 after 60 s: rms", np.sqrt((apart**2).mean()), "m, sigma", np.abs(other / one - 1).max())
    assert np.sqrt((apart**2).mean()) < 0.01
    assert np.abs(other / one - 1).max() < 0.02


BEYOND = """
from imuwb.navigation import FilterModel, drift, solve
from imuwb.navigation.alignment import align
from imuwb.navigation.corrections import corrections_of
from imuwb.navigation.measurement import measurement_of
from imuwb.simulation import drive, mixed_route, preset
import numpy as np
model = FilterModel("m", preset("3dm-gx3-25-gm"))
log = drive(model.error_model, mixed_route(120), 1)
measurement = measurement_of(log, log.imu(), model.installation)
found = corrections_of(log, log.gnss[0], measurement, np.zeros((0, 2)), model)
solution = solve(model, measurement, found, align(measurement, found, np.zeros((0, 2)), model))
try:
    drift(solution, solution.events[-5:-4], 3600.0)
except ValueError as error:
    print("refused", error)
"""


@pytest.mark.slow
def test_an_outage_beyond_the_logs_end_is_refused():
    found = subprocess.run([sys.executable, "-c", BEYOND], capture_output=True, text=True, check=False)
    assert found.returncode == 0
    assert "refused" in found.stdout
