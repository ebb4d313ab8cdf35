"""The compiled loop of the filter: samples and events in, navigation with its covariance out.

A loosely coupled error-state filter with closed-loop feedback (Groves, 14.3): every estimated error is taken out at once, so
the error state between updates is zero and only its covariance is carried. The covariance is carried on the absolute grid of
every M-th sample and at events, so that a run without some of the fixes is, bit for bit, what branches off before them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numba
import numpy as np

from imuwb.navigation.covariance import NAVIGATION, STRIDE, carry
from imuwb.navigation.strapdown import MEASURED, PAST_ANGLE, PAST_STEP, PAST_VELOCITY, SPAN, step
from imuwb.navigation.tables import FIX, MOST_ROWS
from imuwb.navigation.update import update

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.navigation.covariance import Workspace
    from imuwb.navigation.tables import AxisTables, Events, Rules, Samples, Track

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

FINE, NOT_FINITE, NOT_POSITIVE = 0, 1, 2  #: how a run ended


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance(
    state: Floats, axes: Floats, covariance: Floats, samples: Samples, begin: int, end: int, with_covariance: bool,
    every: int, pending: int, tables: AxisTables, space: Workspace,
) -> int:  # fmt: skip  # pragma: no cover - compiled
    """Carry everything on through the samples ``begin`` to ``end`` (excluded); return how many the open span holds."""
    interval, angle, velocity, gap, regimes = (
        samples.interval, samples.angle, samples.velocity, samples.gap, samples.regime
    )  # fmt: skip
    first, weight, scale, transition = tables.first, tables.step, tables.scale, tables.transition
    error = np.zeros(6)
    for k in range(begin, end):
        h, regime = interval[k], regimes[k]
        for axis in range(6):
            low, high = first[axis], first[axis + 1]
            measured = angle[k, axis] if axis < 3 else velocity[k, axis - 3]  # noqa: PLR2004 - gyros first
            state[MEASURED + axis] += measured
            if high - low == 1:
                at = low - NAVIGATION
                axes[at] *= transition[regime, 1, axis, 0, 0]
                error[axis] = weight[regime, at] * axes[at] * (measured if scale[at] else h)
            else:
                _shift(axes, low - NAVIGATION, high - low, transition[regime, 1, axis])
                total = 0.0
                for at in range(low - NAVIGATION, high - NAVIGATION):
                    total += weight[regime, at] * axes[at] * (measured if scale[at] else h)
                error[axis] = total
        if gap[k]:
            state[PAST_STEP] = 0.0
            state[PAST_ANGLE : PAST_ANGLE + 3] = 0.0
            state[PAST_VELOCITY : PAST_VELOCITY + 3] = 0.0
        step(
            state, h, angle[k, 0] - error[0], angle[k, 1] - error[1], angle[k, 2] - error[2],
            velocity[k, 0] - error[3], velocity[k, 1] - error[4], velocity[k, 2] - error[5],
        )  # fmt: skip
        pending += 1
        if with_covariance and (k + 1) % every == 0:
            carry(covariance, state, pending, regime, tables, space)
            pending = 0
    return pending


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _shift(axes: Floats, low: int, order: int, transition: Floats) -> None:  # pragma: no cover - compiled
    """Carry one axis's states on by a sample."""
    if order == 2:  # noqa: PLR2004 - the most frequent
        x, y = axes[low], axes[low + 1]
        axes[low] = transition[0, 0] * x + transition[0, 1] * y
        axes[low + 1] = transition[1, 0] * x + transition[1, 1] * y
    elif order == 3:  # noqa: PLR2004
        x, y, z = axes[low], axes[low + 1], axes[low + 2]
        axes[low] = transition[0, 0] * x + transition[0, 1] * y + transition[0, 2] * z
        axes[low + 1] = transition[1, 0] * x + transition[1, 1] * y + transition[1, 2] * z
        axes[low + 2] = transition[2, 0] * x + transition[2, 1] * y + transition[2, 2] * z
    elif order > 3:  # noqa: PLR2004
        moved = np.zeros(order)
        for i in range(order):
            for j in range(order):
                moved[i] += transition[i, j] * axes[low + j]
        axes[low : low + order] = moved


