"""Modified, Hadamard and total deviations: the Allan deviation's relatives (NIST SP 1065, 5.2).

The modified deviation separates quantization from white noise. The Hadamard deviation does not see a ramp. The total deviation has
more degrees of freedom at the longest averaging times. All integrate samples of a rate.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Literal

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.compiled import compiled
from imuwb.identification.allan_variance.averaging import averaging_factors
from imuwb.identification.allan_variance.overlapping import AllanDeviation, allan, integrated
from imuwb.statistics.distributions import chi_square_limits

Kind = Literal["allan", "modified", "hadamard", "total"]
QUANTIZED = 2  #: alpha of quantization noise
SCALED = 16  #: averaging factor above which degrees of freedom depend on n/m only
MOST_CLUSTERS = 256  #: n/m above which degrees of freedom grow in proportion to n/m
#: alpha -> (b, c, a): degrees of freedom b T/tau - c of the total deviation, and bias factor 1 - a tau/T (SP 1065, table 9)
_TOTAL = {
    2: (1.5, 0.0, 0.0),
    1: (1.5, 0.0, 0.0),
    0: (1.5, 0.0, 0.0),
    -1: (1.17, 0.22, 1 / (3 * np.log(2))),
    -2: (0.93, 0.36, 0.75),
}


def deviation(
    values: Floats,
    dt: float,
    kind: Kind = "allan",
    averaging_times: str | Sequence[float] = "octave",
    *,
    level: float = 0.95,
) -> AllanDeviation:
    """Return a deviation of an evenly spaced record without gaps, with intervals by degrees of freedom.

    Args:
        values: (n,) samples of a rate or specific force.
        dt: s.
        kind: ``"allan"``, ``"modified"``, ``"hadamard"`` or ``"total"``.
        averaging_times: as for ``allan``; those of the modified and Hadamard deviations end at a third of the record.
        level: confidence level of the intervals.

    Raises:
        ValueError: too few samples, or no averaging time within the record.
    """
    plain = allan(values, dt, averaging_times, level=level)
    if kind == "allan":
        return plain
    phase = integrated(values)
    factor = averaging_factors(averaging_times, values.size, dt)
    span = 2 if kind == "total" else 3
    factor = factor[factor <= (phase.size - 1) // span]
    if not factor.size:
        raise ValueError(f"{values.size} samples have no {kind} deviation at these averaging times; take shorter times")
    noise = plain.noise_type[np.isin(plain.factor, factor)]
    terms = np.maximum(phase.size - span * factor, 1)
    if kind == "total":
        squares, terms = _total(phase, factor), np.full(factor.size, phase.size - 2)
        variance = squares / (2 * factor.astype(np.float64) ** 2 * terms)
        ratio = values.size / factor
        b, c, a = (np.array([_TOTAL[int(alpha)][k] for alpha in noise]) for k in range(3))
        variance, freedom = variance / (1 - a / ratio), (b * ratio - c).clip(0.5)
    else:
        modified = kind == "modified"
        terms = terms + modified  # the running sum of the phase has one more point
        # The sum of m successive second differences is a third difference of the phase's running sum.
        squares = _hadamard(integrated(phase) if modified else phase, factor)
        scale = 2.0 * factor.astype(np.float64) ** 4 if modified else 6.0 * factor.astype(np.float64) ** 2
        variance = squares / (scale * terms)
        freedom = np.array(
            [_freedom(kind, int(m), values.size, int(alpha)) for m, alpha in zip(factor, noise, strict=True)]
        )
    sigma = np.sqrt(variance)
    lower, upper = (sigma * np.sqrt(factor) for factor in chi_square_limits(level, freedom))
    return AllanDeviation(
        values.size, dt, level, factor, factor.astype(np.float64) * dt, sigma, lower, upper, freedom, noise, terms
    )


@compiled(reorder=True)
def _third(a: Floats, b: Floats, c: Floats, d: Floats) -> float:  # pragma: no cover - compiled
    """Return the sum of (d - 3 c + 3 b - a)²."""
    total = 0.0
    for k in range(d.size):
        z = d[k] - 3.0 * (c[k] - b[k]) - a[k]
        total += z * z
    return total


def _hadamard(phase: Floats, factors: Integers) -> Floats:
    n = phase.size
    return np.array(
        [_third(phase[: n - 3 * m], phase[m : n - 2 * m], phase[2 * m : n - m], phase[3 * m :]) for m in factors]
    )


def _total(phase: Floats, factors: Integers) -> Floats:
    """Return the sums of squared second differences at all inner points, with the phase mirrored at its ends."""
    n = phase.size
    out = np.zeros(factors.size)
    for i, m in enumerate(factors):
        before = 2 * phase[0] - phase[m:0:-1]
        after = 2 * phase[-1] - phase[-2 : -m - 2 : -1]
        whole = np.concatenate([before, phase, after])
        middle = whole[m + 1 : m + n - 1]
        out[i] = float(np.sum((whole[1 : n - 1] - 2 * middle + whole[2 * m + 1 : 2 * m + n - 1]) ** 2))
    return out


@lru_cache(maxsize=4096)
def _freedom(kind: Kind, factor: int, n: int, alpha: int) -> float:
    """Return the degrees of freedom, 2 E²/var, of a mean of squared differences, from the density of the differences.

    The autocovariance R of the differences is the transform of their density. The variance of the mean of M squares is
    2 sum (M - |l|) R(l)²/M². Above a factor of 16 only n/m matters.
    """
    m = min(factor, SCALED)
    clusters = n / factor
    size = round(min(clusters, MOST_CLUSTERS) * m)
    terms = max(size + 1 - 3 * m, 1)
    length = 1 << (8 * size).bit_length()
    f = (np.arange(length // 2) + 0.5) / length  # at half-integer frequencies, because 1/f² has no value at 0
    step = 2 * np.sin(np.pi * f)  # gain of one difference
    wide = 2 * np.sin(np.pi * f * m)
    # The phase is the sum of a rate of density f^alpha; aliasing turns f into a sine.
    density = step ** float(alpha) / step**2 * wide**6
    if kind == "modified":
        density = density / step**2
    lags = np.arange(terms)
    spectrum = np.zeros(length, dtype=np.complex128)
    spectrum[: length // 2] = density
    covariance = (np.fft.ifft(spectrum)[:terms] * np.exp(1j * np.pi * lags / length)).real
    weights = 2.0 * (terms - lags)
    weights[0] = terms
    freedom = terms**2 * covariance[0] ** 2 / float(weights @ covariance**2)
    # In differences of independent noise, all terms have about equal weight.
    if alpha == QUANTIZED and kind == "hadamard":
        return float(freedom * max(n + 1 - 3 * factor, 1) / terms)
    return float(freedom * max(clusters / MOST_CLUSTERS, 1.0))
