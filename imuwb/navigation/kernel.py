"""The compiled loop of the filter: from samples and events to states with covariances.

A loosely coupled error-state filter with closed-loop feedback (Groves, 14.3): estimated errors are removed at once, so that
the error state between updates is zero, and only its covariance is propagated. The covariance is propagated at every M-th
sample of the log and at events. An outage that branches off before some fixes is therefore equal, bit for bit, to a run
without these fixes.

Arrays are copied in loops, and all counters have one type; otherwise numba compiles the same code several times.
"""

import math

import numpy as np

from imuwb.arrays import Floats
from imuwb.compiled import compiled
from imuwb.navigation.covariance import NAVIGATION, propagate
from imuwb.navigation.strapdown import MEASURED, SIZE, step
from imuwb.navigation.tables import FIX, AxisTables, Events, Marks, Rules, Samples, Track
from imuwb.navigation.update import update
from imuwb.navigation.workspace import STRIDE, Workspace

Whole = int | np.int64

FINE, NOT_FINITE, NOT_POSITIVE = 0, 1, 2  #: how a run ended
_U = np.uint64
_ONE, _TWO = _U(1), _U(2)


@compiled(arrays=False)
def advance(
    state: Floats, axes: Floats, covariance: Floats, samples: Samples, begin: Whole, end: Whole, with_covariance: bool,
    every: int, pending: Whole, tables: AxisTables, space: Workspace,
) -> Whole:  # fmt: skip  # pragma: no cover - compiled
    """Propagate through the samples ``begin`` to ``end`` (excluded); return how many the covariance does not include yet."""
    interval, angle, velocity, regimes = (
        samples.interval, samples.angle, samples.velocity, samples.regime
    )  # fmt: skip
    first, scale = tables.first, tables.scale
    held = regimes[begin] if begin < end else np.int64(0)
    weight, transition = tables.step[held], tables.transition[held, 1]
    error, moved = space.error, space.moved
    for k in range(begin, end):
        h, regime = interval[k], regimes[k]
        if regime != held:
            held = regime
            weight, transition = tables.step[held], tables.transition[held, 1]
        for axis in range(6):
            measured = angle[k, axis] if axis < 3 else velocity[k, axis - 3]  # noqa: PLR2004 - gyros first
            state[MEASURED + axis] += measured
            order, at = _U(first[axis + 1] - first[axis]), _U(first[axis] - NAVIGATION)
            total = 0.0
            if order == 3:  # noqa: PLR2004 - unrolled: tests/benchmarks/README.md states the gain
                x, y, z = axes[at], axes[at + _ONE], axes[at + _TWO]
                p = transition[axis, 0, 0] * x + transition[axis, 0, 1] * y + transition[axis, 0, 2] * z
                q = transition[axis, 1, 0] * x + transition[axis, 1, 1] * y + transition[axis, 1, 2] * z
                r = transition[axis, 2, 0] * x + transition[axis, 2, 1] * y + transition[axis, 2, 2] * z
                axes[at], axes[at + _ONE], axes[at + _TWO] = p, q, r
                total = weight[at] * p * (measured if scale[at] else h)
                total += weight[at + _ONE] * q * (measured if scale[at + _ONE] else h)
                total += weight[at + _TWO] * r * (measured if scale[at + _TWO] else h)
            else:
                block = transition[axis]
                for i in range(order):
                    value = 0.0
                    for j in range(order):
                        value += block[i, j] * axes[at + j]
                    moved[i] = value
                    total += weight[at + i] * value * (measured if scale[at + i] else h)
                for i in range(order):
                    axes[at + i] = moved[i]
            error[axis] = total
        step(
            state, h, angle[k, 0] - error[0], angle[k, 1] - error[1], angle[k, 2] - error[2],
            velocity[k, 0] - error[3], velocity[k, 1] - error[4], velocity[k, 2] - error[5],
        )  # fmt: skip
        pending += 1
        if with_covariance and (k + 1) % every == 0:
            propagate(covariance, state, pending, regime, tables, space)
            pending = np.int64(0)
    return pending


