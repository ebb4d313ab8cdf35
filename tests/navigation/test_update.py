"""One event taken in, against a joint Kalman update with Jacobians by numerical differences."""

from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.navigation.covariance import flat, square
from imuwb.navigation.filter_model import FilterModel
from imuwb.navigation.strapdown import RATE, navigation_state
from imuwb.navigation.tables import FIX, SPEED, STILL, STRAIGHT, Events, Rules, Samples
from imuwb.navigation.update import feed_back, update
from imuwb.navigation.workspace import workspace

from .. import ecef  # noqa: TID252 - tests are no package that has a name
from . import drives

LEVER = np.array([1.2, -0.7, -1.5])
POINT = np.array([-1.6, 0.4, 0.9])
PLACE = np.array([0.78, 0.13, 300.0])
SPEEDS = np.array([12.0, -7.0, 0.4])
EULER = np.array([0.03, -0.05, -0.55])
TURNING = np.array([0.05, -0.1, 0.6])  # rad/s, of the true body; the earth's is part of it
SCALES = (1e-3, 2e-3)


@pytest.fixture(scope="module")
def filtered():
    """Return a filter of all orders with scale factors, in a state of any covariance."""
    model = FilterModel("mixed", drives.mixed().error_model, scale_factor=SCALES)
    tables, spread = model.tables(1 / drives.HZ)
    n, rng = int(tables.first[6]), np.random.default_rng(4)
    loose = rng.standard_normal((n, 3 * n))
    nav = [2, 2, 3, 0.2, 0.2, 0.3, 0.01, 0.01, 0.02]
    sigma = np.concatenate([nav, np.sqrt(np.diag(spread) + 1e-6)])
    state = navigation_state(PLACE, SPEEDS, EULER)
    state[RATE : RATE + 3] = TURNING
    covariance = loose @ loose.T / (3 * n) * np.outer(sigma, sigma)
    return SimpleNamespace(state=state, axes=rng.standard_normal(n - 9) * 1e-4, P=covariance, tables=tables, n=n)


def weights(tables, rate):
    """Return (3, K) what each gyro state adds to its axis's error."""
    found = np.zeros((3, tables.step.shape[1]))
    for axis in range(3):
        part = slice(tables.first[axis] - 9, tables.first[axis + 1] - 9)
        found[axis, part] = np.where(tables.scale[part], rate[axis], tables.step[0, part])
    return found


def residual(kind, state, rate, value, late=0.0):
    """Return estimate less measurement of a state, by the earth's Cartesian axes."""
    turn, v = drives.rotation(state[6:10]), state[3:6]
    body = turn.T @ v
    of_point = body + np.cross(rate, POINT)
    if kind == SPEED:
        return np.array([of_point[0] - value[0]])
    if kind == STRAIGHT:
        return of_point[1:]
    if kind == STILL:
        return v.copy()
    swing = turn @ np.cross(rate, LEVER)
    axes = ecef.local_axes(*value[:2])
    apart = axes.T @ (ecef.cartesian(state[:3]) - ecef.cartesian(value[:3])) + turn @ LEVER
    return np.concatenate([apart + (v + swing) * late, v + swing - value[3:]])


def jacobian(f, kind, value):
    """Return how residuals depend on the errors: states made worse by feeding them back the wrong way."""
    steps = np.concatenate([[0.5] * 3, [1e-3] * 3, [1e-5] * 3, np.full(f.n - 9, 1e-5)])
    columns = []
    for i, size in enumerate(steps):
        ends = []
        for sign in (1, -1):
            state, axes, error = f.state.copy(), f.axes.copy(), np.zeros(f.n)
            error[i] = -sign * size
            feed_back(state, axes, error, f.n)
            rate = TURNING - weights(f.tables, TURNING) @ (axes - f.axes)
            ends.append(residual(kind, state, rate, value))
        columns.append((ends[0] - ends[1]) / (2 * size))
    return np.stack(columns, axis=1)


