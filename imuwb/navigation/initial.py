"""The prior of an axis's states when the filter starts, and its relation to the mean error over a standstill."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.navigation.shaping import Shaping, over


@dataclass(frozen=True, eq=False, slots=True)
class AxisStart:
    """The prior of an axis's p states when the filter starts, and of the axis's mean error over an earlier standstill."""

    covariance: Floats  #: (p, p) of the states
    cross: Floats  #: (p,) covariance of the states and the mean
    variance: float  #: variance of the mean, without the part of white noise


def axis_start(shaping: Shaping, before: int, still: int, after: int) -> AxisStart:
    """Return the prior of an axis's states when the filter starts.

    Args:
        shaping: the axis's shaping filter; at the log's start its states have the covariance ``P0``.
        before: samples from the log's start to the standstill.
        still: samples of the standstill; 0: there is none.
        after: samples from the end of the standstill to the start of the filter.
    """
    p = shaping.order
    a, q = shaping.over(before)
    start = np.zeros((p + 1, p + 1))
    start[:p, :p] = a @ shaping.P0 @ a.T + q
    transition, noise = over(*shaping.with_sum(), still)
    joint = transition @ start @ transition.T + noise
    a, q = shaping.over(after)
    count = max(still, 1)
    return AxisStart(a @ joint[:p, :p] @ a.T + q, a @ joint[:p, p] / count, float(joint[p, p]) / count**2)
