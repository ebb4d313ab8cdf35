"""The papers' intervals of coefficients: by the number of clusters at the averaging time at which a coefficient is read."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from imuwb.identification.allan_variance.fit import AllanFit
from imuwb.identification.coefficient import printed_half_width
from imuwb.statistics import Coefficient


def printed_intervals(fit: AllanFit, duration: float) -> Mapping[str, Coefficient]:
    """Return the coefficients with the papers' intervals.

    Quinchia's table 4 has them at the end of the part of the curve where a coefficient is read: gyro x, B +-5.14 of 44.533 is eq. 15
    at 654 s, the end of its flat part. So B is taken at the end of the flat part, N where its region ends, and K and R where theirs
    begin. A coefficient without such a part has an interval without ends.

    Args:
        fit: of the curve.
        duration: s, of the record.
    """
    regions = {region.letter: region for region in fit.regions}
    times = {letter: regions[letter].end for letter in "QN" if letter in regions}
    times |= {letter: regions[letter].start for letter in "KR" if letter in regions}
    if (flat := fit.correlation_time) is not None:
        times["B"] = flat.upper if np.isfinite(flat.upper) else flat.lower
    return {letter: _printed(c, times.get(letter), duration, fit.level) for letter, c in fit.coefficients.items()}


def _printed(c: Coefficient, time: float | None, duration: float, level: float) -> Coefficient:
    if c.value is None:
        return c
    if time is None:
        return replace(c, lower=0.0, upper=float("inf"))
    half = float(printed_half_width(np.array(duration / time), level))
    return replace(c, lower=max(c.value * (1 - half), 0.0), upper=c.value * (1 + half))