VALUES = {
    FIX: np.array([PLACE[0] + 4e-7, PLACE[1] - 3e-7, 303.0, 12.3, -7.9, 0.2]), SPEED: np.array([13.5, 0, 0, 0, 0, 0]),
    STRAIGHT: np.zeros(6), STILL: np.zeros(6),
}  # fmt: skip
VARIANCES = {
    FIX: np.array([4, 5, 9, 0.01, 0.02, 0.03]), SPEED: np.array([0.04, 0, 0, 0, 0, 0]),
    STRAIGHT: np.array([0.01, 0.04, 0, 0, 0, 0]), STILL: np.array([1e-4, 2e-4, 3e-4, 0, 0, 0]),
}  # fmt: skip


def taken(f, kind, value, variance, *, late=0.0, gate=1e9, patience=5, refused=None, trend=None, state=None):
    """Return all that ``update`` leaves."""
    state, axes, covariance = (f.state if state is None else state).copy(), f.axes.copy(), flat(f.P)
    samples = Samples(np.full(1, 0.01), np.zeros((1, 3)), np.zeros((1, 3)), np.zeros(1, np.int64))
    events = Events(np.zeros(1, np.int64), np.array([kind]), np.array([late]), value[None], variance[None])
    weighing = workspace(f.n).weighing
    if refused is not None:
        weighing = weighing._replace(refused=refused)
    if trend is not None:
        weighing = weighing._replace(trend=trend)
    update(state, axes, covariance, samples, events, 0, Rules(1, gate, patience, LEVER, POINT), f.tables, weighing)
    return SimpleNamespace(state=state, axes=axes, P=square(covariance, f.n), **weighing._asdict())


def kalman(P, h, r, variance):
    """Return error, covariance (Joseph's form), innovations' covariance and NIS of a joint update."""
    s = h @ P @ h.T + np.diag(variance)
    k = P @ h.T @ np.linalg.inv(s)
    rest = np.eye(len(P)) - k @ h
    return k @ r, rest @ P @ rest.T + k @ np.diag(variance) @ k.T, s, r @ np.linalg.solve(s, r)


@pytest.mark.parametrize("kind", [FIX, SPEED, STRAIGHT, STILL])
def test_an_event_is_a_joint_kalman_update(filtered, kind):
    f, value, variance = SimpleNamespace(**vars(filtered)), VALUES[kind], VARIANCES[kind]
    if kind == STILL:
        f.state = f.state * np.where(np.isin(np.arange(f.state.size), [3, 4, 5]), 0.01, 1)
    out = taken(f, kind, value, variance)
    measured = np.flatnonzero(variance)
    h, r = jacobian(f, kind, value), residual(kind, f.state, TURNING, value)
    size = np.abs(h).max(axis=1, keepdims=True)
    assert np.abs((out.rows[measured] - h) / size).max() < 2e-6
    h = out.rows[measured]
    error, P, s, nis = kalman(f.P, h, r, variance[measured])
    sigma = np.sqrt(np.diag(P))
    assert np.abs((out.P - P) / np.outer(sigma, sigma)).max() < 1e-9
    assert np.array_equal(out.P, out.P.T)
    # Estimated errors go out of the state: subtracted from navigation, added to the axes.
    assert (out.axes - f.axes) == pytest.approx(error[9:], rel=1e-5, abs=1e-5 * sigma[9:].max())
    moved = drives.errors(f.state, out.state)
    assert np.abs((moved - error[:9]) / sigma[:9]).max() < 3e-3  # an attitude's error squared
    assert np.nansum(out.nis) == pytest.approx(nis, rel=1e-5)
    first = measured[measured < 3]
    assert out.innovation[first] == pytest.approx(-r[: first.size], rel=1e-5, abs=1e-5)
    assert out.deviation[first] == pytest.approx(np.sqrt(np.diag(s)[: first.size]), rel=1e-9)
    assert out.used.tolist() == [True, kind == FIX]
    assert np.isnan(out.innovation[variance == 0]).all()


