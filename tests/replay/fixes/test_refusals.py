"""Positions that the gate refuses: those that contradict themselves, and a filter that is too sure."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.notes import ids
from imuwb.replay import prepare, refusal_note, refusals, run
from imuwb.simulation import MotionNoise, Receiver

from .. import made  # noqa: TID252 - tests are no package that has a name


@pytest.fixture(scope="module")
def town():
    """Return a drive whose receiver claims 1 cm and scatters by half a metre."""
    return made.town(240, 3, receiver=Receiver(position_sigma=(0.5, 0.5, 1.0), velocity_sigma=(0.05, 0.05, 0.05)))


def found(town, **changes):
    gnss = town.log.gnss[0]
    log = made.with_gnss(town.log, position_sigma=np.full_like(gnss.position, 0.01), **changes)
    return run(town.model, prepare(log, town.model))


def test_positions_that_claim_a_centimetre_and_scatter_by_half_a_metre_are_named(town):
    solution = found(town)
    seen = refusals(solution)
    assert seen.contradictory
    assert seen.scatter == pytest.approx(0.5, rel=0.2)
    assert seen.claimed == pytest.approx(0.01)
    assert seen.count > 0.5 * seen.of
    note = refusal_note(solution)
    assert ids((note,)) == ("refused-positions",)
    assert "--gnss-floor 0.5,0" in note
    assert f" {seen.count} of {seen.of} positions" in note


def test_without_velocities_both_causes_are_named(town):
    solution = found(town, velocity=None, velocity_sigma=None)
    assert np.isnan(refusals(solution).scatter)
    assert "--gnss-floor M,0" in refusal_note(solution)


def test_a_filter_that_is_too_sure_is_named():
    drive = made.town(
        240, 3, receiver=Receiver(position_sigma=(0.02, 0.02, 0.03)), motion_noise=MotionNoise((5e-3, 0.3))
    )
    seen = refusals(run(drive.model, prepare(drive.log, drive.model)))
    assert seen is not None
    assert not seen.contradictory


def test_a_filter_that_refuses_little_has_no_note(town):
    assert refusal_note(run(town.model, prepare(town.log, town.model))) is None
    few = np.array(town.log.gnss[0].position)
    few[[100, 140], 0] += 1e-4
    spiked = replace(town.log, gnss=(replace(town.log.gnss[0], position=few),))
    assert refusal_note(run(town.model, prepare(spiked, town.model))) is None
