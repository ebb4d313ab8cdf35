"""Propagation of the error covariance, by operations on rows: the transition matrix is never formed.

Error states, in this order: position (3) m NED, velocity (3) m/s NED, attitude phi (3) rad NED, then the states of each sensor
axis, ``gyro_x`` ... ``accel_z``. A navigation error is estimate minus truth, and C_true = (I + [phi x]) C_estimate. An error
of an axis's state is truth minus estimate. Feedback subtracts the navigation errors and adds the others. b is the error of
the axes in NED:

    d/dt position = velocity
    d/dt velocity = f x phi + b_accel - (2 omega_ie + omega_en) x velocity + (0, 0, 2 g/R position_down)
    d/dt phi      = -omega_in x phi + omega_en(velocity) - b_gyro

Source: Groves, 14.2, without the terms that have no effect in outages of a few minutes (change of Earth rate and gravity with
latitude).

A covariance is a flat array of rows of ``STRIDE`` numbers, and the loops count in unsigned integers: the compiler then knows
all offsets, and works on four columns at once.
"""

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.compiled import compiled
from imuwb.geodesy.earth import EQUATORIAL_RADIUS
from imuwb.navigation.strapdown import CORIOLIS, EARTH, GRAVITY, MEASURED, PUSHED, SIZE, SPAN, TURNED
from imuwb.navigation.tables import AxisTables
from imuwb.navigation.workspace import MOST_STATES, STRIDE, Workspace

Whole = int | np.int64

NAVIGATION = 9  #: error states of position, velocity and attitude
_LANES = 4  #: columns that the compiler works on at once
_U = np.uint64
_N0, _N1, _N2, _N3, _N4, _N5, _N6, _N7, _N8 = (_U(row * STRIDE) for row in range(9))


def flat(covariance: Floats) -> Floats:
    """Return an (n, n) covariance as flat rows, which the kernels take."""
    n = covariance.shape[0]
    rows = np.zeros((MOST_STATES, STRIDE))
    rows[:n, :n] = covariance
    return rows.ravel()


def square(rows: Floats, n: int) -> Floats:
    """Return the (..., n, n) covariance of flat rows."""
    return rows.reshape(*rows.shape[:-1], MOST_STATES, STRIDE)[..., :n, :n]


@compiled(arrays=False)
def _coefficients(state: Floats) -> tuple[float, ...]:  # pragma: no cover - compiled
    """Return the coefficients of the error equations over a span: length, C_b_n, specific force, rates, gravity gradient."""
    span = state[SPAN]
    over = 1.0 / span
    c00, c01, c02 = state[TURNED] * over, state[TURNED + 1] * over, state[TURNED + 2] * over
    c10, c11, c12 = state[TURNED + 3] * over, state[TURNED + 4] * over, state[TURNED + 5] * over
    c20, c21, c22 = state[TURNED + 6] * over, state[TURNED + 7] * over, state[TURNED + 8] * over
    fn, fe, fd = state[PUSHED] * over, state[PUSHED + 1] * over, state[PUSHED + 2] * over
    wn, we, wd = state[CORIOLIS], state[CORIOLIS + 1], state[CORIOLIS + 2]
    tn, te, td = wn - state[EARTH], we, wd - state[EARTH + 1]
    curved, gradient = 1.0 / EQUATORIAL_RADIUS, 2.0 * state[GRAVITY] / EQUATORIAL_RADIUS
    return span, c00, c01, c02, c10, c11, c12, c20, c21, c22, fn, fe, fd, wn, we, wd, tn, te, td, curved, gradient


