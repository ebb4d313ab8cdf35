"""References that contradict themselves or the fixes: how far, in which outages, and what is refused."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.geodesy import ned_scale
from imuwb.log import SECOND
from imuwb.notes import ids
from imuwb.replay import Outage, prepare, reference_track, replay, run
from imuwb.replay.noise import tuning
from imuwb.replay.noise.tuning import tune
from imuwb.replay.references.reference_check import contradiction, discrepancy, elsewhere, velocity_lag, yardsticks

from .. import made  # noqa: TID252 - tests are no package that has a name
from .test_reference import circle


def track(rate=1.0, off=None, velocity=None, seconds=120.0, keep=None, kind="truth"):
    """Return a circle at 8 m/s, whose positions are off by some metres north, (n,)."""
    t = np.arange(0, seconds, 1 / rate)
    t = t if keep is None else t[keep(t)]
    position, own, _ = circle(t)
    if off is not None:
        position[:, 0] += off(t) / ned_scale(position[:, 0], position[:, 2])[:, 0]
    made_track = made.track(position, own if velocity is None else velocity(own), 1.0)
    return replace(made_track, time=t, kind=kind)


START, ENDS = np.array([10.0, 60.0]), np.array([[20.0, 40.0], [70.0, 90.0]])


@pytest.mark.parametrize(("rate", "most"), [(10.0, 2e-3), (1.0, 0.02), (0.5, 0.3)])
def test_what_turns_does_not_contradict_itself(rate, most):
    assert discrepancy(track(rate), START, ENDS).max() < most


def test_a_step_counts_from_when_it_happens():
    found = discrepancy(track(off=lambda t: 3.0 * (t > 75.5)), START, ENDS)
    assert found == pytest.approx(np.array([[0, 0], [0, 3.0]]), abs=0.05)


def test_a_wrong_velocity_grows():
    found = discrepancy(track(velocity=lambda v: v + np.array([0, 0.2, 5.0])), START, ENDS)
    assert found == pytest.approx(np.array([[2, 6], [2, 6]]), abs=0.2)  # the velocity down does not count


def test_there_and_back_is_its_extent():
    bump = discrepancy(track(off=lambda t: 4.0 * ((t > 65) & (t < 68))), START, ENDS)
    assert bump[1, 1] == pytest.approx(4.0, abs=0.05)


def test_velocities_that_are_late_by_a_constant_time_contradict_nothing():
    late = track(rate=10.0, seconds=121.0)
    t = late.time
    late = replace(late, velocity=np.stack([np.interp(t - 0.15, t, v) for v in late.velocity.T], axis=1))
    assert velocity_lag(late) == pytest.approx(0.15, abs=0.01)
    assert discrepancy(late, START, ENDS).max() < 0.02
    stepped_too = replace(late, position=late.position + (t > 75)[:, None] * np.array([3 / 6.4e6, 0, 0]))
    assert velocity_lag(stepped_too) == pytest.approx(0.15, abs=0.01)
    assert discrepancy(stepped_too, START, ENDS)[1, 1] == pytest.approx(3.0, abs=0.1)
    assert velocity_lag(replace(late, velocity=0 * late.velocity)) == 0


def test_gaps_and_ends_are_unknown():
    lacking = track(rate=10.0, keep=lambda t: (t < 62) | (t > 66))
    found = discrepancy(lacking, np.array([10.0, 60.0, 100.0, -1.0]), np.array([[30.0], [80.0], [130.0], [5.0]]))
    assert np.isnan(found[:, 0]).tolist() == [False, True, True, True]


def test_without_a_velocity_of_its_own_there_is_nothing_to_contradict():
    silent = replace(track(off=lambda t: 3.0 * (t > 75)), velocity_stated=False)
    assert (discrepancy(silent, START, ENDS) == 0).all()


@pytest.fixture(scope="module")
def town():
    drive = made.town(240, 3)
    return SimpleNamespace(log=drive.log, model=drive.model, prepared=prepare(drive.log, drive.model))


@pytest.fixture(scope="module")
def outages(town):
    first = town.prepared.start_time + 40
    return [Outage(first + 10.0 * k, 20.0) for k in range(9)]


def stepped(town, steps):
    """Return the drive with a truth that has steps north, m, at some times, s from the log's start."""
    truth = town.log.references[0]
    time = (truth.time - town.log.zero) / SECOND
    off = sum(size * (time > at) for at, size in steps)
    position = truth.position.copy()
    position[:, 0] += off / ned_scale(position[:, 0], position[:, 2])[:, 0]
    return prepare(replace(town.log, references=(replace(truth, position=position),)), town.model)


def test_a_quarter_of_its_square_is_added(town, outages):
    plain = replay(town.prepared, [town.model], outages)
    at = outages[4].start + 5
    odd = replay(stepped(town, [(at, 0.5)]), [town.model], outages)
    (before,), (after,) = (list(r.runs.values()) for r in (plain, odd))
    before, after = before.outages[20.0].scores, after.outages[20.0].scores
    wider = after.covariance - before.covariance
    hit = np.array([o.start < at < o.start + 20 for o in outages])
    assert wider[hit, -1, 0, 0] == pytest.approx(0.25 / 4, rel=0.05)
    assert wider[hit, -1, 1, 1] == pytest.approx(0.25 / 4, rel=0.05)
    assert np.abs(wider[~hit]).max() < 1e-6
    assert odd.scored[20.0].all()


