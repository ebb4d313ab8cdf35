"""Errors and NEES of a made drift against plain numpy; what the vehicle did, on made tracks."""

from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.replay import motion_classes, scores

from .. import made  # noqa: TID252 - tests are no package that has a name

PLACE = np.array([52.0 * made.DEGREE, 13.0 * made.DEGREE, 80.0])


def quaternion(heading):
    """Return (w, x, y, z) of a turn about down."""
    return np.stack([np.cos(heading / 2), 0 * heading, 0 * heading, np.sin(heading / 2)], axis=-1)


def track(velocity, seconds):
    """Return a reference that starts at a place with a velocity at each second."""
    velocity = np.asarray(velocity, float)
    meridian, transverse = made.radii(PLACE[0])
    gone = np.concatenate([np.zeros((1, 3)), np.cumsum((velocity[1:] + velocity[:-1]) / 2, axis=0)])
    position = PLACE + gone * [1 / (meridian + 80), 1 / ((transverse + 80) * np.cos(PLACE[0])), -1]
    return made.track(position, velocity, seconds)


def straight(speed, seconds, course=0.0):
    return np.tile([speed * np.cos(course), speed * np.sin(course), 0.0], (seconds + 1, 1))


def made_drift(seed, count=6, length=10):
    rng = np.random.default_rng(seed)
    against = track(straight(15.0, 60, 0.7), 60)
    against = made.track(against.position, against.velocity, 60, np.full(61, 3.1), [0.3, 0.4, 0.5])
    start = np.arange(count) * 5.0
    time = start[:, None] + np.arange(1, length + 1) + 0.01
    position, velocity, _, _ = against.at(time)
    meridian, transverse = made.radii(position[..., 0])
    off = rng.standard_normal((count, length, 3)) * 5
    scale = np.stack(
        [meridian + position[..., 2], (transverse + position[..., 2]) * np.cos(position[..., 0]), 1 + 0 * meridian], -1
    )
    slip, turn = rng.standard_normal((count, length, 3)), rng.uniform(-0.2, 0.2, (count, length))
    state = np.concatenate([position + off / scale, velocity + slip, quaternion(3.1 + turn)], axis=-1)
    root = rng.standard_normal((count, length, 9, 9))
    covariance = root @ np.swapaxes(root, -1, -2) + np.eye(9)
    return SimpleNamespace(
        against=against, drift=made.drift_of(start, time, state, covariance), off=off, slip=slip, turn=turn
    )


@pytest.fixture(scope="module")
def one():
    return made_drift(1)


def test_errors_are_estimate_less_reference(one):
    found = scores(one.drift, one.against)
    assert found.north_east == pytest.approx(one.off[..., :2], abs=1e-6)
    assert found.vertical == pytest.approx(one.off[..., 2], abs=1e-6)
    assert found.horizontal == pytest.approx(np.linalg.norm(one.off[..., :2], axis=-1), abs=1e-6)
    assert found.velocity == pytest.approx(np.linalg.norm(one.slip[..., :2], axis=-1), abs=1e-9)
    assert found.elapsed.tolist() == list(range(1, 11))
    assert np.array_equal(found.start, one.drift.start)


def test_heading_errors_go_round(one):
    found = scores(one.drift, one.against)
    assert found.heading == pytest.approx(one.turn, abs=1e-9)  # 3.1 + 0.2 rad is past half a turn
    assert (3.1 + one.turn > np.pi).any()


def test_nees_in_plain_numpy(one):
    found = scores(one.drift, one.against)
    for i in range(6):
        for k in range(10):
            total = one.drift.covariance[i, k, :2, :2] + np.diag([0.3**2, 0.4**2])
            e = one.off[i, k, :2]
            assert found.nees[i, k] == pytest.approx(e @ np.linalg.solve(total, e), rel=1e-5)
            assert found.sigma[i, k] == pytest.approx(np.sqrt(np.trace(total)))


def test_distance_is_the_references(one):
    found = scores(one.drift, one.against)
    assert found.distance[:, -1] == pytest.approx(15.0 * 10.01, rel=1e-6)
    assert (np.diff(found.distance, axis=1) > 0).all()


