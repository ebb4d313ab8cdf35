"""The processes of inertial sensors: frozen values with SI parameters.

Densities are two-sided, as in IEEE 952 and 1293 and the three papers; a Welch estimate is one-sided,
that is, twice as large. Letters are IEEE's: N white noise, B bias instability (flicker), K rate random walk,
R rate ramp, Q quantization. A sample is the average of the continuous process over dt, as an integrating
sensor puts it out. Allan variance and density are those of the samples, with aliasing; as dt goes to 0
they become IEEE's formulas.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from imuwb.arrays import Floats
from imuwb.stochastic import state_space
from imuwb.stochastic.elementary import Elementary
from imuwb.stochastic.state_space import StateSpace


@dataclass(frozen=True, slots=True)
class WhiteNoise(Elementary):
    """Angle or velocity random walk. Allan variance N²/tau; density N²; variance of a sample N²/dt."""

    N: float  #: unit/√Hz
    name: ClassVar[str] = "white_noise"

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return N²/tau (IEEE 952, C.6)."""
        return self.N**2 / tau

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return N² at all f."""
        return np.full_like(f, self.N**2)

    def discretize(self, dt: float) -> StateSpace:
        """Return noise on the output, no state."""
        return state_space.white(self.N**2 / dt)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples."""
        return rng.standard_normal(n) * (self.N / np.sqrt(dt))


@dataclass(frozen=True, slots=True)
class Quantization(Elementary):
    """Quantization in the sense of IEEE: white noise of sigma Q on the angle or the velocity."""

    Q: float  #: rad or m/s
    name: ClassVar[str] = "quantization"

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return 3 Q²/tau² (IEEE 952, C.18)."""
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
class RandomWalk(Elementary):
    """Rate or acceleration random walk: the integral of white noise of density K²."""

    K: float  #: unit/√s
    name: ClassVar[str] = "random_walk"

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return K² tau/3 (IEEE 952, C.12)."""
        return self.K**2 * tau / 3

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return the density of the averaged samples; K²/(2 pi f)² where f dt is small.

        The increments of an averaged Wiener process have variance 2/3 and covariance 1/6 of K² dt.
        """
        return self.K**2 * dt**2 * (2 + np.cos(2 * np.pi * f * dt)) / (12 * np.sin(np.pi * f * dt) ** 2)

    def discretize(self, dt: float) -> StateSpace:
        """Return one state that starts at 0."""
        return state_space.single(1.0, self.K**2 * dt, 0.0)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples of a walk that starts at 0; each the average over its dt."""
        steps = rng.standard_normal((2, n)) * (self.K * np.sqrt(dt))
        ends = np.cumsum(steps[0])
        # Given both ends of a step, the average over it is their mean plus a bridge of variance 1/12.
        return ends - steps[0] / 2 + steps[1] / np.sqrt(12)


@dataclass(frozen=True, slots=True)
class RateRamp(Elementary):
    """A rate that grows steadily, R t. It is not random; its sign is that of the sensor."""

    R: float  #: unit/s
    name: ClassVar[str] = "rate_ramp"

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return R² tau²/2 (IEEE 952, C.22)."""
        return self.R**2 * tau**2 / 2

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return R²/(2 pi f)³, IEEE's way of writing a ramp as a density; a ramp is no stationary process."""
        return self.R**2 / (2 * np.pi * f) ** 3

    def discretize(self, dt: float) -> StateSpace:
        """Return two states, rate and slope, without noise; the slope's sigma at the start is |R|."""
        return StateSpace(
            np.array([[1.0, dt], [0.0, 1.0]]), np.zeros((2, 2)), np.array([1.0, 0.0]), 0.0, np.diag([0.0, self.R**2])
        )

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples of the ramp, from 0 on."""
        return self.R * dt * (np.arange(float(n)) + 0.5)


@dataclass(frozen=True, slots=True)
class Sinusoid(Elementary):
    """A line: amplitude · sin(2 pi f t + phase); the phase has a uniform distribution."""

    amplitude: float  #: unit
    frequency: float  #: Hz
    name: ClassVar[str] = "sinusoid"

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return A² (sin² x / x)², x = pi f tau (IEEE 952, C.25)."""
        x = np.pi * self.frequency * tau
        return self.amplitude**2 * (np.sin(x) ** 2 / x) ** 2

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return 0: a density does not show the power of a line, which is A²/4 at +f and at -f."""
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
class Constant(Elementary):
    """A bias that is drawn once, at turn-on, with this sigma."""

    sigma: float  #: unit
    name: ClassVar[str] = "constant"

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return 0: differences do not see a constant."""
        return np.zeros_like(tau)

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return 0 at every f but 0."""
        return np.zeros_like(f)

    def autocovariance(self, lag: Floats) -> Floats:
        """Return sigma² at every lag."""
        return np.full_like(lag, self.sigma**2)

    def discretize(self, dt: float) -> StateSpace:
        """Return one state that never changes."""
        return state_space.single(1.0, 0.0, self.sigma**2)

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return one draw, n times."""
        return np.full(n, self.sigma * rng.standard_normal())
