"""Whether a record's noise stays the same: the Allan deviation of its parts, compared (dynamic Allan variance).

L. Galleani and P. Tavella (2009), "The dynamic Allan variance", draw it; here it is tested as well. Each part's Allan variance is
about a scaled chi-square, so Bartlett's test of equal variances applies at every averaging time that is short against a part.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.identification.allan_variance.overlapping import allan
from imuwb.identification.spectral.welch import independent, welch
from imuwb.statistics.distributions import chi_square_tail

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

FEWEST_DEGREES = 15.0  #: of freedom of a part's Allan variance
FEWEST = 64  #: samples of a part
REFUSED = 0.01  #: probability, over all averaging times, below which a record is not called stationary


SEGMENT = 1 << 13  #: samples, of the spectrum that tells how neighbouring samples hang together
SHORT = SEGMENT // 16  #: longest averaging factor that it tells of


@dataclass(frozen=True, eq=False, slots=True)
class Stationarity:
    """The Allan deviation of a record's parts, and a verdict."""

    start: Floats  #: (w,) s, where a part begins
    length: float  #: s, of a part
    averaging_time: Floats  #: (k,) s
    deviation: Floats  #: (w, k)
    probability: Floats  #: (k,) of parts that differ as much by chance
    stationary: bool
    smallest: float  #: probability over all averaging times (Bonferroni)
    worst_part: int  #: that stands out most
    worst_time: float  #: s, at this averaging time
    worst_ratio: float  #: of its deviation to all parts' there


def stationarity(values: Floats, dt: float, parts: int = 12) -> Stationarity:
    """Return the Allan deviations of a record's parts, and whether they could be of one process.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        parts: of equal length.

    Raises:
        ValueError: fewer than two parts, parts of fewer than 64 samples, or a constant channel.
    """
    size = values.size // parts if parts > 1 else 0
    if size < FEWEST:
        message = f"{parts} parts of {size} samples; there must be at least 2, of {FEWEST}"
        raise ValueError(message)
    if np.ptp(values) == 0:
        message = "the channel is constant: there is nothing to compare"
        raise ValueError(message)
    curves = [allan(values[i * size : (i + 1) * size], dt, "octave", fast=True) for i in range(parts)]
    deviation = np.array([curve.deviation for curve in curves])
    # One noise type for all parts: each part's own guess would go with its value.
    freedom = np.median([curve.degrees_of_freedom for curve in curves], axis=0) * np.ones((parts, 1))
    short = curves[0].factor <= SHORT
    freedom[:, short] = np.minimum(freedom[:, short], _freedom(values, dt, curves[0].factor[short], size))
    sure = (freedom[0] >= FEWEST_DEGREES) & (deviation > 0).all(axis=0)
    if not sure.any():
        message = "no averaging time is short against the parts, or the channel is constant"
        raise ValueError(message)
    variance, nu = deviation[:, sure] ** 2, freedom[:, sure]
    pooled = (nu * variance).sum(axis=0) / nu.sum(axis=0)
    statistic = nu.sum(axis=0) * np.log(pooled) - (nu * np.log(variance)).sum(axis=0)
    correction = 1 + ((1 / nu).sum(axis=0) - 1 / nu.sum(axis=0)) / (3 * (parts - 1))
    probability = chi_square_tail(statistic / correction, parts - 1)
    smallest = float(min(probability.min() * probability.size, 1.0))
    at = int(np.argmin(probability))
    ratio = variance[:, at] / pooled[at]
    part = int(np.argmax(np.abs(np.log(ratio))))
    tau = curves[0].averaging_time[sure]
    return Stationarity(
        np.arange(float(parts)) * (size * dt), size * dt, tau, deviation[:, sure], probability, smallest > REFUSED, smallest,
        part, float(tau[at]), float(ratio[part] ** 0.5),
    )  # fmt: skip


def _freedom(values: Floats, dt: float, factors: NDArray[np.int64], part: int) -> Floats:
    """Return the degrees of freedom of a part's Allan variance, from the record's own spectrum.

    A power law does not know of a sensor's filter, behind which neighbouring samples say the same: 2 T (int W)²/int W², with
    W the density of the differences that are squared.
    """
    size = min(SEGMENT, 1 << max(part // 4, 2).bit_length() - 1)
    density, count = welch(values, dt, size)
    segments = independent(count)
    f = np.arange(1, density.size) / size  # of the sampling rate
    window = np.sin(np.pi * np.outer(factors, f)) ** 4 / np.sin(np.pi * f) ** 2 * density[1:]
    # The estimate's own scatter makes the squares too large.
    squares = (window**2).sum(axis=1) / (1 + 1 / segments)
    return 2 * part / size * window.sum(axis=1) ** 2 / squares
