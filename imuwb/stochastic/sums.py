"""What processes can compute, and sums of processes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from imuwb.arrays import Floats
from imuwb.stochastic import state_space
from imuwb.stochastic.state_space import StateSpace


@runtime_checkable
class Process(Protocol):
    """A zero-mean random process on one sensor axis. A sample is its average over dt."""

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return the Allan variance of samples of length dt at averaging times tau (s)."""
        ...

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return the two-sided density of the sampled process at f in (0, 1/(2 dt)], Hz."""
        ...

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n consecutive samples."""
        ...


@runtime_checkable
class Stationary(Process, Protocol):
    """A process whose variance does not grow."""

    def autocovariance(self, lag: Floats) -> Floats:
        """Return the autocovariance of the continuous process at lag (s)."""
        ...


@runtime_checkable
class FiniteOrder(Process, Protocol):
    """A process that a Kalman filter can carry.

    Every ``Sum`` has the method; ask ``Sum.is_finite_order`` (and ``is_stationary``) whether its terms have it.
    """

    def discretize(self, dt: float) -> StateSpace:
        """Return the process at instants dt apart.

        The output is the value *at* an instant, while a sample is the average up to the next instant. The longer dt is
        compared with the process's correlation time, the more the two differ.
        """
        ...


class Addable:
    """Gives processes their ``+``."""

    __slots__ = ()

    def __add__(self, other: Process | Sum) -> Sum:
        """Return the sum of two independent processes."""
        return Sum((*_terms(self), *_terms(other)))

    def __radd__(self, other: object) -> Sum:
        """Let ``sum()`` begin at 0."""
        return Sum((*(() if other == 0 else _terms(other)), *_terms(self)))


@dataclass(frozen=True)
class Sum(Addable):
    """Independent processes that add."""

    terms: tuple[Process, ...] = ()

    def __str__(self) -> str:
        """Return the terms with plus signs between them, such as ``WhiteNoise(N=0.001) + RandomWalk(K=2e-05)``."""
        return " + ".join(map(str, self.terms)) or "no process"

    def allan_variance(self, tau: Floats, dt: float) -> Floats:
        """Return the sum of the terms' Allan variances."""
        return sum((term.allan_variance(tau, dt) for term in self.terms), np.zeros_like(tau))

    def power_spectral_density(self, f: Floats, dt: float) -> Floats:
        """Return the sum of the terms' two-sided densities."""
        return sum((term.power_spectral_density(f, dt) for term in self.terms), np.zeros_like(f))

    def sample(self, n: int, dt: float, rng: np.random.Generator) -> Floats:
        """Return n samples; the terms are drawn one after another."""
        total = np.zeros(n)
        for term in self.terms:
            total += term.sample(n, dt, rng)
        return total

    def autocovariance(self, lag: Floats) -> Floats:
        """Return the sum of the terms' autocovariances.

        Raises:
            TypeError: a term has none.
        """
        total = np.zeros_like(lag)
        for term in self.terms:
            if not isinstance(term, Stationary):
                raise TypeError(f"{term} is not stationary: it has no autocovariance")
            total += term.autocovariance(lag)
        return total

    @property
    def is_stationary(self) -> bool:
        """Whether every term has an autocovariance."""
        return all(isinstance(term, Stationary) for term in self.terms)

    @property
    def is_finite_order(self) -> bool:
        """Whether every term has a state space."""
        return all(isinstance(term, FiniteOrder) for term in self.terms)

    def discretize(self, dt: float) -> StateSpace:
        """Return all terms as one state space.

        Raises:
            TypeError: a term is not of finite order (flicker: take its ``approximate``).
        """
        parts: list[StateSpace] = []
        for term in self.terms:
            if not isinstance(term, FiniteOrder):
                raise TypeError(f"{term} has no state space of finite order; use its approximation (approximate)")
            parts.append(term.discretize(dt))
        return state_space.joined(tuple(parts))


def short_text(value: Any) -> str:  # noqa: ANN401 - a number, or numbers
    """Return a number, or numbers, with four digits."""
    return f"({', '.join(map(short_text, value))})" if isinstance(value, tuple) else f"{value:.4g}"


def _terms(value: object) -> tuple[Process, ...]:
    if isinstance(value, Sum):
        return value.terms
    if isinstance(value, Process):
        return (value,)
    raise TypeError(f"{value!r} is not a process; a sum takes processes only")
