"""Burg's method, all orders in one sweep over the record each.

J. P. Burg (1975); the form with alpha as in Quinchia, eq. 9: x(n) = -sum alpha_k x(n-k) + beta0 w(n). Forward
and backward errors of an order and the sums for the next are computed in the same pass, block by block.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.compiled import compiled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

BLOCK = 1024


@dataclass(frozen=True, eq=False, slots=True)
class Burg:
    """Autoregressive models of order 0 ... p of one record."""

    mean: float  #: taken off
    n: int  #: samples
    alpha: tuple[Floats, ...]  #: (k,) for order k
    variance: Floats  #: (p + 1,) of the innovations, beta0²


def burg(values: Floats, orders: int, breaks: Sequence[int] = ()) -> Burg:
    """Return the models of all orders up to ``orders``.

    Args:
        values: (n,) evenly spaced samples; their mean is taken off.
        orders: highest order.
        breaks: indices at which samples are missing before; no error spans one.

    Raises:
        ValueError: no part between breaks is longer than the highest order, or the channel is constant.
    """
    edges = np.array([0, *sorted(breaks), values.size], dtype=np.int64)
    if np.diff(edges).max() <= orders:
        message = f"the longest part of the record has {np.diff(edges).max()} samples; order {orders} needs more"
        raise ValueError(message)
    mean = float(values.mean())
    forward = values - mean
    power = float(np.einsum("i,i", forward, forward)) / values.size
    if power == 0:
        message = "the channel is constant: it has no autoregressive model"
        raise ValueError(message)
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
    forward: Floats, backward: Floats, edges: NDArray[np.int64], order: int, reflection: float
) -> tuple[float, float]:  # pragma: no cover - compiled
    """Take the errors from the order before to ``order`` in place; return the sums for the one above.

    Of a part that begins at s, the forward error of sample s + i + order lies at that place, the backward error
    that it meets at s + i: so neither is ever moved.
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
            # The backward error of one sample meets the forward error of the next.
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