@numba.njit(cache=True, nogil=True, error_model="numpy")
def branch(
    state: Floats, axes: Floats, covariance: Floats, samples: Samples, events: Events, rules: Rules, tables: AxisTables,
    space: Workspace, begin: int, marks: Integers, with_covariance: bool, states: Floats, spreads: Floats,
) -> int:  # fmt: skip  # pragma: no cover - compiled
    """Carry a checkpoint on without fixes; the other aids go on. Return how it ended.

    Args:
        state, axes, covariance: the checkpoint; changed.
        samples, events, rules, tables, space: as of ``run``.
        begin: first sample.
        marks: (L,) samples behind which is written, rising; on the grid of covariances.
        with_covariance: whether covariances are carried.
        states: (L, 10) written: position, velocity, quaternion.
        spreads: (L, 9, 9) written: covariance of position, velocity and attitude.
    """
    n = tables.first[6]
    rows, refused = np.zeros((MOST_ROWS, n)), np.zeros(2, np.int64)
    innovation, deviation, nis, used = np.empty(6), np.empty(6), np.empty(2), np.zeros(2, np.bool_)
    at, kind = events.at, events.kind
    done, pending, e = begin, 0, 0
    while e < at.size and at[e] < begin:
        e += 1
    for m in range(marks.size):
        while e < at.size and at[e] < marks[m]:
            if kind[e] != FIX:
                pending = advance(
                    state, axes, covariance, samples, done, at[e] + 1, with_covariance, rules.every, pending, tables, space
                )  # fmt: skip
                done = at[e] + 1
                if state[SPAN] > 0.0:
                    carry(covariance, state, pending, int(samples.regime[at[e]]), tables, space)
                    pending = 0
                update(
                    state, axes, covariance, samples, events, e, rules, tables, rows, refused,
                    innovation, deviation, nis, used,
                )  # fmt: skip
            e += 1
        pending = advance(
            state, axes, covariance, samples, done, marks[m], with_covariance, rules.every, pending, tables, space
        )  # fmt: skip
        done = marks[m]
        states[m] = state[:10]
        for i in range(NAVIGATION):
            spreads[m, i] = covariance[i * STRIDE : i * STRIDE + NAVIGATION]
    return sound(state, covariance, n) if with_covariance else FINE


@numba.njit(cache=True, nogil=True, error_model="numpy")
def sound(state: Floats, covariance: Floats, n: int) -> int:  # pragma: no cover - compiled
    """Return whether a state and its variances are numbers that can be."""
    for i in range(10):
        if not math.isfinite(state[i]):
            return NOT_FINITE
    for i in range(n):
        diagonal = covariance[i * STRIDE + i]
        if not math.isfinite(diagonal):
            return NOT_FINITE
        if diagonal < 0.0:
            return NOT_POSITIVE
    return FINE


@numba.njit(cache=True, nogil=True, error_model="numpy")
def run(
    state: Floats, axes: Floats, covariance: Floats, samples: Samples, events: Events, rules: Rules, tables: AxisTables,
    space: Workspace, begin: int, skip_from: int, skip_to: int, track: Track,
) -> tuple[int, int]:  # fmt: skip  # pragma: no cover - compiled
    """Run the filter through all events; return how it ended, and at which event.

    Args:
        state, axes, covariance: at the beginning of sample ``begin``; changed.
        samples, events, rules, tables: the log and the model.
        space: scratch.
        begin: first sample.
        skip_from, skip_to: fixes behind samples from the one to the other, both excluded, are not used.
        track: written.
    """
    n = tables.first[6]
    rows, refused = np.zeros((MOST_ROWS, n)), np.zeros(2, np.int64)
    done, pending, prior = begin, 0, track.before
    at, kind = events.at, events.kind
    for e in range(at.size):
        if at[e] < begin:
            continue
        if kind[e] == FIX and skip_from < at[e] < skip_to:
            continue
        pending = advance(
            state, axes, covariance, samples, done, at[e] + 1, True, rules.every, pending, tables, space
        )  # fmt: skip
        done = at[e] + 1
        if state[SPAN] > 0.0:
            carry(covariance, state, pending, int(samples.regime[at[e]]), tables, space)
            pending = 0
        if prior.state.shape[0] > 0:
            prior.state[e], prior.axes[e] = state, axes
            for i in range(n):
                prior.covariance[e, i] = covariance[i * STRIDE : i * STRIDE + n]
                prior.transition[e, i] = space.transition[i * STRIDE : i * STRIDE + n]
                space.transition[i * STRIDE : (i + 1) * STRIDE] = 0.0
                space.transition[i * STRIDE + i] = 1.0
        update(
            state, axes, covariance, samples, events, e, rules, tables, rows, refused,
            track.innovation[e], track.deviation[e], track.nis[e], track.used[e],
        )  # fmt: skip
        ended = sound(state, covariance, n)
        if ended != FINE:
            return ended, e
        track.state[e], track.axes[e] = state, axes
        for i in range(n):
            track.covariance[e, i] = covariance[i * STRIDE : i * STRIDE + n]
    return FINE, at.size