def test_outages_that_failed_are_nan(one):
    d = one.drift
    broken = made.drift_of(d.start, d.time, d.state, d.covariance)
    broken.sound[2] = False
    found = scores(broken, one.against)
    assert np.isnan(found.horizontal).all(axis=1).tolist() == [False, False, True, False, False, False]


def test_behind_the_reference_is_nan(one):
    d = one.drift
    found = scores(made.drift_of(d.start, d.time + 29.5, d.state, d.covariance), one.against)
    assert np.isnan(found.horizontal[:-1]).sum() == 0
    assert np.isnan(found.horizontal[-1]).sum() == 5  # 60 s is where it ends; 54.51 + 5.5
    assert np.isnan(found.nees[-1]).sum() == 5


def test_some_outages_up_to_a_duration(one):
    found = scores(one.drift, one.against)
    few = found.of(np.array([4, 1]), 7.0)
    assert few.horizontal == pytest.approx(found.horizontal[[4, 1]][:, :7])
    assert few.start.tolist() == [20.0, 5.0]
    assert few.nees.shape == few.sigma.shape == few.distance.shape == (2, 7)


TRACKS = {
    "straight": straight(15.0, 40),
    "fast": straight(20.0, 40),
    "stop": np.concatenate([straight(15.0, 25), np.zeros((15, 3))]),
    "turn": np.stack([10 * np.cos(np.arange(41) * 0.04), 10 * np.sin(np.arange(41) * 0.04), np.zeros(41)], axis=1),
}


def classified(velocity, begin=5.0, duration=30):
    against = track(velocity, len(velocity) - 1)
    time = begin + np.arange(1.0, duration + 1)[None]
    drift = made.drift_of([begin], time, np.zeros((1, duration, 10)), np.zeros((1, duration, 9, 9)))
    run = SimpleNamespace(outages={float(duration): SimpleNamespace(drift=drift)})
    return str(motion_classes(SimpleNamespace(reference=against, runs={"a": run}), float(duration))[0])


@pytest.mark.parametrize("kind", list(TRACKS))
def test_motion(kind):
    assert classified(TRACKS[kind]) == kind


@pytest.mark.parametrize("course", [0.0, np.pi - 0.01, -np.pi / 2])
def test_straight_in_any_direction(course):
    wave = 0.05 * np.sin(np.arange(41))  # a lane is not straight
    velocity = np.stack([15 * np.cos(course + wave), 15 * np.sin(course + wave), 0 * wave], axis=1)
    assert classified(velocity) == "straight"


@pytest.mark.parametrize(("degrees", "kind"), [(40, "straight"), (50, "turn"), (-50, "turn")])
def test_a_turn_is_of_45_degrees(degrees, kind):
    course = np.radians(degrees) * np.clip((np.arange(41) - 10) / 20, 0, 1)
    velocity = np.stack([10 * np.cos(course), 10 * np.sin(course), 0 * course], axis=1)
    assert classified(velocity) == kind


def test_a_turn_there_and_back_is_one():
    course = np.radians(50) * np.sin(np.pi * np.clip((np.arange(41) - 8) / 24, 0, 1))
    assert classified(np.stack([10 * np.cos(course), 10 * np.sin(course), 0 * course], axis=1)) == "turn"


def test_who_stands_does_not_turn():
    rng = np.random.default_rng(0)
    velocity = 0.1 * rng.standard_normal((41, 3))  # a receiver's noise has any course
    assert classified(velocity) == "stop"
    velocity = straight(12.0, 40)
    velocity[10:16] = 0.1 * rng.standard_normal((6, 3))
    assert classified(velocity) == "straight"  # less than a third of it


def test_speed_of_70_km_h_is_fast():
    assert classified(straight(69 / 3.6, 40)) == "straight"
    assert classified(straight(71 / 3.6, 40)) == "fast"


@pytest.mark.parametrize(("speed", "kind"), [(0.9, "stop"), (1.1, "straight")])
def test_below_a_metre_a_second_it_stands(speed, kind):
    assert classified(straight(speed, 40)) == kind


@pytest.mark.parametrize(("seconds", "kind"), [(9, "straight"), (10, "stop")])
def test_a_stop_takes_more_than_three_tenths(seconds, kind):
    velocity = straight(15.0, 40)
    velocity[10 : 10 + seconds] = 0.0  # of 31 points
    assert classified(velocity) == kind
