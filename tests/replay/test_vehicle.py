"""What a log says of itself: how the IMU sits, where fixes lack or are worse, and fixes made worse on purpose."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from imuwb.errors import MissingDataError
from imuwb.log import SECOND, GnssStream, ImuStream, Triad
from imuwb.navigation import Installation
from imuwb.replay import Degradation, degraded, estimate_mounting, own_outages, prepare, replay
from imuwb.replay.references.reference import reference_track

from . import made

MOUNTING = (175.0, -7.0, 110.0)


@pytest.fixture(scope="module")
def town():
    return made.town(420, 5)


def turned(log, angles):
    """Return a log whose IMU sits otherwise: what it measures is turned from the vehicle's axes into its own."""
    turn = Rotation.from_euler("ZYX", angles[::-1], degrees=True)
    imu = log.imus[0]
    triads = [Triad(t.time, turn.apply(np.array(t.value))) for t in (imu.angular_rate, imu.specific_force)]
    return replace(log, imus=(ImuStream(imu.name, *triads, imu.temperature, imu.origin),))


def with_gnss(log, **changes):
    return replace(log, gnss=(replace(log.gnss[0], **changes),))


def test_a_mounting_is_found(town):
    found = estimate_mounting(turned(town.log, MOUNTING), None, 0.95)
    left = Rotation.from_euler("ZYX", found.angles[::-1], degrees=True).inv() * Rotation.from_euler(
        "ZYX", MOUNTING[::-1], degrees=True
    )
    # level is as good as the places where the car stood, and its accelerometers
    assert np.degrees(left.magnitude()) < 1.5 + found.heading.upper - found.heading.value
    assert 0 < found.heading.upper - found.heading.value < 3


def test_a_mounting_that_is_found_gives_the_drift_of_an_imu_that_sits_straight(town):
    odd = turned(town.log, MOUNTING)
    model = replace(town.model, installation=Installation(mounting=estimate_mounting(odd, None, 0.95).angles))
    straight, other = prepare(town.log, town.model), prepare(odd, model)
    assert other.alignment.euler == pytest.approx(straight.alignment.euler, abs=np.radians(3))


def test_no_velocities_tell_no_mounting(town):
    with pytest.raises(MissingDataError, match="velocities .* --mounting"):
        estimate_mounting(with_gnss(town.log, velocity=None), None, 0.95)


def lacking(gnss, begin, end):
    """Return a receiver without fixes between two times, s."""
    time = (gnss.time - gnss.time[0]) / SECOND
    kept = (time <= begin) | (time >= end)
    parts = ("time", "position", "velocity", "position_sigma", "velocity_sigma", "fix_type")
    return replace(gnss, **{p: getattr(gnss, p)[kept] for p in parts})


def test_a_logs_own_outage_is_found_and_scored_against_the_truth(town):
    log = replace(town.log, gnss=(lacking(town.log.gnss[0], 200, 224),))
    prepared = prepare(log, town.model)
    (own,) = own_outages(prepared, town.model)
    assert own.start == pytest.approx(200, abs=0.02)
    assert own.duration == 24
    found = replay(prepared, [town.model], [own])
    assert found.scored[24.0].tolist() == [True]
    assert 0 < found.runs["known"].outages[24.0].scores.horizontal[0, -1] < 200


@pytest.mark.parametrize("how", ["sigma", "type"])
def test_fixes_that_are_worse_than_most_are_an_outage_too(town, how):
    gnss = town.log.gnss[0]
    rows = slice(250, 262)
    sigma, kind = np.array(gnss.position_sigma), np.full(len(gnss), 6)
    if how == "sigma":
        sigma[rows] *= 10
    else:
        kind[rows] = 5
    log = with_gnss(town.log, position_sigma=sigma, fix_type=kind)
    (own,) = own_outages(prepare(log, town.model), town.model)
    assert (own.start, own.duration) == (pytest.approx(249, abs=0.02), 13)


def test_a_log_without_outages_has_none(town):
    assert own_outages(prepare(town.log, town.model), town.model) == ()


def test_fixes_are_made_worse_as_asked():
    n = 3600
    time = np.arange(n, dtype=np.int64) * SECOND
    gnss = GnssStream("g", time, np.tile([0.8, 0.1, 100.0], (n, 1)))
    noisy = degraded(gnss, Degradation(noise=3.0, seed=1))
    north = (noisy.position[:, 0] - 0.8) * made.radii(0.8)[0]
    assert north.std() == pytest.approx(3.0, rel=0.05)
    assert (noisy.position[:, 2] - 100).std() == pytest.approx(3.0, rel=0.05)
    jumps = degraded(gnss, Degradation(jump=50.0, every=120.0, seed=2))
    meridian, transverse = made.radii(0.8)
    off = np.hypot((jumps.position[:, 0] - 0.8) * meridian, (jumps.position[:, 1] - 0.1) * transverse * np.cos(0.8))
    struck = off > 1
    assert off[struck] == pytest.approx(50.0, rel=0.05)
    assert 0.5 < struck.mean() / (5 / 120) < 1.5


def test_worse_fixes_do_not_make_the_reference_worse(town):
    worse = prepare(town.log, town.model, None, Degradation(noise=5.0))
    assert np.std(worse.gnss.position[:, 2] - town.log.gnss[0].position[:, 2]) == pytest.approx(5.0, rel=0.1)
    assert reference_track(town.log, None, "truth").sigma.max() == 0
