"""The cosine coefficients of a record, which are nearly independent under all noise processes.

The discrete cosine transform (type II) of a record has, at j half periods, a coefficient whose variance is the two-sided
density of the sampled process at f = j/(2 T). For white noise and for a random walk, averaged over dt as a sensor does, that is
exact and the coefficients are independent. This holds although a random walk is not stationary, because cosines, unlike a
Fourier series, need no match of the record's two ends. Flicker and Gauss-Markov noise couple the lowest coefficients; their
covariance is known in closed form. So a likelihood of the whole record costs one transform.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from imuwb.arrays import Booleans, Floats, Integers, alone
from imuwb.compiled import compiled
from imuwb.identification.likelihood.cosine_transform import cosine_transform, transform_length
from imuwb.stochastic import FlickerNoise, GaussMarkov, Process, Quantization

LOW = 32  #: lowest coefficients, which have a joint covariance
WIDTH = 1.04  #: ratio of the last frequency to the first in a bin
POINTS = 8  #: frequencies of a wide bin at which a density is averaged
FEWEST = 256  #: samples


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class CosineSpectrum:
    """A record's cosine coefficients: each of the lowest, and the mean squares of the others in narrow bins."""

    n: int  #: samples
    dt: float  #: s
    ramp: float  #: unit/s, taken off before the transform
    index: Integers  #: (l,) half periods of the lowest coefficients, from 1 on
    low: Floats  #: (l,) coefficients, scaled so that their variance is the two-sided density
    first: Integers  #: (k,) first half period of each bin
    last: Integers  #: (k,) last half period of each bin
    power: Floats  #: (k,) mean square in a bin
    count: Integers  #: (k,) coefficients in a bin, without those near lines

    @property
    def frequency(self) -> Floats:
        """Return the centre of each bin (Hz)."""
        return np.sqrt(self.first * self.last.astype(np.float64)) / (2 * self.n * self.dt)

    def __repr__(self) -> str:
        """Return the number of coefficients and bins."""
        return (
            f"cosine spectrum of {self.n} samples at {1 / self.dt:.6g} Hz: {self.low.size} lowest coefficients, "
            f"{self.power.size} bins"
        )

    def density(self, process: Process) -> Floats:
        """Return a process's two-sided density averaged over each bin, (k,)."""
        width = (self.last - self.first + 1).astype(np.float64)
        points = np.where(
            width[:, None] <= POINTS, np.arange(POINTS), (np.arange(POINTS) + 0.5) / POINTS * width[:, None] - 0.5
        )
        inside = points < width[:, None]
        at = (self.first[:, None] + np.minimum(points, width[:, None] - 1)) / (2 * self.n * self.dt)
        values = process.power_spectral_density(at.ravel(), self.dt).reshape(at.shape)
        return (values * inside).sum(axis=1) / inside.sum(axis=1)

    def covariance(self, process: Process) -> Floats:
        """Return the covariance of the lowest coefficients under a process, (l, l)."""
        if isinstance(process, FlickerNoise):
            return process.B**2 * _flicker(self.index, self.n * self.dt)
        if isinstance(process, GaussMarkov):
            return process.sigma**2 * _gauss_markov(self.index, self.n * self.dt, process.Tc)
        f = self.index / (2 * self.n * self.dt)
        diagonal = np.diag(process.power_spectral_density(f, self.dt))
        if isinstance(process, Quantization):
            # No cosine cancels the steps before the first sample and after the last one.
            edge = np.sqrt(2 / self.n) * np.cos(np.pi * self.index / (2 * self.n))
            sign = np.where(self.index % 2 == 0, 1.0, -1.0)
            diagonal += process.Q**2 / self.dt * (np.outer(edge, edge) + np.outer(edge * sign, edge * sign))
        return diagonal

    def trend(self) -> Floats:
        """Return the lowest coefficients of a ramp of 1 unit/s, (l,)."""
        t = np.pi * self.index / (2 * self.n)
        # The sum of k cos(pi j (k + 1/2)/n) is -cos t/(2 sin² t) for odd j, and 0 for even j.
        odd = -np.cos(t) / (2 * np.sin(t) ** 2)
        return np.where(self.index % 2 == 1, odd, 0.0) * np.sqrt(2 / self.n) * self.dt**1.5