def test_a_fixs_velocity_is_judged_behind_its_position(filtered):
    f = filtered
    both = taken(f, FIX, VALUES[FIX], VARIANCES[FIX])
    r = residual(FIX, f.state, TURNING, VALUES[FIX])
    error, P, _, alone = kalman(f.P, both.rows[:3], r[:3], VARIANCES[FIX][:3])
    assert both.nis[0] == pytest.approx(alone, rel=1e-5)
    after = r[3:] - both.rows[3:] @ error
    assert both.innovation[3:] == pytest.approx(-after, rel=1e-5)
    _, _, s, nis = kalman(P, both.rows[3:], after, VARIANCES[FIX][3:])
    assert both.nis[1] == pytest.approx(nis, rel=1e-5)
    assert both.deviation[3:] == pytest.approx(np.sqrt(np.diag(s)), rel=1e-9)


@pytest.mark.parametrize("late", [-0.005, 0.004])
def test_a_late_fix_is_where_the_antenna_was_to_be(filtered, late):
    out = taken(filtered, FIX, VALUES[FIX], VARIANCES[FIX], late=late)
    expected = residual(FIX, filtered.state, TURNING, VALUES[FIX], late)
    assert out.innovation[:3] == pytest.approx(-expected[:3], abs=1e-5)


def test_a_component_without_sigma_says_nothing(filtered):
    variance = VARIANCES[FIX].copy()
    variance[[2, 5]] = 0
    out = taken(filtered, FIX, VALUES[FIX], variance)
    other = taken(filtered, FIX, VALUES[FIX] + [0, 0, 500, 0, 0, 99], variance)
    assert np.array_equal(out.P, other.P)
    r = residual(FIX, filtered.state, TURNING, VALUES[FIX])
    _, P, _, nis = kalman(filtered.P, out.rows[[0, 1, 3, 4]], r[[0, 1, 3, 4]], variance[[0, 1, 3, 4]])
    assert np.abs(out.P - P).max() / np.abs(P).max() < 1e-9
    assert out.nis.sum() == pytest.approx(nis, rel=1e-4)


# Gate and recovery


def test_a_gate_leaves_out_a_group_and_nothing_else(filtered):
    value = VALUES[FIX] + np.array([1e-4, 0, 0, 0, 0, 0])  # 640 m
    out = taken(filtered, FIX, value, VARIANCES[FIX], gate=40.0)
    assert out.used.tolist() == [False, True]
    assert out.refused.tolist() == [1, 0, 0, 0, 1]
    assert out.nis[0] > 40 > out.nis[1]
    r = residual(FIX, filtered.state, TURNING, value)
    _, P, _, nis = kalman(filtered.P, out.rows[3:], r[3:], VARIANCES[FIX][3:])
    assert np.abs(out.P - P).max() / np.abs(P).max() < 1e-9
    assert out.nis[1] == pytest.approx(nis, rel=1e-5)
    value[3] += 100
    out = taken(filtered, FIX, value, VARIANCES[FIX], gate=40.0)
    assert not out.used.any()
    assert np.array_equal(out.state, filtered.state)
    assert np.array_equal(out.P, filtered.P)


FAR = VALUES[FIX] + np.array([1e-4, 0, 0, 0, 0, 0])  #: 640 m
POSITION = np.where(np.arange(6) < 3, VARIANCES[FIX], 0)


def refused_often(f, values, refused, velocities=False):
    """Return what the last of some fixes leaves, each of which the filter meets in the same state; three may be refused."""
    variance, trend = VARIANCES[FIX] if velocities else POSITION, np.zeros((2, 5))
    for value in values:
        out = taken(f, FIX, value, variance, gate=40.0, patience=3, refused=refused, trend=trend)
    return out


