"""References against closed forms: truth, RTK-fixed points with a lever arm, a filter's own run, and what is missing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.log import SECOND, GnssStream, Log, Origin, Provenance, Reference
from imuwb.navigation.filter_model import Installation
from imuwb.replay import own_track, reference_track
from imuwb.replay.references.reference import reference_names

from .. import made  # noqa: TID252 - tests are no package that has a name

START = np.array([45.07 * made.DEGREE, 7.69 * made.DEGREE, 240.0])
ZERO = 1_700_000_000 * SECOND


def circle(t, radius=80.0, rate=0.1):
    """Return a point on a circle: position, velocity NED, heading."""
    meridian, transverse = made.radii(START[0])
    angle = rate * t
    north, east, up = radius * np.sin(angle), radius * (1 - np.cos(angle)), 0.3 * t
    position = np.stack([
        START[0] + north / (meridian + 240), START[1] + east / ((transverse + 240) * np.cos(START[0])), START[2] + up,
    ], axis=-1)  # fmt: skip
    velocity = np.stack([radius * rate * np.cos(angle), radius * rate * np.sin(angle), np.full_like(t, -0.3)], axis=-1)
    return position, velocity, angle


def metres(one, other):
    meridian, transverse = made.radii(START[0])
    off = one - other
    return off * [meridian + 240, (transverse + 240) * np.cos(START[0]), 1]


def log_of(rate=10.0, seconds=60.0, keep=None, fix=None, **gnss):
    t = np.arange(0, seconds, 1 / rate)
    t = t if keep is None else t[keep(t)]
    position, velocity, angle = circle(t)
    stamps = ZERO + np.rint(t * SECOND).astype(np.int64)
    attitude = np.stack([0 * angle, 0 * angle, np.angle(np.exp(1j * angle))], axis=1)
    references = () if fix else (Reference("truth", stamps, position, velocity, attitude, Origin()),)
    receivers = ()
    if fix:
        fixed = np.full(t.size, fix) if isinstance(fix, int) else fix(t)
        receivers = (GnssStream("/rtk", stamps, position, velocity, fix_type=fixed, **gnss),)
    return Log(Provenance("made", "made", "sha256:0", 0), gnss=receivers, references=references, zero=ZERO)


def solution(arm=(0.0, 0.0, 0.0), delay=0.0, seconds=60.0, roll=0.0):
    """Return what a filter's run says: once a second, along the circle."""
    t = np.arange(0.0, seconds)
    position, velocity, angle = circle(t)
    euler = np.stack([np.full(t.size, roll), 0 * t, np.angle(np.exp(1j * angle))], axis=1)
    model = SimpleNamespace(name="full", installation=Installation(lever_arm=arm, gnss_delay=delay))
    sigma = np.tile(np.arange(1.0, 16.0), (t.size, 1))
    return SimpleNamespace(model=model, time=t, position=position, velocity=velocity, euler=euler, sigma=sigma)


def test_truth_between_its_points():
    against = reference_track(log_of(rate=2.0), solution())
    assert (against.kind, against.name) == ("truth", "truth")
    t = np.linspace(0.1, 59.3, 700).reshape(7, 100)
    position, velocity, heading, sigma = against.at(t)
    want, speed, angle = circle(t)
    # A cubic between points h apart is off by h⁴/384 of the fourth derivative; here 80 m 0.1⁴ 0.5⁴/384.
    assert np.abs(metres(position, want)).max() < 1e-5
    assert np.abs(velocity - speed).max() < 8 * (0.1 * 0.5) ** 2 / 8 * 1.1  # straight lines
    assert np.abs(heading - angle).max() < 1e-9
    assert np.array_equal(sigma, np.zeros((7, 100, 3)))


def test_heading_of_truth_goes_on_through_half_a_turn():
    against = reference_track(log_of(), solution())
    t = np.pi / 0.1 + np.linspace(-0.05, 0.05, 11)
    assert against.at(t)[2] == pytest.approx(0.1 * t, abs=1e-9)


def test_a_gap_is_nan_and_a_short_one_is_not():
    long = reference_track(log_of(keep=lambda t: (t < 20) | (t > 24)), solution()).at(
        np.array([19.8, 20.5, 22.0, 23.9, 24.2])
    )[0]
    assert np.isnan(long).all(axis=1).tolist() == [False, True, True, True, False]
    short = reference_track(log_of(keep=lambda t: (t < 20) | (t > 22)), solution()).at(np.array([20.5, 21.0, 21.9]))[0]
    assert np.abs(metres(short, circle(np.array([20.5, 21.0, 21.9]))[0])).max() < 0.01


def test_before_and_behind_is_nan():
    position = reference_track(log_of(), solution()).at(np.array([-0.1, 0.0, 59.9, 60.1]))[0]
    assert np.isnan(position).any(axis=1).tolist() == [True, False, False, True]


