"""The covariance's kernel against dense matrices, against disturbed mechanizations, and against many of them."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal
from scipy.linalg import solve_discrete_lyapunov

from imuwb.log import AXES
from imuwb.navigation.covariance import flat, propagate, square
from imuwb.navigation.filter_model import FilterModel, Settings
from imuwb.navigation.strapdown import MEASURED, step
from imuwb.navigation.workspace import workspace
from imuwb.simulation import mixed_route
from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, Sum

from . import drives

SECONDS = 30


@pytest.fixture(scope="module")
def motion():
    """Return half a minute in which it speeds up, turns and brakes."""
    route = mixed_route(240, 3)
    t = np.arange(0, 200, 1.0)
    turning = np.abs(np.diff(np.unwrap(route.state(t).attitude[:, 2])))
    begin = float(np.argmax(np.convolve(turning, np.ones(SECONDS), "valid")))
    found = drives.increments(route, SECONDS, begin=begin)
    assert np.ptp(np.unwrap(found.euler[:, 2])) > 0.5
    assert np.ptp(np.linalg.norm(found.speeds, axis=1)) > 3
    return found


def propagated(motion, model, covariance, every, steps=None):
    """Return the covariance that the kernel carries along a drive, and the tables."""
    tables, _ = model.tables(1 / drives.HZ)
    state, rows, space = motion.start.copy(), flat(covariance), workspace(covariance.shape[0])
    steps = motion.h.size if steps is None else steps
    for k in range(steps):
        state[MEASURED : MEASURED + 3] += motion.angle[k]
        state[MEASURED + 3 : MEASURED + 6] += motion.push[k]
        step(state, motion.h[k], *motion.angle[k], *motion.push[k])
        if (k + 1) % every == 0 or k + 1 == steps:
            propagate(rows, state, k % every + 1, 0, tables, space)
    return square(rows, covariance.shape[0]), tables


def begun(model, rng):
    """Return a full covariance to begin with: any of navigation, what the model says of the axes."""
    _, spread = model.tables(1 / drives.HZ)
    sigma = np.array([2, 2, 3, 0.1, 0.1, 0.2, 0.01, 0.01, 0.03])
    loose = rng.standard_normal((9, 30))
    n = 9 + spread.shape[0]
    covariance = np.zeros((n, n))
    covariance[:9, :9] = loose @ loose.T / 30 * np.outer(sigma, sigma)
    covariance[9:, 9:] = spread
    return covariance


def companion(axis, scale):
    """Return A, Q, c and P0 of an axis, of the last values of its processes, and of a scale factor."""
    a, q, p, c = [], [], [], []
    if axis in drives.MARKOV:
        sigma, correlation = drives.MARKOV[axis]
        phi = np.exp(-1 / drives.HZ / correlation)
        a, q, p, c = [np.array([[phi]])], [np.array([[sigma**2 * (1 - phi**2)]])], [np.array([[sigma**2]])], [1.0]
    if axis in drives.WALK:
        a, p, c = [*a, np.eye(1)], [*p, np.zeros((1, 1))], [*c, 1.0]
        q = [*q, np.full((1, 1), drives.WALK[axis] ** 2 / drives.HZ)]
    if axis in drives.ALPHA:
        alpha, beta = drives.ALPHA[axis]
        order = len(alpha)
        one, drive = np.eye(order, k=-1), np.zeros((order, order))
        one[0], drive[0, 0] = -np.array(alpha), beta**2
        a, q, c = [*a, one], [*q, drive], [*c, 1.0, *[0.0] * (order - 1)]
        p = [*p, solve_discrete_lyapunov(one, drive)]
    if scale:
        a, q, p, c = [*a, np.eye(1)], [*q, np.zeros((1, 1))], [*p, np.full((1, 1), scale**2)], [*c, np.nan]
    return a, q, p, c


def blocks(parts):
    n = sum(p.shape[0] for p in parts)
    whole, at = np.zeros((n, n)), 0
    for part in parts:
        whole[at : at + len(part), at : at + len(part)] = part
        at += len(part)
    return whole


def dense(motion, covariance, scales, steps):
    """Return the covariance, sample by sample with the matrix exponential; and the axes' errors' with navigation's."""
    axes = [companion(axis, scale) for axis, scale in zip(AXES, scales, strict=True)]
    a, q, p = (blocks([x for axis in axes for x in axis[i]]) for i in range(3))
    c, at = np.zeros((6, a.shape[0])), 0
    for i, axis in enumerate(axes):
        c[i, at : at + len(axis[3])] = axis[3]
        at += len(axis[3])
    whole = blocks([covariance[:9, :9], p])
    track, h = drives.went(motion), 1 / drives.HZ
    measured = np.concatenate([motion.angle, motion.push], axis=1) / h
    before = np.vstack([motion.start[:10], track])
    for k in range(steps):
        turn = drives.rotation(before[k, 6:10])
        middle = (before[k, :6] + before[k + 1, :6]) / 2
        still, transport = drives.earth(middle[:3], middle[3:])
        f = drives.dynamics(turn @ measured[k, 3:], still, transport)
        phi, held, noise = drives.discrete(f, drives.entry(turn), drives.WHITE**2, h)
        adds = held @ np.where(np.isnan(c), measured[k][:, None], c)
        big = blocks([phi, a])
        big[:9, 9:] = adds @ a
        into = np.vstack([adds, np.eye(len(a))])
        whole = big @ whole @ big.T + into @ q @ into.T
        whole[:9, :9] += noise
    return whole[:9, :9], whole[:9, 9:] @ np.nan_to_num(c).T


