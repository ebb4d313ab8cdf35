"""The first-order autoregressive coefficient at one temperature (El-Diasty, tables 2 to 5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.identification.correlation.autoregressive import fit_autoregressive
from imuwb.identification.temperature.record import residuals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.identification.temperature.record import Record

    Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class FirstOrder:
    """x(n) = -alpha x(n-1) + beta0 w(n); the paper's text, b(k+1) = C b(k) + e, has C = -alpha."""

    alpha: float
    sigma: float  #: standard error, Bartlett's: true whatever the series is
    sigma_if_ar: float  #: √((1 - alpha²)/n), true only of an AR(1)

    @property
    def paper(self) -> float:
        """Return C of the paper's text."""
        return -self.alpha


def first_order(records: Sequence[Record], dt: float) -> FirstOrder:
    """Return the coefficient of one axis's records at one temperature, their drifts taken off.

    Raises:
        ValueError: a record that is too short, or constant.
    """
    rests = [residuals(record)[1] for record in records]
    return first_order_of(np.concatenate(rests), dt, [int(b) for b in np.cumsum([r.size for r in rests])[:-1]])


def first_order_of(values: Floats, dt: float, breaks: Sequence[int]) -> FirstOrder:
    """Return the coefficient of samples with these breaks, by Burg's method."""
    first = fit_autoregressive(values, dt, 1, test=(), breaks=breaks).orders[0]
    return FirstOrder(float(first.alpha[0]), float(first.alpha_sigma[0]), float(first.alpha_sigma_if_ar[0]))