@compiled(arrays=False)
def sound(state: Floats, covariance: Floats, n: int) -> int:  # pragma: no cover - compiled
    """Return FINE if a state and its variances are valid, otherwise NOT_FINITE or NOT_POSITIVE."""
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


@compiled(arrays=False)
def _copy_square(rows: Floats, n: Whole, square: Floats) -> None:  # pragma: no cover - compiled
    for i in range(n):
        for j in range(n):
            square[i, j] = rows[i * STRIDE + j]


@compiled(arrays=False)
def run(
    state: Floats, axes: Floats, covariance: Floats, samples: Samples, events: Events, rules: Rules, tables: AxisTables,
    space: Workspace, begin: int, event: int, skip_from: int, skip_to: int, marks: Marks, track: Track,
) -> tuple[int, Whole]:  # fmt: skip  # pragma: no cover - compiled
    """Run the filter from a checkpoint; return FINE, NOT_FINITE or NOT_POSITIVE, and the event at which the run ended.

    Args:
        state, axes, covariance: the checkpoint; changed.
        samples, events, rules, tables: the log and the model.
        space: scratch.
        begin: first sample.
        event: first event.
        skip_from, skip_to: fixes at samples between these two, both excluded, are not used.
        marks: where the state is written between events; the run ends at the last mark, or, without marks, after the last event.
        track: the run writes its state after each event here, if there is room.
    """
    n = tables.first[6]
    weighing, spare, seen = space.weighing, space.spare, space.seen
    for i in range(5):
        weighing.refused[i] = 0
    for i in range(2):
        for j in range(5):
            weighing.trend[i, j] = 0.0
    done: Whole = np.int64(begin)
    pending: Whole = np.int64(0)
    e, m = np.int64(event), np.int64(0)
    at, kind, mark, with_covariance = events.at, events.kind, marks.at, marks.with_covariance
    kept, prior, smoothing = track.state.shape[0] > 0, track.before, track.before.state.shape[0] > 0
    while m < mark.size or (mark.size == 0 and e < at.size):
        looking = mark.size > 0 and (e >= at.size or mark[m] <= at[e])
        if not looking and kind[e] == FIX and skip_from < at[e] < skip_to:
            e += 1
            continue
        end = mark[m] if looking else at[e] + 1
        pending = advance(
            state, axes, covariance, samples, done, end, with_covariance, rules.every, pending, tables, space
        )
        done = end
        # At a mark, the covariance is propagated in a copy, so that marks do not change the rest of the run.
        if looking:
            for i in range(spare.size):
                spare[i] = covariance[i]
            for i in range(SIZE):
                seen[i] = state[i]
        if with_covariance and pending > 0:
            propagate(
                spare if looking else covariance, seen if looking else state, pending, int(samples.regime[end - 1]), tables,
                space,
            )  # fmt: skip
        if looking:
            for i in range(10):
                marks.state[m, i] = state[i]
            _copy_square(spare, np.int64(NAVIGATION), marks.covariance[m])
            m += 1
            continue
        pending = np.int64(0)
        if smoothing:
            for i in range(SIZE):
                prior.state[e, i] = state[i]
            for i in range(axes.size):
                prior.axes[e, i] = axes[i]
            _copy_square(covariance, n, prior.covariance[e])
            _copy_square(space.transition, n, prior.transition[e])
            for i in range(n * STRIDE):
                space.transition[i] = 0.0
            for i in range(n):
                space.transition[i * STRIDE + i] = 1.0
        update(state, axes, covariance, samples, events, e, rules, tables, weighing)
        ended = sound(state, covariance, n)
        if ended != FINE:
            return ended, e
        if kept:
            for i in range(6):
                track.innovation[e, i], track.deviation[e, i] = weighing.innovation[i], weighing.deviation[i]
            for i in range(2):
                track.nis[e, i], track.used[e, i] = weighing.nis[i], weighing.used[i]
            for i in range(SIZE):
                track.state[e, i] = state[i]
            for i in range(axes.size):
                track.axes[e, i] = axes[i]
            _copy_square(covariance, n, track.covariance[e])
        e += 1
    return sound(state, covariance, n), e
