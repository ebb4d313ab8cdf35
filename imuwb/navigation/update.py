"""The update of a filter by one event: residuals, gate, and feedback of the estimated errors."""

import math

import numpy as np

from imuwb.arrays import Floats
from imuwb.compiled import compiled
from imuwb.geodesy.earth import ECCENTRICITY_SQUARED, EQUATORIAL_RADIUS
from imuwb.navigation.covariance import NAVIGATION
from imuwb.navigation.strapdown import HEIGHT, LATITUDE, LONGITUDE, QUATERNION, RATE, VELOCITY
from imuwb.navigation.tables import FIX, MOST_ROWS, SPEED, STILL, AxisTables, Events, Rules, Samples
from imuwb.navigation.workspace import STRIDE, Weighing

Whole = int | np.int64
CONSISTENT = (
    0.4  #: products of neighbouring residuals over their squares; below, refused fixes point in many directions
)
MOST_FACTOR = 4.0  #: by which all variances are multiplied when fixes are refused again and again


@compiled(arrays=False)
def rotation(state: Floats, c: Floats) -> None:  # pragma: no cover - compiled
    """Write C_b_n of a state into ``c``."""
    w, x, y, z = state[QUATERNION], state[QUATERNION + 1], state[QUATERNION + 2], state[QUATERNION + 3]
    c[0, 0], c[0, 1], c[0, 2] = w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)
    c[1, 0], c[1, 1], c[1, 2] = 2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)
    c[2, 0], c[2, 1], c[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z


@compiled(arrays=False)
def _radii(latitude: float, height: float) -> tuple[float, float]:  # pragma: no cover - compiled
    """Return metres per radian of latitude and of longitude (``geodesy.ned_scale``)."""
    squared = 1.0 - ECCENTRICITY_SQUARED * math.sin(latitude) ** 2
    transverse = EQUATORIAL_RADIUS / math.sqrt(squared)
    meridian = transverse * (1.0 - ECCENTRICITY_SQUARED) / squared
    return meridian + height, (transverse + height) * math.cos(latitude)


@compiled(arrays=False)
def _measure(
    state: Floats, kind: int, late: float, value: Floats, lever: Floats, point: Floats, tables: AxisTables, regime: int,
    space: Weighing,
) -> None:  # fmt: skip  # pragma: no cover - compiled
    """Write the residuals, predicted minus measured, and their derivatives with respect to the error states."""
    first, weight, scale = tables.first, tables.step, tables.scale
    rows, residual, c, arm, swing = space.rows, space.residual, space.turn, space.arm, space.swing
    for r in range(MOST_ROWS):
        residual[r] = 0.0
        for i in range(rows.shape[1]):
            rows[r, i] = 0.0
    rotation(state, c)
    v = state[VELOCITY : VELOCITY + 3]
    if kind == FIX:
        north, east = _radii(state[LATITUDE], state[HEIGHT])
        for i in range(3):
            arm[i] = c[i, 0] * lever[0] + c[i, 1] * lever[1] + c[i, 2] * lever[2]
        w = state[RATE : RATE + 3]
        bx, by = w[1] * lever[2] - w[2] * lever[1], w[2] * lever[0] - w[0] * lever[2]
        bz = w[0] * lever[1] - w[1] * lever[0]
        for i in range(3):
            swing[i] = c[i, 0] * bx + c[i, 1] * by + c[i, 2] * bz
        residual[0] = (state[LATITUDE] - value[0]) * north + arm[0] + (v[0] + swing[0]) * late
        residual[1] = (state[LONGITUDE] - value[1]) * east + arm[1] + (v[1] + swing[1]) * late
        residual[2] = -(state[HEIGHT] - value[2]) + arm[2] + (v[2] + swing[2]) * late
        for i in range(3):
            residual[3 + i] = v[i] + swing[i] - value[3 + i]
            rows[i, i] = 1.0
            rows[3 + i, 3 + i] = 1.0
        for i in range(0, 6, 3):
            _cross(rows, i, arm if i == 0 else swing)
        # The antenna's velocity depends on the gyros' error b: C (b x l).
        for axis in range(3):
            for i in range(3):
                one, two = (axis + 1) % 3, (axis + 2) % 3
                # row i of C (e x l), where e is the unit vector of the axis
                turned = c[i, two] * lever[one] - c[i, one] * lever[two]
                if turned != 0.0:
                    for s in range(first[axis], first[axis + 1]):
                        gain = weight[regime, s - NAVIGATION] * (w[axis] if scale[s - NAVIGATION] else 1.0)
                        rows[3 + i, s] += turned * gain
    elif kind == STILL:
        for i in range(3):
            residual[i] = v[i]
            rows[i, 3 + i] = 1.0
    else:
        # The velocity of the point in the body is C^T v + w x l; its error is C^T (dv + v x phi) + b x l, as
        # C_est = (I - [phi x]) C, where b is the error of the gyros.
        w = state[RATE : RATE + 3]
        for axis in range(3):
            if (axis == 0) != (kind == SPEED):
                continue
            at = max(axis - 1, 0)
            along = c[0, axis] * v[0] + c[1, axis] * v[1] + c[2, axis] * v[2]
            first_turn, second_turn = (axis + 1) % 3, (axis + 2) % 3
            along += w[first_turn] * point[second_turn] - w[second_turn] * point[first_turn]
            for g in range(first[first_turn], first[first_turn + 1]):
                gain = weight[regime, g - NAVIGATION] * (w[first_turn] if scale[g - NAVIGATION] else 1.0)
                rows[at, g] += point[second_turn] * gain
            for g in range(first[second_turn], first[second_turn + 1]):
                gain = weight[regime, g - NAVIGATION] * (w[second_turn] if scale[g - NAVIGATION] else 1.0)
                rows[at, g] -= point[first_turn] * gain
            residual[at] = along - (value[0] if kind == SPEED else 0.0)
            for i in range(3):
                one, two = (i + 1) % 3, (i + 2) % 3
                rows[at, 3 + i] = c[i, axis]
                rows[at, 6 + i] = v[one] * c[two, axis] - v[two] * c[one, axis]


@compiled(arrays=False)
def _cross(rows: Floats, row: int, arm: Floats) -> None:  # pragma: no cover - compiled
    """Write [arm x]: the change of an arm with an attitude error phi is (I - [phi x]) arm - arm = [arm x] phi."""
    rows[row, 7], rows[row, 8] = -arm[2], arm[1]
    rows[row + 1, 6], rows[row + 1, 8] = arm[2], -arm[0]
    rows[row + 2, 6], rows[row + 2, 7] = -arm[1], arm[0]


@compiled(arrays=False)
def _scalar(
    covariance: Floats, error: Floats, n: int, row: Floats, residual: float, variance: float, gain: Floats
) -> tuple[float, float]:  # pragma: no cover - compiled
    """Update by one measurement; return its innovation and the variance of the innovation.

    ``error`` is the error that this event's measurements have estimated so far.
    """
    innovation, total = residual, variance
    for i in range(n):
        gain[i] = 0.0
    for j in range(n):
        if row[j] != 0.0:
            innovation -= row[j] * error[j]
            for i in range(n):
                gain[i] += row[j] * covariance[j * STRIDE + i]
    for j in range(n):
        total += row[j] * gain[j]
    for i in range(n):
        error[i] += gain[i] * innovation / total
        for j in range(i + 1):
            less = gain[i] * gain[j] / total
            covariance[i * STRIDE + j] -= less
            if i != j:
                covariance[j * STRIDE + i] -= less
    return innovation, total


@compiled(arrays=False)
def feed_back(state: Floats, axes: Floats, error: Floats, n: int) -> None:  # pragma: no cover - compiled
    """Remove the estimated errors from a state."""
    north, east = _radii(state[LATITUDE], state[HEIGHT])
    state[LATITUDE] -= error[0] / north
    state[LONGITUDE] -= error[1] / east
    state[HEIGHT] += error[2]
    for i in range(3):
        state[VELOCITY + i] -= error[3 + i]
    # C_true = (I + [phi x]) C
    a, b, c = 0.5 * error[6], 0.5 * error[7], 0.5 * error[8]
    w, x, y, z = state[QUATERNION], state[QUATERNION + 1], state[QUATERNION + 2], state[QUATERNION + 3]
    q0, q1 = w - a * x - b * y - c * z, x + a * w + b * z - c * y
    q2, q3 = y + b * w + c * x - a * z, z + c * w + a * y - b * x
    norm = 1.0 / math.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    state[QUATERNION], state[QUATERNION + 1] = q0 * norm, q1 * norm
    state[QUATERNION + 2], state[QUATERNION + 3] = q2 * norm, q3 * norm
    for s in range(NAVIGATION, n):
        axes[s - NAVIGATION] += error[s]


@compiled(arrays=False)
def update(
    state: Floats, axes: Floats, covariance: Floats, samples: Samples, events: Events, e: Whole, rules: Rules,
    tables: AxisTables, space: Weighing,
) -> None:  # fmt: skip  # pragma: no cover - compiled
    """Update a filter by one event: first its position, then its velocity; each must pass the gate on its NIS."""
    n = tables.first[6]
    kind, variance = events.kind[e], events.variance[e]
    rows, residual, error, guess, tried = space.rows, space.residual, space.error, space.guess, space.tried
    innovation, deviation, nis, used, refused = space.innovation, space.deviation, space.nis, space.used, space.refused
    trend = space.trend
    regime = int(samples.regime[events.at[e]])
    _measure(state, kind, events.late[e], events.value[e], rules.lever, rules.point, tables, regime, space)
    if kind == FIX and tables.receiver[0] > 0:
        # The receiver shows the position plus its own correlated error, whose estimate is one of the axes' states.
        for i in range(3):
            s = tables.receiver[i]
            residual[i] += axes[s - NAVIGATION]
            rows[i, s] = -1.0
    for i in range(n):
        error[i] = guess[i] = 0.0
    for i in range(6):
        innovation[i] = deviation[i] = np.nan
    for i in range(2):
        nis[i], used[i] = np.nan, False
    for group in range(2):
        measured = 0
        for r in range(3 * group, 3 * group + 3):
            measured += variance[r] > 0.0
        if measured == 0:
            continue
        doubted = False
        for attempt in range(2):
            for i in range(n * STRIDE):
                tried[i] = covariance[i]
            for i in range(n):
                guess[i] = error[i]
            total = 0.0
            for r in range(3 * group, 3 * group + 3):
                if variance[r] <= 0.0:
                    continue
                before, own = residual[r], variance[r]
                for j in range(n):
                    if rows[r, j] != 0.0:
                        before -= rows[r, j] * error[j]
                        for i in range(n):
                            own += rows[r, j] * rows[r, i] * covariance[j * STRIDE + i]
                wide = variance[r] + residual[r] * residual[r] if attempt == 1 and doubted else variance[r]
                left, spread = _scalar(tried, guess, n, rows[r], residual[r], wide, space.gain)
                total += left * left / spread
                if attempt == 0:
                    innovation[r], deviation[r] = -before, math.sqrt(own)
            if attempt == 0:
                nis[group] = total
            if total <= rules.gate or attempt == 1:
                for i in range(n * STRIDE):
                    covariance[i] = tried[i]
                for i in range(n):
                    error[i] = guess[i]
                used[group] = True
                if kind == FIX:
                    refused[group] = 0
                    refused[2 + group] = refused[2 + group] + 1 if attempt == 1 and not doubted else 0
                    for i in range(5):
                        trend[group, i] = 0.0
                    if group == 1:
                        refused[4] = 1 if attempt == 0 else 0
                break
            if kind != FIX:
                break
            refused[group] += 1
            if group == 1:
                refused[4] = 0
            for i in range(3):
                now = residual[3 * group + i] if variance[3 * group + i] > 0.0 else 0.0
                trend[group, 3] += now * now
                trend[group, 4] += now * trend[group, i]
                trend[group, i] = now
            if refused[group] <= rules.patience:
                break
            # More than ``patience`` fixes in a row are refused. If their residuals point in many directions, the fixes scatter
            # more than they claim, and this one is taken with its residual as its sigma. Otherwise the filter is wrong: the
            # first time its position alone, or its velocity; if the fixes after are refused again, all its states, unless
            # the velocities agree.
            if trend[group, 4] < CONSISTENT * trend[group, 3]:
                doubted = True
            elif refused[2 + group] > 0 and (group == 1 or refused[4] == 0):
                factor = min(total / measured, MOST_FACTOR)
                for i in range(n * STRIDE):
                    covariance[i] *= factor
            else:
                for r in range(3 * group, 3 * group + 3):
                    if variance[r] > 0.0:
                        covariance[r * STRIDE + r] += residual[r] * residual[r]
    if used[0] or used[1]:
        feed_back(state, axes, error, n)
