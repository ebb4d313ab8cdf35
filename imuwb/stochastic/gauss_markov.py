"""Gauss-Markov processes of first order."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from imuwb.arrays import Floats
from imuwb.stochastic.elementary import Elementary
from imuwb.stochastic.state_space import StateSpace, single


@dataclass(frozen=True, slots=True)
class GaussMarkov(Elementary):
    """First-order Gauss-Markov: variance sigma², correlation e^(-|t|/Tc) (Quinchia, eq. 1 and 4)."""

    sigma: float  #: unit
    Tc: float  #: s
    name: ClassVar[str] = "gauss_markov"

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return 2 s² T²/tau² (tau/T - 3/2 + 2 e^(-tau/T) - e^(-2 tau/T)/2), with s = sigma and T = Tc.

        The largest Allan deviation is 0.6174 s, at tau = 1.893 T.
        """
        x = tau / self.Tc
        # For small x the terms cancel to x³/3 - x⁴/4 + 7 x⁵/60.
        exact = x - 1.5 + 2 * np.exp(-x) - 0.5 * np.exp(-2 * x)
        series = x**3 / 3 - x**4 / 4 + 7 * x**5 / 60
        return 2 * self.sigma**2 / x**2 * np.where(x < 1e-3, series, exact)  # noqa: PLR2004 - where both agree

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return the density of averaged samples; 2 s² T/(1 + (2 pi f T)²) where f dt is small."""
        a = dt / self.Tc
        phi = np.exp(-a)
        # The averages are ARMA(1, 1): autocovariance v0 at lag 0, g phi^(k-1) at lag k.
        g = self.sigma**2 * (np.expm1(-a) / a) ** 2
        # v0 - g is of order a: where a is small, by its series (-expm1(-a)/a = 1 - a/2 + a²/6).
        small = a < 1e-2  # noqa: PLR2004 - where both agree to 1e-9
        exact = 2 * (a + np.expm1(-a)) / a**2 - (np.expm1(-a) / a) ** 2
        rest = self.sigma**2 * (2 * a / 3 - a**2 / 2 + 7 * a**3 / 30 - a**4 / 12 if small else exact)
        # With v0 = rest + g the sum over lags is rest + g (1 + 2 Re(z/(1 - phi z))), z = e^(-iw).
        w = 2 * np.pi * f * dt
        loss = -np.expm1(-a)  # 1 - phi
        distance = loss**2 + 4 * phi * np.sin(w / 2) ** 2  # |1 - phi z|²
        # 1 + 2 Re(z/(1 - phi z)) = (1 - phi) (1 - phi + 2 cos w) / |1 - phi z|², where nothing cancels
        return dt * (rest + g * loss * (loss + 2 * np.cos(w)) / distance)

    def autocovariance(self, lag: Floats) -> Floats:
        """Return s² e^(-|lag|/Tc)."""
        return self.sigma**2 * np.exp(-np.abs(lag) / self.Tc)

    def discretize(self, dt: float) -> StateSpace:
        """Return one state with e^(-dt/Tc) (not 1 - dt/Tc), stationary from the start."""
        return single(np.exp(-dt / self.Tc), -np.expm1(-2 * dt / self.Tc) * self.sigma**2, self.sigma**2)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples, each the exact average over dt."""
        from scipy import signal  # noqa: PLC0415 - slow to load

        a = dt / self.Tc
        phi, loss = np.exp(-a), -np.expm1(-a)
        # Given the state at the start of a step, its end and its average are jointly normal.
        end = self.sigma**2 * -np.expm1(-2 * a)
        mean_gain = loss / a
        both = self.sigma**2 * loss**2 / a
        small = a < 1e-3  # noqa: PLR2004 - below it the difference of exponentials cancels
        variance = 2 * a / 3 - a**2 / 2 if small else 2 / a - 4 * loss / a**2 + (1 - phi**2) / a**2
        mean = self.sigma**2 * variance
        noise = rng.standard_normal((2, n))
        steps = np.sqrt(end) * noise[0]
        rest = np.sqrt(max(mean - both**2 / end, 0.0)) if end > 0 else 0.0
        start = self.sigma * rng.standard_normal()
        states, _ = signal.lfilter([1.0], [1.0, -phi], steps, zi=np.array([phi * start]))
        before = np.concatenate([[start], states[:-1]])
        average_noise = (both / end * steps if end > 0 else 0.0) + rest * noise[1]
        return mean_gain * before + average_noise
