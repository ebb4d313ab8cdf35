"""The filter in plain numpy: dense matrices, a covariance a sample, joint updates; slow, and short."""

import numpy as np

from imuwb.navigation.strapdown import EARTH, GRAVITY, RATE, navigation_state, step
from imuwb.navigation.tables import FIX, SPEED

from . import drives


def transition(state, turn, force, h):
    """Return the step of navigation's errors: attitude at the middle, the mean of both velocities; and where errors enter."""
    earth = np.array([state[EARTH], 0, state[EARTH + 1]])
    transport = state[17:20] - 2 * earth
    f = drives.dynamics(force, earth, transport, state[GRAVITY])
    g = drives.entry(turn)
    both = np.hstack([f, g])
    # phi
    rows = np.hstack([np.eye(9), np.zeros((9, 6))])
    slope = both[6:]
    new_phi, middle = rows[6:9] + h * slope, rows[6:9] + h / 2 * slope
    used = rows.copy()
    used[6:9] = middle
    lifted = np.vstack([used, np.hstack([np.zeros((6, 9)), np.eye(6)])])
    new_v = rows[3:6] + h * both[3:6] @ lifted
    new_r = rows[:3] + h / 2 * (rows[3:6] + new_v)
    whole = np.vstack([new_r, new_v, new_phi])
    return whole[:, :9], whole[:, 9:]


def added(turn, white, inside, h):
    """Return noise of a step: attitude, and velocity that moves; an error that comes in within it acts at once."""
    gyro, accel = (turn @ np.diag(white[i : i + 3] * h + inside[i : i + 3] * h * h) @ turn.T for i in (0, 3))
    q = np.zeros((9, 9))
    q[6:, 6:], q[3:6, 3:6] = gyro, accel
    q[:3, 3:6] = q[3:6, :3] = h / 2 * accel
    q[:3, :3] = h * h / 3 * accel
    return q


def measured(kind, state, value, lever, late, c, rate):
    """Return rows, residual, of position's part and velocity's part."""
    n = 9 + c.shape[1]
    turn, v = drives.rotation(state[6:10]), state[3:6]
    h = np.zeros((6, n))
    r = np.zeros(6)
    if kind == FIX:
        arm, swing = turn @ lever, turn @ np.cross(rate, lever)
        r[:3] = (state[:3] - value[:3]) * drives.scale(state[:3]) + arm + (v + swing) * late
        r[3:] = v + swing - value[3:]
        h[:3, :3] = h[3:, 3:6] = np.eye(3)
        h[:3, 6:9], h[3:, 6:9] = drives.cross(arm), drives.cross(swing)
        h[3:, 9:] = -turn @ drives.cross(lever) @ np.where(np.isnan(c[:3]), rate[:, None], c[:3])
    else:
        body = turn.T @ v
        lines = [0] if kind == SPEED else [1, 2]
        for k, i in enumerate(lines):
            r[k] = body[i] - (value[0] if kind == SPEED else 0)
            h[k, 3:6], h[k, 6:9] = turn[:, i], -turn[:, i] @ drives.cross(v)
    return h, r


class Plain:
    """A filter of a drive that is made ready."""

    def __init__(self, made, tables, lever, axes, covariance) -> None:
        """Begin where it starts, with such states of the axes."""
        self.made, self.tables, self.lever = made, tables, np.array(lever)
        k = int(tables.first[6]) - 9
        expected = np.where(tables.scale, np.nan, tables.step[0])
        self.c, self.a, self.q = np.zeros((6, k)), np.zeros((k, k)), np.zeros((k, k))
        for i in range(6):
            part = slice(tables.first[i] - 9, tables.first[i + 1] - 9)
            p = part.stop - part.start
            self.c[i, part] = expected[part]
            self.a[part, part], self.q[part, part] = tables.transition[0, 1, i, :p, :p], tables.noise[0, 1, i, :p, :p]
        self.known = np.nan_to_num(self.c)  # without the scale factors
        start = made.alignment
        self.state = navigation_state(start.position, start.velocity, start.euler)
        self.x, self.P = axes.copy(), covariance.copy()

    def onwards(self, h, sensed):
        """Go on by a sample."""
        self.x = self.a @ self.x
        now = np.where(np.isnan(self.c), sensed[:, None] / h, self.c)
        turn = drives.rotation(self.state[6:10])
        step(self.state, h, *(sensed - now @ self.x * h))
        force = self.state[36:39] / h
        self.state[26:] = 0
        phi, into = transition(self.state, turn, force, h)
        big = np.zeros_like(self.P)
        big[:9, :9], big[:9, 9:], big[9:, 9:] = phi, into @ now @ self.a, self.a
        self.P = big @ self.P @ big.T
        self.P[9:, 9:] += self.q
        inside = np.einsum("ij,jk,ik->i", self.known, self.q, self.known)
        self.P[:9, :9] += added(turn, self.tables.white[0], inside, h)
        cross = h * drives.entry(turn) @ self.known @ self.q
        self.P[:9, 9:] += cross
        self.P[9:, :9] += cross.T

    def corrected(self, e):
        """Take an event in: position, then velocity, each at once."""
        events, state = self.made.corrections.events, self.state
        rows, r = measured(
            events.kind[e], state, events.value[e], self.lever, events.late[e], self.c, state[RATE : RATE + 3]
        )
        error = np.zeros(len(self.P))
        for part in (slice(0, 3), slice(3, 6)):
            use = np.flatnonzero(events.variance[e, part] > 0) + part.start
            if use.size:
                s = rows[use] @ self.P @ rows[use].T + np.diag(events.variance[e, use])
                k = self.P @ rows[use].T @ np.linalg.inv(s)
                error += k @ (r[use] - rows[use] @ error)
                self.P -= k @ s @ k.T
        state[:3] -= error[:3] / drives.scale(state[:3])
        state[3:6] -= error[3:6]
        half, w = error[6:9] / 2, state[6:10].copy()
        state[6:10] = np.concatenate([[w[0] - half @ w[1:]], w[1:] + w[0] * half + np.cross(half, w[1:])])
        state[6:10] /= np.linalg.norm(state[6:10])
        self.x += error[9:]

    def run(self):
        """Yield each event with the state, the axes' states and the covariance after it."""
        samples, at = self.made.measurement.samples, self.made.corrections.events.at
        done = self.made.alignment.sample
        for e in range(self.made.alignment.event + 1, at.size):
            for k in range(done, at[e] + 1):
                self.onwards(samples.interval[k], np.concatenate([samples.angle[k], samples.velocity[k]]))
            done = max(done, at[e] + 1)
            self.corrected(e)
            yield e, self.state[:10].copy(), self.x.copy(), self.P.copy()
