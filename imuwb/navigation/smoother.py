"""A solution smoothed backwards from its end: every state then knows all fixes (Rauch, Tung and Striebel 1965).

The filter feeds its errors back, so that behind an event the estimated error is zero; the smoothed error behind event k is

    s_k = G_k (s_(k+1) + c_(k+1)),  G_k = P+_k F_(k+1)^T (P-_(k+1))^-1,

with c the correction that event k+1 brought, and its covariance P+_k + G_k (P^s_(k+1) - P-_(k+1)) G_k^T.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from imuwb.geodesy.attitude import euler_of_rotation, rotation_of_quaternion
from imuwb.geodesy.earth import radii_of_curvature
from imuwb.navigation.covariance import NAVIGATION
from imuwb.navigation.strapdown import QUATERNION, VELOCITY

if TYPE_CHECKING:
    from imuwb.log import Floats
    from imuwb.navigation.filter import Solution


@dataclass(frozen=True, eq=False, slots=True)
class Smoothed:
    """A smoothed solution at its fixes, (m,) of them."""

    time: Floats  #: (m,) s from the log's start
    position: Floats  #: (m, 3) latitude rad, longitude rad, height m
    velocity: Floats  #: (m, 3) m/s, NED
    euler: Floats  #: (m, 3) roll, pitch, heading, rad
    sigma: Floats  #: (m, n) of all error states


def smoothed(solution: Solution) -> Smoothed:
    """Return a solution smoothed over the whole log.

    Args:
        solution: of ``solve(..., smooth=True)``.

    Raises:
        ValueError: what it needs was not kept.
    """
    track, before = solution.track, solution.track.before
    if not before.state.shape[0]:
        message = "the solution has not kept what a smoother needs: solve(..., smooth=True)"
        raise ValueError(message)
    order = [e for e in range(solution.found.time.size) if e >= solution.start.event]
    # Behind the start, an event that a run did not come to has no state.
    order = [e for e in order if track.state[e].any()]
    n = track.covariance.shape[1]
    corrections = {e: _correction(solution, e) for e in order[1:]}
    error, spread = np.zeros(n), track.covariance[order[-1]]
    errors, spreads = {order[-1]: error}, {order[-1]: spread}
    for k, following in zip(order[-2::-1], order[:0:-1], strict=True):
        scale = 1 / np.sqrt(np.maximum(np.diagonal(before.covariance[following]), 1e-300))
        prior = before.covariance[following] * scale[:, None] * scale
        crossed = (before.transition[following] @ track.covariance[k]) * scale[:, None]
        gain = cho_solve(cho_factor(prior + 1e-12 * np.eye(n)), crossed).T * scale
        error = gain @ (error + corrections[following])
        spread = track.covariance[k] + gain @ (spread - before.covariance[following]) @ gain.T
        errors[k], spreads[k] = error, spread
    off = np.array([errors[int(e)] for e in solution.events])
    variances = np.array([np.diagonal(spreads[int(e)]) for e in solution.events])
    position, velocity, rotation = _without(solution, off)
    return Smoothed(solution.time, position, velocity, euler_of_rotation(rotation), np.sqrt(np.maximum(variances, 0.0)))


def _correction(solution: Solution, e: int) -> Floats:
    """Return the errors that an event took out: what was before less what is behind it, of an axis's states the reverse."""
    was, now = solution.track.before.state[e], solution.track.state[e]
    meridian, transverse = radii_of_curvature(was[:1])
    north, east = meridian[0] + was[2], (transverse[0] + was[2]) * np.cos(was[0])
    turn = (
        rotation_of_quaternion(now[QUATERNION : QUATERNION + 4])
        @ rotation_of_quaternion(was[QUATERNION : QUATERNION + 4]).T
    )
    found = np.empty(solution.track.covariance.shape[1])
    found[:3] = (was[0] - now[0]) * north, (was[1] - now[1]) * east, now[2] - was[2]
    found[3:6] = was[VELOCITY : VELOCITY + 3] - now[VELOCITY : VELOCITY + 3]
    # C_now = (I + [phi x]) C_was
    found[6:9] = (turn[2, 1] - turn[1, 2]) / 2, (turn[0, 2] - turn[2, 0]) / 2, (turn[1, 0] - turn[0, 1]) / 2
    found[NAVIGATION:] = solution.track.axes[e] - solution.track.before.axes[e]
    return found


def _without(solution: Solution, error: Floats) -> tuple[Floats, Floats, Floats]:
    """Return positions, velocities and rotations of a solution with errors, (m, n), taken out."""
    position = solution.position.copy()
    meridian, transverse = radii_of_curvature(position[:, 0])
    position[:, 0] -= error[:, 0] / (meridian + position[:, 2])
    position[:, 1] -= error[:, 1] / ((transverse + position[:, 2]) * np.cos(position[:, 0]))
    position[:, 2] += error[:, 2]
    phi = error[:, 6:9]
    zero = np.zeros(len(phi))
    skew = np.stack([
        np.stack([zero, -phi[:, 2], phi[:, 1]], axis=1), np.stack([phi[:, 2], zero, -phi[:, 0]], axis=1),
        np.stack([-phi[:, 1], phi[:, 0], zero], axis=1),
    ], axis=1)  # fmt: skip
    rotation = (np.eye(3) + skew) @ rotation_of_quaternion(solution.quaternion)
    return position, solution.velocity - error[:, 3:6], rotation
