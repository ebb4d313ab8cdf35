"""A test of whether a record's noise is stationary: the Allan deviations of its parts are compared.

L. Galleani and P. Tavella (2009), "The dynamic Allan variance", show the parts; the test is added here. The Allan variance of a
part is about a scaled chi-square, so Bartlett's test of equal variances applies at each averaging time much shorter than a part.
"""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.identification.allan_variance.overlapping import allan
from imuwb.identification.spectral.welch import independent, welch
from imuwb.statistics.distributions import chi_square_tail
from imuwb.texts import number_text, seconds_text

FEWEST_DEGREES = 15.0  #: least degrees of freedom of a part's Allan variance
FEWEST = 64  #: least number of samples in a part
REFUSED = 0.01  #: probability, over all averaging times, below which a record is not stationary
SEGMENT = 1 << 13  #: samples of a segment of the spectrum that shows the correlation of neighbouring samples
SHORT = SEGMENT // 16  #: longest averaging factor for which that spectrum is fine enough


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Stationarity:
    """The Allan deviations of a record's parts, and whether they could be of one process."""

    start: Floats  #: (w,) s, begin of each part
    length: float  #: s, of a part
    averaging_time: Floats  #: (k,) s
    deviation: Floats  #: (w, k)
    probability: Floats  #: (k,) probability that chance makes the parts differ as much
    stationary: bool
    smallest: float  #: probability over all averaging times (Bonferroni)
    worst_part: int  #: index of the part that differs most
    worst_time: float  #: s, averaging time at which it differs most
    worst_ratio: float  #: ratio of its deviation to that of all parts, at that time

    def __repr__(self) -> str:
        """Return the verdict, and the part that differs most if the record is not stationary."""
        if self.stationary:
            return f"stationary: {self.start.size} parts of {seconds_text(self.length)} are alike (p = {self.smallest:.2g})"
        return (
            f"not stationary (p = {self.smallest:.2g}): the part from {seconds_text(float(self.start[self.worst_part]))} has "
            f"{self.worst_ratio:.2g} times the usual Allan deviation at {number_text(self.worst_time)} s"
        )


def stationarity(values: Floats, dt: float, parts: int = 12) -> Stationarity:
    """Return the test of whether the parts of a record have the noise of one process.

    Args:
        values: (n,) evenly spaced samples.
        dt: s.
        parts: number of parts, of equal length.

    Raises:
        ValueError: fewer than two parts, parts of fewer than 64 samples, or a constant channel.
    """
    size = values.size // parts if parts > 1 else 0
    if size < FEWEST:
        raise ValueError(f"{parts} parts of {size} samples; the test needs at least 2 parts of {FEWEST}")
    if np.ptp(values) == 0:
        raise ValueError("the channel is constant, so its parts have no noise to compare")
    curves = [allan(values[i * size : (i + 1) * size], dt, "octave", fast=True) for i in range(parts)]
    deviation = np.array([curve.deviation for curve in curves])
    # All parts get one noise type, because each part's own guess would depend on its value.
    freedom = np.median([curve.degrees_of_freedom for curve in curves], axis=0) * np.ones((parts, 1))
    short = curves[0].factor <= SHORT
    freedom[:, short] = np.minimum(freedom[:, short], _freedom(values, dt, curves[0].factor[short], size))
    sure = (freedom[0] >= FEWEST_DEGREES) & (deviation > 0).all(axis=0)
    if not sure.any():
        raise ValueError("the parts are too short for any averaging time, or constant; take fewer parts")
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


def _freedom(values: Floats, dt: float, factors: Integers, part: int) -> Floats:
    """Return the degrees of freedom of a part's Allan variance, from the record's own spectrum.

    After a sensor's own filter, neighbouring samples are correlated, which a power law neglects. The degrees of freedom are
    2 T (int W)²/int W², where W is the density of the differences that are squared.
    """
    size = min(SEGMENT, 1 << max(part // 4, 2).bit_length() - 1)
    density, count = welch(values, dt, size)
    segments = independent(count)
    f = np.arange(1, density.size) / size  # of the sampling rate
    window = np.sin(np.pi * np.outer(factors, f)) ** 4 / np.sin(np.pi * f) ** 2 * density[1:]
    # The scatter of the estimated density makes its squares too large.
    squares = (window**2).sum(axis=1) / (1 + 1 / segments)
    return 2 * part / size * window.sum(axis=1) ** 2 / squares
