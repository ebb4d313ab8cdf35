"""Means of still stretches, and what they are worth where noise is not white."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import special

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

PARTS = 4  #: of a stretch, whose means' scatter tells the error of the whole mean; each is parted so again
FEWEST = 4 * PARTS * PARTS  #: samples of a stretch
CHANCE = 0.05  #: at which white noise is called red
COARSE = 3  #: values of a stretch, or fewer: its noise no longer moves the mean between the sensor's steps


@dataclass(frozen=True, eq=False, slots=True)
class Means:
    """Means of P stretches of a triad, in the unit of its samples."""

    value: Floats  #: (P, 3)
    variance: Floats  #: (P, 3)
    freedom: Floats  #: (3,) of the variances of an axis
    red: tuple[bool, bool, bool]  #: axes whose slow noise counts


def means(stretches: Sequence[Floats]) -> Means:
    """Return the means of stretches, with variances that know slow noise.

    The quarters of each stretch scatter by the noise that their mean has, slow noise mostly included; all stretches tell
    of the same sensor, so that P stretches give 3 P degrees of freedom. Where quarters scatter by more than their own
    quarters explain (F test, 5 %), noise is not white: a longer mean is then no better. It has a quarter's variance, and
    more where that grows with length, as a random walk's does from sixteenths to quarters.

    Args:
        stretches: each (n, 3), evenly sampled at one rate, n at least 64.

    Raises:
        ValueError: no stretch, or one that is too short.
    """
    if not stretches or min(len(s) for s in stretches) < FEWEST:
        message = f"a stretch of {min((len(s) for s in stretches), default=0)} samples; its mean takes {FEWEST}"
        raise ValueError(message)
    value = np.stack([s.mean(axis=0) for s in stretches])
    sizes = np.array([len(s) for s in stretches], dtype=np.float64)[:, None]
    slow, fast = (np.stack(part) for part in zip(*map(_scatter, stretches), strict=True))
    # Variance of a sample if noise were white: the same for all stretches.
    long, short = (slow * sizes / PARTS).mean(axis=0), (fast * sizes / PARTS**2).mean(axis=0)
    freedom = (PARTS - 1) * len(stretches)
    limit = special.fdtri(freedom, PARTS * freedom, 1 - CHANCE)
    red = long > limit * short
    growth = np.clip(long / np.where(short > 0, short, np.inf) / PARTS, 1.0, PARTS**2)
    variance = np.where(red, slow.mean(axis=0) * growth, long / sizes) + np.stack([_rounding(s) for s in stretches])
    return Means(value, variance, np.full(3, float(freedom)), tuple(bool(r) for r in red))  # type: ignore[return-value]


def _scatter(values: Floats) -> tuple[Floats, Floats]:
    """Return the variances of means of quarters, and of sixteenths within a quarter, (3,) each."""
    size = len(values) // PARTS**2
    start = (len(values) - size * PARTS**2) // 2
    parts = values[start : start + size * PARTS**2].reshape(PARTS, PARTS, size, 3).mean(axis=2)
    return parts.mean(axis=1).var(axis=0, ddof=1), parts.var(axis=1, ddof=1).mean(axis=0)


def _rounding(values: Floats) -> Floats:
    """Return the variance of what rounding leaves in the mean, (3,), where noise is smaller than a step."""
    found = np.zeros(3)
    for axis in range(3):
        levels = np.unique(values[:, axis])
        if 1 < levels.size <= COARSE:
            found[axis] = float(np.diff(levels).min()) ** 2 / 12
    return found