@compiled(arrays=False)
def _propagated(
    coefficients: tuple[float, ...], rn: float, re: float, rd: float, vn: float, ve: float, vd: float,
    pn: float, pe: float, pd: float, gx: float, gy: float, gz: float, ax: float, ay: float, az: float,
) -> tuple[float, ...]:  # fmt: skip  # pragma: no cover - compiled
    """Return the navigation errors at the end of a span, to second order in its length, from the axes' mean errors."""
    span, c00, c01, c02, c10, c11, c12, c20, c21, c22, fn, fe, fd, wn, we, wd, tn, te, td, curved, gradient = (
        coefficients
    )
    half = 0.5 * span
    dn = td * pe - te * pd + ve * curved - (c00 * gx + c01 * gy + c02 * gz)
    de = tn * pd - td * pn - vn * curved - (c10 * gx + c11 * gy + c12 * gz)
    dd = te * pn - tn * pe - (c20 * gx + c21 * gy + c22 * gz)
    # Velocity depends on phi at the middle of the span, position on the mean of both velocities.
    mn, me, md = pn + half * dn, pe + half * de, pd + half * dd
    un = vn + span * (fe * md - fd * me + c00 * ax + c01 * ay + c02 * az - (we * vd - wd * ve))
    ue = ve + span * (fd * mn - fn * md + c10 * ax + c11 * ay + c12 * az - (wd * vn - wn * vd))
    ud = vd + span * (fn * me - fe * mn + c20 * ax + c21 * ay + c22 * az - (wn * ve - we * vn) + gradient * rd)
    rn, re, rd = rn + half * (vn + un), re + half * (ve + ue), rd + half * (vd + ud)
    return rn, re, rd, un, ue, ud, pn + span * dn, pe + span * de, pd + span * dd


@compiled(arrays=False)
def _navigation_rows(
    source: Floats, product: Floats, columns: int, state: Floats, first: Integers, weights: Floats
) -> None:  # pragma: no cover - compiled
    """Write the first nine rows of the transition matrix times ``source`` into ``product``."""
    coefficients = _coefficients(state)
    n = _U(columns)
    for axis in range(6):
        row, start, end = _U(axis * STRIDE), first[axis], first[axis + 1]
        weight, other = (weights[start - NAVIGATION], _U(start * STRIDE)) if start < end else (0.0, _U(0))
        for j in range(n):
            product[row + j] = weight * source[other + j]
        for s in range(start + 1, end):
            weight, other = weights[s - NAVIGATION], _U(s * STRIDE)
            if weight != 0.0:  # of a lattice's states, only one has a weight
                for j in range(n):
                    product[row + j] += weight * source[other + j]
    for j in range(n):
        gx, gy, gz = product[_N0 + j], product[_N1 + j], product[_N2 + j]
        ax, ay, az = product[_N3 + j], product[_N4 + j], product[_N5 + j]
        rn, re, rd, vn, ve, vd, pn, pe, pd = _propagated(
            coefficients, source[_N0 + j], source[_N1 + j], source[_N2 + j], source[_N3 + j], source[_N4 + j],
            source[_N5 + j], source[_N6 + j], source[_N7 + j], source[_N8 + j], gx, gy, gz, ax, ay, az,
        )  # fmt: skip
        product[_N0 + j], product[_N1 + j], product[_N2 + j] = rn, re, rd
        product[_N3 + j], product[_N4 + j], product[_N5 + j] = vn, ve, vd
        product[_N6 + j], product[_N7 + j], product[_N8 + j] = pn, pe, pd