@pytest.fixture(scope="module")
def known():
    return {}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("every", "steps", "within"), [(1, 1, 1e-6), (10, 10, 3e-5), (1, 1500, 5e-4), (10, 1500, 5e-4)]
)
@pytest.mark.parametrize("scales", [(0.0, 0.0), (3e-3, 5e-3)])
def test_rows_do_what_dense_matrices_do(motion, known, scales, every, steps, within):
    model = drives.mixed(every=every)
    model = FilterModel("mixed", model.error_model, scale_factor=scales, settings=model.settings)
    start = begun(model, np.random.default_rng(1))
    found, tables = propagated(motion, model, start, every, steps)
    assert np.diff(tables.first).tolist() == [o + (scales[0] > 0) for o in (0, 1, 3, 2, 4, 2)]
    if (scales, steps) not in known:
        known[scales, steps] = dense(motion, start, (scales[0],) * 3 + (scales[1],) * 3, steps)
    expected, expected_cross = known[scales, steps]
    sigma = np.sqrt(np.diag(expected))
    assert np.abs((found[:9, :9] - expected) / np.outer(sigma, sigma)).max() < within
    # What navigation has to do with each axis's error is the same in whatever states that is written.
    weight = np.zeros((6, found.shape[0] - 9))
    for axis in range(6):
        part = slice(tables.first[axis] - 9, tables.first[axis + 1] - 9)
        weight[axis, part] = np.where(tables.scale[part], 0.0, tables.step[0, part])
    spread = np.sqrt(np.einsum("ij,jk,ik->i", weight, found[9:, 9:], weight))
    cross = (found[:9, 9:] @ weight.T - expected_cross) / np.outer(sigma, np.where(spread > 0, spread, 1))
    assert np.abs(cross).max() < within


def test_it_stays_symmetric_and_positive(motion):
    model = drives.mixed()
    found, _ = propagated(motion, model, begun(model, np.random.default_rng(2)), 10)
    sigma = np.sqrt(np.diag(found))
    assert np.abs((found - found.T) / np.outer(sigma, sigma)).max() < 1e-15
    assert np.linalg.eigvalsh(found / np.outer(sigma, sigma)).min() > -1e-12


def test_without_noise_what_is_certain_stays_certain(motion):
    model = quiet(1)
    found, _ = propagated(motion, model, np.zeros((21, 21)), 1)
    assert not found.any()


# Signs, each by itself: a disturbed mechanization


def quiet(every):
    """Return a filter of a bias and a scale factor per axis, without noise."""
    axes = {a: AxisModel(Sum((Constant(1.0),))) for a in AXES}
    return FilterModel("quiet", ImuErrorModel("quiet", axes), scale_factor=(1.0, 1.0), settings=Settings(every=every))


DISTURBED = [*[(i, 1.0) for i in range(3)], *[(i, 0.1) for i in range(3, 6)], *[(i, 1e-4) for i in range(6, 9)]]
DISTURBED += [(9 + 2 * i, (1e-5, 1e-3)[i > 2]) for i in range(6)]
DISTURBED += [(10 + 2 * i, 1e-4) for i in range(6)]


