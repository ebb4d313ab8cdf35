"""Trajectories of other files as references: their clock, their point, and the place of their frame."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.geodesy import ned_scale, rotation_of_euler
from imuwb.geodesy.local_track import LocalTrack
from imuwb.geodesy.tangent_plane import ned_of, turn_between
from imuwb.log import SECOND, GnssStream, Log, Provenance, Reference
from imuwb.notes import ids
from imuwb.replay import Placing, external_reference, reference_track
from imuwb.replay.references.external import AXES, BODIES
from imuwb.replay.references.reference import given_track
from imuwb.simulation import drive, mixed_route

from .. import made  # noqa: TID252 - tests are no package that has a name
from .test_reference import solution


@pytest.fixture(scope="module")
def log():
    return drive(made.error_model(), mixed_route(240, 3), 1, rate=20.0)


def local(log, axes="enu", body="forward-left-up", rows=slice(None)):
    """Return the truth of a log in a local frame, with another tool's axes."""
    truth = log.references[0]
    first = truth.position[0]
    turn = AXES[axes].T
    ned = ned_of(truth.position, first)
    level = np.swapaxes(turn_between(truth.position, first), 1, 2)
    rotation = turn @ level @ rotation_of_euler(truth.attitude) @ BODIES[body].T
    return LocalTrack("a.tum", truth.time[rows], (ned @ turn.T)[rows], rotation[rows])


def placed(log, found, placing=Placing()):  # noqa: B008 - frozen
    return external_reference(found, log, log.gnss[0], placing, "truth")


@pytest.mark.parametrize(("axes", "body"), [(a, b) for a in AXES for b in BODIES])
def test_any_frame_and_any_body_axes_find_their_place(log, axes, body):
    truth = log.references[0]
    found, notes = placed(log, local(log, axes, body))
    assert ids(notes) == ("placed",)
    off = (found.position - truth.position) * ned_scale(truth.position[:, 0], truth.position[:, 2])
    # The fit takes over the mean error of the fixes, 1.5 m north and east, 3 m down, over the root of their number.
    assert np.abs(off).max() < 2.5
    turned = found.attitude[:, 2] - truth.attitude[:, 2]
    assert np.abs(np.angle(np.exp(1j * turned))).max() < np.radians(1.0)


def test_a_stated_origin_is_not_fitted(log):
    truth = log.references[0]
    latitude, longitude, height = truth.position[0]
    origin = (np.degrees(latitude), np.degrees(longitude), height)
    found, _ = placed(log, local(log, "ned", "forward-right-down"), Placing(origin=origin, axes="ned"))
    off = (found.position - truth.position) * ned_scale(truth.position[:, 0], truth.position[:, 2])
    assert np.abs(off[:, :2]).max() < 1e-3
    assert found.attitude == pytest.approx(truth.attitude, abs=1e-6)


def test_body_axes_that_fit_nothing_are_left_out(log):
    track = local(log)
    on_its_side = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    found, notes = placed(log, replace(track, rotation=track.rotation @ on_its_side))
    assert found.attitude is None
    assert "not used" in notes[0]


def test_a_straight_track_needs_its_place(log):
    track = local(log)
    time = (track.time - track.time[0]) / SECOND
    line = np.outer(10.0 * time, [1, 0, 0])
    scale = ned_scale(log.gnss[0].position[:, 0], log.gnss[0].position[:, 2])
    along = np.outer(10.0 * (log.gnss[0].time - track.time[0]) / SECOND, [1, 0, 0])
    straight = replace(log.gnss[0], position=log.gnss[0].position[0] + along / scale)
    with pytest.raises(UsageError, match=r"too straight .* --truth-origin"):
        external_reference(replace(track, position=line), log, straight, Placing(), "truth")


def test_another_drives_track_is_refused(log):
    track = local(log)
    with pytest.raises(UsageError, match=r"does not fit the fixes.*--truth-delay"):
        placed(log, replace(track, position=track.position[::-1] * [1, 2, 1]))