@compiled(arrays=False)
def _axis_rows(
    source: Floats, product: Floats, begin: np.uint64, first: Integers, transition: Floats
) -> None:  # pragma: no cover - compiled
    """Write the other rows of the transition matrix times ``source`` into ``product``, from column ``begin``."""
    low, high = begin, _U((first[6] + _LANES - 1) // _LANES * _LANES)
    for axis in range(6):
        start, end = first[axis], first[axis + 1]
        if end - start == 3:  # noqa: PLR2004 - unrolled, as the columns below
            a, b, c = transition[axis, 0, 0], transition[axis, 0, 1], transition[axis, 0, 2]
            d, e, f = transition[axis, 1, 0], transition[axis, 1, 1], transition[axis, 1, 2]
            g, h, k = transition[axis, 2, 0], transition[axis, 2, 1], transition[axis, 2, 2]
            one, two, three = _U(start * STRIDE), _U((start + 1) * STRIDE), _U((start + 2) * STRIDE)
            for j in range(low, high):
                x, y, z = source[one + j], source[two + j], source[three + j]
                product[one + j] = a * x + b * y + c * z
                product[two + j] = d * x + e * y + f * z
                product[three + j] = g * x + h * y + k * z
            continue
        for s in range(start, end):
            row, other = _U(s * STRIDE), _U(start * STRIDE)
            weight = transition[axis, s - start, 0]
            for j in range(low, high):
                product[row + j] = weight * source[other + j]
            for t in range(start + 1, end):
                weight, other = transition[axis, s - start, t - start], _U(t * STRIDE)
                if weight != 0.0:
                    for j in range(low, high):
                        product[row + j] += weight * source[other + j]


@compiled(arrays=False)
def _navigation_columns(
    product: Floats, covariance: Floats, state: Floats, first: Integers, weights: Floats
) -> None:  # pragma: no cover - compiled
    """Write the navigation states' columns of ``product`` times the transposed transition matrix into the covariance."""
    coefficients = _coefficients(state)
    for i in range(NAVIGATION):
        row = _U(i * STRIDE)
        gx, gy, gz, ax, ay, az = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for s in range(first[0], first[1]):
            gx += weights[s - NAVIGATION] * product[row + _U(s)]
        for s in range(first[1], first[2]):
            gy += weights[s - NAVIGATION] * product[row + _U(s)]
        for s in range(first[2], first[3]):
            gz += weights[s - NAVIGATION] * product[row + _U(s)]
        for s in range(first[3], first[4]):
            ax += weights[s - NAVIGATION] * product[row + _U(s)]
        for s in range(first[4], first[5]):
            ay += weights[s - NAVIGATION] * product[row + _U(s)]
        for s in range(first[5], first[6]):
            az += weights[s - NAVIGATION] * product[row + _U(s)]
        rn, re, rd, vn, ve, vd, pn, pe, pd = _propagated(
            coefficients, product[row], product[row + _U(1)], product[row + _U(2)], product[row + _U(3)],
            product[row + _U(4)], product[row + _U(5)], product[row + _U(6)], product[row + _U(7)], product[row + _U(8)],
            gx, gy, gz, ax, ay, az,
        )  # fmt: skip
        covariance[row], covariance[row + _U(1)], covariance[row + _U(2)] = rn, re, rd
        covariance[row + _U(3)], covariance[row + _U(4)], covariance[row + _U(5)] = vn, ve, vd
        covariance[row + _U(6)], covariance[row + _U(7)], covariance[row + _U(8)] = pn, pe, pd


@compiled(arrays=False)
def _axis_columns(
    product: Floats, covariance: Floats, first: Integers, transition: Floats
) -> None:  # pragma: no cover - compiled
    """Write the axes' columns of the same product into the covariance, and, by symmetry, the axes' rows.

    Loops over 1, 2 and 3 states are unrolled: tests/benchmarks/README.md states the gain.
    """
    for axis in range(6):
        start, end = first[axis], first[axis + 1]
        order, step = end - start, transition[axis]
        if order == 1:
            a = step[0, 0]
            for i in range(end):
                total = a * product[_U(i * STRIDE + start)]
                covariance[_U(i * STRIDE + start)] = total
                covariance[_U(start * STRIDE + i)] = total
        elif order == 2:  # noqa: PLR2004 - unrolled
            a, b, c, d = step[0, 0], step[0, 1], step[1, 0], step[1, 1]
            for i in range(end):
                at = _U(i * STRIDE + start)
                x, y = product[at], product[at + _U(1)]
                one, two = a * x + b * y, c * x + d * y
                covariance[at], covariance[at + _U(1)] = one, two
                at = _U(start * STRIDE + i)
                covariance[at], covariance[at + _U(STRIDE)] = one, two
        elif order == 3:  # noqa: PLR2004 - unrolled
            a, b, c = step[0, 0], step[0, 1], step[0, 2]
            d, e, f = step[1, 0], step[1, 1], step[1, 2]
            g, h, k = step[2, 0], step[2, 1], step[2, 2]
            for i in range(end):
                at = _U(i * STRIDE + start)
                x, y, z = product[at], product[at + _U(1)], product[at + _U(2)]
                one, two, three = a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + k * z
                covariance[at], covariance[at + _U(1)], covariance[at + _U(2)] = one, two, three
                at = _U(start * STRIDE + i)
                covariance[at], covariance[at + _U(STRIDE)], covariance[at + _U(2 * STRIDE)] = one, two, three
        else:
            for s in range(start, end):
                for i in range(end):
                    total = 0.0
                    for t in range(start, end):
                        total += step[s - start, t - start] * product[_U(i * STRIDE + t)]
                    covariance[_U(i * STRIDE + s)] = total
                    covariance[_U(s * STRIDE + i)] = total


@compiled(arrays=False)
def _add_noise(
    covariance: Floats, state: Floats, samples: Whole, first: Integers, noise: Floats, white: Floats, inside: Floats,
    cross: Floats,
) -> None:  # fmt: skip  # pragma: no cover - compiled
    """Add the noise of a span to a covariance."""
    span = state[SPAN]
    each = span / samples
    for axis in range(6):
        start = first[axis]
        for s in range(start, first[axis + 1]):
            for t in range(start, first[axis + 1]):
                covariance[s * STRIDE + t] += noise[axis, s - start, t - start]
            # A state's noise already changes attitude or velocity within the span.
            moved = cross[s - NAVIGATION] * each / span
            if moved != 0.0:
                row, sign = (6, -moved) if axis < 3 else (3, moved)  # noqa: PLR2004 - gyros first
                for i in range(3):
                    value = sign * state[TURNED + 3 * i + axis % 3]
                    covariance[(row + i) * STRIDE + s] += value
                    covariance[s * STRIDE + row + i] += value
    # White noise of both triads in NED. The noise of the accelerometers, integrated twice, also changes position.
    over = 1.0 / span
    sudden = each * each * over * over
    gx, gy, gz = (
        white[0] * over + inside[0] * sudden,
        white[1] * over + inside[1] * sudden,
        white[2] * over + inside[2] * sudden,
    )
    ax, ay, az = (
        white[3] * over + inside[3] * sudden,
        white[4] * over + inside[4] * sudden,
        white[5] * over + inside[5] * sudden,
    )
    for i in range(3):
        for j in range(3):
            one, other = TURNED + 3 * i, TURNED + 3 * j
            xx, yy = state[one] * state[other], state[one + 1] * state[other + 1]
            zz = state[one + 2] * state[other + 2]
            accel = ax * xx + ay * yy + az * zz
            covariance[(6 + i) * STRIDE + 6 + j] += gx * xx + gy * yy + gz * zz
            covariance[(3 + i) * STRIDE + 3 + j] += accel
            covariance[i * STRIDE + 3 + j] += 0.5 * span * accel
            covariance[(3 + i) * STRIDE + j] += 0.5 * span * accel
            covariance[i * STRIDE + j] += span * span / 3.0 * accel


@compiled(arrays=False)
def propagate(
    covariance: Floats, state: Floats, samples: Whole, regime: Whole, axes: AxisTables, space: Workspace
) -> None:  # pragma: no cover - compiled
    """Propagate a covariance over the span of the sums in a state, and begin a new span.

    Args:
        covariance: flat rows, changed.
        state: (SIZE,) of the mechanization; its sums are cleared.
        samples: number of samples in the span.
        regime: index of the temperature regime in the tables.
        axes: the axes' shaping filters.
        space: scratch.
    """
    span = state[SPAN]
    if span <= 0.0:
        return
    first, output, scale, weights = axes.first, axes.output[regime, samples], axes.scale, space.weights
    transition, noise, white = axes.transition[regime, samples], axes.noise[regime, samples], axes.white[regime]
    inside, cross, product = axes.inside[regime, samples], axes.cross[regime, samples], space.product
    n = first[6]
    for axis in range(6):
        for s in range(first[axis] - NAVIGATION, first[axis + 1] - NAVIGATION):
            weights[s] = output[s]
            if scale[s]:
                weights[s] *= state[MEASURED + axis] / span
    for turn in range(0 if space.transition.size > 0 else 1, 2):
        source = covariance if turn == 1 else space.transition
        _navigation_rows(source, product, (n + _LANES - 1) // _LANES * _LANES, state, first, weights)
        _axis_rows(source, product, _U(turn * (NAVIGATION - 1)), first, transition)
        if turn == 0:
            for k in range(n * STRIDE):
                source[k] = product[k]
    _navigation_columns(product, covariance, state, first, weights)
    _axis_columns(product, covariance, first, transition)
    for i in range(NAVIGATION):
        for j in range(i):
            mean = 0.5 * (covariance[i * STRIDE + j] + covariance[j * STRIDE + i])
            covariance[i * STRIDE + j] = mean
            covariance[j * STRIDE + i] = mean
    _add_noise(covariance, state, samples, first, noise, white, inside, cross)
    for k in range(SPAN, SIZE):
        state[k] = 0.0
