"""Which power law rules at an averaging time: the lag-1 autocorrelation method.

W. J. Riley and C. A. Greenhall (2004), "Power law noise identification using the lag 1
autocorrelation"; NIST SP 1065, 5.5.3.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.compiled import compiled

if TYPE_CHECKING:
    from numpy.typing import NDArray

FEWEST = 30  #: averaged points; with fewer the method guesses
MOST = 1 << 11  #: points looked at; the autocorrelation is then sure to 0.022, and its steps are 0.25 apart
MOST_DIFFERENCES = 2


def exponent(phase: NDArray[np.float64]) -> int | None:
    """Return alpha (2 quantization ... 0 white, -1 flicker, -2 random walk) of phase data at its own step.

    None where there are fewer than 30 points, or nothing varies.
    """
    if phase.size < FEWEST:
        return None
    delta = _order(phase[:MOST].copy())
    return None if np.isnan(delta) else int(np.clip(round(2 - 2 * delta), -2, 2))


@compiled()
def _order(series: NDArray[np.float64]) -> float:  # pragma: no cover - compiled
    """Return the order of fractional differencing; nan where nothing varies. ``series`` is used up."""
    n = series.size
    for differences in range(MOST_DIFFERENCES + 1):
        mean = 0.0
        for k in range(n):
            mean += series[k] / n
        power = product = 0.0
        for k in range(n):
            power += (series[k] - mean) ** 2
            if k:
                product += (series[k] - mean) * (series[k - 1] - mean)
        if power == 0.0:
            return np.nan
        # A fractionally differenced process of order delta has r1 = delta / (1 - delta).
        delta = product / (power + product)
        if delta < 0.25 or differences == MOST_DIFFERENCES:  # noqa: PLR2004 - the paper's
            return delta + differences
        n -= 1
        for k in range(n):
            series[k] = series[k + 1] - series[k]
    return np.nan
