"""Scratch of the filter's compiled loops: what one thread needs, made once."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from imuwb.navigation.strapdown import SIZE
from imuwb.navigation.tables import MOST_ROWS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


MOST_STATES = 48  #: of a filter
STRIDE = 48  #: of a matrix's flat rows: numbers from one to the next, known when the loops are compiled


class Weighing(NamedTuple):
    """Of one event taken in: what is found, and what is on the way."""

    innovation: Floats  #: (6,) m and m/s, measured less predicted; nan where nothing is measured
    deviation: Floats  #: (6,) its sigma
    nis: Floats  #: (2,) of position and velocity
    used: NDArray[np.bool_]  #: (2,)
    refused: NDArray[np.int64]  #: (2,) how many positions and velocities were refused one behind the other
    rows: Floats  #: (6, n) how residuals depend on the error states
    residual: Floats  #: (6,)
    error: Floats  #: (n,) estimated so far
    guess: Floats  #: (n,) the same, of a group that is tried
    gain: Floats  #: (n,)
    tried: Floats  #: flat rows of its covariance
    turn: Floats  #: (3, 3) C_b_n
    arm: Floats  #: (3,) m NED
    swing: Floats  #: (3,) m/s NED


class Workspace(NamedTuple):
    """Of a run; zero outside what is used."""

    product: Floats  #: flat rows
    weights: Floats  #: (MOST_STATES,)
    transition: Floats  #: flat rows, product of the transition matrices since it was the identity; empty: not wanted
    error: Floats  #: (6,) of the axes
    moved: Floats  #: (MOST_STATES,)
    spare: Floats  #: flat rows of a covariance that is only looked at
    seen: Floats  #: (SIZE,) a state likewise
    weighing: Weighing


def workspace(n: int, *, transition: bool = False) -> Workspace:
    """Return scratch for a filter of n error states; with a place for the transition matrix, if a smoother wants it."""
    weighing = Weighing(
        np.zeros(6), np.zeros(6), np.zeros(2), np.zeros(2, np.bool_), np.zeros(2, np.int64), np.zeros((MOST_ROWS, n)),
        np.zeros(MOST_ROWS), np.zeros(n), np.zeros(n), np.zeros(n), _rows(), np.zeros((3, 3)), np.zeros(3), np.zeros(3),
    )  # fmt: skip
    return Workspace(
        _rows(), np.zeros(MOST_STATES), _rows() if transition else np.zeros(0), np.zeros(6), np.zeros(MOST_STATES), _rows(),
        np.zeros(SIZE), weighing,
    )  # fmt: skip


def _rows() -> Floats:
    return np.zeros(MOST_STATES * STRIDE)
