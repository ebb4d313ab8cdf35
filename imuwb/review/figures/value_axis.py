"""The range of the values in a chart over time: the viewer labels multiples of powers of ten, and one label shows no scale."""

import math

import numpy as np

from imuwb.arrays import Floats

MOST_STEPS = 8.0  #: of a power of ten, between which a small chart has room for labels
AIR = 0.03  #: share of the range that is added at both ends


def value_range(values: Floats, most_steps: float = MOST_STEPS) -> tuple[float, float] | None:
    """Return the range that a chart must show so that two values of its axis have labels; None: it need not be stated.

    Args:
        values: any shape; those that are not finite are left out.
        most_steps: number of steps between the ends at which the viewer still labels each.
    """
    known = values[np.isfinite(values)]
    if not known.size or (span := float(np.ptp(known))) <= 0:
        return None
    low, high = float(known.min()), float(known.max())
    step = 10.0 ** math.ceil(math.log10(span / most_steps))
    first, last = math.ceil(low / step), math.floor(high / step)
    if last > first:
        return None
    if last == first:  # one label: the nearer one of its neighbours
        below, above = low - (first - 1) * step, (last + 1) * step - high
        first, last = (first - 1, last) if below < above else (first, last + 1)
    else:
        first, last = last, first
    low, high = min(low, first * step), max(high, last * step)
    air = AIR * (high - low)
    return low - air, high + air