def test_outages_in_which_it_exceeds_the_drift_are_not_scored(town, outages):
    at = outages[4].start + 5
    found = replay(stepped(town, [(at, 300.0), (at + 1, -300.0)]), [town.model], outages)
    hit = np.array([o.start < at < o.start + 20 for o in outages])
    assert found.scored[20.0].tolist() == (~hit).tolist()
    assert "reference-contradicts-itself" in ids(found.notes)
    (note,) = (n for n in found.notes if getattr(n, "id", "") == "reference-contradicts-itself")
    assert note.startswith(f"{hit.sum()} outages of 20 s")
    assert "300.0 m" in note


def test_a_reference_that_does_so_nearly_everywhere_is_refused(town, outages):
    steps = [(t, 300.0) for t in np.arange(0, 240, 9.0)]
    broken = stepped(town, steps)
    found = replay(broken, [town.model], outages)
    assert found.reference.kind == "smoothed"
    assert "reference-refused" in ids(found.notes)
    with pytest.raises(MissingDataError, match=r"truth is refused as a reference.*in 9 of 9 outages.*--truth"):
        replay(broken, [town.model], outages, reference="truth")


def test_the_noise_is_never_tuned_on_a_refused_stretch(monkeypatch):
    drive = made.town(420, 3, seed=5, model=made.error_model(white=(1e-3, 1e-2), turn_on=(2e-4, 5e-3)))
    town = SimpleNamespace(log=drive.log, model=drive.model)
    used = []
    scored = tuning._scored  # noqa: SLF001 - what is fitted

    def remember(prepared, model, factors, outages, against):
        used.append([o.start for o in outages])
        return scored(prepared, model, factors, outages, against)

    monkeypatch.setattr(tuning, "_scored", remember)
    at = 250.0
    tune(stepped(town, [(at, 500.0)]), drive.model, "best")
    assert used
    assert not any(start < at < start + 30 for starts in used for start in starts)


def test_what_follows_from_the_fixes_must_agree_with_them(town):
    own = reference_track(town.log, run(town.model, town.prepared), "own")
    assert contradiction(own, town.prepared) is None
    fast = replace(own, velocity=own.velocity * 10)
    assert "km/h" in contradiction(fast, town.prepared)
    scale = ned_scale(own.position[:, 0], own.position[:, 2])
    far = replace(own, position=own.position + np.array([80.0, 0, 0]) / scale)
    assert "80 m from the fixes" in contradiction(far, town.prepared)


def test_truth_may_know_that_the_fixes_are_wrong(town, outages):
    truth = town.log.references[0]
    scale = ned_scale(truth.position[:, 0], truth.position[:, 2])
    far = replace(truth, position=truth.position + np.array([80.0, 0, 0]) / scale)
    prepared = prepare(replace(town.log, references=(far,)), town.model)
    found = replay(prepared, [town.model], outages)
    assert found.reference.kind == "truth"
    assert "reference-against-fixes" in ids(found.notes)


def test_a_smoothed_run_that_left_the_earth_is_refused(shared):
    from imuwb.readers import read
    from imuwb.replay import model_named

    log = read(shared / "tlog" / "pymavlink_flight.tlog")
    base = replace(made.town(120).model, settings=made.Settings(settling=30.0))
    prepared = prepare(log, base)
    model = model_named("full", base, interval=prepared.measurement.interval)
    track = reference_track(log, run(model, prepared, smooth=True), "smoothed")
    assert np.quantile(np.hypot(track.velocity[:, 0], track.velocity[:, 1]), 0.99) > 245 / 3.6
    assert "km/h" in contradiction(track, prepared)


def test_yardsticks_do_not_choose_by_the_single_drift():
    drifts = np.array([0.1, 10.0, 20.0, 30.0])
    filters = [made.scores(drifts), made.scores(drifts * 2)]
    # Although 0.1 m is less than 1 m, the median is 15 m.
    assert yardsticks(np.array([1.0, 14.9, 15.1, np.nan]), filters).tolist() == [True, True, False, True]
    assert yardsticks(np.array([1.0]), [made.scores([np.nan])]).all()


def test_scores_keep_the_discrepancy_in_parts():
    one = replace(made.scores([1.0, 2.0], seconds=3), discrepancy=np.arange(6.0).reshape(2, 3))
    assert one.of(np.array([1]), 2.0).discrepancy.tolist() == [[3, 4]]


@pytest.mark.parametrize("kind", ["truth", "own"])
def test_a_reference_of_another_place_is_refused_whatever_its_kind(town, kind):
    track = replace(reference_track(town.log, run(town.model, town.prepared), "own"), kind=kind)
    assert elsewhere(track, town.prepared) is None
    exchanged = replace(track, position=track.position[:, [1, 0, 2]])
    assert " km from the fixes" in elsewhere(exchanged, town.prepared)


def test_a_truth_of_another_place_is_not_measured_against(town, outages):
    truth = town.log.references[0]
    swapped = replace(truth, position=truth.position[:, [1, 0, 2]])
    prepared = prepare(replace(town.log, references=(swapped,)), town.model)
    with pytest.raises(MissingDataError, match="another place"):
        replay(prepared, [town.model], outages, reference="truth")
    found = replay(prepared, [town.model], outages)
    assert found.reference.kind == "smoothed"
    assert "reference-refused" in ids(found.notes)
