"""Which power law rules at an averaging time: the lag-1 autocorrelation method.

W. J. Riley and C. A. Greenhall (2004), "Power law noise identification using the lag 1
autocorrelation"; NIST SP 1065, 5.5.3.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

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
    series = phase[:MOST]
    for differences in range(MOST_DIFFERENCES + 1):
        deviation = series - series.mean()
        # einsum, not @: threads of a linear-algebra library cost more here than they save
        power = float(np.einsum("i,i", deviation, deviation))
        if power == 0:
            return None
        r1 = float(np.einsum("i,i", deviation[1:], deviation[:-1])) / power
        # A fractionally differenced process of order delta has r1 = delta / (1 - delta).
        delta = r1 / (1 + r1)
        if delta < 0.25 or differences == MOST_DIFFERENCES:  # noqa: PLR2004 - the paper's
            return int(np.clip(round(2 - 2 * (delta + differences)), -2, 2))
        series = np.diff(series)
    return None
