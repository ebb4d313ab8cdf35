"""Errors of a GNSS receiver beyond white noise: correlated errors, multipath, jitter of the delay, over-stated precision."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import signal

from imuwb.arrays import Floats
from imuwb.errors import UsageError

Triple = tuple[float, float, float]
MINUTE = 60.0  #: s
LARGEST, LONGEST, MOST_STEPS = 1e6, 1e6, 60.0  #: m or m/s; s; 1/min


@dataclass(frozen=True, slots=True)
class GnssErrors:
    """Errors of the fixes, in addition to the receiver's white noise.

    The sigma that a fix states is the root sum of squares of the white noise and of the Gauss-Markov error, divided by ``claim``.
    Multipath steps are not part of it.

    Raises:
        UsageError: a value out of its range.
    """

    position_sigma: Triple = (0.0, 0.0, 0.0)  #: m, NED, of a first-order Gauss-Markov error of the position
    position_time: float = 60.0  #: s, its correlation time
    velocity_sigma: Triple = (0.0, 0.0, 0.0)  #: m/s, NED, of a first-order Gauss-Markov error of the velocity
    velocity_time: float = 10.0  #: s, its correlation time
    step_rate: float = 0.0  #: multipath steps per minute; their starts are a Poisson process
    #: m, NED; a step moves the position by a constant that is normal with this sigma
    step_sigma: Triple = (5.0, 5.0, 10.0)
    step_duration: float = 10.0  #: s, mean; the duration is exponentially distributed
    jitter: float = 0.0  #: s, sigma of the delay about the receiver's latency; a delay is never negative
    #: true sigma over stated sigma, of position and velocity; 1: the claims are true
    claim: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        """Check the values."""
        for what, values, most in (
            ("a Gauss-Markov error's sigma", (*self.position_sigma, *self.velocity_sigma), LARGEST),
            ("a multipath step's sigma", self.step_sigma, LARGEST),
            ("the number of multipath steps per minute", (self.step_rate,), MOST_STEPS),
            ("the jitter of the delay in seconds", (self.jitter,), MINUTE),
        ):
            for value in values:
                if not 0 <= value <= most:
                    raise UsageError(f"{what} is {value}; it must be 0 to {most:g}")
        for what, values, most in (
            ("a Gauss-Markov error's correlation time in seconds", (self.position_time, self.velocity_time), LONGEST),
            ("a multipath step's mean duration in seconds", (self.step_duration,), LONGEST),
            ("the ratio of true and stated sigma", self.claim, LARGEST),
        ):
            for value in values:
                if not 0 < value <= most:
                    raise UsageError(f"{what} is {value}; it must be above 0 and at most {most:g}")

    def delays(self, count: int, latency: float, rng: np.random.Generator) -> Floats:
        """Return the age of each fix at its time stamp, (n,) s."""
        return np.maximum(0.0, latency + self.jitter * rng.standard_normal(count))

    def sample(self, count: int, rate: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """Return the errors of the fixes without their white noise.

        Args:
            count: fixes.
            rate: Hz.
            rng: for all draws.

        Returns:
            (n, 3) m and (n, 3) m/s, NED
        """
        position = np.array(self.position_sigma) * _gauss_markov(count, self.position_time * rate, rng)
        velocity = np.array(self.velocity_sigma) * _gauss_markov(count, self.velocity_time * rate, rng)
        return position + self._steps(count, rate, rng), velocity

    def claimed(self, position: Triple, velocity: Triple) -> tuple[Floats, Floats]:
        """Return the sigmas that a fix states, (3,) m and (3,) m/s, from those of the white noise."""
        return (
            np.hypot(position, self.position_sigma) / self.claim[0],
            np.hypot(velocity, self.velocity_sigma) / self.claim[1],
        )

    def truth(self) -> dict[str, str]:
        """Return the true parameters of the errors that are there: {name: value with its SI unit}."""
        found: dict[str, str] = {}
        for kind, unit, sigma, time in (
            ("position", "m", self.position_sigma, self.position_time),
            ("velocity", "m/s", self.velocity_sigma, self.velocity_time),
        ):
            if any(sigma):
                found[f"gnss.{kind}.gauss_markov.sigma"] = triple(sigma, unit)
                found[f"gnss.{kind}.gauss_markov.Tc"] = f"{time:.12g} s"
        if self.step_rate:
            found["gnss.steps.rate"] = f"{self.step_rate:.12g} 1/min"
            found["gnss.steps.sigma"] = triple(self.step_sigma, "m")
            found["gnss.steps.duration"] = f"{self.step_duration:.12g} s"
        return found | {
            "gnss.jitter": f"{self.jitter:.12g} s",
            "gnss.position.claim": f"{self.claim[0]:.12g}",
            "gnss.velocity.claim": f"{self.claim[1]:.12g}",
        }

    def _steps(self, count: int, rate: float, rng: np.random.Generator) -> Floats:
        """Return the sum of the multipath steps at each fix, (n, 3) m; steps that began before the first fix are included."""
        mean = self.step_rate / MINUTE
        warm = 10 * self.step_duration if mean else 0.0  # a step that began earlier is over with probability 1 - e^-10
        length = warm + count / rate
        number = int(rng.poisson(mean * length))
        starts = rng.uniform(-warm, count / rate, number)
        ends = starts + rng.exponential(self.step_duration, number)
        offsets = rng.standard_normal((number, 3)) * self.step_sigma
        moved = np.zeros((count, 3))
        for start, end, offset in zip(starts, ends, offsets, strict=True):
            moved[max(0, math.ceil(start * rate)) : max(0, math.ceil(end * rate))] += offset
        return moved


def triple(values: Triple, unit: str) -> str:
    """Return three values, and their unit, as a text."""
    return f"{' '.join(f'{value:.12g}' for value in values)} {unit}"


def _gauss_markov(count: int, steps: float, rng: np.random.Generator) -> Floats:
    """Return three independent Gauss-Markov series of sigma 1 at instants, (n, 3); the correlation time is in steps."""
    factor = math.exp(-1 / steps)
    noise = rng.standard_normal((count, 3))
    noise[1:] *= math.sqrt(1 - factor**2)
    return signal.lfilter([1.0], [1.0, -factor], noise, axis=0)
