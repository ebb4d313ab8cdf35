"""Flicker noise (bias instability), and the Gauss-Markov processes that a filter carries in its place."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from imuwb.arrays import Floats
from imuwb.stochastic.elementary import Elementary
from imuwb.stochastic.gauss_markov import GaussMarkov
from imuwb.stochastic.sums import Sum

FLICKER_LEVEL = float(np.sqrt(2 * np.log(2) / np.pi))  #: flat Allan deviation of flicker noise over its B, 0.664
SERIES = 64  #: lag from which the increments' autocovariance is computed as a series


@dataclass(frozen=True, slots=True)
class FlickerApproximation:
    """A sum of Gauss-Markov processes in place of flicker noise, valid within a band only."""

    processes: Sum
    band: tuple[float, float]  #: Hz
    largest_error: float  #: relative, of the spectral density within the band


@dataclass(frozen=True, slots=True)
class FlickerNoise(Elementary):
    """Bias instability: density B²/(2 pi f), an Allan deviation flat at √(2 ln2/pi) B = 0.664 B."""

    B: float  #: unit
    name: ClassVar[str] = "flicker_noise"

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return (2 ln 2/pi) B² at every tau, which averaged samples have exactly."""
        return np.full_like(tau, 2 * np.log(2) / np.pi * self.B**2)

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return B²/(2 pi f), averaged over dt and folded at the Nyquist frequency.

        The sum over all aliases of sin²(pi f dt)/(pi f dt)² · 1/f is Hurwitz' zeta of order 3.
        """
        from scipy.special import zeta  # noqa: PLC0415 - scipy is slow to import

        x = np.clip(f * dt, 1e-300, 0.5)
        folded = zeta(3.0, x) + zeta(3.0, 1.0 - x)
        return self.B**2 * dt / (2 * np.pi**3) * np.sin(np.pi * x) ** 2 * folded

    def approximate(self, band: tuple[float, float], states: int, dt: float) -> FlickerApproximation:
        """Return Gauss-Markov processes that a filter can carry in its place, valid within ``band`` (Hz) only."""
        if not 0 < band[0] < band[1] <= 0.5 / dt * (1 + 1e-9):
            raise ValueError(
                f"the band is {band} Hz; it must rise, from above 0 to at most the Nyquist frequency {0.5 / dt} Hz"
            )
        return _gauss_markov_bank(self.B**2 / (2 * np.pi), band, states)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples with the exact second-order law, the first one 0.

        Flicker itself is not stationary; its increments are. They are drawn by circulant embedding
        (Davies and Harte 1987) and added up, so that the Allan deviation is flat at every m.
        """
        if n < 2 or self.B == 0:  # noqa: PLR2004 - one sample has no increment
            return np.zeros(n)
        from scipy.fft import next_fast_len  # noqa: PLC0415 - scipy is slow to import

        half = next_fast_len(n, real=True)
        steps = _circulant(_flicker_increments(half + 1), rng)[: n - 1]
        return np.concatenate([[0.0], np.cumsum(steps)]) * self.B


def _flicker_increments(lags: int) -> Floats:
    """Return the autocovariance of x(k+1) - x(k) at lags 0, 1, ... of averaged flicker with B = 1.

    The integral of flicker has the generalised covariance t² ln|t| / (2 pi) (in steps of dt), and the
    increments are its second differences: weights 1 -4 6 -4 1. At large lags the differences cancel in
    floating point; there the series of even derivatives is used.
    """
    from scipy.special import xlogy  # noqa: PLC0415 - scipy is slow to import

    k = np.arange(lags, dtype=np.float64)
    near, far = k[:SERIES], k[SERIES:]
    shifted = near + np.arange(-2, 3)[:, None]
    differences = np.array([1, -4, 6, -4, 1]) @ xlogy(shifted**2, np.abs(shifted))
    series = -2 / far**2 - 2 / far**4 - 3 / far**6
    return np.concatenate([differences, series]) / (2 * np.pi)


def _circulant(covariance: Floats, rng: np.random.Generator) -> Floats:
    """Return a stationary Gaussian series that has exactly this autocovariance up to its last lag."""
    from scipy.fft import hfft, irfft  # noqa: PLC0415 - scipy is slow to import

    half = covariance.size - 1
    # The covariance is real and even: its transform is real, and contains the eigenvalues of the circulant.
    power = np.maximum(hfft(covariance, 2 * half)[: half + 1], 0.0)
    noise = rng.standard_normal((2, half + 1))
    noise[:, [0, half]] *= [[np.sqrt(2.0)], [0.0]]
    return irfft((noise[0] + 1j * noise[1]) * np.sqrt(power * half), 2 * half)


def _gauss_markov_bank(level: float, band: tuple[float, float], states: int) -> FlickerApproximation:
    """Return Gauss-Markov processes whose summed spectrum is level/f in a band.

    Corner frequencies stand evenly on the log axis from edge to edge; with all variances equal the sum is 1/f by symmetry,
    and one common factor makes the largest relative error within the band smallest.
    """
    from scipy.optimize import nnls  # noqa: PLC0415 - scipy.optimize is slow to import

    corners = np.geomspace(band[0], band[1], states) if states > 1 else np.array([np.sqrt(band[0] * band[1])])
    f = np.geomspace(*band, 200)
    # two-sided: 2 s² T / (1 + (2 pi f T)²) with T = 1/(2 pi corner)
    shape = (1 / (np.pi * corners)) / (1 + (f[:, None] / corners) ** 2)
    # non-negative least squares of the ratio to 1/f
    variances, _ = nnls(shape * f[:, None] / level, np.ones(f.size))
    ratio = (shape @ variances) * f / level
    scale = 2 / (ratio.min() + ratio.max())
    processes = tuple(
        GaussMarkov(float(np.sqrt(v * scale)), float(1 / (2 * np.pi * corner)))
        for v, corner in zip(variances, corners, strict=True)
        if v > 0
    )
    return FlickerApproximation(Sum(processes), band, float(np.abs(ratio * scale - 1).max()))
