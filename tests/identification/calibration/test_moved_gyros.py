"""Gyros calibrated by the motions between still positions."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.identification.calibration import Motion, means, moved_gyros, without_attitudes
from imuwb.identification.calibration.motions import Triad, attitudes, integral
from imuwb.simulation.hand_held import attitude_of
from imuwb.simulation.six_position import spread

G, RATE, HOLD, MOVE = 9.81, 50, 100, 100
GAIN = np.array([[1.02, 0.012, -0.007], [0.004, 0.985, 0.011], [-0.013, 0.006, 1.015]])
ACCEL = np.array([[1.01, 0.0, 0.0], [0.012, 0.98, 0.0], [-0.007, 0.011, 1.02]])
BIAS, FORCE_BIAS, LEAK = np.array([0.02, -0.01, 0.03]), np.array([0.1, -0.2, 0.15]), 0.002 * np.eye(3)[[1, 2, 0]]


def recorded(noise=0.0, scale=1.0, seed=0):
    """Return the positions' gyro and accelerometer samples, and the motions between them, of a sensor with known errors."""
    rng = np.random.default_rng(seed)
    share = np.sin(np.pi * (np.arange(MOVE) + 0.5) / MOVE)
    rates, forces, before = [], [], None
    for i, up in enumerate(spread(16)):
        attitude = attitude_of(up, 1.3 * i)
        if before is not None:
            step = (before.inv() * attitude).as_rotvec() * (share / share.sum())[:, None]
            rates.append(step * RATE)
            forces.append(np.einsum("nji,j->ni", attitudes(step), forces[-1][0]))
        before = attitude
        rates.append(np.zeros((HOLD, 3)))
        forces.append(np.tile(G * up, (HOLD, 1)))
    rate, force = np.concatenate(rates), np.concatenate(forces)
    gyro = scale * (rate @ GAIN.T + BIAS + force / G @ LEAK.T) + noise * rng.standard_normal(rate.shape)
    accel = force @ ACCEL.T + FORCE_BIAS + noise * rng.standard_normal(rate.shape)
    first = [i * (HOLD + MOVE) for i in range(16)]
    step = np.full(2 * HOLD + MOVE, 1 / RATE)
    motions = [
        Motion(i, gyro[a : a + 2 * HOLD + MOVE], accel[a : a + 2 * HOLD + MOVE], step, HOLD, HOLD, HOLD, HOLD)
        for i, a in enumerate(first[:-1])
    ]
    return [gyro[a : a + HOLD] for a in first], [accel[a : a + HOLD] for a in first], motions


def calibrated(noise=1e-4, scale=1.0, **options):
    gyro, accel, motions = recorded(noise, scale=scale, **options)
    still = without_attitudes(means(accel), G, 0.95, samples=accel)
    seconds = np.full(len(gyro), HOLD / RATE)
    return moved_gyros(motions, means(gyro), seconds, still, G, 0.95, 0.0, raw=scale != 1.0), motions


@pytest.mark.parametrize("scale", [1.0, 4000.0])
def test_all_of_the_gyros_come_back(scale):
    found, _ = calibrated(noise=1e-4 * (1 if scale == 1.0 else 0.1), scale=scale)
    for i, axis in enumerate(found.axes):
        assert 1 + axis.scale_factor.value == pytest.approx(scale * GAIN[i, i], rel=2e-4)
        assert [c.value / scale for c in axis.cross_coupling] == pytest.approx(np.delete(GAIN[i], i), abs=2e-4)
        assert axis.bias.value / scale == pytest.approx(BIAS[i], abs=1e-4)  # the earth's rate is not in this record
        assert [s.value * G / scale for s in axis.g_sensitivity] == pytest.approx(LEAK[i], abs=1e-4)
        assert axis.scale_factor.lower < axis.scale_factor.value < axis.scale_factor.upper
    assert np.sqrt((found.apart**2).mean()) < 2e-3


def test_intervals_hold():
    inside = []
    for seed in range(6):
        found, _ = calibrated(noise=2e-3, seed=seed)
        inside += [a.scale_factor.lower < GAIN[i, i] - 1 < a.scale_factor.upper for i, a in enumerate(found.axes)]
        for i, axis in enumerate(found.axes):
            inside += [c.lower < t < c.upper for c, t in zip(axis.cross_coupling, np.delete(GAIN[i], i), strict=True)]
    assert 0.87 < np.mean(inside) <= 1.0
    assert 0.7 < found.excess < 1.4  # white noise is all there is


def test_the_slopes_are_those_of_the_integral():
    motion = recorded()[2][3]
    value = np.concatenate([BIAS[:, None], LEAK, GAIN], axis=1).ravel()

    true = np.concatenate([FORCE_BIAS, ACCEL.ravel()])

    def at(v, force=true):
        rows = v.reshape(3, 7)
        return integral(
            motion, Triad(rows[:, 4:], rows[:, 0]), rows[:, 1:4], Triad(force[3:].reshape(3, 3), force[:3]), G
        )

    part, small = at(value), 1e-6
    assert np.abs(part.apart).max() < 1e-4
    steps = small * np.eye(21)
    slope = np.stack([(at(value + d).apart - at(value - d).apart) / (2 * small) for d in steps], axis=1)
    assert part.slope == pytest.approx(slope, abs=0.01 * np.abs(slope).max())
    slope = np.stack(
        [(at(value, true + d).apart - at(value, true - d).apart) / (2 * small) for d in small * np.eye(12)], axis=1
    )
    assert part.accel_slope == pytest.approx(slope, abs=0.01 * np.abs(slope).max())


def test_attitudes_are_the_product_of_the_turns():
    turns = np.random.default_rng(1).normal(0, 0.3, (9, 3))
    direct, whole = [], np.eye(3)
    for i, turn in enumerate(turns):
        if i:
            turn = turn + np.cross(turns[i - 1], turn) / 12  # noqa: PLW2901 - the term for coning
        half = attitudes(turn[None])[0]
        direct.append(whole @ half)
        whole = whole @ half @ half
    assert attitudes(turns) == pytest.approx(np.stack(direct))


def test_motions_that_do_not_do():
    gyro, accel, motions = recorded(1e-4)
    still = without_attitudes(means(accel), G, 0.95)
    seconds = np.full(len(gyro), HOLD / RATE)
    with pytest.raises(ValueError, match="5 motions"):
        moved_gyros(motions[:5], means(gyro), seconds, still, G, 0.95, None)
    flat = [replace(m, gyro=m.gyro * [1, 1, 1e-9]) for m in motions]
    with pytest.raises(ValueError, match="too few axes|do not measure"):
        moved_gyros(flat, means(gyro), seconds, still, G, 0.95, None)
    wrong = [replace(m, gyro=m.gyro * [-1, 1, 1]) for m in motions]
    with pytest.raises(ValueError, match="do not measure"):
        moved_gyros(wrong, means(gyro), seconds, still, G, 0.95, None)


def test_a_window_is_cut_next_to_the_motion():
    motion = recorded()[2][0]
    cut = motion.trimmed(0.5)
    assert (cut.first, cut.last, len(cut.step)) == (25, 25, 150)
    assert (cut.gyro[0] == motion.gyro[HOLD - 25]).all()
    assert (cut.left, cut.held, cut.whole) == (HOLD, HOLD, False)
    assert motion.trimmed(60.0).whole
