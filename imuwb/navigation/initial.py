"""What is known of an axis's states when a filter starts: they ran since the log began, and their mean was seen while it stood."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.navigation.shaping import over

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.navigation.shaping import Shaping

    Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class AxisStart:
    """States at the start, and how they go with the mean error over a stillness before."""

    covariance: Floats  #: (p, p) of the states
    cross: Floats  #: (p,) with the mean
    variance: float  #: of the mean, without white noise


def axis_start(one: Shaping, before: int, still: int, after: int) -> AxisStart:
    """Return what a model says of an axis's states at the start.

    Args:
        one: the axis's shaping filter; at the log's beginning its states have the covariance ``P0``.
        before: samples from there to the stillness.
        still: samples of the stillness; 0: there is none.
        after: samples from its end to the start.
    """
    p = one.order
    a, q = one.over(before)
    first = a @ one.P0 @ a.T + q
    # The sum of the errors is carried along as one more state.
    wide = np.zeros((p + 1, p + 1))
    wide[:p, :p], wide[p, :p], wide[p, p] = one.A, one.c @ one.A, 1.0
    noise = np.zeros((p + 1, p + 1))
    noise[:p, :p], noise[p, :p], noise[:p, p] = one.Q, one.c @ one.Q, one.Q @ one.c
    noise[p, p] = one.c @ one.Q @ one.c
    power, total = over(wide, noise, still)
    start = np.zeros((p + 1, p + 1))
    start[:p, :p] = first
    joint = power @ start @ power.T + total
    a, q = one.over(after)
    count = max(still, 1)
    return AxisStart(a @ joint[:p, :p] @ a.T + q, a @ joint[:p, p] / count, float(joint[p, p]) / count**2)