def cosine_spectrum(values: Floats, dt: float, lines: Sequence[tuple[float, float]] = ()) -> CosineSpectrum:
    """Return the cosine coefficients of an evenly spaced record without gaps.

    Args:
        values: (n,) samples.
        dt: s.
        lines: (frequency, half width) in Hz; coefficients within are left out.

    Raises:
        ValueError: fewer than 256 samples.
    """
    if values.size < FEWEST:
        raise ValueError(f"{values.size} samples are too few for a likelihood; it needs at least {FEWEST}")
    values = values[: transform_length(values.size)]
    n = values.size
    level, slope = _straight_line(values)
    with alone(n):
        coefficients = cosine_transform(values, level, slope)
    spans = np.array([[max((f - half) * 2 * n * dt, 0.0), (f + half) * 2 * n * dt] for f, half in lines]).reshape(-1, 2)
    index = np.arange(1, LOW + 1)
    index = index[~((index >= spans[:, :1]) & (index <= spans[:, 1:])).any(axis=0)]
    edges = _edges(n)
    power, count = coefficients.sums_of_squares(
        edges, np.floor(spans[:, 0]).astype(np.int64), np.ceil(spans[:, 1]).astype(np.int64)
    )
    full = count > 0
    return CosineSpectrum(
        n, dt, slope / dt, index, coefficients.at(index) * np.sqrt(dt), edges[:-1][full], edges[1:][full] - 1,
        power[full] / count[full] * dt, count[full],
    )  # fmt: skip


def expected_spectrum(n: int, dt: float) -> CosineSpectrum:
    """Return the coefficients and bins that a record of n samples has, without values: all that Fisher's information needs."""
    index = np.arange(1, LOW + 1)
    edges = _edges(n)
    blank = np.ones(edges.size - 1)
    return CosineSpectrum(
        n, dt, 0.0, index, np.zeros(LOW), edges[:-1], edges[1:] - 1, blank, (edges[1:] - edges[:-1]).astype(np.int64)
    )


@compiled(reorder=True)
def _straight_line(values: Floats) -> tuple[float, float]:  # pragma: no cover - compiled
    """Return the mean, and the slope per sample, of the least-squares line."""
    n = values.size
    middle = (n - 1) / 2.0
    total = moment = 0.0
    for k in range(n):
        x = values[k] - values[0]
        total += x
        moment += (k - middle) * x
    return values[0] + total / n, moment / (n * (float(n) * n - 1.0) / 12.0)


def _edges(n: int) -> Integers:
    steps = np.geomspace(LOW + 1, n, max(round(np.log(n / (LOW + 1)) / np.log(WIDTH)), 1) + 1)
    return np.unique(np.rint(steps).astype(np.int64))


def _cin(x: Floats) -> Floats:
    """Return the integral of (1 - cos t)/t from 0 to x."""
    return np.euler_gamma + np.log(x) - special.sici(x)[1]


def _pairs(index: Integers) -> tuple[Floats, Floats, Booleans, Booleans]:
    """Return pi i and pi j of all pairs, which pairs are equal, and which pairs the symmetry decouples."""
    a = np.pi * index.astype(np.float64)
    same = np.eye(index.size, dtype=bool)
    apart = (index[:, None] + index[None, :]) % 2 == 1
    return a[:, None] + 0 * a, a[None, :] + 0 * a[:, None], same, apart


def _flicker(index: Integers, duration: float) -> Floats:
    """Return the covariance under flicker of B = 1, from its generalised autocovariance -ln|t|/pi."""
    a, b, same, apart = _pairs(index)
    si = special.sici(a)[0]
    diagonal = si / a - (1 - np.cos(a)) / a**2
    other = -2 * (_cin(a) - _cin(b)) / np.where(same, 1.0, a**2 - b**2)
    return 2 * duration / np.pi * np.where(same, diagonal, np.where(apart, 0.0, other))


def _gauss_markov(index: Integers, duration: float, correlation_time: float) -> Floats:
    """Return the covariance under a Gauss-Markov process of sigma 1, from its autocovariance e^(-|t|/Tc)."""
    a, b, same, apart = _pairs(index)
    x = duration / correlation_time
    end = np.exp(-x) * np.cos(a)  # cos(pi j) = +-1 has the same sign for both of a coupled pair

    def sine(w: Floats) -> Floats:  # integral of e^(-x t) sin(w t) over the record
        return w * (1 - end) / (x**2 + w**2)

    # (1 - t) cos(w t) against e^(-x t), with z = x - i w: 1/z - (1 - e^-z)/z²
    z = x - 1j * a
    cosine = (1 / z - (1 - end) / z**2).real
    diagonal = cosine - sine(a) / a
    other = (-2 * a * sine(a) + 2 * b * sine(b)) / np.where(same, 1.0, a**2 - b**2)
    return 2 * duration * np.where(same, diagonal, np.where(apart, 0.0, other))
