"""A first-order recursion whose factor changes from step to step."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.compiled import compiled


@compiled()
def carried(start: float, factor: Floats, steps: Floats) -> Floats:  # pragma: no cover - compiled
    """Return x, (n + 1,): first the start, then x(k) = factor(k) x(k-1) + steps(k), with (n,) factors and steps."""
    series = np.empty(steps.size + 1)
    series[0] = start
    for k in range(steps.size):
        series[k + 1] = factor[k] * series[k] + steps[k]
    return series
