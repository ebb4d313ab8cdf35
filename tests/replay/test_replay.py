"""A replay end to end on simulated drives: consistent where the model is right, and what it says of bad logs."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import ImuStream, Triad
from imuwb.navigation.outages import drift
from imuwb.replay import HORIZONS, Outage, model_named, prepare, replay, run, summarize, sweep
from imuwb.replay.outages import check_outages, events_of

from . import made


@pytest.fixture(scope="module")
def town():
    made_town = made.town(240, 3)
    prepared = prepare(made_town.log, made_town.model)
    return SimpleNamespace(log=made_town.log, model=made_town.model, prepared=prepared)


@pytest.fixture(scope="module")
def swept(town):
    white = model_named("none", town.model, interval=0.02)
    outages = sweep(town.prepared, town.model, 20.0)
    return replay(town.prepared, [town.model, white], outages)


def test_a_sweep_has_an_outage_behind_every_fix(town):
    start = np.array([o.start for o in sweep(town.prepared, town.model, 20.0)])
    assert np.diff(start) == pytest.approx(1.0)
    assert start[0] == pytest.approx(town.prepared.start_time + 30.0)
    assert start[-1] == pytest.approx(239 - 20)
    assert sweep(town.prepared, town.model, 500.0) == ()


def test_a_sweep_of_a_fast_receiver_is_once_a_second():
    fast = made.town(120, receiver=made.Receiver(rate=8.0))
    start = [o.start for o in sweep(prepare(fast.log, fast.model), fast.model, 5.0)]
    assert np.diff(start).min() >= 0.95
    assert np.diff(start).max() <= 1.0 + 1e-6


def test_the_filter_that_knows_is_consistent_and_the_one_that_does_not_drifts_more(swept):
    known, white = (summarize(n, 20.0, r.outages[20.0].scores, HORIZONS, 1.0, 0.95) for n, r in swept.runs.items())
    assert known.count == int(swept.scored[20.0].sum()) > 100
    assert known.effective_count == 7
    for c in known.consistency:
        assert 0.3 < c.nees_per_dof < 2.5
        assert c.coverage95 > 0.7
    assert white.consistency[-1].nees_per_dof > 3 * known.consistency[-1].nees_per_dof
    assert white.median_end.value > 2 * known.median_end.value


def test_common_and_own_reference(swept):
    found = swept.runs["known"].outages[20.0]
    assert swept.reference.kind == "truth"
    off = np.linalg.norm(found.scores.north_east - found.own.north_east, axis=-1)
    assert np.nanmedian(off) < 2.0  # the run without outage is off truth as fixes are
    assert np.isfinite(off[:-1]).all()
    # Of a run with more fixes the variance is taken off, and what is left is a covariance.
    sigma = swept.runs["known"].solution.sigma[:, :2]
    time = swept.runs["known"].solution.time
    own = np.stack([np.interp(found.drift.time, time, s) for s in sigma.T], axis=-1)[..., None] * np.eye(2)
    less = found.drift.covariance[..., :2, :2] - own**2
    assert (np.linalg.eigvalsh(found.own.covariance) > 0).all()
    late = slice(9, None)  # by then the fixes know far more
    assert found.own.covariance[:, late] == pytest.approx(less[:, late], rel=1e-9)
    assert found.scores.covariance == pytest.approx(found.drift.covariance[..., :2, :2])  # truth adds nothing


def test_an_outage_at_a_second_is_the_sweeps(town, swept):
    alone = replay(town.prepared, [town.model], [Outage(120.0, 20.0)])
    row = int(np.argmin(np.abs(swept.runs["known"].outages[20.0].drift.start - 120.0)))
    assert alone.runs["known"].outages[20.0].scores.horizontal[0] == pytest.approx(
        swept.runs["known"].outages[20.0].scores.horizontal[row], rel=1e-9
    )


def test_outages_of_several_lengths_are_run_apart(town):
    found = replay(town.prepared, [town.model], [Outage(110.0, 20.0), Outage(150.0, 5.0), Outage(120.0, 5.0)])
    assert {d: v.tolist() for d, v in found.scored.items()} == {5.0: [True, True], 20.0: [True]}
    assert found.runs["known"].outages[5.0].scores.horizontal.shape == (2, 5)


def test_the_last_fix_before_an_outage(town):
    solution = run(town.model, town.prepared)
    at = events_of(solution, [Outage(120.0, 5.0), Outage(120.9, 5.0), Outage(121.0, 5.0)])
    assert solution.corrections.time[at] == pytest.approx([120.0, 120.0, 121.0])


def test_outages_between_the_same_fixes_are_refused(town):
    with pytest.raises(UsageError, match=r"the outage of 5 s at 120\.4 s and another one .* 120\.0 s"):
        replay(town.prepared, [town.model], [Outage(120.0, 5.0), Outage(120.4, 5.0)])
    check_outages(town.prepared, town.model, [Outage(120.0, 5.0), Outage(120.4, 6.0), Outage(121.0, 5.0)])


def test_an_outage_that_begins_in_a_gap_of_fixes_is_refused(town):
    time = made.seconds_of(town.log.gnss[0])
    log = made.with_gnss(town.log, (time < 121) | (time > 134))
    prepared = prepare(log, town.model)
    words = r"the outage of 5 s at 133 s begins in a gap .* 120\.0 s; .* --at own"
    with pytest.raises(UsageError, match=words):
        replay(prepared, [town.model], [Outage(133.0, 5.0)])
    check_outages(prepared, town.model, [Outage(120.0, 5.0)])  # after the last fix before the gap
    drift = replay(prepared, [town.model], [Outage(135.0, 5.0)]).runs["known"].outages[5.0].drift
    assert drift.time[0] == pytest.approx(np.arange(136.0, 141.0), abs=0.02)


@pytest.mark.parametrize("every", [30, 100])
def test_marks_are_where_they_are_said_to_be(town, every):
    model = replace(town.model, settings=replace(town.model.settings, every=every))
    found = replay(town.prepared, [model], sweep(town.prepared, model, 5.0)[:7]).runs["known"].outages[5.0]
    elapsed = found.drift.time - found.drift.start[:, None]
    assert np.abs(elapsed - found.scores.elapsed).max() < 0.011  # half a sample


@pytest.mark.parametrize(("duration", "marks"), [(5.0, [1, 2, 3, 4, 5]), (4.6, [1, 2, 3, 4, 4.6]), (0.6, [0.6])])
def test_seconds_and_the_end_are_scored(town, duration, marks):
    found = replay(town.prepared, [town.model], [Outage(120.0, duration)])
    assert found.runs["known"].outages[duration].scores.elapsed.tolist() == marks


def test_an_outage_is_judged_at_its_end(town):
    found = replay(town.prepared, [town.model], [Outage(120.0, 2.4)])
    drift = found.runs["known"].outages[2.4].drift
    assert drift.time[0, -1] - drift.start[0] == pytest.approx(2.4, abs=1e-6)


@pytest.mark.parametrize("every", [10, 70])
def test_an_outage_to_the_very_end(town, every):
    model = replace(town.model, settings=replace(town.model.settings, every=every))
    last, interval = float(town.prepared.measurement.time[-1]), town.prepared.measurement.interval
    solution = run(model, town.prepared)
    for start in (220.0, 230.3):
        longest = last - interval - start - 1e-9
        check_outages(town.prepared, model, [Outage(start, longest)])
        found = drift(solution, events_of(solution, [Outage(start, longest)]), longest)
        assert found.time[0, -1] <= last
        assert found.time[0, -1] - found.start[0] == pytest.approx(longest, abs=0.011)
        with pytest.raises(UsageError, match="ends after the log"):
            replay(town.prepared, [model], [Outage(start, longest + 0.01)])


def test_a_sweep_of_a_log_that_ends_with_its_last_fix(town):
    """As pymavlink_flight.tlog and mavparser_00000081.BIN do."""
    imu = town.log.imus[0]
    triads = [Triad(t.time[:11_953], t.value[:11_953]) for t in (imu.angular_rate, imu.specific_force)]  # 239.04 s
    prepared = prepare(replace(town.log, imus=(ImuStream(imu.name, *triads),)), town.model)
    found = replay(prepared, [town.model], sweep(prepared, town.model, 20.0))
    assert found.scored[20.0].sum() > 100


def test_outages_that_cannot_be(town):
    settled = town.prepared.start_time + 30
    for start in (-5.0, 10.0, town.prepared.start_time + 9.9):
        with pytest.raises(
            UsageError,
            match=rf"the outage of 5 s at {start:g} s .* {settled - 20:.1f} s or later",
        ):
            check_outages(town.prepared, town.model, [Outage(start, 5.0)])
    check_outages(town.prepared, town.model, [Outage(settled - 19.9, 5.0)])  # asked for, settled or not
    for start in (236.0, 1e9):
        with pytest.raises(
            UsageError,
            match=rf"the outage of 5 s at {re.escape(f'{start:g}')} s ends after the log; it must end before 240.0 s",
        ):
            check_outages(town.prepared, town.model, [Outage(start, 5.0)])
    with pytest.raises(
        MissingDataError,
        match=r"the filter starts at .* s and settles for 30 s, and the log ends at 240.0 s",
    ):
        check_outages(town.prepared, town.model, [])
