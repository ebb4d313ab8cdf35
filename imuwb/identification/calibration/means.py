"""Means of steady stretches, and their variances where the noise is not white."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from imuwb.arrays import Booleans, Floats

PARTS = 4  #: number of parts of a stretch, and again of each part; the scatter of their means gives the error of the whole mean
FEWEST = 4 * PARTS * PARTS  #: least number of samples in a stretch
CHANCE = 0.05  #: probability of a false alarm of the test for white noise
COARSE = 3  #: different values in a stretch; with no more, noise does not average out the rounding


@dataclass(frozen=True, eq=False, slots=True)
class Means:
    """Means of P stretches of a triad, in the unit of its samples."""

    value: Floats  #: (P, 3)
    variance: Floats  #: (P, 3)
    freedom: Floats  #: (3,) degrees of freedom of the variances of each axis
    red: tuple[bool, bool, bool]  #: axes whose noise is not white within a stretch


def means(stretches: Sequence[Floats]) -> Means:
    """Return the means of stretches, with variances that include slow noise.

    The scatter of the means of a stretch's quarters shows the noise of the mean, with most of the slow noise. All stretches are of
    one sensor, so P stretches give 3 P degrees of freedom. If the quarters scatter by more than the quarters of the quarters
    explain (F test, 5 %), the noise is not white, and a longer mean is no better. The mean then has the variance of a
    quarter's mean, increased by the growth from sixteenths to quarters, as for a random walk.

    Args:
        stretches: each (n, 3), evenly sampled at one common rate, n at least 64.

    Raises:
        ValueError: no stretch, or a stretch that is too short.
    """
    if not stretches or min(len(s) for s in stretches) < FEWEST:
        raise ValueError(f"a stretch of {min((len(s) for s in stretches), default=0)} samples; its mean needs {FEWEST}")
    value = np.stack([s.mean(axis=0) for s in stretches])
    variance, freedom, red = _noise(stretches)
    variance = variance + np.stack([_rounding(s) for s in stretches])
    return Means(value, variance, np.full(3, freedom), tuple(bool(r) for r in red))  # type: ignore[return-value]


def along(stretches: Sequence[Floats], directions: Floats, given: Means) -> Means:
    """Return means whose variance is that along one direction in each stretch, if it is smaller than the axes' variances make it.

    A hand that holds a sensor sways. Gravity then moves across the mean direction of up, by more than the noise, and this does not
    change the magnitude of the mean.

    Args:
        stretches: the samples, each (n, 3).
        directions: (P, 3) change of the magnitude with each axis.
        given: means of the same stretches.
    """
    variance, freedom, red = _noise([(s @ d)[:, None] for s, d in zip(stretches, directions, strict=True)])
    sizes = np.array([len(s) for s in stretches], dtype=np.float64)
    share = float((variance[:, 0] * sizes).sum() / ((directions**2 * given.variance).sum(axis=1) * sizes).sum())
    if share > special.fdtri(freedom, float(given.freedom.sum()), CHANCE):
        return given
    slow = bool(red[0])
    return Means(given.value, share * given.variance, np.full(3, freedom / 3), (slow, slow, slow))


def _noise(stretches: Sequence[Floats]) -> tuple[Floats, float, Booleans]:
    """Return the variances of means, (P, k), their degrees of freedom, and whether the noise is not white, (k,)."""
    sizes = np.array([len(s) for s in stretches], dtype=np.float64)[:, None]
    slow, fast = (np.stack(part) for part in zip(*map(_scatter, stretches), strict=True))
    # Variance of one sample if the noise were white: common to all stretches.
    long, short = (slow * sizes / PARTS).mean(axis=0), (fast * sizes / PARTS**2).mean(axis=0)
    freedom = (PARTS - 1) * len(stretches)
    limit = special.fdtri(freedom, PARTS * freedom, 1 - CHANCE)
    red = long > limit * short
    growth = np.clip(long / np.where(short > 0, short, np.inf) / PARTS, 1.0, PARTS**2)
    return np.where(red, slow.mean(axis=0) * growth, long / sizes), float(freedom), red


def _scatter(values: Floats) -> tuple[Floats, Floats]:
    """Return the variance between the means of quarters, and between those of sixteenths within a quarter, (k,) each."""
    size = len(values) // PARTS**2
    start = (len(values) - size * PARTS**2) // 2
    parts = values[start : start + size * PARTS**2].reshape(PARTS, PARTS, size, -1).mean(axis=2)
    return parts.mean(axis=1).var(axis=0, ddof=1), parts.var(axis=1, ddof=1).mean(axis=0)


def _rounding(values: Floats) -> Floats:
    """Return the variance of the mean's rounding error, (3,), where the noise is smaller than a step of the sensor."""
    rounding = np.zeros(3)
    for axis in range(3):
        levels = np.unique(values[:, axis])
        if 1 < levels.size <= COARSE:
            rounding[axis] = float(np.diff(levels).min()) ** 2 / 12
    return rounding
