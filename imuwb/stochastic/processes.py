"""The processes of inertial sensors: frozen values with SI parameters.

Densities are two-sided, as in IEEE 952 and 1293 and the three papers; a Welch estimate is one-sided,
twice that. Letters are IEEE's: N white noise, B bias instability (flicker), K rate random walk,
R rate ramp, Q quantization. A sample is the average of the continuous process over dt, which is what
an integrating sensor puts out; Allan variance and density are those of the samples, aliasing and all,
and go over into IEEE's formulas as dt goes to 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from scipy import fft, special

from imuwb.stochastic import state_space
from imuwb.stochastic.autoregressive import Autoregressive
from imuwb.stochastic.checks import as_floats, require
from imuwb.stochastic.state_space import FlickerApproximation, StateSpace
from imuwb.stochastic.sums import Addable, Sum

if TYPE_CHECKING:
    from imuwb.log import Floats


@dataclass(frozen=True, slots=True)
class WhiteNoise(Addable):
    """Angle or velocity random walk. Allan variance N²/tau; density N²; N²/dt per sample."""

    N: float  #: unit/√Hz
    name: ClassVar[str] = "white_noise"

    def __post_init__(self) -> None:
        """Check N."""
        as_floats(self)
        require("N", self.N)

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return N²/tau (IEEE 952, C.6)."""
        del dt
        return self.N**2 / tau

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return N² at all f."""
        del dt
        return np.full_like(f, self.N**2)

    def discretize(self, dt: float) -> StateSpace:
        """Return noise on the output, no state."""
        return state_space.white(self.N**2 / dt)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples."""
        return rng.standard_normal(n) * (self.N / np.sqrt(dt))


@dataclass(frozen=True, slots=True)
class Quantization(Addable):
    """Quantization of the integrated output, as IEEE means it: white noise of sigma Q on the angle or velocity."""

    Q: float  #: rad or m/s
    name: ClassVar[str] = "quantization"

    def __post_init__(self) -> None:
        """Check Q."""
        as_floats(self)
        require("Q", self.Q)

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return 3 Q²/tau² (IEEE 952, C.18)."""
        del dt
        return 3 * self.Q**2 / tau**2

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return Q² (2 sin pi f dt)² / dt: a difference of white noise, which needs dt."""
        return self.Q**2 * (2 * np.sin(np.pi * f * dt)) ** 2 / dt

    def discretize(self, dt: float) -> StateSpace:
        """Return two states, the noise of this and of the last instant; the output is their difference over dt."""
        a, q = np.array([[0.0, 0.0], [1.0, 0.0]]), np.diag([self.Q**2, 0.0])
        return StateSpace(a, q, np.array([1.0, -1.0]) / dt, 0.0, np.eye(2) * self.Q**2)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples."""
        return np.diff(rng.standard_normal(n + 1)) * (self.Q / dt)


@dataclass(frozen=True, slots=True)
class FlickerNoise(Addable):
    """Bias instability: density B²/(2 pi f), an Allan deviation flat at √(2 ln2/pi) B = 0.664 B."""

    B: float  #: unit
    name: ClassVar[str] = "flicker_noise"

    def __post_init__(self) -> None:
        """Check B."""
        as_floats(self)
        require("B", self.B)

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return (2 ln 2/pi) B² at every tau, which averaged samples have exactly."""
        del dt
        return np.full_like(tau, 2 * np.log(2) / np.pi * self.B**2)

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return B²/(2 pi f), averaged over dt and folded at the Nyquist frequency.

        The sum over all aliases of sin²(pi f dt)/(pi f dt)² · 1/f is Hurwitz' zeta of order 3.
        """
        x = np.clip(f * dt, 1e-300, 0.5)
        folded = special.zeta(3.0, x) + special.zeta(3.0, 1.0 - x)
        return self.B**2 * dt / (2 * np.pi**3) * np.sin(np.pi * x) ** 2 * folded

    def approximate(self, band: tuple[float, float], states: int, dt: float) -> FlickerApproximation:
        """Return Gauss-Markov processes that a filter can carry instead, good in ``band`` (Hz) only."""
        if not 0 < band[0] < band[1] <= 0.5 / dt * (1 + 1e-9):
            message = f"band {band} Hz must rise from above 0 to at most the Nyquist frequency {0.5 / dt} Hz"
            raise ValueError(message)
        chosen, error = state_space.gauss_markov_bank(self.B**2 / (2 * np.pi), band, states)
        return FlickerApproximation(Sum(chosen), band, error)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples with the exact second-order law, the first one 0.

        Flicker itself is not stationary; its increments are. They are drawn by circulant embedding
        (Davies and Harte 1987) and added up, so the Allan deviation is flat at every m.
        """
        del dt
        if n < 2 or self.B == 0:  # noqa: PLR2004 - one sample has no increment
            return np.zeros(n)
        half = fft.next_fast_len(n, real=True)
        steps = _circulant(_flicker_increments(half + 1), rng)[: n - 1]
        return np.concatenate([[0.0], np.cumsum(steps)]) * self.B


