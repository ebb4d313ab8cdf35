"""The first-order autoregressive coefficient at one temperature (El-Diasty, tables 2 to 5)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.correlation.autoregressive import fit_autoregressive
from imuwb.identification.temperature.record import Record, residuals


@dataclass(frozen=True, slots=True)
class FirstOrder:
    """The AR(1) x(n) = -alpha x(n-1) + beta0 w(n); El-Diasty's b(k+1) = C b(k) + e has C = -alpha."""

    alpha: float
    sigma: float  #: standard error by Bartlett's formula, for any series
    sigma_if_ar: float  #: √((1 - alpha²)/n), for a true AR(1) only

    def __str__(self) -> str:
        """Return alpha with its standard error."""
        return f"alpha {self.alpha:.5f} ± {self.sigma:.1g}"


def first_order(records: Sequence[Record], dt: float) -> FirstOrder:
    """Return the coefficient of one axis's records at one temperature, without their drifts.

    Raises:
        ValueError: a record that is too short or constant.
    """
    rests = [residuals(record)[1] for record in records]
    return first_order_of(np.concatenate(rests), dt, [int(b) for b in np.cumsum([r.size for r in rests])[:-1]])


def first_order_of(values: Floats, dt: float, breaks: Sequence[int]) -> FirstOrder:
    """Return the coefficient of samples with breaks, by Burg's method."""
    first = fit_autoregressive(values, dt, 1, test=(), breaks=breaks).orders[0]
    return FirstOrder(float(first.alpha[0]), float(first.alpha_sigma[0]), float(first.alpha_sigma_if_ar[0]))
