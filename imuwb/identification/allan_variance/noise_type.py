"""The power law that dominates at an averaging time, by the lag-1 autocorrelation.

W. J. Riley and C. A. Greenhall (2004), "Power law noise identification using the lag 1
autocorrelation"; NIST SP 1065, 5.5.3.
"""

import numpy as np

from imuwb.arrays import Floats
from imuwb.compiled import compiled

FEWEST = 30  #: least number of averaged points that the method needs
MOST = 1 << 11  #: points that are used; the autocorrelation then scatters by 0.022, and the noise types are 0.25 apart
MOST_DIFFERENCES = 2


def exponent(phase: Floats) -> int | None:
    """Return alpha (2 quantization ... 0 white, -1 flicker, -2 random walk) of phase data at its own step.

    The result is None for fewer than 30 points, or for constant phase.
    """
    if phase.size < FEWEST:
        return None
    delta = _order(phase[:MOST].copy())
    return None if np.isnan(delta) else int(np.clip(round(2 - 2 * delta), -2, 2))


@compiled()
def _order(series: Floats) -> float:  # pragma: no cover - compiled
    """Return the order of fractional differencing; nan for a constant series. ``series`` is overwritten."""
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
