"""Finite-order processes as a filter takes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.stochastic.processes import GaussMarkov
    from imuwb.stochastic.sums import Sum


@dataclass(frozen=True, eq=False, slots=True)
class StateSpace:
    """One process, in steps of dt: x(k+1) = A x(k) + w, cov(w) = Q; output c x + v, var(v) = R.

    ``P0`` is the covariance of x at the start: the stationary one where there is one.
    """

    A: NDArray[np.float64]  #: (p, p)
    Q: NDArray[np.float64]  #: (p, p)
    c: NDArray[np.float64]  #: (p,)
    R: float
    P0: NDArray[np.float64]  #: (p, p)

    @property
    def order(self) -> int:
        """Return the number of states."""
        return self.A.shape[0]


@dataclass(frozen=True, slots=True)
class FlickerApproximation:
    """A sum of Gauss-Markov processes in the place of flicker noise, good within a band only."""

    processes: Sum
    band: tuple[float, float]  #: Hz
    largest_error: float  #: of the spectral density within the band, relative


def white(variance: float) -> StateSpace:
    """Return white noise of that variance per sample: no state."""
    none = np.zeros((0, 0))
    return StateSpace(none, none, np.zeros(0), variance, none)


def joined(parts: tuple[StateSpace, ...]) -> StateSpace:
    """Return the sum of independent processes: block-diagonal A, Q and P0, c one behind the other."""
    order = sum(part.order for part in parts)
    a, q, p = np.zeros((3, order, order))
    at = 0
    for part in parts:
        block = slice(at, at + part.order)
        a[block, block], q[block, block], p[block, block] = part.A, part.Q, part.P0
        at += part.order
    c = np.concatenate([part.c for part in parts]) if parts else np.zeros(0)
    return StateSpace(a, q, c, sum(part.R for part in parts), p)


def gauss_markov_bank(level: float, band: tuple[float, float], states: int) -> tuple[tuple[GaussMarkov, ...], float]:
    """Return first-order Gauss-Markov processes whose summed spectrum is level/f in a band, and its error.

    Corner frequencies stand evenly on the log axis from edge to edge; with all variances equal the sum
    is 1/f by symmetry, and one common factor makes the largest relative error within the band smallest.
    """
    from imuwb.stochastic.processes import GaussMarkov  # noqa: PLC0415 - processes use this module

    corners = np.geomspace(band[0], band[1], states) if states > 1 else np.array([np.sqrt(band[0] * band[1])])
    f = np.geomspace(*band, 200)
    # two-sided: 2 s² T / (1 + (2 pi f T)²) with T = 1/(2 pi corner)
    shape = (1 / (np.pi * corners)) / (1 + (f[:, None] / corners) ** 2)
    # non-negative least squares of the ratio to 1/f
    from scipy.optimize import nnls  # noqa: PLC0415 - scipy.optimize is slow to import

    variances, _ = nnls(shape * f[:, None] / level, np.ones(f.size))
    ratio = (shape @ variances) * f / level
    scale = 2 / (ratio.min() + ratio.max())
    chosen = tuple(
        GaussMarkov(float(np.sqrt(v * scale)), float(1 / (2 * np.pi * corner)))
        for v, corner in zip(variances, corners, strict=True)
        if v > 0
    )
    return chosen, float(np.abs(ratio * scale - 1).max())