@pytest.fixture(scope="module")
def undisturbed(motion):
    return drives.went(motion)[-1]


@pytest.mark.parametrize("every", [1, 10])
@pytest.mark.parametrize(("which", "size"), DISTURBED)
def test_an_error_grows_as_a_disturbed_mechanization_does(motion, undisturbed, which, size, every):
    other = disturbed(motion, which, size)
    expected = drives.errors(drives.went(motion, **other)[-1], undisturbed)
    begin = np.zeros((21, 21))
    begin[which, which] = size**2
    found, _ = propagated(motion, quiet(every), begin, every)
    # A covariance of rank one: a column over the state's own sigma is what the state leads to, sign and all.
    grown = found[:9, which] / np.sqrt(found[which, which])
    if which < 9:
        grown *= np.sign(expected[which])
    for part, unit in ((slice(0, 3), 30.0), (slice(3, 6), 1.0), (slice(6, 9), 0.03)):
        largest = np.abs(expected / np.repeat([30.0, 1.0, 0.03], 3)).max() * unit
        assert grown[part] == pytest.approx(expected[part], abs=largest * (3e-3 if every == 1 else 1e-2))


def disturbed(motion, which, size):
    """Return the start, or the increments, of an estimate that errs by this much in one state."""
    if which >= 9:
        axis, scaled = divmod(which - 9, 2)
        angle, push = motion.angle.copy(), motion.push.copy()
        values = (angle if axis < 3 else push)[:, axis % 3]
        # measured = true + b, and the estimate of b is 0
        values[:] = values / (1 - size) if scaled else values + size * motion.h
        return {"angle": angle, "push": push}
    start = motion.start.copy()
    if which < 3:
        start[which] += size / drives.scale(start[:3])[which]
    elif which < 6:
        start[which] += size
    else:
        w = start[6:10]
        turn = np.zeros(3)
        turn[which - 6] = -size / 2  # C_estimate = (I - [phi x]) C_true
        start[6:10] = np.concatenate([[w[0] - turn @ w[1:]], w[1:] + w[0] * turn + np.cross(turn, w[1:])])
        start[6:10] /= np.linalg.norm(start[6:10])
    return {"start": start}


# Spread of many


def drawn(axis, n, rng):
    """Return an axis's errors, a sample each."""
    values = rng.standard_normal(n) * drives.WHITE[AXES.index(axis)] * np.sqrt(drives.HZ)
    if axis in drives.MARKOV:
        sigma, correlation = drives.MARKOV[axis]
        phi = np.exp(-1 / drives.HZ / correlation)
        noise = np.concatenate([[1.0], np.full(n, np.sqrt(1 - phi**2))]) * rng.standard_normal(n + 1) * sigma
        values += signal.lfilter([1.0], [1.0, -phi], noise)[1:]
    if axis in drives.WALK:
        values += np.cumsum(rng.standard_normal(n)) * drives.WALK[axis] / np.sqrt(drives.HZ)
    if axis in drives.ALPHA:
        alpha, beta = drives.ALPHA[axis]
        values += signal.lfilter([beta], [1.0, *alpha], rng.standard_normal(n + 3000))[3000:]
    return values


@pytest.mark.slow
def test_errors_of_many_drives_spread_as_the_covariance_says(motion, undisturbed):
    rng, runs, n = np.random.default_rng(8), 400, motion.h.size
    found = np.empty((runs, 9))
    for run in range(runs):
        errors = np.stack([drawn(axis, n, rng) for axis in AXES], axis=1) / drives.HZ
        track = drives.went(motion, angle=motion.angle + errors[:, :3], push=motion.push + errors[:, 3:])
        found[run] = drives.errors(track[-1], undisturbed)
    model = drives.mixed()
    start = begun(model, rng)
    start[:9] = start[:, :9] = 0
    expected = propagated(motion, model, start, 10)[0][:9, :9]
    chance = SimpleNamespace(variance=np.sqrt(2 / runs), nees=np.sqrt(2 * 9 / runs))
    assert (found**2).mean(axis=0) / np.diag(expected) == pytest.approx(1, abs=4 * chance.variance)
    nees = np.einsum("ri,ij,rj->r", found, np.linalg.inv(expected), found)
    assert nees.mean() == pytest.approx(9, abs=4 * chance.nees)