def test_behind_patience_it_believes_and_widens_by_what_it_saw(filtered):
    refused = np.zeros(5, np.int64)
    out = refused_often(filtered, [FAR] * 3, refused)
    assert not out.used[0]
    assert refused.tolist() == [3, 0, 0, 0, 0]
    refused[:] = 0
    out = refused_often(filtered, [FAR] * 4, refused)
    assert out.used[0]
    assert refused.tolist() == [0, 0, 1, 0, 0]
    assert not out.trend.any()
    r = residual(FIX, filtered.state, TURNING, FAR)[:3]
    wide = filtered.P.copy()
    wide[range(3), range(3)] += r**2
    _, P, _, _ = kalman(wide, out.rows[:3], r, POSITION[:3])
    assert np.abs(np.diag(out.P) / np.diag(P) - 1).max() < 5e-3  # the ground falls off by 3 cm
    assert np.abs(residual(FIX, out.state, TURNING, FAR)[:3]).max() < 0.05 * np.abs(r).max()
    assert out.nis[0] > 40  # of what it was before


def test_behind_patience_again_all_states_are_widened(filtered):
    """A position that was believed and is refused again shows that more than the position is wrong."""
    refused = np.array([0, 0, 1, 0, 0])
    out = refused_often(filtered, [FAR] * 4, refused)
    assert out.used[0]
    assert refused.tolist() == [0, 0, 2, 0, 0]
    r = residual(FIX, filtered.state, TURNING, FAR)[:3]
    _, P, _, _ = kalman(filtered.P * 4, out.rows[:3], r, POSITION[:3])
    assert np.abs(np.diag(out.P) / np.diag(P) - 1).max() < 5e-3
    assert (np.diag(out.P)[9:] > np.diag(filtered.P)[9:]).any()  # of the axes too


def test_velocities_that_agree_leave_the_other_states(filtered):
    refused = np.array([0, 0, 1, 0, 1])
    out = refused_often(filtered, [FAR] * 4, refused, velocities=True)
    assert out.used.all()
    assert refused.tolist() == [0, 0, 2, 0, 1]
    assert (np.diag(out.P)[9:] <= np.diag(filtered.P)[9:] * (1 + 1e-9)).all()


def test_fixes_that_scatter_are_doubted_and_not_the_filter(filtered):
    """Residuals of alternating signs: the fix has its residual as its sigma, and the state hardly moves."""
    other = VALUES[FIX] - np.array([1e-4, 0, 0, 0, 0, 0])
    refused = np.array([0, 0, 2, 0, 0])
    out = refused_often(filtered, [FAR, other, FAR, other], refused)
    assert out.used[0]
    assert refused.tolist() == [0, 0, 0, 0, 0]
    r = residual(FIX, filtered.state, TURNING, other)[:3]
    _, P, _, _ = kalman(filtered.P, out.rows[:3], r, POSITION[:3] + r**2)
    assert np.abs(np.diag(out.P) / np.diag(P) - 1).max() < 5e-3
    assert np.abs(residual(FIX, out.state, TURNING, other)[:3]).max() > 0.9 * np.abs(r).max()


def test_a_fix_that_passes_ends_the_mistrust(filtered):
    refused = np.array([2, 0, 3, 0, 0])
    taken(filtered, FIX, VALUES[FIX], VARIANCES[FIX], gate=1e9, refused=refused)
    assert refused.tolist() == [0, 0, 0, 0, 1]


def test_an_aid_is_never_believed_against_the_filter(filtered):
    refused = np.array([99, 99, 0, 0, 0])
    out = taken(filtered, SPEED, np.array([90.0, 0, 0, 0, 0, 0]), VARIANCES[SPEED], gate=40.0, refused=refused)
    assert not out.used.any()
    assert np.array_equal(out.P, filtered.P)


def test_aids_do_not_count_among_refused_fixes(filtered):
    refused = np.array([4, 0, 0, 0, 0])
    taken(filtered, STRAIGHT, np.zeros(6), VARIANCES[STRAIGHT] * 1e6, gate=40.0, refused=refused)
    assert refused.tolist() == [4, 0, 0, 0, 0]
