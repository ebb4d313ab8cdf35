"""Strapdown mechanization: position, velocity and attitude in NED from increments of angle and velocity (Groves, 5.4).

The corrections of coning and sculling use the increments of the step before; the steps may differ in length. Earth rate,
transport rate and gravity are those at the middle of a step. The state of the mechanization is one flat array, so that a copy
of it is a checkpoint:

    LATITUDE rad, LONGITUDE rad, HEIGHT m; VELOCITY (3) m/s NED; QUATERNION (4) body to NED;
    PAST_ANGLE (3) rad, PAST_VELOCITY (3) m/s and PAST_STEP s: increments and length of the step before; length 0: none;
    CORIOLIS (3) rad/s: 2 omega_ie + omega_en; GRAVITY m/s²; EARTH (2) rad/s, north and down: at the middle of the last step;
    RATE (3) rad/s: the last angular rate;
    for the covariance, sums over the steps since its last propagation: SPAN s: their length; TURNED (9) s: integral of C_b_n;
    PUSHED (3) m/s: integral of the specific force in NED; MEASURED (6) rad and m/s: integrals of the sensors' output.
"""

import math

import numpy as np

from imuwb.arrays import Floats
from imuwb.compiled import compiled
from imuwb.geodesy.attitude import quaternion_of_rotation, rotation_of_euler
from imuwb.geodesy.earth import (
    CENTRIFUGAL_RATIO,
    EARTH_RATE,
    ECCENTRICITY_SQUARED,
    EQUATORIAL_RADIUS,
    FLATTENING,
    GRAVITY_AT_EQUATOR,
    SOMIGLIANA,
    gravity,
)

LATITUDE, LONGITUDE, HEIGHT, VELOCITY, QUATERNION = 0, 1, 2, 3, 6
PAST_ANGLE, PAST_VELOCITY, PAST_STEP = 10, 13, 16
CORIOLIS, GRAVITY, EARTH, RATE = 17, 20, 21, 23
SPAN, TURNED, PUSHED, MEASURED = 26, 27, 36, 39
SIZE = 45


def navigation_state(position: Floats, velocity: Floats, euler: Floats) -> Floats:
    """Return the state at the start of a mechanization.

    Args:
        position: (3,) latitude rad, longitude rad, height m.
        velocity: (3,) m/s, NED.
        euler: (3,) roll, pitch, heading, rad.

    Returns:
        (SIZE,)
    """
    state = np.zeros(SIZE)
    state[LATITUDE : HEIGHT + 1] = position
    state[VELOCITY : VELOCITY + 3] = velocity
    state[QUATERNION : QUATERNION + 4] = quaternion_of_rotation(rotation_of_euler(euler))
    state[CORIOLIS], state[CORIOLIS + 2] = 2 * EARTH_RATE * np.cos(position[0]), -2 * EARTH_RATE * np.sin(position[0])
    state[GRAVITY] = gravity(position[0], position[2])
    return state


