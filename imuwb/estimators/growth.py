"""How an integrator's error grows while nothing aids it: of a sensor's true processes, and of those that an estimator carries.

The error of an axis is integrated k times: k = 1 makes attitude from a gyro and velocity from an accelerometer, k = 2 makes
position from an accelerometer, k = 3 position from a gyro (times g). A filter that has seen the axis through white noise N
for long, and whose model of the slow error is a random walk K, knows the bias with the variance N K, and remembers for N/K
(the stationary Kalman filter). What it predicts after a time T without aids, and what is true of it, are then two numbers
of N, K and the true slow processes. They agree where the true process is that walk. Flicker noise and trends have no start
value, so the truth is a double sum over weights that add up to 0, of the structure function D(t) = E[(x(s+t) - x(s))²].
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from imuwb.arrays import Floats
from imuwb.stochastic import Constant, FlickerNoise, GaussMarkov, RandomWalk, Sum

#: how many times a gyro's and an accelerometer's error is integrated on its way to position
TO_POSITION = {"gyro": 3, "accel": 2}
_AHEAD, _BACK = 60, 100  #: cells over the time without aids, and over the filter's memory
_REACH = 30.0  #: memories that the past reaches back; e^-30 is nothing

#: second integral of a structure function, and what makes it for a process
_Twice: TypeAlias = Callable[[Floats], Floats]


@dataclass(frozen=True, slots=True)
class Weights:
    """Cells of time with a weight each; the weights add up to 0."""

    edges: Floats  #: (n + 1,) s, rising; aids end at 0
    weights: Floats  #: (n,)

    def variance(self, processes: Sum) -> float:
        """Return the variance of the weighted sum of a sum of slow processes."""
        before, after = self.edges[:-1], self.edges[1:]
        width = after - before
        total = np.zeros((len(width), len(width)))
        for twice in _second_integrals(processes):
            corner = twice(np.abs(after[:, None] - before[None]))
            total += corner + corner.T
            total -= twice(np.abs(after[:, None] - after[None])) + twice(np.abs(before[:, None] - before[None]))
        share = self.weights / width
        return max(0.0, float(-share @ total @ share / 2))


def remembered(horizon: float, times: int, memory: float) -> Weights:
    """Return the weights of an error integrated k times over a horizon, less the bias that a filter knew before.

    Args:
        horizon: s without aids.
        times: k.
        memory: s, over which the filter's knowledge of the bias decays.
    """
    nearest = 1e-3 * min(memory, horizon)
    back = -np.concatenate([[0.0], np.geomspace(nearest, _REACH * memory, _BACK)])[::-1]
    known = np.diff(np.exp(back / memory))
    return _joined(back, known / known.sum(), horizon, times)


def averaged(horizon: float, times: int, window: float) -> Weights:
    """Return the weights where the bias is the mean over a window before (s), as for an integrator without a filter."""
    back = np.linspace(-window, 0.0, _AHEAD + 1)
    return _joined(back, np.full(_AHEAD, 1 / _AHEAD), horizon, times)


def _joined(back: Floats, known: Floats, horizon: float, times: int) -> Weights:
    ahead = np.linspace(0.0, horizon, _AHEAD + 1)
    left = (horizon - ahead) ** times / math.factorial(times)
    gain = horizon**times / math.factorial(times)
    return Weights(np.concatenate([back, ahead[1:]]), np.concatenate([-gain * known, left[:-1] - left[1:]]))


def white_variance(density: float, horizon: float, times: int) -> float:
    """Return N² T^(2k-1) / ((2k-1) (k-1)!²)."""
    return density**2 * horizon ** (2 * times - 1) / ((2 * times - 1) * math.factorial(times - 1) ** 2)


def walk_variance(walk: float, horizon: float, times: int) -> float:
    """Return K² T^(2k+1) / ((2k+1) k!²), of a walk whose start is known."""
    return walk**2 * horizon ** (2 * times + 1) / ((2 * times + 1) * math.factorial(times) ** 2)


def constant_variance(sigma: float, horizon: float, times: int) -> float:
    """Return σ² T^(2k) / k!², of a bias that nobody knows."""
    return sigma**2 * horizon ** (2 * times) / math.factorial(times) ** 2


def predicted_variance(white: float, walk: float, horizon: float, times: int) -> float:
    """Return the variance, without the white noise after the aids ended, that a filter of N and K states."""
    return constant_variance(math.sqrt(white * walk), horizon, times) + walk_variance(walk, horizon, times)


def true_variance(slow: Sum, white: float, walk: float, horizon: float, times: int) -> float:
    """Return the same variance as it is when the slow error is ``slow``: half of N K comes from the white noise."""
    seen = constant_variance(math.sqrt(white * walk / 2), horizon, times)
    return seen + remembered(horizon, times, white / walk).variance(slow)


def slow_part(processes: Sum) -> Sum:
    """Return the processes that a filter can carry as a slow error: flicker noise, random walks, Gauss-Markov processes."""
    return Sum(tuple(term for term in processes.terms if isinstance(term, FlickerNoise | RandomWalk | GaussMarkov)))


def turn_on(processes: Sum) -> float:
    """Return sigma of the bias that is drawn at turn-on; 0 where none is stated."""
    return math.sqrt(sum(term.sigma**2 for term in processes.terms if isinstance(term, Constant)))


def _second_integrals(processes: Sum) -> list[_Twice]:
    """Return the second integral of each term's structure function: D is K²t, 2σ²(1 - e^(-t/τ)), (2B²/π) ln t."""
    found: list[_Twice] = []
    for term in processes.terms:
        if isinstance(term, RandomWalk):
            found.append(lambda t, k=term.K: k**2 * t**3 / 6)
        elif isinstance(term, GaussMarkov):
            found.append(lambda t, s=term.sigma, tc=term.Tc: _gauss_markov(t, s, tc))
        elif isinstance(term, FlickerNoise):
            found.append(lambda t, b=term.B: b**2 / np.pi * t**2 * np.log(np.maximum(t, 1e-300)))
    return found


def _gauss_markov(t: Floats, sigma: float, time: float) -> Floats:
    """Return 2σ² (t²/2 - τt + τ²(1 - e^(-t/τ))), whose terms cancel to t³/6τ - t⁴/24τ² where t is short."""
    x = t / time
    exact = x**2 / 2 - x - np.expm1(-x)
    series = x**3 / 6 - x**4 / 24 + x**5 / 120
    return 2 * sigma**2 * time**2 * np.where(x < 1e-2, series, exact)  # noqa: PLR2004 - where both agree to 1e-9
