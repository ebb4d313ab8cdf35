"""Autoregressive processes, which are valid at their own step only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.stochastic import state_space
from imuwb.stochastic.elementary import Elementary
from imuwb.stochastic.state_space import StateSpace

ROUNDING = 1e-9  #: margin of a pole's magnitude: rounding may put a pole at 1 just below 1
EXACT = 1e-12  #: largest 1 + sum alpha of a pole that is exactly 1


@dataclass(frozen=True, slots=True)
class Autoregressive(Elementary):
    """x(n) = -sum alpha_k x(n-k) + beta0 w(n) (Quinchia, eq. 9); valid at its own step only.

    One pole may be exactly 1: then the process is the sum of a stable one of lower order, from 0 on. Of order 1 it is a random walk.

    Raises:
        ValueError: another pole on or outside the unit circle; the message names it.
    """

    alpha: tuple[float, ...]
    beta0: float  #: unit
    dt: float  #: s, the step of the samples
    name: ClassVar[str] = "autoregressive"

    def __post_init__(self) -> None:
        """Check that the process is stable."""
        Elementary.__post_init__(self)
        object.__setattr__(self, "alpha", tuple(float(a) for a in self.alpha))
        sums = np.cumsum([1.0, *self.alpha])
        poles = np.roots(sums[:-1] if self.alpha and abs(sums[-1]) < EXACT else [1.0, *self.alpha])
        worst = max(np.abs(poles), default=0.0)
        if worst >= 1 - ROUNDING:
            raise ValueError(
                f"this AR set is not stable: it has a pole of magnitude {worst:.6g}; it must be below 1, or one pole exactly 1"
            )

    @property
    def steps(self) -> Autoregressive | None:
        """Return the stable process of which this one is the sum, if a pole is exactly 1; else None."""
        sums = np.cumsum([1.0, *self.alpha])
        if not self.alpha or abs(sums[-1]) >= EXACT:
            return None
        return Autoregressive(tuple(sums[1:-1]), self.beta0, self.dt)

    def _at(self, dt: float) -> None:
        if abs(dt - self.dt) > 1e-6 * self.dt:
            raise ValueError(f"this AR model is valid at its own step of {self.dt} s only, not at {dt} s; resample it")

    def _stationary(self) -> StateSpace:
        if self.steps is not None:
            raise ValueError("this AR set has a pole at 1: its variance grows, so it is not stationary")
        from scipy.linalg import solve_discrete_lyapunov  # noqa: PLC0415 - slow to import, seldom needed

        p = len(self.alpha)
        a = np.eye(p, k=-1)
        a[0] = -np.array(self.alpha)
        q = np.zeros((p, p))
        q[0, 0] = self.beta0**2
        return StateSpace(a, q, np.eye(p)[0], 0.0, solve_discrete_lyapunov(a, q))

    def discretize(self, dt: float) -> StateSpace:
        """Return the companion form, newest value first; at its own step only."""
        self._at(dt)
        steps = self.steps
        if steps is not None and steps.alpha:
            return state_space.summed(steps.discretize(dt))
        if steps is not None:
            return state_space.single(1.0, self.beta0**2, 0.0)
        return self._stationary() if self.alpha else state_space.white(self.beta0**2)

    def every(self, factor: int) -> StateSpace:
        """Return the process seen at every ``factor``-th sample, exactly: A^m, and the noise of m steps added up.

        It has the same states, but not the form of an autoregressive process (``resampled`` has).
        """
        if not self.alpha:
            return state_space.white(self.beta0**2)
        step = self._stationary()
        power = np.linalg.matrix_power(step.A, factor)
        # The noise of the steps is the part of the stationary covariance that the power does not explain.
        return StateSpace(power, step.P0 - power @ step.P0 @ power.T, step.c, 0.0, step.P0)

    def resampled(self, factor: int) -> Autoregressive:
        """Return an autoregressive process of the same order p with ``factor`` times the step.

        Its autocovariance agrees with that of every ``factor``-th sample up to lag p (Yule and Walker). Except for order 1,
        these samples themselves are no autoregressive process of that order.
        """
        if not self.alpha or factor == 1:
            return Autoregressive(self.alpha, self.beta0, self.dt * factor)
        from scipy.linalg import solve_toeplitz  # noqa: PLC0415 - slow to import, seldom needed

        p = len(self.alpha)
        if p == 1 and self.steps is not None:
            return Autoregressive(self.alpha, self.beta0 * factor**0.5, self.dt * factor)
        r = self.autocovariance(np.arange(p + 1.0) * (factor * self.dt))
        alpha = -solve_toeplitz(r[:p], r[1:])
        return Autoregressive(tuple(alpha), float(r[0] + alpha @ r[1:]) ** 0.5, self.dt * factor)

    def autocovariance(self, lag: Floats) -> Floats:
        """Return the autocovariance at lags that are multiples of its step."""
        steps = np.rint(np.abs(lag) / self.dt).astype(np.int64)
        if not self.alpha:
            return np.where(steps == 0, self.beta0**2, 0.0)
        first = self._stationary().P0[0]
        most = int(steps.max(initial=0)) + 1
        # r(k) = -sum alpha r(k-j): the recursion of the series itself, started with its exact values.
        rest = self._filtered(np.zeros(most), first[::-1])
        return np.concatenate([first, rest])[steps]

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return the Allan variance from the autocovariance: (4 V(m) - V(2m)) / (2 m²), V(m) the variance of a sum of m."""
        self._at(dt)
        m = np.rint(tau / self.dt).astype(np.int64)
        if (steps := self.steps) is not None:
            return np.array([_variance_of_sums(steps, int(size)) for size in m])
        k = np.arange(2.0 * int(m.max()))
        r = self.autocovariance(k * self.dt)
        lower, weighted = np.cumsum(r) - r[0], np.cumsum(k * r)

        def variance_of_sum(size: Integers) -> Floats:
            return size * r[0] + 2 * (size * lower[size - 1] - weighted[size - 1])

        return (4 * variance_of_sum(m) - variance_of_sum(2 * m)) / (2 * m.astype(np.float64) ** 2)

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return beta0² dt / |1 + sum alpha z^-k|²."""
        self._at(dt)
        z = np.exp(-2j * np.pi * f[..., None] * dt * np.arange(1, len(self.alpha) + 1))
        return self.beta0**2 * dt / np.abs(1 + z @ np.array(self.alpha)) ** 2

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples, stationary from the first; with a pole at 1, from 0 on."""
        self._at(dt)
        if (steps := self.steps) is not None:
            return np.cumsum(steps.sample(n, dt, rng))
        noise = self.beta0 * rng.standard_normal(n)
        if not self.alpha:
            return noise
        past = np.linalg.cholesky(self._stationary().P0 + 1e-300 * np.eye(len(self.alpha))) @ rng.standard_normal(
            len(self.alpha)
        )
        return self._filtered(noise, past)

    def _filtered(self, noise: Floats, past: Floats) -> Floats:
        """Return the series that noise drives from its past values, the newest first."""
        from scipy import signal  # noqa: PLC0415 - slow to load

        taps = [1.0, *self.alpha]
        return signal.lfilter([1.0], taps, noise, zi=signal.lfiltic([1.0], taps, past))[0]


def _variance_of_sums(steps: Autoregressive, m: int) -> float:
    """Return the Allan variance of the sums of a stable process over blocks of m: its samples count with a triangle as weight."""
    from scipy import signal  # noqa: PLC0415 - slow to load

    triangle = np.minimum(np.arange(1.0, 2 * m), np.arange(2 * m - 1.0, 0, -1)) / m
    weight = signal.fftconvolve(triangle, triangle)[triangle.size - 1 :]
    r = steps.autocovariance(np.arange(float(triangle.size)) * steps.dt)
    return float(weight[0] * r[0] + 2 * weight[1:] @ r[1:]) / 2
