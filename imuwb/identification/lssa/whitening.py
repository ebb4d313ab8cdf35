"""Whitening: rows in which noise of a known structure is independent and of equal size, C^-1 = W' W, without forming C.

* ``Chain``: each sample depends on the one before, over any step: white (with weights), first-order Gauss-Markov, AR(1), random
  walk.
* ``Recursion``: AR(p) on an even lattice; only rows whose p predecessors exist.
* ``Dense``: any covariance.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy import linalg

from imuwb.arrays import Complexes, Floats, Integers

MOST_DENSE = 20_000  #: largest number of samples with a given covariance
CONDITION = 1e-12  #: share of the largest variance; a covariance with a smaller pivot is singular


@dataclass(frozen=True, eq=False, slots=True)
class Chain:
    """Row i is scale_i (x_i - hold_i x_(i-1))."""

    hold: Floats  #: (n,) 0 ... 1; 0 for the first sample
    scale: Floats  #: (n,); 0 for a row without information

    def rows(self, columns: Floats) -> Floats:
        """Return the whitened rows of (n, k)."""
        rows = columns * self.scale[:, None]
        if not self.plain:
            rows[1:] -= (self.scale * self.hold)[1:, None] * columns[:-1]
        return rows

    def back(self, rows: Floats) -> Floats:
        """Return W' times (n, k) rows."""
        back = rows * self.scale[:, None]
        if not self.plain:
            back[:-1] -= self.hold[1:, None] * back[1:]
        return back

    @property
    def count(self) -> int:
        """Return the number of rows with information."""
        return int(np.count_nonzero(self.scale))

    @property
    def plain(self) -> bool:
        """Return whether samples are independent."""
        return not self.hold.any()


@dataclass(frozen=True, eq=False, slots=True)
class Recursion:
    """Row i is x_i + sum alpha_k x_(i-k)."""

    alpha: Floats  #: (p,) alpha of Quinchia's eq. 9
    interval: float  #: s
    kept: Integers  #: samples whose p predecessors exist

    def rows(self, columns: Floats) -> Floats:
        """Return the whitened rows of (n, k)."""
        rows = columns[self.kept].copy()
        for k, alpha in enumerate(self.alpha, 1):
            rows += alpha * columns[self.kept - k]
        return rows

    def gain(self, frequency: Floats) -> Complexes:
        """Return the gain of the rows at exp(i omega t)."""
        turn = np.exp(-2j * np.pi * np.outer(np.arange(1, self.alpha.size + 1), frequency * self.interval))
        return np.asarray(1 + self.alpha @ turn, dtype=np.complex128)

    @property
    def count(self) -> int:
        """Return the number of rows."""
        return self.kept.size


@dataclass(frozen=True, eq=False, slots=True)
class Dense:
    """The rows are L^-1 x with C = L L'."""

    factor: Floats  #: (n, n) L

    def rows(self, columns: Floats) -> Floats:
        """Return the whitened rows of (n, k)."""
        return np.asarray(linalg.solve_triangular(self.factor, columns, lower=True, check_finite=False))

    @property
    def count(self) -> int:
        """Return the number of rows."""
        return len(self.factor)


Whitening: TypeAlias = Chain | Recursion | Dense


def white(n: int, weights: Floats | None = None) -> Chain:
    """Return the rows of independent samples.

    Args:
        n: samples.
        weights: (n,) inverse variances, up to a common factor; 0: the sample is ignored.
    """
    return Chain(np.zeros(n), np.ones(n) if weights is None else np.sqrt(weights))


def random_walk(time: Floats) -> Chain:
    """Return the rows of a random walk, which are its steps; its level is unknown.

    Args:
        time: (n,) s, rising.
    """
    hold, scale = np.ones(time.size), np.zeros(time.size)
    hold[0] = 0.0
    scale[1:] = 1 / np.sqrt(np.diff(time))
    return Chain(hold, scale)


def gauss_markov(time: Floats, correlation_time: float) -> Chain:
    """Return the rows of a first-order Gauss-Markov process of variance 1.

    Args:
        time: (n,) s, rising.
        correlation_time: s.
    """
    passed = np.concatenate([[np.inf], np.diff(time) / correlation_time])
    return Chain(np.exp(-passed), 1 / np.sqrt(-np.expm1(-2 * passed)))


def first_order(steps: Integers, alpha: float) -> Chain:
    """Return the rows of AR(1), x(n) = -alpha x(n-1) + w(n), with or without gaps.

    Args:
        steps: (n - 1,) whole numbers of intervals between samples.
        alpha: between -1 and 1.
    """
    hold = np.concatenate([[0.0], (-alpha) ** steps])
    return Chain(hold, 1 / np.sqrt(1 - hold**2))


def recursion(index: Integers, interval: float, alpha: Floats) -> Recursion:
    """Return the rows of AR(p) on a lattice.

    Raises:
        ValueError: gaps leave less than half of the rows.
    """
    p = alpha.size
    kept = np.arange(p, index.size)
    kept = kept[index[p:] - index[: index.size - p] == p]
    if 2 * kept.size < index.size:
        raise ValueError(
            f"AR({p}) needs {p} consecutive samples before each sample: gaps leave {kept.size} of {index.size} rows; "
            "use AR(1) or Gauss-Markov noise, which allow gaps"
        )
    return Recursion(alpha, interval, kept)


def dense(covariance: Floats) -> Dense:
    """Return the rows of a covariance.

    Raises:
        ValueError: the covariance is not square, too large, not symmetric, not finite, or singular.
    """
    n = len(covariance)
    if covariance.shape != (n, n) or n > MOST_DENSE:
        raise ValueError(
            f"the covariance is {' x '.join(map(str, covariance.shape))}; it must be square, with at most {MOST_DENSE} rows"
        )
    scale = float(np.abs(np.diagonal(covariance)).max())
    if not np.isfinite(covariance).all() or not np.abs(covariance - covariance.T).max() <= 1e-9 * scale:
        raise ValueError("the covariance must be symmetric and finite")
    try:
        factor = np.asarray(linalg.cholesky(covariance, lower=True, check_finite=False))
    except linalg.LinAlgError as error:
        raise ValueError(
            f"the covariance is not positive definite: {error}; some combination of samples would have no noise"
        ) from error
    if np.diagonal(factor).min() ** 2 < CONDITION * scale:
        raise ValueError(
            "the covariance is singular within rounding errors; some combination of samples would have no noise"
        )
    return Dense(factor)