def test_a_delay_moves_the_stamps(log):
    truth = log.references[0]
    late = replace(truth, time=truth.time + SECOND // 5)
    found, _ = placed(log, late, Placing(delay=0.2))
    assert found.time.tolist() == truth.time.tolist()


def test_clocks_that_do_not_meet_are_said_with_the_option_that_moves_them(log):
    truth = log.references[0]
    first = int(log.imus[0].angular_rate.time[0])
    other = replace(truth, time=truth.time - truth.time[0])
    with pytest.raises(MissingDataError, match=rf"--truth-delay {-first / SECOND:.3f}"):
        placed(log, other)
    assert placed(log, other, Placing(delay=-first / SECOND))[0].time[0] == pytest.approx(first, abs=1e3)


def test_a_log_gives_its_reference_or_its_receiver(log):
    found, notes = placed(log, log)
    assert found.name == "truth"
    assert ids(notes) == ("trajectory-chosen",)
    bare = replace(log, references=())
    found, notes = placed(log, bare)
    assert (found.name, notes) == (log.gnss[0].name, ())
    assert found.position_sigma.shape == found.position.shape
    with pytest.raises(MissingDataError, match="neither a reference nor positions"):
        placed(log, replace(bare, gnss=()))


def test_a_solution_is_rather_an_odometry_and_a_truth_a_receiver(log):
    both = replace(log, references=(), poses=(local(log),))
    assert placed(log, both)[0].name == log.gnss[0].name
    found, notes = external_reference(both, log, log.gnss[0], Placing(), "solution")
    assert found.name == "a.tum"
    assert ids(notes) == ("trajectory-chosen", "placed")


def test_rows_of_a_receiver_that_are_no_position_are_left_out(log):
    g = log.gnss[0]
    flat = np.full(len(g), 6)
    flat[:10] = 1
    velocity = np.array(g.velocity)
    velocity[20] = np.nan
    found, _ = placed(log, replace(log, references=(), gnss=(replace(g, fix_type=flat, velocity=velocity),)))
    assert len(found) == len(g) - 11


def test_velocity_follows_from_positions_where_none_is_stated(log):
    truth = log.references[0]
    own, derived = given_track(log, truth), given_track(log, replace(truth, velocity=None))
    assert (own.velocity_stated, derived.velocity_stated) == (True, False)
    assert np.abs(own.velocity - derived.velocity)[1:-1].max() < 0.1


def test_sigmas_are_those_of_the_file(log):
    truth = log.references[0]
    sigma = np.tile([1.0, 2.0, np.nan], (len(truth), 1))
    assert given_track(log, replace(truth, position_sigma=sigma)).sigma[5].tolist() == [1, 2, 0]
    assert given_track(log, truth).sigma.max() == 0


def test_the_point_of_the_reference_is_moved_to_the_imu():
    run = solution()
    arm = (1.0, 2.0, -3.0)
    scale = ned_scale(run.position[:, 0], run.position[:, 2])
    point = run.position + rotation_of_euler(run.euler) @ np.array(arm) / scale
    stamps = np.rint(run.time * SECOND).astype(np.int64)
    for attitude in (run.euler, None):
        reference = Reference("a", stamps, point, run.velocity, attitude, lever_arm=arm)
        log = Log(Provenance("made", "made", "", 0), references=(reference,), zero=0)
        track = reference_track(log, run, "truth")
        assert np.abs((track.position - run.position) * scale).max() < 1e-3


def test_a_filters_estimate_is_no_truth(log):
    truth = log.references[0]
    ekf = replace(truth, name="POS", origin=replace(truth.origin, frame="NED, estimated by the vehicle's own filter"))
    both = replace(log, references=(ekf, truth))
    run = solution(seconds=10)
    assert reference_track(both, run).kind == "truth"
    for wanted in ("ekf", "POS"):
        found = reference_track(both, run, wanted)
        assert found.kind == "estimate"
        assert found.name.startswith("POS, an estimate")
    assert reference_track(both, run, "truth").name == "truth"
    with pytest.raises(ValueError, match="no estimate of the vehicle"):
        reference_track(log, run, "ekf")
    with pytest.raises(UsageError, match="--reference x: .*fixed, smoothed, own, ekf"):
        reference_track(log, run, "x")


def test_a_receiver_without_sigmas_or_velocity_is_a_reference(log):
    g = log.gnss[0]
    bare = GnssStream(g.name, g.time, g.position)
    found, _ = placed(log, replace(log, references=(), gnss=(bare,)))
    assert found.velocity is None
    assert given_track(log, found).velocity_stated is False