def _flicker_increments(lags: int) -> Floats:
    """Return the autocovariance of x(k+1) - x(k) at lags 0, 1, ... of averaged flicker with B = 1.

    The integral of flicker has the generalised covariance t² ln|t| / (2 pi) (in steps of dt), and the
    increments are its second differences: weights 1 -4 6 -4 1. Far out the differences cancel to nothing
    in floating point; there the series of even derivatives takes over.
    """
    k = np.arange(lags, dtype=np.float64)
    near, far = k[:64], k[64:]
    shifted = near + np.arange(-2, 3)[:, None]
    differences = np.array([1, -4, 6, -4, 1]) @ special.xlogy(shifted**2, np.abs(shifted))
    series = -2 / far**2 - 2 / far**4 - 3 / far**6
    return np.concatenate([differences, series]) / (2 * np.pi)


def _circulant(covariance: Floats, rng: np.random.Generator) -> Floats:
    """Return a stationary Gaussian series, exactly of this autocovariance up to its last lag."""
    half = covariance.size - 1
    # Real and even: the transform is real, and holds the eigenvalues of the circulant.
    power = np.maximum(fft.hfft(covariance, 2 * half)[: half + 1], 0.0)
    noise = rng.standard_normal((2, half + 1))
    noise[:, [0, half]] *= [[np.sqrt(2.0)], [0.0]]
    return fft.irfft((noise[0] + 1j * noise[1]) * np.sqrt(power * half), 2 * half)


