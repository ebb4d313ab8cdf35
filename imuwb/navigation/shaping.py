"""From a sum of processes to the states that a filter carries for one sensor axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.linalg import block_diag

from imuwb.stochastic import (
    Autoregressive,
    FiniteOrder,
    FlickerNoise,
    GaussMarkov,
    Quantization,
    StateSpace,
    Sum,
    WhiteNoise,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from imuwb.stochastic import Process

    Floats = NDArray[np.float64]

#: "corrected": white noise of density N² and exp(-dt/Tc); "as printed": what Quinchia's appendix writes, to the letter
Reading = Literal["corrected", "as printed"]

FLICKER_BAND = (
    2e-4,
    0.2,
)  #: Hz, where a filter's Gauss-Markov states stand for flicker: outages, and what came before them
FLICKER_STATES = 3


@dataclass(frozen=True, eq=False, slots=True)
class Shaping:
    """The error of one axis: x(k+1) = A x(k) + w a sample, its output c x, and white noise of a density."""

    A: Floats  #: (p, p)
    Q: Floats  #: (p, p) covariance of w
    c: Floats  #: (p,) unit of the axis
    P0: Floats  #: (p, p) covariance of x at the start
    white: float  #: unit²/Hz, two-sided
    states: tuple[str, ...]  #: (p,) what each state is
    left_out: tuple[str, ...] = ()  #: processes that no state stands for

    @property
    def order(self) -> int:
        """Return the number of states."""
        return self.A.shape[0]

    def over(self, samples: int) -> tuple[Floats, Floats]:
        """Return A and Q of that many samples."""
        return over(self.A, self.Q, samples)


def over(a: Floats, q: Floats, samples: int) -> tuple[Floats, Floats]:
    """Return the transition and the noise of many samples, by doubling."""
    power, noise = np.eye(a.shape[0]), np.zeros_like(q)
    while samples:
        if samples & 1:
            power, noise = a @ power, a @ noise @ a.T + q
        a, q = a @ a, a @ q @ a.T + q
        samples >>= 1
    return power, noise


def shaping(processes: Sum, dt: float, reading: Reading = "corrected") -> Shaping:
    """Return the states of a sum of processes at a sampling interval.

    Quantization, whose integral does not grow, and what else has no state are left out, and named. Flicker noise becomes
    Gauss-Markov states, good in ``FLICKER_BAND``. A value at the instant stands for a sample's average: the difference is of
    the order of dt over the correlation time.

    Args:
        processes: of one axis, SI.
        dt: s.
        reading: of Quinchia's formulas.

    Raises:
        ValueError: an autoregressive process of another step, or one whose poles do not let it be carried.
    """
    spaces: list[StateSpace] = []
    names: list[str] = []
    left_out: list[str] = []
    white = 0.0
    for term in processes.terms:
        if isinstance(term, WhiteNoise):
            # Eq. 27 is a variance per sample, and printed as a density: it comes out larger by 1/dt.
            white += term.N**2 / (dt if reading == "as printed" else 1.0)
        elif isinstance(term, Quantization):
            left_out.append("quantization")
        else:
            for name, space in _spaces(term, dt, reading):
                spaces.append(space)
                names.extend(f"{name} {i + 1}" if space.order > 1 else name for i in range(space.order))
                white += space.R * dt
    if not spaces:
        none = np.zeros((0, 0))
        return Shaping(none, none, np.zeros(0), none, white, (), tuple(left_out))
    a, q, p = (block_diag(*(getattr(space, part) for space in spaces)) for part in ("A", "Q", "P0"))
    c = np.concatenate([space.c for space in spaces])
    return Shaping(a, q, c, p, white, tuple(names), tuple(left_out))


def _spaces(term: Process, dt: float, reading: Reading) -> Iterator[tuple[str, StateSpace]]:
    if isinstance(term, FlickerNoise):
        if term.B:
            band = FLICKER_BAND[0], min(FLICKER_BAND[1], 0.5 / dt)
            for part in term.approximate(band, FLICKER_STATES, dt).processes.terms:
                yield from _spaces(part, dt, reading)
    elif isinstance(term, GaussMarkov):
        space = term.discretize(dt)
        if reading == "as printed":  # eq. 2 and 21: 1 - dt/Tc, with the noise of eq. 28
            space = StateSpace(np.full((1, 1), 1 - dt / term.Tc), space.Q, space.c, space.R, space.P0)
        yield f"Gauss-Markov, {term.Tc:.4g} s", space
    elif isinstance(term, Autoregressive):
        if term.alpha:
            term.discretize(dt)  # says what is wrong with another step
            yield f"AR({len(term.alpha)})", lattice(term)
        else:
            yield "", term.discretize(dt)
    elif isinstance(term, FiniteOrder):
        yield str(getattr(term, "name", type(term).__name__)).replace("_", " "), term.discretize(dt)
    else:
        message = f"{term} has no state that a filter could carry"
        raise TypeError(message)


def lattice(process: Autoregressive) -> StateSpace:
    """Return an autoregressive process with orthonormal states, in the normalised lattice form (Gray and Markel 1975).

    The states are its backward prediction errors over their sigmas: their stationary covariance is the identity, where the
    last p values' of a process with poles near 1 is nearly singular, and a covariance of those is lost to rounding.
    """
    order = len(process.alpha)
    reflection = _reflection(process.alpha)
    variance = process.beta0**2 / np.prod(1 - reflection**2)

    def onwards(past: Floats, driving: float) -> Floats:
        forward, now = driving, np.empty(order)
        for m in range(order, 0, -1):
            k, rest = reflection[m - 1], np.sqrt(1 - reflection[m - 1] ** 2)
            backward = rest * past[m - 1] + k * forward
            forward = rest * forward - k * past[m - 1]
            if m < order:
                now[m] = backward
        now[0] = forward
        return now

    a = np.stack([onwards(unit, 0.0) for unit in np.eye(order)], axis=1)
    g = onwards(np.zeros(order), 1.0)
    c = np.zeros(order)
    c[0] = np.sqrt(variance)
    return StateSpace(a, np.outer(g, g), c, 0.0, np.eye(order))


def _reflection(alpha: tuple[float, ...]) -> Floats:
    """Return the reflection coefficients of a stable set, by Levinson's recursion backwards."""
    a = np.array(alpha)
    found = np.empty(a.size)
    for m in range(a.size, 0, -1):
        k = found[m - 1] = a[m - 1]
        a = (a[: m - 1] - k * a[: m - 1][::-1]) / (1 - k * k)
    return found
