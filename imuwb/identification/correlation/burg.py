"""Burg's method: one pass over the record for each order.

J. P. Burg (1975), with the sign of Quinchia, eq. 9: x(n) = -sum alpha_k x(n-k) + beta0 w(n). The same pass computes, block by
block, the forward and backward errors of an order and the sums for the next order.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.compiled import compiled

BLOCK = 1024  #: samples; a block stays in the fastest cache


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Burg:
    """Autoregressive models of order 0 ... p of one record."""

    mean: float  #: taken off before the fit
    n: int  #: samples
    alpha: tuple[Floats, ...]  #: coefficients, (k,) for order k
    variance: Floats  #: (p + 1,) variance of the innovations, beta0²

    def __repr__(self) -> str:
        """Return the number of models."""
        return f"Burg's models of orders 0 to {len(self.alpha) - 1}, from {self.n} samples"

    def standard_errors(self, order: int) -> Floats:
        """Return the standard errors of alpha, (p,), if the series is autoregressive of this order p; of 1: √((1 - alpha²)/n).

        The covariance is beta0²/n R^-1. Its diagonal follows from the models of lower orders (Levinson): R^-1 = sum a_k a_k'/v_k.
        """
        diagonal = np.zeros(order)
        for k in range(order):  # the model of order k, newest value last, in rows 0 ... k
            diagonal[: k + 1] += np.append(self.alpha[k][::-1], 1.0) ** 2 / self.variance[k]
        return np.sqrt(diagonal * self.variance[order] / self.n)


def burg(values: Floats, orders: int, breaks: Sequence[int] = ()) -> Burg:
    """Return the models of all orders up to ``orders``.

    Args:
        values: (n,) evenly spaced samples.
        orders: highest order.
        breaks: indices before which samples are missing; no error spans a break.

    Raises:
        ValueError: no part between breaks is longer than the highest order, or the channel is constant.
    """
    edges = np.array([0, *sorted(breaks), values.size], dtype=np.int64)
    if np.diff(edges).max() <= orders:
        raise ValueError(
            f"the longest part without gaps has {np.diff(edges).max()} samples; order {orders} needs at least {orders + 1}"
        )
    mean = float(values.mean())
    forward = values - mean
    power = float(np.einsum("i,i", forward, forward)) / values.size
    if power == 0:
        raise ValueError("the channel is constant, so it has no autoregressive model")
    backward = forward.copy()
    alpha, variance = [np.empty(0)], [power]
    reflection = 0.0
    for order in range(1, orders + 1):
        product, squares = _sweep(forward, backward, edges, order - 1, reflection)
        reflection = -2 * product / squares if squares > 0 else 0.0
        last = np.append(alpha[-1], 0.0)
        alpha.append(last + reflection * np.append(last[:-1][::-1], 1.0))
        variance.append(variance[-1] * (1 - reflection**2))
    return Burg(mean, values.size, tuple(alpha), np.array(variance))


@compiled()
def _sweep(
    forward: Floats, backward: Floats, edges: Integers, order: int, reflection: float
) -> tuple[float, float]:  # pragma: no cover - compiled
    """Update the errors to ``order`` in place, and return the sums for the next order.

    In a part that begins at s, the forward error of sample s + i + order stays at that index, and the backward error that it
    is multiplied with stays at s + i, so no error is ever moved.
    """
    product = squares = 0.0
    for part in range(edges.size - 1):
        begin, size = edges[part], edges[part + 1] - edges[part]
        count = size - order  # pairs to update
        if count <= 0:
            continue
        f, b = forward[begin + order : begin + size], backward[begin : begin + count]
        for low in range(0, count, BLOCK):
            high = min(low + BLOCK, count)
            if reflection != 0.0:
                _update(f[low:high], b[low:high], reflection)
            # The backward error of a sample is multiplied with the forward error of the next sample.
            first = max(low - 1, 0)
            p, s = _sums(f[first + 1 : high], b[first : high - 1])
            product += p
            squares += s
    return product, squares


@compiled(reorder=True)
def _update(f: Floats, b: Floats, reflection: float) -> None:  # pragma: no cover - compiled
    for i in range(f.size):
        x, y = f[i], b[i]
        f[i] = x + reflection * y
        b[i] = y + reflection * x


@compiled(reorder=True)
def _sums(f: Floats, b: Floats) -> tuple[float, float]:  # pragma: no cover - compiled
    product = squares = 0.0
    for i in range(f.size):
        product += f[i] * b[i]
        squares += f[i] * f[i] + b[i] * b[i]
    return product, squares
