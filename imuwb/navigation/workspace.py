"""Scratch memory of the filter's compiled loops: made once for each thread."""

from typing import NamedTuple

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.navigation.strapdown import SIZE
from imuwb.navigation.tables import MOST_ROWS

MOST_STATES = 48  #: largest number of error states of a filter
STRIDE = 48  #: numbers from one row to the next of a flat matrix; constant, so that the compiler knows all offsets


class Weighing(NamedTuple):
    """Results and scratch of one event's update."""

    innovation: Floats  #: (6,) m and m/s, measured minus predicted; nan: not measured
    deviation: Floats  #: (6,) sigma of the innovation
    nis: Floats  #: (2,) of position and velocity
    used: Booleans  #: (2,) whether position and velocity passed the gate
    refused: Integers  #: (5,) positions and velocities refused in a row, those accepted by force in a row, velocities that passed
    trend: Floats  #: (2, 5) of refused positions and velocities in a row: last residual, sum of squares, of products of neighbours
    rows: Floats  #: (6, n) derivatives of the residuals with respect to the error states
    residual: Floats  #: (6,) predicted minus measured
    error: Floats  #: (n,) error that the event has estimated so far
    guess: Floats  #: (n,) estimated error if the present group, position or velocity, passes the gate
    gain: Floats  #: (n,)
    tried: Floats  #: flat rows of the covariance if the present group passes the gate
    turn: Floats  #: (3, 3) C_b_n
    arm: Floats  #: (3,) m NED, the lever arm
    swing: Floats  #: (3,) m/s NED, velocity of the antenna relative to the IMU


class Workspace(NamedTuple):
    """Scratch of a run; zero outside the part in use."""

    product: Floats  #: flat rows
    weights: Floats  #: (MOST_STATES,)
    transition: Floats  #: flat rows, product of the transition matrices since the last event; empty: not wanted
    error: Floats  #: (6,) of the axes
    moved: Floats  #: (MOST_STATES,) an axis's states after a step
    spare: Floats  #: flat rows, copy of a covariance at a mark
    seen: Floats  #: (SIZE,) copy of a state at a mark
    weighing: Weighing


def workspace(n: int, *, transition: bool = False) -> Workspace:
    """Return scratch memory.

    Args:
        n: error states.
        transition: whether to make room for the transition matrix, which a smoother needs.
    """
    weighing = Weighing(
        np.zeros(6), np.zeros(6), np.zeros(2), np.zeros(2, np.bool_), np.zeros(5, np.int64), np.zeros((2, 5)),
        np.zeros((MOST_ROWS, n)),
        np.zeros(MOST_ROWS), np.zeros(n), np.zeros(n), np.zeros(n), _rows(), np.zeros((3, 3)), np.zeros(3), np.zeros(3),
    )  # fmt: skip
    return Workspace(
        _rows(), np.zeros(MOST_STATES), _rows() if transition else np.zeros(0), np.zeros(6), np.zeros(MOST_STATES), _rows(),
        np.zeros(SIZE), weighing,
    )  # fmt: skip


def _rows() -> Floats:
    return np.zeros(MOST_STATES * STRIDE)
