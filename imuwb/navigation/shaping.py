"""Shaping filters: the states that represent the sum of processes on one sensor axis."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from imuwb.arrays import Floats
from imuwb.stochastic import (
    Autoregressive,
    FiniteOrder,
    FlickerNoise,
    GaussMarkov,
    Process,
    Quantization,
    StateSpace,
    Sum,
    WhiteNoise,
)
from imuwb.stochastic.state_space import summed, with_sum

#: How Quinchia's formulas are read (equations 2, 21 and 27 to 36). All readings but "corrected" have 1 - dt/Tc of eq. 21.
#: "corrected": white noise of density N², and exp(-dt/Tc).
#: "printed variances": the quantities of eqs. 27 to 36 are variances of a sample or step. N²/dt enters times dt².
#: "printed densities": they are densities, as the text calls them: all enter times dt. White noise is 1/dt times too strong, and
#: the noise of all biases dt times too weak, dt as a number of seconds.
Reading = Literal["corrected", "printed variances", "printed densities"]

DENSITIES: Reading = "printed densities"

#: Hz, band in which Gauss-Markov states represent flicker noise; it covers the lengths of outages and of the drive before them.
FLICKER_BAND = (2e-4, 0.2)
FLICKER_STATES = 3


@dataclass(frozen=True, eq=False, slots=True)
class Shaping:
    """The error of one axis: x(k+1) = A x(k) + w for each sample, with the output c x, and white noise.

    p is the number of states.
    """

    A: Floats  #: (p, p)
    Q: Floats  #: (p, p) covariance of w
    c: Floats  #: (p,) unit of the axis
    P0: Floats  #: (p, p) covariance of x at the start
    white: float  #: unit²/Hz, two-sided density of the white noise
    states: tuple[str, ...]  #: (p,) name of each state
    left_out: tuple[str, ...] = ()  #: processes without a state

    @property
    def order(self) -> int:
        """Return the number of states."""
        return self.A.shape[0]

    def over(self, samples: int) -> tuple[Floats, Floats]:
        """Return A and Q over a number of samples."""
        return over(self.A, self.Q, samples)

    def with_sum(self) -> tuple[Floats, Floats]:
        """Return A and Q with one more state: the sum of the errors so far, S(k) = S(k-1) + c x(k)."""
        return with_sum(self.A, self.Q, self.c)


def over(a: Floats, q: Floats, samples: int) -> tuple[Floats, Floats]:
    """Return a transition and its noise over a number of samples, by doubling."""
    power, noise = np.eye(a.shape[0]), np.zeros_like(q)
    while samples:
        if samples & 1:
            power, noise = a @ power, a @ noise @ a.T + q
        a, q = a @ a, a @ q @ a.T + q
        samples >>= 1
    return power, noise


def shaping(processes: Sum, dt: float, reading: Reading = "corrected") -> Shaping:
    """Return the shaping filter of a sum of processes at a sampling interval.

    Quantization has no state, as its integral does not grow; ``left_out`` names it. Flicker noise becomes Gauss-Markov states,
    which are valid in ``FLICKER_BAND``. The value at an instant is used for the average over a sample; the relative
    difference is about dt over the correlation time.

    Args:
        processes: the sum on one axis, SI.
        dt: s.
        reading: how Quinchia's formulas are read.

    Raises:
        ValueError: an autoregressive process with another sampling interval, or with poles outside the unit circle.
    """
    spaces: list[StateSpace] = []
    names: list[str] = []
    left_out: list[str] = []
    white = 0.0
    for term in processes.terms:
        if isinstance(term, WhiteNoise):
            # Eq. 27 states the variance of a sample; taken as a density, it is too large by the factor 1/dt.
            white += term.N**2 / (dt if reading == DENSITIES else 1.0)
        elif isinstance(term, Quantization):
            left_out.append("quantization")
        else:
            for name, space in _spaces(term, dt, reading):
                if reading == DENSITIES:
                    space = replace(space, Q=space.Q * dt)  # noqa: PLW2901 - the same process, read differently
                spaces.append(space)
                names.extend(f"{name} {i + 1}" if space.order > 1 else name for i in range(space.order))
                white += space.R * dt
    if not spaces:
        none = np.zeros((0, 0))
        return Shaping(none, none, np.zeros(0), none, white, (), tuple(left_out))
    a, q, p = (_diagonal([getattr(space, part) for space in spaces]) for part in ("A", "Q", "P0"))
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
        if reading != "corrected":  # eq. 2 and 21: 1 - dt/Tc, with the noise of eq. 28
            space = StateSpace(np.full((1, 1), 1 - dt / term.Tc), space.Q, space.c, space.R, space.P0)
        yield f"Gauss-Markov, {term.Tc:.4g} s", space
    elif isinstance(term, Autoregressive):
        if term.alpha:
            term.discretize(dt)  # raises if the process has another sampling interval
            yield f"AR({len(term.alpha)})", _autoregressive(term)
        else:
            yield "", term.discretize(dt)
    elif isinstance(term, FiniteOrder):
        yield str(getattr(term, "name", type(term).__name__)).replace("_", " "), term.discretize(dt)
    else:
        raise TypeError(f"{term} has no states; a filter can represent only processes of finite order")


def _autoregressive(process: Autoregressive) -> StateSpace:
    """Return an autoregressive process; one with a pole at 1 as the sum of a stable one, and of order 1 as a random walk."""
    steps = process.steps
    if steps is None:
        return lattice(process)
    return summed(lattice(steps)) if steps.alpha else process.discretize(process.dt)


def lattice(process: Autoregressive) -> StateSpace:
    """Return an autoregressive process with orthonormal states, in the normalised lattice form (Gray and Markel 1975).

    The states are the backward prediction errors over their sigmas; their stationary covariance is the identity. If
    the last p values were the states, poles near 1 would make the covariance nearly singular, and rounding would destroy it.
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
    """Return the reflection coefficients of a stable process, by Levinson's recursion in reverse."""
    a = np.array(alpha)
    reflection = np.empty(a.size)
    for m in range(a.size, 0, -1):
        k = reflection[m - 1] = a[m - 1]
        a = (a[: m - 1] - k * a[: m - 1][::-1]) / (1 - k * k)
    return reflection


def _diagonal(blocks: Sequence[Floats]) -> Floats:
    """Return a matrix of square blocks along its diagonal."""
    ends = np.cumsum([block.shape[0] for block in blocks])
    whole = np.zeros((ends[-1], ends[-1]))
    for block, end in zip(blocks, ends, strict=True):
        whole[end - block.shape[0] : end, end - block.shape[0] : end] = block
    return whole
