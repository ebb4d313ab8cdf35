"""Is the noise a random walk, is it autoregressive of some order? Two tests of what whitening leaves, taken together.

If the structure is right, whitened rows are independent. Short lags are looked at by the correlations of the first twenty
(Ljung and Box 1978), slow drifts by the powers in octaves of frequency, which must be equal (Bartlett 1937). The smaller
probability counts, twice for having two.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

from imuwb.identification.correlation.burg import burg
from imuwb.statistics.distributions import chi_square_tail, normal_limit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

LAGS = 20
FIRST_OCTAVE = 4  #: frequencies in the lowest band


@dataclass(frozen=True, slots=True)
class ChiSquare:
    """A statistic, and how probable one as large is if the structure is right."""

    value: float
    freedom: int
    probability: float


@dataclass(frozen=True, eq=False, slots=True)
class Hypothesis:
    """A structure of the noise, and whether it is tenable."""

    name: str  #: "random walk" or "AR(p)"
    order: int  #: p; 0 of the random walk
    tenable: bool
    p_value: float
    correlations: ChiSquare  #: of short lags (Ljung and Box)
    octaves: ChiSquare  #: of slow drifts (Bartlett)
    alpha: Floats  #: (p,) x(n) = -sum alpha x(n-k) + w(n)
    sigma: Floats  #: (p,) standard errors if the structure is right
    octave_frequency: Floats  #: (b,) cycles a sample, middle of each octave
    octave_power: Floats  #: (b,) of the whitened rows over the mean of all: 1 if the structure is right

    @property
    def coefficient(self) -> float | None:
        """Return El-Diasty's C of b(k+1) = C b(k) + e, which is -alpha; None but for AR(1)."""
        return -float(self.alpha[0]) if self.order == 1 else None


def is_random_walk(values: Floats, level: float = 0.99) -> Hypothesis:
    """Return whether a series may be a random walk: its steps are then independent.

    Args:
        values: (n,) evenly spaced, without constituents.
        level: 1 - the probability of refusing a random walk.
    """
    return _tested("random walk", 0, np.diff(values), np.empty(0), level, 0)


def is_autoregressive(values: Floats, order: int, level: float = 0.99) -> Hypothesis:
    """Return whether a series may be AR(p): its innovations are then independent.

    Args:
        values: (n,) evenly spaced, without constituents.
        order: p.
        level: 1 - the probability of refusing what is AR(p).

    Raises:
        ValueError: fewer samples than the tests need, a constant series.
    """
    found = burg(values, order)
    alpha = found.alpha[order]
    rows = np.convolve(values - found.mean, np.concatenate([[1.0], alpha]), "valid")
    return _tested(f"AR({order})", order, rows, alpha, level, values.size)


def _tested(name: str, order: int, rows: Floats, alpha: Floats, level: float, n: int) -> Hypothesis:
    if rows.size < 8 * (LAGS + order):
        message = f"{rows.size} samples; tests of {LAGS} lags need at least {8 * (LAGS + order)}"
        raise ValueError(message)
    rows = rows - rows.mean()
    if not rows.any():
        message = "the series is constant, or its steps are: there is no noise to test"
        raise ValueError(message)
    correlations = _correlations(rows, order)
    frequency, power, octaves = _octaves(rows)
    p_value = min(1.0, 2 * min(correlations.probability, octaves.probability))
    sigma = _standard_errors(alpha, n) if order else np.empty(0)
    return Hypothesis(name, order, p_value > 1 - level, p_value, correlations, octaves, alpha, sigma, frequency, power)


def _correlations(rows: Floats, parameters: int) -> ChiSquare:
    """Return the statistic of the first lags' correlations (Ljung and Box)."""
    n, lags = rows.size, LAGS + parameters
    length = fft.next_fast_len(n + lags + 1, real=True)
    power = np.abs(fft.rfft(rows, length)) ** 2
    covariance = fft.irfft(power, length)[: lags + 1]
    r = covariance[1:] / covariance[0]
    return _chi_square(n * (n + 2) * float(np.sum(r**2 / (n - np.arange(1, lags + 1)))), lags - parameters)


def _chi_square(value: float, freedom: int) -> ChiSquare:
    return ChiSquare(value, freedom, float(chi_square_tail(value, freedom)))


def _octaves(rows: Floats) -> tuple[Floats, Floats, ChiSquare]:
    """Return the middle frequencies of octaves, their power, and the statistic of its being equal (Bartlett)."""
    power = np.abs(fft.rfft(rows)[1 : (rows.size + 1) // 2]) ** 2
    edges = [0, FIRST_OCTAVE]
    while 2 * edges[-1] < power.size:
        edges.append(2 * edges[-1])
    edges[-1] = power.size
    count = np.diff(edges)
    mean = np.add.reduceat(power, edges[:-1]) / count
    freedom = 2.0 * count
    whole = freedom.sum()
    pooled = float(freedom @ mean) / whole
    statistic = whole * np.log(pooled) - freedom @ np.log(mean)
    statistic /= 1 + (np.sum(1 / freedom) - 1 / whole) / (3 * (count.size - 1))
    middle = np.sqrt((np.array(edges[:-1]) + 1) * np.array(edges[1:])) / rows.size
    return middle, mean / pooled, _chi_square(float(statistic), count.size - 1)


def _standard_errors(alpha: Floats, n: int) -> Floats:
    """Return the standard errors of a true AR(p)'s coefficients: of AR(1), sqrt((1 - alpha²)/n)."""
    p = alpha.size
    full = np.concatenate([[1.0], alpha])
    errors = np.empty(p)
    for k in range(p):
        # n times the covariance's diagonal: products of the polynomial and its mirror (Box, Jenkins, Reinsel, 7A).
        i = np.arange(k + 1)
        errors[k] = np.sum(full[i] ** 2) - np.sum(full[p - i] ** 2)
    return np.sqrt(np.maximum(errors, 0.0) / n)


def words(hypothesis: Hypothesis, level: float, confidence: float = 0.95) -> str:
    """Return what a test says, in words."""
    p = f"p < {1e-4:g}" if hypothesis.p_value < 1e-4 else f"p = {hypothesis.p_value:.3g}"  # noqa: PLR2004 - as far as it matters
    if not hypothesis.tenable:
        return (
            f"not {'a ' if not hypothesis.order else ''}{hypothesis.name} ({p}, at the {100 * (1 - level):g} % level)"
        )
    said = f"{'a ' if not hypothesis.order else ''}{hypothesis.name} is tenable ({p})"
    if hypothesis.order == 1:
        half = normal_limit(confidence) * float(hypothesis.sigma[0])
        c = hypothesis.coefficient
        said += f", C = {c:.4f} ± {half:.4f}" if c is not None else ""
    return said
