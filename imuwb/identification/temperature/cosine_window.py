"""Cosine coefficients of series that were smoothed by a Gaussian window, as they were before it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import fft

from imuwb.arrays import Floats

SEEN = 0.2  #: least factor of the window on a coefficient that is used
ENDS = 2.0  #: windows at each end of the record that are left out: half of a window there has no readings, so noise dominates
FEWEST = 50  #: coefficients that are used in any case


@dataclass(frozen=True, eq=False, slots=True)
class CosineWindow:
    """A Gaussian window over a series of means, and the cosine coefficients that it lets through."""

    width: float  #: s, its sigma
    interval: float  #: s, of a mean
    inside: slice  #: means away from the ends of the record
    frequency: Floats  #: (m,) rad/s, of the coefficients that are used
    factor: Floats  #: (m,) of the window on them

    @staticmethod
    def of(length: int, interval: float, width: float) -> "CosineWindow":
        """Return a window of a width (s) over a series of ``length`` means of ``interval`` s each."""
        ends = min(int(np.ceil(ENDS * width / interval)), length // 8)
        frequency = _frequencies(length - 2 * ends, interval)[1:]
        factor = _factors(frequency, width)
        kept = max(int(np.count_nonzero(factor > SEEN)), min(FEWEST, factor.size))
        return CosineWindow(width, interval, slice(ends, length - ends), frequency[:kept], factor[:kept])

    @property
    def length(self) -> int:
        """Return the number of means inside."""
        return self.inside.stop - self.inside.start

    def cosines(self, smoothed: Floats) -> Floats:
        """Return the used coefficients of smoothed series, (n,) -> (m,) or (n, p) -> (m, p)."""
        found = np.asarray(fft.dct(smoothed[self.inside], axis=0, norm="ortho"), dtype=np.float64)
        factor: Floats = self.factor if smoothed.ndim == 1 else self.factor[:, None]
        return found[1 : self.factor.size + 1] / factor

    def readings(self, coefficients: Floats) -> Floats:
        """Return the factors of the means inside, (length,), in a sum over the used coefficients with the factors (m,)."""
        every = np.zeros(self.length)
        every[1 : self.factor.size + 1] = coefficients / self.factor
        return np.asarray(fft.idct(every, norm="ortho"), dtype=np.float64)

    def variance(self, readings: Floats, density: Callable[[Floats], Floats]) -> float:
        """Return the variance of a sum over the smoothed means inside.

        Args:
            readings: (length,) factors of the means.
            density: the variances of the cosine coefficients of the noise before the window, as a function of the frequency (rad/s).
        """
        frequency = _frequencies(self.length, self.interval)
        through = np.asarray(fft.dct(readings, norm="ortho"), dtype=np.float64) * _factors(frequency, self.width)
        return float(through**2 @ density(frequency))


def smoothed(values: Floats, interval: float, width: float) -> Floats:
    """Return a series of means, (n,), through a Gaussian window whose sigma is ``width`` s."""
    through = _factors(_frequencies(values.size, interval), width) * fft.dct(values, norm="ortho")
    return np.asarray(fft.idct(through, norm="ortho"), dtype=np.float64)


def _frequencies(length: int, interval: float) -> Floats:
    return np.asarray(np.pi * np.arange(length) / (length * interval), dtype=np.float64)


def _factors(frequency: Floats, width: float) -> Floats:
    return np.asarray(np.exp(-0.5 * (frequency * width) ** 2), dtype=np.float64)
