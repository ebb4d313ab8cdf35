"""A replay end to end on simulated drives: consistent where the model is right, and what it says of bad logs."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import SECOND, ImuStream, Triad
from imuwb.navigation.filter_model import Aids, Installation
from imuwb.navigation.outages import drift
from imuwb.replay import HORIZONS, Outage, model_named, prepare, replay, run, summarize, sweep
from imuwb.replay.replay import check_outages, events_of, receiver_of
from imuwb.simulation import Odometer

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


def without_imu(log, begin, end):
    """Return a log whose IMU lacks samples between two times, s."""
    imu = log.imus[0]
    keep = (imu.angular_rate.time - log.zero < begin * SECOND) | (imu.angular_rate.time - log.zero > end * SECOND)
    triads = [Triad(t.time[keep], t.value[keep]) for t in (imu.angular_rate, imu.specific_force)]
    return replace(log, imus=(ImuStream(imu.name, *triads),))


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
    assert solution.found.time[at] == pytest.approx([120.0, 120.0, 121.0])


def test_outages_between_the_same_fixes_are_refused(town):
    with pytest.raises(UsageError, match=r"two outages of 5 s begin behind the same fix, at 120\.0 s"):
        replay(town.prepared, [town.model], [Outage(120.0, 5.0), Outage(120.4, 5.0)])
    check_outages(town.prepared, town.model, [Outage(120.0, 5.0), Outage(120.4, 6.0), Outage(121.0, 5.0)])


def test_an_outage_that_begins_in_a_gap_of_fixes_is_refused(town):
    time = made.seconds_of(town.log.gnss[0])
    log = made.with_gnss(town.log, (time < 121) | (time > 134))
    prepared = prepare(log, town.model)
    words = r"the outage at 133 s begins where the log has no fixes: the last is at 120\.0 s; --at own"
    with pytest.raises(UsageError, match=words):
        replay(prepared, [town.model], [Outage(133.0, 5.0)])
    check_outages(prepared, town.model, [Outage(120.0, 5.0)])  # behind the last fix there is
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
    last, interval = float(town.prepared.moves.time[-1]), town.prepared.moves.interval
    solution = run(model, town.prepared)
    for start in (220.0, 230.3):
        longest = last - interval - start - 1e-9
        check_outages(town.prepared, model, [Outage(start, longest)])
        found = drift(solution, events_of(solution, [Outage(start, longest)]), longest)
        assert found.time[0, -1] <= last
        assert found.time[0, -1] - found.start[0] == pytest.approx(longest, abs=0.011)
        with pytest.raises(UsageError, match="ends behind the log"):
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
            match=rf"the outage at {start:g} s begins before the filter has settled: it starts at .* s and needs 10 s at the very least",
        ):
            check_outages(town.prepared, town.model, [Outage(start, 5.0)])
    check_outages(town.prepared, town.model, [Outage(settled - 19.9, 5.0)])  # asked for, settled or not
    for start in (236.0, 1e9):
        with pytest.raises(
            UsageError, match=rf"the outage of 5 s at {re.escape(f'{start:g}')} s ends behind the log \(240.0 s\)"
        ):
            check_outages(town.prepared, town.model, [Outage(start, 5.0)])
    with pytest.raises(
        MissingDataError,
        match=r"no outage fits: the filter starts at .* s, needs 30 s to settle, and the log ends at 240.0 s",
    ):
        check_outages(town.prepared, town.model, [])


def test_no_receiver(town):
    with pytest.raises(MissingDataError, match=r"no GNSS receiver in this log; name a file with its fixes with --gnss"):
        prepare(replace(town.log, gnss=()), town.model)
    with pytest.raises(UsageError, match="no receiver '/other'; there are /gnss/fix"):
        prepare(town.log, town.model, "/other")


def test_a_receiver_by_its_name(town):
    g = town.log.gnss[0]
    two = replace(town.log, gnss=(g, replace(g, name="/other")))
    assert prepare(two, town.model, "/other").gnss.name == "/other"
    assert prepare(two, town.model).gnss.name == "/gnss/fix"


def test_which_of_several_receivers_is_said(town):
    g = town.log.gnss[0]
    two = replace(town.log, gnss=(g, replace(g, name="/other")))
    said = "of 2 receivers /gnss/fix is taken; --receiver names another"
    assert said in prepare(two, town.model).notes
    assert said not in prepare(town.log, town.model).notes
    assert not [n for n in prepare(two, town.model, "/gnss/fix").notes if "receivers" in n]  # it was asked for


def test_the_receiver_that_tells_most_is_taken(town):
    g = made.gnss_of(town.log)
    bare = made.gnss_of(town.log, velocity=None, velocity_sigma=None)
    vague = made.gnss_of(town.log, position_sigma=None, velocity_sigma=None)
    short = made.gnss_of(town.log, slice(0, 200))
    few = replace(made.gnss_of(town.log, slice(0, 100)), name="/best")
    for others, best in (((bare,), few), ((vague,), few), ((bare, vague), few), ((short,), replace(g, name="/best"))):
        named = [replace(o, name=f"/{i}") for i, o in enumerate(others)]
        for order in ((*named, best), (best, *named)):  # wherever it stands
            assert receiver_of(replace(town.log, gnss=order), None).name == "/best"
    assert receiver_of(replace(town.log, gnss=(g, replace(g, name="/other"))), None).name == "/gnss/fix"


@pytest.mark.parametrize("velocity", [None, np.full((240, 3), np.nan)], ids=["none", "nan"])
def test_without_velocity_positions_tell_the_heading(town, velocity):
    prepared = prepare(made.with_gnss(town.log, velocity=velocity, velocity_sigma=None), town.model)
    truth = town.log.references[0]
    t = (truth.time - town.log.zero) / SECOND
    course = np.arctan2(*(np.interp(prepared.start_time, t, truth.velocity[:, i]) for i in (1, 0)))
    off = np.angle(np.exp(1j * (prepared.start.euler[2] - course)))
    assert abs(off) < 3.5 * np.sqrt(prepared.start.covariance[8, 8])
    assert abs(prepared.start_time - town.prepared.start_time) < 15  # positions tell later that it moves
    model = replace(town.model, settings=replace(town.model.settings, settling=60.0))
    found = replay(prepared, [model], sweep(prepared, model, 10.0))
    (one,) = found.runs.values()
    assert found.scored[10.0].all()
    s = summarize("known", 10.0, one.outages[10.0].scores, (10.0,), 1.0, 0.95)
    assert 0.2 < s.consistency[-1].nees_per_dof < 3
    assert np.isnan(one.solution.fix_nis[:, 1]).all()
    assert 0.8 < np.nanmean(one.solution.fix_nis[:, 0]) / 3 < 1.2


def test_no_sigmas_are_said_and_taken(town):
    prepared = prepare(made.with_gnss(town.log, position_sigma=None, velocity_sigma=None), town.model)
    said = "\n".join(prepared.notes)
    assert "claims no sigmas of position: (2.5, 5.0) m are taken" in said
    assert "claims no sigmas of velocity: (0.15, 0.3) m/s are taken" in said
    assert np.unique(prepared.found.events.variance[:, 0]) == pytest.approx([2.5**2])


def test_sigmas_of_nothing_are_the_usual(town):
    none = np.full((240, 3), np.nan)
    prepared = prepare(made.with_gnss(town.log, position_sigma=none, velocity_sigma=0 * none), town.model)
    assert (prepared.found.events.variance > 0).all()


@pytest.mark.parametrize("count", [0, 1, 4])
def test_too_few_fixes(town, count):
    if not count:
        log = made.with_gnss(town.log, fix_type=np.full(240, 1))
    else:
        log = made.with_gnss(town.log, np.arange(100, 100 + count))
    with pytest.raises(
        MissingDataError, match=rf"{count} usable fixes of /gnss/fix lie within the IMU's time .* a filter needs 5"
    ):
        prepare(log, town.model)


def test_who_never_moves_has_no_heading(town):
    still = np.arange(60)
    with pytest.raises(MissingDataError, match=r"never moves faster than 3 m/s .* heading cannot be observed"):
        prepare(made.with_gnss(town.log, still), town.model)


def test_clocks_that_do_not_meet(town):
    far = town.log.gnss[0].time + 10**6 * SECOND
    log = replace(made.with_gnss(town.log, time=far), zero=town.log.zero)
    with pytest.raises(
        MissingDataError, match=r"0 usable fixes .* \(-?0\.0 s to 240\.0 s; the fixes: 1000000\.0 s to 1000239\.0 s\)"
    ):
        prepare(log, town.model)


def test_half_the_fixes_are_enough(town):
    log = made.with_gnss(town.log, np.arange(0, 240, 2))
    found = replay(prepare(log, town.model), [town.model], [Outage(130.0, 10.0)])
    assert found.scored[10.0].tolist() == [True]


def test_held_fixes_are_left_out(town, swept):
    g = town.log.gnss[0]
    rows = np.repeat(np.arange(240), 5)
    time = g.time[rows] + np.tile(np.arange(5) * SECOND // 5, 240)
    parts = {n: getattr(g, n)[rows] for n in ("position", "velocity", "position_sigma", "velocity_sigma", "fix_type")}
    prepared = prepare(replace(town.log, gnss=(replace(g, time=time, **parts),)), town.model)
    assert any("fixes that repeat the one before while moving are not used" in n for n in prepared.notes)
    found = replay(prepared, [town.model], sweep(prepared, town.model, 20.0))
    median = np.median(found.runs["known"].outages[20.0].scores.horizontal[:, -1])
    assert median == pytest.approx(np.median(swept.runs["known"].outages[20.0].scores.horizontal[:, -1]), rel=0.3)


def test_velocity_spikes_and_jumps_do_no_harm(town, swept):
    g = town.log.gnss[0]
    velocity, position = np.array(g.velocity), np.array(g.position)
    velocity[[100, 140, 200], 0] += 400.0
    position[[120, 121, 170], 0] += 50 / 6.37e6  # north, two of them one behind the other
    prepared = prepare(made.with_gnss(town.log, velocity=velocity, position=position), town.model)
    assert "/gnss/fix: 3 velocities above 350 m/s are not used" in prepared.notes
    found = replay(prepared, [town.model], sweep(prepared, town.model, 20.0))
    one = found.runs["known"]
    assert one.solution.refused == 3
    median = np.median(one.outages[20.0].scores.horizontal[:, -1])
    assert median == pytest.approx(np.median(swept.runs["known"].outages[20.0].scores.horizontal[:, -1]), rel=0.15)


def test_a_spike_at_the_first_moving_fix_is_not_where_it_starts(town):
    velocity = np.array(town.log.gnss[0].velocity)
    velocity[20, 1] = 427.0  # it stands
    start = prepare(made.with_gnss(town.log, velocity=velocity), town.model).start_time
    assert start == town.prepared.start_time


def test_a_gap_of_the_imu_is_not_scored_and_said(town):
    log = without_imu(town.log, 140.0, 142.0)
    prepared = prepare(log, town.model)
    outages = [Outage(110.0, 20.0), Outage(130.0, 20.0), Outage(141.5, 10.0), Outage(150.0, 20.0)]
    found = replay(prepared, [town.model], outages)
    assert found.scored[20.0].tolist() == [True, False, True]
    assert found.scored[10.0].tolist() == [False]
    assert "1 outages of 20 s are not scored: IMU samples are missing within them" in found.notes
    assert any("samples missing in 1 gaps: bridged by straight lines" in n for n in found.notes)


def test_behind_the_reference_is_not_scored_and_said(town):
    truth = town.log.references[0]
    short = replace(truth, **{n: getattr(truth, n)[:1400] for n in ("time", "position", "velocity", "attitude")})
    prepared = prepare(replace(town.log, references=(short,)), town.model)
    found = replay(prepared, [town.model], [Outage(110.0, 20.0), Outage(130.0, 20.0)])
    assert found.scored[20.0].tolist() == [True, False]
    assert "1 outages of 20 s are not scored: truth has no value there, or a filter failed" in found.notes


def test_a_reference_that_is_not_there(town):
    log = replace(town.log, references=())
    prepared = prepare(log, town.model)
    with pytest.raises(ValueError, match="no reference trajectory with velocities"):
        replay(prepared, [town.model], [Outage(120.0, 5.0)], reference="truth")
    kinds = {
        w: replay(prepared, [town.model], [Outage(120.0, 5.0)], reference=w).reference.kind
        for w in ("best", "smoothed", "own")
    }
    assert kinds == {"best": "smoothed", "smoothed": "smoothed", "own": "own"}


def test_all_fixes_smoothed_are_nearer_to_truth_than_the_own_run(town):
    log = replace(town.log, references=())
    prepared = prepare(log, town.model)
    outages = [Outage(120.0, 5.0)]
    off = {}
    truth = replay(town.prepared, [town.model], outages).reference
    for kind in ("smoothed", "own"):
        against = replay(prepared, [town.model], outages, reference=kind).reference
        t = np.arange(80.0, 235.0)
        where = against.at(t)[0] - truth.at(t)[0]
        off[kind] = np.sqrt(np.mean((where[:, 0] * made.A) ** 2))
    assert off["smoothed"] < 0.8 * off["own"] < 1.5


@pytest.mark.parametrize("reference", ["own", "smoothed"])
def test_nees_does_not_depend_on_the_reference(town, reference):
    """Of the better estimate the error has no covariance with what it adds: var(a - b) is P_a less P_b."""
    outages = sweep(town.prepared, town.model, 5.0)
    of = {w: replay(town.prepared, [town.model], outages, reference=w) for w in ("truth", reference)}
    good = of["truth"].scored[5.0] & of[reference].scored[5.0]
    truth, other = (r.runs["known"].outages[5.0].scores.nees[good, -1].mean() for r in of.values())
    assert other == pytest.approx(truth, rel=0.3)


def test_aids_bound_the_drift(town):
    odometer = made.town(240, 3, odometer=Odometer())
    aided = replace(odometer.model, aids=Aids(straight=0.1, still=0.05, speed=0.1))
    prepared = prepare(odometer.log, aided)
    outages = [Outage(s, 30.0) for s in np.arange(110.0, 200, 10)]
    found = replay(prepared, [aided], outages).runs["known"].outages[30.0].scores
    plain = replay(town.prepared, [town.model], outages).runs["known"].outages[30.0].scores
    assert np.median(found.horizontal[:, -1]) < 0.5 * np.median(plain.horizontal[:, -1])


def test_a_lever_arm_and_a_mounting_that_are_told_do_not_matter():
    arm = (0.8, -0.3, -1.4)
    off = made.town(240, 3, receiver=made.Receiver(lever_arm=arm))
    outages = [Outage(s, 20.0) for s in np.arange(110.0, 210, 5)]

    def median(installation):
        model = replace(off.model, installation=installation)
        scored = replay(prepare(off.log, model), [model], outages).runs["known"]
        return float(np.median(scored.outages[20.0].scores.horizontal[:, -1])), np.nanmean(scored.solution.fix_nis) / 3

    told, nis = median(Installation(lever_arm=arm))
    _, ignored = median(Installation())
    assert 0.85 < nis < 1.15
    assert nis < ignored
    assert told < 40