@compiled(arrays=False)
def step(
    state: Floats, h: float, ax: float, ay: float, az: float, ux: float, uy: float, uz: float
) -> None:  # pragma: no cover - compiled
    """Propagate a state over one step.

    Args:
        state: (SIZE,), changed.
        h: s, length of the step.
        ax, ay, az: rad, integral of the angular rate over the step, without the estimated errors.
        ux, uy, uz: m/s, integral of the specific force over the step, without the estimated errors.
    """
    # Coning and sculling: the weight of the step before follows from a parabola through both steps, also if they differ in length.
    past = state[PAST_STEP]
    k = h * h / (6.0 * past * (past + h)) if past > 0.0 else 0.0
    px, py, pz = state[PAST_ANGLE], state[PAST_ANGLE + 1], state[PAST_ANGLE + 2]
    qx, qy, qz = state[PAST_VELOCITY], state[PAST_VELOCITY + 1], state[PAST_VELOCITY + 2]
    bx = ax + k * (py * az - pz * ay)
    by = ay + k * (pz * ax - px * az)
    bz = az + k * (px * ay - py * ax)
    # The body turns during the step: first and second order of the rotation's series.
    tx, ty, tz = ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux
    sx = ux + 0.5 * tx + (ay * tz - az * ty) / 6.0 + k * (py * uz - pz * uy + qy * az - qz * ay)
    sy = uy + 0.5 * ty + (az * tx - ax * tz) / 6.0 + k * (pz * ux - px * uz + qz * ax - qx * az)
    sz = uz + 0.5 * tz + (ax * ty - ay * tx) / 6.0 + k * (px * uy - py * ux + qx * ay - qy * ax)
    state[PAST_ANGLE], state[PAST_ANGLE + 1], state[PAST_ANGLE + 2] = ax, ay, az
    state[PAST_VELOCITY], state[PAST_VELOCITY + 1], state[PAST_VELOCITY + 2] = ux, uy, uz
    state[PAST_STEP] = h
    state[RATE], state[RATE + 1], state[RATE + 2] = ax / h, ay / h, az / h

    w, x, y, z = state[QUATERNION], state[QUATERNION + 1], state[QUATERNION + 2], state[QUATERNION + 3]
    c00, c01, c02 = w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    c10, c11, c12 = 2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)
    c20, c21, c22 = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z
    fn, fe, fd = c00 * sx + c01 * sy + c02 * sz, c10 * sx + c11 * sy + c12 * sz, c20 * sx + c21 * sy + c22 * sz

    # Velocity and position at the middle of the step, with the rates of the step before.
    vn, ve, vd = state[VELOCITY], state[VELOCITY + 1], state[VELOCITY + 2]
    wn, we, wd = state[CORIOLIS], state[CORIOLIS + 1], state[CORIOLIS + 2]
    mn = vn + 0.5 * (fn - h * (we * vd - wd * ve))
    me = ve + 0.5 * (fe - h * (wd * vn - wn * vd))
    md = vd + 0.5 * (fd + h * (state[GRAVITY] - (wn * ve - we * vn)))
    latitude, height = state[LATITUDE], state[HEIGHT] - 0.25 * h * (vd + md)
    sine = math.sin(latitude)
    squared = 1.0 - ECCENTRICITY_SQUARED * sine * sine
    latitude += 0.25 * h * (vn + mn) * squared * math.sqrt(squared) / (EQUATORIAL_RADIUS * (1.0 - ECCENTRICITY_SQUARED))
    sine, cosine = math.sin(latitude), math.cos(latitude)
    squared = 1.0 - ECCENTRICITY_SQUARED * sine * sine
    root = math.sqrt(squared)
    transverse = EQUATORIAL_RADIUS / root
    meridian = transverse * (1.0 - ECCENTRICITY_SQUARED) / squared
    down = GRAVITY_AT_EQUATOR * (1.0 + SOMIGLIANA * sine * sine) / root
    over = height / EQUATORIAL_RADIUS
    down *= 1.0 - 2.0 * (1.0 + FLATTENING * (1.0 - 2.0 * sine * sine) + CENTRIFUGAL_RATIO) * over + 3.0 * over * over

    # Earth rate, and transport rate at the middle velocity.
    earth_n, earth_d = EARTH_RATE * cosine, -EARTH_RATE * sine
    tn, te, td = me / (transverse + height), -mn / (meridian + height), -me * sine / (cosine * (transverse + height))
    zn, ze, zd = (earth_n + tn) * h, te * h, (earth_d + td) * h
    wn, we, wd = 2.0 * earth_n + tn, te, 2.0 * earth_d + td
    state[CORIOLIS], state[CORIOLIS + 1], state[CORIOLIS + 2], state[GRAVITY] = wn, we, wd, down
    state[EARTH], state[EARTH + 1] = earth_n, earth_d

    # The navigation frame turns by (zn, ze, zd) during the step; on average, half of this turn applies.
    gn = fn - 0.5 * (ze * fd - zd * fe)
    ge = fe - 0.5 * (zd * fn - zn * fd)
    gd = fd - 0.5 * (zn * fe - ze * fn)
    nn = vn + gn - h * (we * md - wd * me)
    ne = ve + ge - h * (wd * mn - wn * md)
    nd = vd + gd + h * (down - (wn * me - we * mn))
    state[VELOCITY], state[VELOCITY + 1], state[VELOCITY + 2] = nn, ne, nd
    state[LATITUDE] += 0.5 * h * (vn + nn) / (meridian + height)
    state[LONGITUDE] += 0.5 * h * (ve + ne) / ((transverse + height) * cosine)
    state[HEIGHT] -= 0.5 * h * (vd + nd)

    # q <- q(-zeta) q q(beta) for small angles: the series of sin(a)/a and cos(a) are exact to 1e-16 below 0.1 rad.
    s = 0.25 * (bx * bx + by * by + bz * bz)
    sinc = 0.5 * (1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0)))
    cosb = 1.0 - s / 2.0 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0)))
    bx, by, bz = sinc * bx, sinc * by, sinc * bz
    ow = w * cosb - x * bx - y * by - z * bz
    ox = w * bx + x * cosb + y * bz - z * by
    oy = w * by - x * bz + y * cosb + z * bx
    oz = w * bz + x * by - y * bx + z * cosb
    zn, ze, zd = -0.5 * zn, -0.5 * ze, -0.5 * zd
    w = ow - zn * ox - ze * oy - zd * oz
    x = ox + zn * ow + ze * oz - zd * oy
    y = oy + ze * ow + zd * ox - zn * oz
    z = oz + zd * ow + zn * oy - ze * ox
    norm = 1.0 / math.sqrt(w * w + x * x + y * y + z * z)
    state[QUATERNION], state[QUATERNION + 1] = w * norm, x * norm
    state[QUATERNION + 2], state[QUATERNION + 3] = y * norm, z * norm

    state[SPAN] += h
    state[TURNED] += h * c00
    state[TURNED + 1] += h * c01
    state[TURNED + 2] += h * c02
    state[TURNED + 3] += h * c10
    state[TURNED + 4] += h * c11
    state[TURNED + 5] += h * c12
    state[TURNED + 6] += h * c20
    state[TURNED + 7] += h * c21
    state[TURNED + 8] += h * c22
    state[PUSHED] += gn
    state[PUSHED + 1] += ge
    state[PUSHED + 2] += gd


@compiled(arrays=False)
def _mechanize(
    state: Floats, interval: Floats, angle: Floats, velocity: Floats, track: Floats
) -> None:  # pragma: no cover - compiled
    for k in range(interval.size):
        a, u = angle[k], velocity[k]
        step(state, interval[k], a[0], a[1], a[2], u[0], u[1], u[2])
        for i in range(10):
            track[k, i] = state[i]


def mechanize(state: Floats, interval: Floats, angle: Floats, velocity: Floats) -> Floats:
    """Return the track of an IMU without errors.

    Args:
        state: (SIZE,) from ``navigation_state``; not changed.
        interval: (n,) s, length of each step.
        angle: (n, 3) rad, integral of the angular rate over each step.
        velocity: (n, 3) m/s, integral of the specific force over each step.

    Returns:
        (n, 10) after each step: latitude rad, longitude rad, height m, velocity NED m/s, quaternion of the body.
    """
    track = np.empty((interval.size, 10))
    _mechanize(state.copy(), interval, np.ascontiguousarray(angle), np.ascontiguousarray(velocity), track)
    return track