@pytest.mark.parametrize(("roll", "arm"), [(0.0, (1.5, -0.4, -1.2)), (np.pi / 2, (0.5, 2.0, 0.3))])
def test_fixed_points_are_moved_to_the_imu(roll, arm):
    """The antenna's circle less the arm, turned by heading and roll as a hand would."""
    against = reference_track(log_of(fix=6), solution(arm, roll=roll))
    assert (against.kind, against.heading) == ("fixed", None)
    assert against.name.endswith(" of /rtk")
    position, _, heading, sigma = against.at(against.time)
    antenna, _, angle = circle(against.time)
    forward, right, down = arm if roll == 0 else (arm[0], -arm[2], arm[1])
    cosine, sine = np.cos(angle), np.sin(angle)
    want = np.stack(
        [cosine * forward - sine * right, sine * forward + cosine * right, np.full(angle.size, -down)], axis=1
    )
    assert np.abs(metres(antenna, position) - want).max() < 1e-3  # heading is a straight line between fixes
    assert np.isnan(heading).all()
    assert (sigma == 0.02).all()


def test_fixed_points_are_as_late_as_fixes():
    against = reference_track(log_of(fix=6), solution(delay=0.3))
    at = against.at(np.array([10.0]))[0]
    assert np.abs(metres(at, circle(np.array([10.3]))[0])).max() < 1e-4


def test_floating_points_are_no_reference():
    log = log_of(fix=lambda t: np.where((t > 20) & (t < 26), 5, 6))
    position = reference_track(log, solution()).at(np.array([19.0, 23.0, 27.0]))[0]
    assert np.isnan(position).any(axis=1).tolist() == [False, True, False]


def test_fixed_points_without_a_velocity_down_take_it_from_the_heights():
    log = log_of(fix=6)
    flat = np.where([True, True, False], log.gnss[0].velocity, np.nan)
    log = replace(log, gnss=(replace(log.gnss[0], velocity=flat),))
    against = reference_track(log, solution())
    t = np.array([10.03, 30.55])
    assert against.kind == "fixed"
    assert np.abs(metres(against.at(t)[0], circle(t)[0])).max() < 1e-3
    assert against.velocity[:, 2] == pytest.approx(-0.3, abs=1e-6)


def test_fixed_points_bring_their_sigma():
    log = log_of(fix=6)
    known = np.tile([0.01, np.nan, 0.03], (len(log.gnss[0]), 1))
    sigma = reference_track(log_of(fix=6, position_sigma=known), solution()).at(np.array([5.0]))[3]
    assert sigma[0] == pytest.approx([0.01, 0.02, 0.03])


def test_own_run():
    mine = solution()
    against = own_track(mine)
    assert (against.kind, against.name) == ("own", "full without outage")
    position, velocity, heading, sigma = against.at(mine.time)
    assert position == pytest.approx(mine.position, rel=1e-12)
    assert velocity == pytest.approx(mine.velocity)
    assert heading == pytest.approx(0.1 * mine.time)
    assert (sigma == [1, 2, 3]).all()


def test_the_best_there_is():
    truth, fixed, plain = log_of(), log_of(fix=6), log_of(fix=5)
    assert [reference_track(x, solution()).kind for x in (truth, fixed)] == ["truth", "fixed"]
    assert [reference_names(x)[0] for x in (truth, fixed, plain)] == ["truth", "fixed", "smoothed"]
    assert [reference_names(truth, w) for w in ("smoothed", "POS")] == [("smoothed",), ("POS",)]
    both = replace(truth, gnss=fixed.gnss)
    assert reference_names(both) == ("truth", "fixed", "smoothed")
    assert [reference_track(both, solution(), w).kind for w in ("best", "truth", "fixed", "own")] == [
        "truth",
        "truth",
        "fixed",
        "own",
    ]
    mixed = log_of(fix=lambda t: np.where(t < 28, 6, 5))  # fewer than half
    assert reference_names(mixed) == ("smoothed",)


def test_a_reference_needs_no_velocities():
    log = log_of()
    bare = replace(log, references=(replace(log.references[0], velocity=None),))
    assert reference_names(bare)[0] == "truth"
    assert not reference_track(bare, solution(), "truth").velocity_stated
    with pytest.raises(ValueError, match="no reference trajectory; name a file with --truth"):
        reference_track(replace(log, references=()), solution(), "truth")


@pytest.mark.parametrize("log", [log_of(), log_of(fix=5), log_of(fix=lambda t: np.where(t < 28, 6, 5))])
def test_no_fixed_points(log):
    with pytest.raises(ValueError, match="no receiver of the log has RTK-fixed"):
        reference_track(log, solution(), "fixed")


def test_of_several_points_of_one_time_the_last_counts():
    """An IMU slower than its receiver: two fixes correct one sample, and the second result is the better one."""
    run = solution()
    twice = np.sort(np.concatenate([np.arange(60), [10, 30]]))
    wrong = run.position[twice].copy()
    wrong[[10, 31]] += 1e-5  # the first of each two
    doubled = SimpleNamespace(
        model=run.model, time=run.time[twice], position=wrong, velocity=run.velocity[twice], euler=run.euler[twice],
        sigma=run.sigma[twice],
    )  # fmt: skip
    t = np.array([9.5, 10.0, 30.0, 30.25])
    np.testing.assert_array_equal(own_track(doubled).at(t)[0], own_track(run).at(t)[0])


@pytest.mark.parametrize("count", [0, 1])
def test_a_reference_needs_two_points(count):
    log = log_of(fix=6)
    velocity = np.full_like(log.gnss[0].velocity, np.nan)
    velocity[100 : 100 + count] = 1.0
    log = replace(log, gnss=(replace(log.gnss[0], velocity=velocity),))
    with pytest.raises(ValueError, match=rf"{count} points .* --reference"):
        reference_track(log, solution(), "fixed")