@dataclass(frozen=True, slots=True)
class RandomWalk(Addable):
    """Rate or acceleration random walk: the integral of white noise of density K²."""

    K: float  #: unit/√s
    name: ClassVar[str] = "random_walk"

    def __post_init__(self) -> None:
        """Check K."""
        as_floats(self)
        require("K", self.K)

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return K² tau/3 (IEEE 952, C.12)."""
        del dt
        return self.K**2 * tau / 3

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return the density of the averaged samples; K²/(2 pi f)² where f dt is small.

        The increments of an averaged Wiener process have variance 2/3 and covariance 1/6 of K² dt.
        """
        return self.K**2 * dt**2 * (2 + np.cos(2 * np.pi * f * dt)) / (12 * np.sin(np.pi * f * dt) ** 2)

    def discretize(self, dt: float) -> StateSpace:
        """Return one state that starts at 0."""
        one = np.ones((1, 1))
        return StateSpace(one, one * self.K**2 * dt, np.ones(1), 0.0, 0 * one)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples of a walk that starts at 0; each the average over its dt."""
        steps = rng.standard_normal((2, n)) * (self.K * np.sqrt(dt))
        ends = np.cumsum(steps[0])
        # The average over a step, given both its ends, is their mean plus a bridge of variance 1/12.
        return ends - steps[0] / 2 + steps[1] / np.sqrt(12)


@dataclass(frozen=True, slots=True)
class RateRamp(Addable):
    """A rate that grows steadily: R t. Not random; its sign is the sensor's."""

    R: float  #: unit/s
    name: ClassVar[str] = "rate_ramp"

    def __post_init__(self) -> None:
        """Check R."""
        as_floats(self)
        require("|R|", abs(self.R))

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return R² tau²/2 (IEEE 952, C.22)."""
        del dt
        return self.R**2 * tau**2 / 2

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return R²/(2 pi f)³, IEEE's way of writing a ramp as a density; a ramp is no stationary process."""
        del dt
        return self.R**2 / (2 * np.pi * f) ** 3

    def discretize(self, dt: float) -> StateSpace:
        """Return two states, rate and slope, without noise; the slope's sigma at the start is |R|."""
        return StateSpace(
            np.array([[1.0, dt], [0.0, 1.0]]), np.zeros((2, 2)), np.array([1.0, 0.0]), 0.0, np.diag([0.0, self.R**2])
        )

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples of the ramp, from 0 on."""
        del rng
        return self.R * dt * (np.arange(float(n)) + 0.5)


@dataclass(frozen=True, slots=True)
class GaussMarkov(Addable):
    """First-order Gauss-Markov: variance sigma², correlation e^(-|t|/Tc) (Quinchia, eq. 1 and 4)."""

    sigma: float  #: unit
    Tc: float  #: s
    name: ClassVar[str] = "gauss_markov"

    def __post_init__(self) -> None:
        """Check sigma and Tc."""
        as_floats(self)
        require("sigma", self.sigma)
        require("Tc", self.Tc, above=0.0)

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return 2 s² T²/tau² (tau/T - 3/2 + 2 e^(-tau/T) - e^(-2 tau/T)/2); it peaks at 0.6174 s, 1.893 T."""
        del dt
        x = tau / self.Tc
        # For small x the terms cancel to x³/3 - x⁴/4 + 7 x⁵/60.
        exact = x - 1.5 + 2 * np.exp(-x) - 0.5 * np.exp(-2 * x)
        series = x**3 / 3 - x**4 / 4 + 7 * x**5 / 60
        return 2 * self.sigma**2 / x**2 * np.where(x < 1e-3, series, exact)  # noqa: PLR2004 - where both agree

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return the density of averaged samples; 2 s² T/(1 + (2 pi f T)²) where f dt is small."""
        a = dt / self.Tc
        phi = np.exp(-a)
        # The averages are ARMA(1, 1): autocovariance v0 at lag 0, g phi^(k-1) behind.
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
        phi = np.exp(-dt / self.Tc)
        one = np.ones((1, 1))
        return StateSpace(
            phi * one, -np.expm1(-2 * dt / self.Tc) * self.sigma**2 * one, np.ones(1), 0.0, self.sigma**2 * one
        )

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


@dataclass(frozen=True, slots=True)
class Sinusoid(Addable):
    """A line: amplitude · sin(2 pi f t + phase), the phase drawn evenly."""

    amplitude: float  #: unit
    frequency: float  #: Hz
    name: ClassVar[str] = "sinusoid"

    def __post_init__(self) -> None:
        """Check amplitude and frequency."""
        as_floats(self)
        require("amplitude", self.amplitude)
        require("frequency", self.frequency, above=0.0)

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return A² (sin² x / x)², x = pi f tau (IEEE 952, C.25)."""
        del dt
        x = np.pi * self.frequency * tau
        return self.amplitude**2 * (np.sin(x) ** 2 / x) ** 2

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return 0: the power of a line is in no density; A²/4 stands at +f and at -f."""
        del dt
        return np.zeros_like(f)

    def autocovariance(self, lag: Floats) -> Floats:
        """Return A²/2 cos(2 pi f lag)."""
        return self.amplitude**2 / 2 * np.cos(2 * np.pi * self.frequency * lag)

    def discretize(self, dt: float) -> StateSpace:
        """Return an oscillator of two states without noise."""
        w = 2 * np.pi * self.frequency * dt
        turn = np.array([[np.cos(w), np.sin(w)], [-np.sin(w), np.cos(w)]])
        return StateSpace(turn, np.zeros((2, 2)), np.array([1.0, 0.0]), 0.0, np.eye(2) * self.amplitude**2 / 2)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples, each the average over dt."""
        phase = rng.uniform(0, 2 * np.pi)
        at = 2 * np.pi * self.frequency * dt * (np.arange(n) + 0.5) + phase
        return self.amplitude * np.sinc(self.frequency * dt) * np.sin(at)


@dataclass(frozen=True, slots=True)
class Constant(Addable):
    """A bias that is drawn once, at turn-on, with this sigma."""

    sigma: float  #: unit
    name: ClassVar[str] = "constant"

    def __post_init__(self) -> None:
        """Check sigma."""
        as_floats(self)
        require("sigma", self.sigma)

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return 0: differences do not see a constant."""
        del dt
        return np.zeros_like(tau)

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return 0 at every f but 0."""
        del dt
        return np.zeros_like(f)

    def autocovariance(self, lag: Floats) -> Floats:
        """Return sigma² at every lag."""
        return np.full_like(lag, self.sigma**2)

    def discretize(self, dt: float) -> StateSpace:
        """Return one state that never changes."""
        del dt
        one = np.ones((1, 1))
        return StateSpace(one, 0 * one, np.ones(1), 0.0, one * self.sigma**2)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return one draw, n times."""
        del dt
        return np.full(n, self.sigma * rng.standard_normal())


PROCESSES = {
    kind.name: kind
    for kind in (
        WhiteNoise, Quantization, FlickerNoise, RandomWalk, RateRamp, GaussMarkov, Autoregressive, Sinusoid, Constant,
    )
}  # fmt: skip
