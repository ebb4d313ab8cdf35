"""The state-space form of finite-order processes, which a filter needs."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats


@dataclass(frozen=True, eq=False, slots=True)
class StateSpace:
    """One process, in steps of dt: x(k+1) = A x(k) + w, cov(w) = Q; output c x + v, var(v) = R.

    ``P0`` is the covariance of x at the start: the stationary one where there is one.
    """

    A: Floats  #: (p, p)
    Q: Floats  #: (p, p)
    c: Floats  #: (p,)
    R: float
    P0: Floats  #: (p, p)

    @property
    def order(self) -> int:
        """Return the number of states."""
        return self.A.shape[0]


def white(variance: float) -> StateSpace:
    """Return white noise of that variance per sample: no state."""
    none = np.zeros((0, 0))
    return StateSpace(none, none, np.zeros(0), variance, none)


def single(a: float, q: float, p0: float) -> StateSpace:
    """Return one state, which is the output: its step, the variance of its noise, and its variance at the start."""
    one = np.ones((1, 1))
    return StateSpace(a * one, q * one, np.ones(1), 0.0, p0 * one)


def summed(space: StateSpace) -> StateSpace:
    """Return a process with one more state, which is its output: the sum of the outputs so far, S(k) = S(k-1) + c x(k), from 0 on."""
    a, q = with_sum(space.A, space.Q, space.c)
    p = np.zeros_like(q)
    p[:-1, :-1] = space.P0
    return StateSpace(a, q, np.eye(space.order + 1)[-1], 0.0, p)


def with_sum(a: Floats, q: Floats, c: Floats) -> tuple[Floats, Floats]:
    """Return A and Q, (p + 1, p + 1), with one more state: the sum of the outputs so far, S(k) = S(k-1) + c x(k)."""
    p = a.shape[0]
    more, noise = np.zeros((2, p + 1, p + 1))
    more[:p, :p], more[p, :p], more[p, p] = a, c @ a, 1.0
    noise[:p, :p], noise[p, :p], noise[:p, p] = q, c @ q, q @ c
    noise[p, p] = c @ q @ c
    return more, noise


def joined(parts: tuple[StateSpace, ...]) -> StateSpace:
    """Return the sum of independent processes: block-diagonal A, Q and P0, the parts of c one after another."""
    order = sum(part.order for part in parts)
    a, q, p = np.zeros((3, order, order))
    at = 0
    for part in parts:
        block = slice(at, at + part.order)
        a[block, block], q[block, block], p[block, block] = part.A, part.Q, part.P0
        at += part.order
    c = np.concatenate([part.c for part in parts]) if parts else np.zeros(0)
    return StateSpace(a, q, c, sum(part.R for part in parts), p)
