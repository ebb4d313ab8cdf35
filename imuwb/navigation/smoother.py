"""The smoother: a solution in which each state depends on all fixes (Rauch, Tung and Striebel 1965).

The filter feeds its errors back, so the estimated error after an event is zero. The smoothed error after event k is

    s_k = G_k (s_(k+1) + c_(k+1)),  G_k = P+_k F_(k+1)^T (P-_(k+1))^-1,

where c is the correction by event k+1. Its covariance is P+_k + G_k (P^s_(k+1) - P-_(k+1)) G_k^T.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.geodesy.attitude import euler_of_rotation, rotation_of_quaternion
from imuwb.geodesy.earth import ned_scale
from imuwb.navigation.covariance import NAVIGATION
from imuwb.navigation.filter import Solution
from imuwb.navigation.strapdown import QUATERNION, VELOCITY


@dataclass(frozen=True, eq=False, slots=True)
class Smoothed:
    """A smoothed solution at its m fixes."""

    time: Floats  #: (m,) s from the log's start
    position: Floats  #: (m, 3) latitude rad, longitude rad, height m
    velocity: Floats  #: (m, 3) m/s, NED
    euler: Floats  #: (m, 3) roll, pitch, heading, rad
    sigma: Floats  #: (m, n) of all error states


def smoothed(solution: Solution) -> Smoothed:
    """Return a solution smoothed over the whole log.

    Args:
        solution: from ``solve(..., smooth=True)``.

    Raises:
        ValueError: the solution does not have what the smoother needs.
    """
    order, errors, variances = backward_pass(solution)
    rows = np.searchsorted(order, solution.events)
    position, velocity, rotation = _corrected(solution, errors[rows])
    return Smoothed(solution.time, position, velocity, euler_of_rotation(rotation), np.sqrt(variances[rows]))


def backward_pass(solution: Solution) -> tuple[Integers, Floats, Floats]:
    """Return the used events, and for each the smoothed error of the state after it, with its variances.

    Args:
        solution: from ``solve(..., smooth=True)``.

    Returns:
        (m,) among the solution's events, (m, n), and (m, n).

    Raises:
        ValueError: the solution does not have what the smoother needs.
    """
    from scipy.linalg import cho_factor, cho_solve  # noqa: PLC0415 - scipy is slow to import

    track, before = solution.track, solution.track.before
    if not before.state.shape[0]:
        raise ValueError("the solution does not have what a smoother needs; use solve(..., smooth=True)")
    # An event that the run did not use has no state.
    order = [e for e in range(solution.alignment.event, solution.corrections.time.size) if track.state[e].any()]
    n = track.covariance.shape[1]
    corrections = corrections_of_events(solution, np.array(order))
    errors, variances = np.zeros((len(order), n)), np.zeros((len(order), n))
    error, spread = np.zeros(n), track.covariance[order[-1]]
    variances[-1] = np.diagonal(spread)
    for row, (k, following) in reversed(list(enumerate(pairwise(order)))):
        scale = 1 / np.sqrt(np.maximum(np.diagonal(before.covariance[following]), 1e-300))
        prior = before.covariance[following] * scale[:, None] * scale
        crossed = (before.transition[following] @ track.covariance[k]) * scale[:, None]
        gain = cho_solve(cho_factor(prior + 1e-12 * np.eye(n)), crossed).T * scale
        error = gain @ (error + corrections[row + 1])
        spread = track.covariance[k] + gain @ (spread - before.covariance[following]) @ gain.T
        errors[row], variances[row] = error, np.diagonal(spread)
    return np.array(order), errors, np.maximum(variances, 0.0)


def corrections_of_events(solution: Solution, events: Integers) -> Floats:
    """Return the errors that events removed, (m, n): before minus after; for the axes' states, after minus before."""
    before, after = solution.track.before.state[events], solution.track.state[events]
    turn = rotation_of_quaternion(after[:, QUATERNION : QUATERNION + 4]) @ np.swapaxes(
        rotation_of_quaternion(before[:, QUATERNION : QUATERNION + 4]), 1, 2
    )
    removed = np.empty((len(events), solution.track.covariance.shape[1]))
    removed[:, :3] = (before[:, :3] - after[:, :3]) * ned_scale(before[:, 0], before[:, 2])
    removed[:, 3:6] = before[:, VELOCITY : VELOCITY + 3] - after[:, VELOCITY : VELOCITY + 3]
    # C_after = (I + [phi x]) C_before
    for axis, (i, j) in enumerate(((2, 1), (0, 2), (1, 0))):
        removed[:, 6 + axis] = (turn[:, i, j] - turn[:, j, i]) / 2
    removed[:, NAVIGATION:] = solution.track.axes[events] - solution.track.before.axes[events]
    return removed


def _corrected(solution: Solution, error: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the positions, velocities and rotations of a solution after the errors, (m, n), are removed."""
    position = solution.position - error[:, :3] / ned_scale(solution.position[:, 0], solution.position[:, 2])
    x, y, z = error[:, 6:9].T
    zero = np.zeros_like(x)
    skew = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    rotation = (np.eye(3) + skew) @ rotation_of_quaternion(solution.quaternion)
    return position, solution.velocity - error[:, 3:6], rotation
