"""The motion between two still positions: what its gyros integrate to, and how that changes with their parameters."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from imuwb.arrays import Floats

PARAMETERS = 7  #: of one gyro: bias, sensitivity to the direction of up (3), gains of the true rates (3)
CONING = 1 / 12  #: of the product of neighbouring increments (Savage's second-order coning term for equal steps)


@dataclass(frozen=True, eq=False, slots=True)
class Motion:
    """Samples from one still position to the next, both windows included."""

    before: int  #: number of the position in which the motion begins
    gyro: Floats  #: (n, 3) in the unit of the samples
    accel: Floats  #: (n, 3) at the same times, in the unit of the samples
    step: Floats  #: (n,) s, interval of each sample
    first: int  #: samples of the window in which the sensor is still, at the beginning
    last: int  #: the same at the end
    left: int  #: samples of the position in which the motion begins
    held: int  #: samples of the position in which the motion ends
    whole: bool = True  #: whether both windows are the whole positions

    def trimmed(self, seconds: float) -> "Motion":
        """Return the motion with windows of at most this duration, next to the motion."""
        dt = float(self.step.mean())
        most = max(round(seconds / dt), 2)
        begin, end = max(self.first - most, 0), len(self.step) - max(self.last - most, 0)
        rows = slice(begin, end)
        first, last = min(self.first, most), min(self.last, most)
        whole = self.whole and len(self.step) == end - begin
        return Motion(
            self.before, self.gyro[rows], self.accel[rows], self.step[rows], first, last, self.left, self.held, whole
        )


@dataclass(frozen=True, eq=False, slots=True)
class Triad:
    """A linear model of three axes: reading = gain · input + bias."""

    gain: Floats  #: (3, 3)
    bias: Floats  #: (3,)


@dataclass(frozen=True, eq=False, slots=True)
class Integral:
    """The direction of up before and after a motion, in the body's frame at its first sample, and what it depends on."""

    apart: Floats  #: (2,) direction after minus direction before, across up
    slope: Floats  #: (2, 21) change of it with the gyros' parameters, axis by axis
    accel_slope: Floats  #: (2, 12) change of it with the accelerometers' bias and gain, row by row
    ends: tuple[
        Floats, Floats
    ]  #: (2, 3) each: change of it with the mean force in the window after, and before, per m/s²
    gyro_noise: Floats  #: (2, 2) covariance for gyros of a density of 1 (unit of the samples)²/Hz
    swings: tuple[
        Floats, Floats
    ]  #: (2, 3) each: the same, common with the mean reading in the position before, and after
    earth: Floats  #: (2, 3) change of it with a rate of the frame of the body at the first sample, s
    turned: tuple[
        Floats, Floats
    ]  #: (3, 3) each: rotations from the body in the position before, and after, to that frame
    next_frame: Floats  #: (3, 3) rotation from the body at the beginning of the position after to that frame


def integral(motion: Motion, gyro: Triad, leak: Floats, accel: Triad, gravity: float) -> Integral:
    """Return what a motion's gyros integrate to (Tedaldi, Pretto and Menegatti 2014, eq. 15, with two windows in place of two means).

    Args:
        motion: the motion.
        gyro: gains and biases of the gyros.
        leak: (3, 3) reading of each gyro for a specific force of 1 g along each axis.
        accel: gains and biases of the accelerometers.
        gravity: m/s².
    """
    up = (motion.accel - accel.bias) @ np.linalg.inv(accel.gain).T / gravity
    inverse = np.linalg.inv(gyro.gain)
    rate = (motion.gyro - gyro.bias - up @ leak.T) @ inverse.T
    middle = attitudes(rate * motion.step[:, None])
    before, after = slice(0, motion.first), slice(len(up) - motion.last, None)
    level = np.einsum("nij,nj->ni", middle, up)
    start, end = _unit(level[before].mean(axis=0)), _unit(level[after].mean(axis=0))
    across = across_of(start + end)
    turned = across @ _cross(_unit(start + end))
    share = _share(motion) * motion.step
    swing = middle @ inverse
    inputs = np.concatenate([np.ones((len(up), 1)), up, rate], axis=1)
    moment = np.einsum("n,nij,nk->ijk", share, swing, inputs).reshape(3, 3 * PARAMETERS)
    noise = np.einsum("n,nij,nkj->ik", share**2 / motion.step, swing, swing)
    back: Floats = np.asarray(np.linalg.inv(accel.gain) / gravity, dtype=np.float64)
    ends = tuple(across @ middle[rows].mean(axis=0) / gravity for rows in (after, before))
    bent = [_accel_slope(across, middle[rows], up[rows] * gravity, back) for rows in (after, before)]
    means = [middle[rows].mean(axis=0) for rows in (before, after)]
    swings = [
        turned @ mean @ inverse * (windowed / held / 2)
        for mean, windowed, held in zip(means, (motion.first, motion.last), (motion.left, motion.held), strict=True)
    ]
    return Integral(
        across @ (end - start), turned @ moment, bent[0] - bent[1], (ends[0], ends[1]), turned @ noise @ turned.T,
        (swings[0], swings[1]), turned * share.sum(), (means[0], means[1]), middle[len(up) - motion.last],
    )  # fmt: skip


def attitudes(turns: Floats) -> Floats:
    """Return the rotations from the body at the middle of each step to the body at the beginning of the first, (n, 3, 3).

    Args:
        turns: (n, 3) rad, angular rate times duration of each step.
    """
    turns = turns + CONING * np.cross(np.roll(turns, 1, axis=0), turns) * (np.arange(len(turns)) > 0)[:, None]
    whole = np.asarray(Rotation.from_rotvec(turns).as_matrix(), dtype=np.float64)
    half = np.asarray(Rotation.from_rotvec(turns / 2).as_matrix(), dtype=np.float64)
    reach = 1
    while reach < len(whole):  # products of 2, 4, 8 ... neighbours (Hillis and Steele)
        whole = np.concatenate([whole[:reach], whole[:-reach] @ whole[reach:]])
        reach *= 2
    return np.concatenate([np.eye(3)[None], whole[:-1]]) @ half


def _share(motion: Motion) -> Floats:
    """Return the share of each step's turn in the turn from the mean of one window to the mean of the other, (n,)."""
    share = np.ones(len(motion.step))
    share[: motion.first] = (np.arange(motion.first) + 0.5) / motion.first
    share[len(share) - motion.last :] = 1 - (np.arange(motion.last) + 0.5) / motion.last
    return share


def _accel_slope(across: Floats, middle: Floats, force: Floats, back: Floats) -> Floats:
    """Return the change of a window's direction of up with the accelerometers' bias and gain, (2, 12)."""
    turned = across @ middle.mean(axis=0) @ back  # (2, 3)
    mean = force.mean(axis=0)
    return -np.concatenate([turned, (turned[:, :, None] * mean).reshape(2, 9)], axis=1)


def _unit(vector: Floats) -> Floats:
    return vector / np.linalg.norm(vector)


def across_of(up: Floats) -> Floats:
    """Return two unit vectors at right angles to a direction and to each other, (2, 3)."""
    first = _unit(_cross(up)[:, int(np.argmin(np.abs(up)))])
    return np.stack([first, _unit(_cross(up) @ first)])


def _cross(vector: Floats) -> Floats:
    """Return the matrix of the product vector × other, (3, 3)."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
