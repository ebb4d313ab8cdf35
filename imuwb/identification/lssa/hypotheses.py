"""Is the noise a random walk? Is it autoregressive of a given order? Two tests of the whitened series together.

If the structure is right, whitened samples are independent. The first test looks at the correlations of the first twenty lags
(Ljung and Box 1978), the second at the powers in octaves of frequency, which must be equal (Bartlett 1937). The first finds
short correlations, the second slow drifts. The p value is twice the smaller of both probabilities.
"""

from dataclasses import dataclass

import numpy as np
from scipy import fft

from imuwb.arrays import Floats
from imuwb.identification.correlation.burg import burg
from imuwb.statistics.distributions import chi_square_tail, normal_limit

LAGS = 20  #: number of lags in the test of correlations
FIRST_OCTAVE = 4  #: frequencies in the lowest octave
CLEAR = 1e-4  #: smaller p values are not printed


@dataclass(frozen=True, slots=True)
class ChiSquare:
    """A statistic, and the probability of a value at least as large if the structure is right."""

    value: float
    freedom: int
    probability: float


@dataclass(frozen=True, eq=False, slots=True)
class Hypothesis:
    """A structure of the noise, and whether the series agrees with it."""

    name: str  #: "random walk" or "AR(p)"
    order: int  #: p; 0 for the random walk
    tenable: bool
    p_value: float
    correlations: ChiSquare  #: test of the correlations of short lags (Ljung and Box)
    octaves: ChiSquare  #: test for slow drifts (Bartlett)
    alpha: Floats  #: (p,) x(n) = -sum alpha x(n-k) + w(n)
    sigma: Floats  #: (p,) standard errors if the structure is right
    octave_frequency: Floats  #: (b,) cycles per sample, middle of each octave
    octave_power: Floats  #: (b,) power of the whitened series over the mean of all octaves: 1 if the structure is right
    verdict: str  #: such as: AR(1) is tenable (p = 0.3), C = 0.80 ± 0.01

    @property
    def coefficient(self) -> float | None:
        """Return El-Diasty's C of b(k+1) = C b(k) + e, which is -alpha; None for an order other than 1."""
        return -float(self.alpha[0]) if self.order == 1 else None


def is_random_walk(values: Floats, level: float = 0.99) -> Hypothesis:
    """Return the test that a series is a random walk: its steps are then independent.

    Args:
        values: (n,) evenly spaced, without constituents.
        level: 1 - the probability of rejecting a true random walk.
    """
    return _tested("random walk", np.diff(values), np.empty(0), np.empty(0), level)


def is_autoregressive(values: Floats, order: int, level: float = 0.99, confidence: float = 0.95) -> Hypothesis:
    """Return the test that a series is AR(p): its innovations are then independent.

    Args:
        values: (n,) evenly spaced, without constituents.
        order: p.
        level: 1 - the probability of rejecting a true AR(p).
        confidence: level of the interval of C in the verdict.

    Raises:
        ValueError: fewer samples than the tests need, or a constant series.
    """
    fit = burg(values, order)
    alpha = fit.alpha[order]
    rows = np.convolve(values - fit.mean, np.concatenate([[1.0], alpha]), "valid")
    return _tested(f"AR({order})", rows, alpha, fit.standard_errors(order), level, confidence)


def _tested(
    name: str, rows: Floats, alpha: Floats, sigma: Floats, level: float, confidence: float = 0.95
) -> Hypothesis:
    order = alpha.size
    if rows.size < 8 * (LAGS + order):
        raise ValueError(f"{rows.size} samples; a test of {LAGS} lags needs at least {8 * (LAGS + order)}")
    rows = rows - rows.mean()
    if not rows.any():
        raise ValueError("the series is constant, or its steps are: there is no noise to test")
    correlations = _correlations(rows, order)
    frequency, power, octaves = _octaves(rows)
    p_value = min(1.0, 2 * min(correlations.probability, octaves.probability))
    tenable = p_value > 1 - level
    p = f"p < {CLEAR:g}" if p_value < CLEAR else f"p = {p_value:.3g}"
    verdict = f"{name if order else f'a {name}'} is tenable ({p})"
    if not tenable:
        verdict = f"not {name if order else f'a {name}'} ({p}, at the {100 * (1 - level):g} % level)"
    elif order == 1:
        verdict += f", C = {-alpha[0]:.4f} ± {normal_limit(confidence) * sigma[0]:.4f}"
    return Hypothesis(name, order, tenable, p_value, correlations, octaves, alpha, sigma, frequency, power, verdict)


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
    """Return the middle frequencies of octaves, their powers, and the statistic of equal powers (Bartlett)."""
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
