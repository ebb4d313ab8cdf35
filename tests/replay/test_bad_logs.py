"""What a replay makes of logs that lack something, and of receivers of several kinds."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import SECOND, ImuStream, Triad
from imuwb.navigation.filter_model import Aids, Installation
from imuwb.notes import ids
from imuwb.replay import Outage, prepare, replay, summarize, sweep
from imuwb.replay.prepared import receiver_of
from imuwb.simulation import Odometer

from . import made


@pytest.fixture(scope="module")
def town():
    made_town = made.town(240, 3)
    prepared = prepare(made_town.log, made_town.model)
    return SimpleNamespace(log=made_town.log, model=made_town.model, prepared=prepared)


@pytest.fixture(scope="module")
def swept(town):
    return replay(town.prepared, [town.model], sweep(town.prepared, town.model, 20.0))


def without_imu(log, begin, end):
    """Return a log whose IMU lacks samples between two times, s."""
    imu = log.imus[0]
    keep = (imu.angular_rate.time - log.zero < begin * SECOND) | (imu.angular_rate.time - log.zero > end * SECOND)
    triads = [Triad(t.time[keep], t.value[keep]) for t in (imu.angular_rate, imu.specific_force)]
    return replace(log, imus=(ImuStream(imu.name, *triads),))


def test_no_receiver(town):
    with pytest.raises(MissingDataError, match=r"no GNSS receiver.* --gnss"):
        prepare(replace(town.log, gnss=()), town.model)
    with pytest.raises(UsageError, match="no receiver '/other'; .* /gnss/fix"):
        prepare(town.log, town.model, "/other")


def test_a_receiver_by_its_name(town):
    g = town.log.gnss[0]
    two = replace(town.log, gnss=(g, replace(g, name="/other")))
    assert prepare(two, town.model, "/other").gnss.name == "/other"
    assert prepare(two, town.model).gnss.name == "/gnss/fix"


def test_which_of_several_receivers_is_said(town):
    g = town.log.gnss[0]
    two = replace(town.log, gnss=(g, replace(g, name="/other")))
    assert "several-receivers" in ids(prepare(two, town.model).notes)
    assert any("2 receivers: /gnss/fix" in n for n in prepare(two, town.model).notes)
    assert "several-receivers" not in ids(prepare(town.log, town.model).notes)
    assert "several-receivers" not in ids(prepare(two, town.model, "/gnss/fix").notes)  # it was asked for


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
    off = np.angle(np.exp(1j * (prepared.alignment.euler[2] - course)))
    assert abs(off) < 3.5 * np.sqrt(prepared.alignment.covariance[8, 8])
    assert abs(prepared.start_time - town.prepared.start_time) < 15  # positions show the motion later
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
    assert {"default-position-sigmas", "default-velocity-sigmas"} <= set(ids(prepared.notes))
    assert np.unique(prepared.corrections.events.variance[:, 0]) == pytest.approx([2.5**2])


def test_sigmas_of_nothing_are_the_usual(town):
    none = np.full((240, 3), np.nan)
    prepared = prepare(made.with_gnss(town.log, position_sigma=none, velocity_sigma=0 * none), town.model)
    assert (prepared.corrections.events.variance > 0).all()


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
    with pytest.raises(MissingDataError, match=r"never faster than 3 m/s"):
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
    assert "repeated-fixes" in ids(prepared.notes)
    found = replay(prepared, [town.model], sweep(prepared, town.model, 20.0))
    median = np.median(found.runs["known"].outages[20.0].scores.horizontal[:, -1])
    assert median == pytest.approx(np.median(swept.runs["known"].outages[20.0].scores.horizontal[:, -1]), rel=0.3)


def test_velocity_spikes_and_jumps_do_no_harm(town, swept):
    g = town.log.gnss[0]
    velocity, position = np.array(g.velocity), np.array(g.position)
    velocity[[100, 140, 200], 0] += 400.0
    position[[120, 121, 170], 0] += 50 / 6.37e6  # north, two of them in a row
    prepared = prepare(made.with_gnss(town.log, velocity=velocity, position=position), town.model)
    (note,) = (n for n in prepared.notes if n.id == "velocity-spikes")
    assert note.startswith("/gnss/fix: 3 lone velocities")
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
    assert {"gap-in-outage", "imu-gaps"} <= set(ids(found.notes))
    assert any(n.startswith("1 outage of 20 s is not scored") for n in found.notes)


def test_behind_the_reference_is_not_scored_and_said(town):
    truth = town.log.references[0]
    short = replace(truth, **{n: getattr(truth, n)[:1400] for n in ("time", "position", "velocity", "attitude")})
    prepared = prepare(replace(town.log, references=(short,)), town.model)
    found = replay(prepared, [town.model], [Outage(110.0, 20.0), Outage(130.0, 20.0)])
    assert found.scored[20.0].tolist() == [True, False]
    assert "no-reference" in ids(found.notes)
    assert any(n.startswith("1 outage of 20 s is not scored: truth") for n in found.notes)


def test_a_reference_that_is_not_there(town):
    log = replace(town.log, references=())
    prepared = prepare(log, town.model)
    with pytest.raises(ValueError, match="no reference trajectory; name a file"):
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

    expected, nis = median(Installation(lever_arm=arm))
    _, ignored = median(Installation())
    assert 0.85 < nis < 1.15
    assert nis < ignored
    assert expected < 40
