"""How large a spectral value must be to be significant.

All limits are exceedances: minus the logarithm of the probability that noise alone reaches a value at one frequency. If the
noise's level is estimated from the whole residual, the exceedance follows from the share s with nu degrees of freedom (Pagiatakis
1999): -(nu - 2)/2 log(1 - s). With ``local`` noise it follows from the F distribution of a value over the mean of its neighbours.

In a record of m frequencies noise makes a large value at some frequency far more often than at a given one. The limit of the
record counts how often the exceedance of noise crosses a limit between neighbouring frequencies. Their correlation is that of the
spectral window (S. O. Rice 1944, on a grid).
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy import optimize, special

from imuwb.arrays import Floats, Integers
from imuwb.identification.lssa.spectrum import Spectrum

NEIGHBOURS = 50  #: Fourier frequencies on each side of a frequency, at most, from which local noise is estimated
LEAST_NEIGHBOURS = 4  #: on both sides together
SKIPPED = 2  #: nearest Fourier frequencies on each side, into which a line leaks
LOWEST = SKIPPED + LEAST_NEIGHBOURS  #: least number of cycles of a line in the record, with local noise
NODES, WEIGHTS = np.polynomial.laguerre.laggauss(64)  #: of the quadrature


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Significance:
    """What noise alone would show at m frequencies, and the limits of significance."""

    exceedance: Floats  #: (m,)
    level: Floats  #: (m,) level of the noise: half of a noise line's mean reduction of the residual's quadratic form
    one: float  #: exceedance that is significant at one frequency chosen beforehand
    record: float  #: exceedance that is significant anywhere in the record
    probability: float  #: 1 - the level of both limits
    neighbours: Integers | None  #: (m,) frequencies that give the level; None: the whole residual gives it

    def reduction(self, spectrum: Spectrum, exceedance: float) -> Floats:
        """Return by how much a line must reduce the quadratic form for an exceedance, (m,); 0 where the level is not known."""
        if self.neighbours is None:
            adjusted = spectrum.adjusted
            return np.full(self.level.size, -adjusted.rest * np.expm1(-2 * exceedance / (adjusted.freedom - 2)))
        count = np.maximum(self.neighbours, 1)
        return 2 * self.level * count * np.expm1(exceedance / count)

    def share_limit(self, freedom: int) -> tuple[float, float]:
        """Return the shares s of both limits, for a level from the whole residual."""
        one, record = (float(-np.expm1(-2 * x / (freedom - 2))) for x in (self.one, self.record))
        return one, record

    def limit(self, spectrum: Spectrum, exceedance: float) -> Floats:
        """Return the density, (m,) unit²/Hz, that a line needs for an exceedance."""
        safe = np.where(spectrum.reduction > 0, spectrum.reduction, 1.0)
        scale = np.where(spectrum.reduction > 0, spectrum.density / safe, 0.0)
        return scale * self.reduction(spectrum, exceedance)


def significance(spectrum: Spectrum, level: float = 0.99) -> Significance:
    """Return the exceedances of a spectrum and the limits of significance.

    Args:
        spectrum: spectrum of the series.
        level: level of both limits.
    """
    freedom = spectrum.adjusted.freedom
    if spectrum.adjusted.noise.noise.kind == "local":
        around, count = _neighbours(spectrum.reduction, spectrum.oversampling)
        ratio = np.divide(spectrum.reduction, around, out=np.zeros_like(around), where=around > 0)
        exceedance, noise = count.astype(float) * np.log1p(ratio / np.maximum(count, 1)), 0.5 * around
        possible = max(int(np.count_nonzero(count)), 1)
    else:
        exceedance = -0.5 * (freedom - 2) * np.log1p(-np.minimum(spectrum.share, 1 - 1e-15))
        noise = np.full(exceedance.size, spectrum.adjusted.rest / freedom)
        count, possible = None, exceedance.size
    alpha = 1 - level
    record = record_limit(alpha, possible, round(correlation(spectrum), 6))
    return Significance(exceedance, noise, float(-np.log(alpha)), record, alpha, count)


def correlation(spectrum: Spectrum) -> float:
    """Return the correlation of noise at neighbouring frequencies, from 0 to 1: the absolute value of the spectral window."""
    time = spectrum.adjusted.time
    return float(np.abs(np.mean(np.exp(2j * np.pi * spectrum.grid.step * time))))


@cache
def record_limit(alpha: float, count: int, together: float) -> float:
    """Return the exceedance that noise reaches at any of ``count`` frequencies with probability ``alpha``.

    Args:
        alpha: probability.
        count: number of neighbouring frequencies.
        together: correlation between neighbours.
    """
    wanted = np.log1p(-alpha)

    def beyond(u: float) -> float:
        return _log_quiet(u, count, together) - wanted

    return float(optimize.brentq(beyond, 1e-3, 60 + np.log(count)))


def record_probability(exceedance: float, count: int, together: float) -> float:
    """Return the probability that noise reaches an exceedance at any of ``count`` frequencies."""
    return float(-np.expm1(_log_quiet(max(exceedance, 1e-3), count, together)))


def _log_quiet(u: float, count: int, together: float) -> float:
    """Return the log probability that no frequency reaches u: the first value is below u, and none crosses it."""
    climbing = np.exp(-u) - _both(u, together)
    return float(-(count - 1) * -np.log1p(-min(climbing, 0.999)) + np.log1p(-np.exp(-u)))


def _both(u: float, together: float) -> float:
    """Return the probability that two neighbours both reach u; they are squared sizes of correlated complex normal numbers."""
    rho = together**2
    if rho < 1e-12:  # noqa: PLR2004 - independent to rounding
        return float(np.exp(-2 * u))
    x = u + NODES
    tail = 1 - special.chndtr(2 * u / (1 - rho), 2, 2 * rho * x / (1 - rho))
    return float(np.exp(-u) * (WEIGHTS @ tail))


def _neighbours(reduction: Floats, oversampling: int) -> tuple[Floats, Integers]:
    """Return the mean of the Fourier frequencies around each frequency, and their number (0 near zero frequency)."""
    m, k = reduction.size, oversampling
    rows = -(-m // k)
    table = np.zeros((rows, k))
    table.ravel()[:m] = reduction
    sums = np.concatenate([np.zeros((1, k)), np.cumsum(table, axis=0)])
    row = np.arange(rows)
    # Index 0 of the grid is one step above zero; in cycles, the frequency is (row k + column + 1) / k.
    reach = np.minimum(NEIGHBOURS, row // 2)
    last = rows - 1 - (m % k != 0)
    low = np.maximum(row - SKIPPED - reach, 0)
    high = np.minimum(row + SKIPPED + reach, last)
    before = np.maximum(row - SKIPPED, low)
    after = np.minimum(row + SKIPPED, high)
    total = sums[before] - sums[low] + sums[high + 1] - sums[after + 1]
    count = (before - low + high - after) * (row >= LOWEST) * (reach >= LEAST_NEIGHBOURS // 2)
    mean = np.divide(total, count[:, None], out=np.zeros_like(total), where=count[:, None] > 0)
    return mean.ravel()[:m], np.repeat(count, k)[:m]
