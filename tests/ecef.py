"""Strapdown navigation in the earth-centred, earth-fixed frame, independent of imuwb: the oracle of everything in NED.

Nothing here comes from the package: its own constants (NIMA TR8350.2), its own gravity, a rotation matrix in place of
angles, Cartesian coordinates in place of latitude and longitude, Runge-Kutta of fourth order in place of increments.
"""

from __future__ import annotations

import math

import numba
import numpy as np

A, B = 6378137.0, 6356752.3142451793  # m, semi-axes
E2, EP2 = 1 - (B / A) ** 2, (A / B) ** 2 - 1
RATE = 7.292115e-5  # rad/s
GM = 3.986004418e14  # m³/s²
GAMMA_E, GAMMA_P = 9.7803253359, 9.8321849378  # m/s², gravity at the equator and at the poles
CHUNK = 60.0  # s of inertial signals at a time


def cartesian(position):
    """Return (n, 3) m of (n, 3) latitude rad, longitude rad, height m."""
    latitude, longitude, height = np.moveaxis(np.asarray(position, float), -1, 0)
    n = A / np.sqrt(1 - E2 * np.sin(latitude) ** 2)
    across = (n + height) * np.cos(latitude)
    return np.stack(
        [across * np.cos(longitude), across * np.sin(longitude), (n * (1 - E2) + height) * np.sin(latitude)], axis=-1
    )


def local_axes(latitude, longitude):
    """Return the matrix whose columns are north, east and down."""
    sl, cl, so, co = math.sin(latitude), math.cos(latitude), math.sin(longitude), math.cos(longitude)
    return np.array([[-sl * co, -so, -cl * co], [-sl * so, co, -cl * so], [cl, 0.0, -sl]])


def body_axes(roll, pitch, heading):
    """Return the matrix whose columns are forward, right and down in NED: three turns, one after the other."""

    def turn(axis, angle):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        matrix = np.eye(3)
        matrix[i, i] = matrix[j, j] = math.cos(angle)
        matrix[j, i], matrix[i, j] = math.sin(angle), -math.sin(angle)
        return matrix

    return turn(2, heading) @ turn(1, pitch) @ turn(0, roll)


@numba.njit
def _gravity(x, y, z):
    """Return gravity with the centrifugal part, along the ellipsoid's normal: Somigliana, to second order in height."""
    p = math.hypot(x, y)
    u = math.atan2(z * A, p * B)  # Bowring: exact to a nanometre near the surface
    latitude = math.atan2(z + EP2 * B * math.sin(u) ** 3, p - E2 * A * math.cos(u) ** 3)
    s, c = math.sin(latitude), math.cos(latitude)
    height = p * c + z * s - A * math.sqrt(1 - E2 * s * s)
    surface = (A * GAMMA_E * c * c + B * GAMMA_P * s * s) / math.sqrt((A * c) ** 2 + (B * s) ** 2)
    f, m = 1 - B / A, RATE**2 * A**2 * B / GM
    g = surface * (1 - 2 / A * (1 + f + m - 2 * f * s * s) * height + 3 * height**2 / A**2)
    return -g * c * x / p, -g * c * y / p, -g * s


@numba.njit
def _derivative(state, omega, force, out):
    """r' = v; v' = C f + g - 2 W x v; C' = C [omega x] - [W x] C."""
    g = _gravity(state[0], state[1], state[2])
    out[:3] = state[3:6]
    for i in range(3):
        c0, c1, c2 = state[6 + 3 * i], state[7 + 3 * i], state[8 + 3 * i]
        out[3 + i] = c0 * force[0] + c1 * force[1] + c2 * force[2] + g[i]
        out[6 + 3 * i] = c1 * omega[2] - c2 * omega[1]
        out[7 + 3 * i] = c2 * omega[0] - c0 * omega[2]
        out[8 + 3 * i] = c0 * omega[1] - c1 * omega[0]
    out[3] += 2 * RATE * state[4]
    out[4] -= 2 * RATE * state[3]
    for j in range(3):
        out[6 + j] += RATE * state[9 + j]
        out[9 + j] -= RATE * state[6 + j]


@numba.njit
def _runge_kutta(state, omega, force, h):
    """Carry the state over steps of h; the signals have a row for each half step, ends included."""
    slope, at, total = np.empty(15), np.empty(15), np.empty(15)
    for i in range(0, omega.shape[0] - 1, 2):
        total[:] = 0.0
        for row, ahead, weight in ((0, 0.0, 1.0), (1, 0.5, 2.0), (1, 0.5, 2.0), (2, 1.0, 1.0)):
            for j in range(15):
                at[j] = state[j] + (ahead * h * slope[j] if row else 0.0)
            _derivative(at, omega[i + row], force[i + row], slope)
            for j in range(15):
                total[j] += weight * slope[j]
        for j in range(15):
            state[j] += h / 6 * total[j]


def strapdown(inertial, start, end, position, velocity, attitude, rate=1000.0):
    """Return where the signals lead.

    Args:
        inertial: times (n,) s -> omega_ib^b (n, 3) rad/s, f^b (n, 3) m/s².
        start, end: s; whole seconds apart.
        position: (3,) latitude rad, longitude rad, height m, at the start.
        velocity: (3,) m/s, NED.
        attitude: (3,) roll, pitch, heading, rad.
        rate: Hz, of the steps.

    Returns:
        times (m,) s, ECEF positions (m, 3) m, ECEF velocities (m, 3) m/s, C_b_e (m, 3, 3); a row each CHUNK, and the end.
    """
    axes = local_axes(position[0], position[1])
    state = np.concatenate([cartesian(position), axes @ velocity, (axes @ body_axes(*attitude)).ravel()])
    found, times = [state.copy()], [start]
    while times[-1] < end:
        span = min(CHUNK, end - times[-1])
        t = times[-1] + np.arange(round(2 * span * rate) + 1) / (2 * rate)
        omega, force = inertial(t.clip(max=end))
        _runge_kutta(state, np.ascontiguousarray(omega), np.ascontiguousarray(force), 1 / rate)
        found.append(state.copy())
        times.append(times[-1] + span)
    track = np.array(found)
    return np.array(times), track[:, :3], track[:, 3:6], track[:, 6:].reshape(-1, 3, 3)
