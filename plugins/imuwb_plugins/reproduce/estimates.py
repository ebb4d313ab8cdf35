"""From the results of analyses to estimates in the units that a paper prints."""

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from imuwb.arrays import Floats
from imuwb.statistics import Coefficient, Estimate
from imuwb.units import UNITS
from imuwb_plugins.reproduce.printed import NORMAL

PARTS = 10  #: of a record, for the error of what has no interval of its own


def in_unit(coefficient: Coefficient, unit: str) -> Estimate | str:
    """Return a coefficient in a unit, or why there is none: the record shows only a limit."""
    if coefficient.value is None or coefficient.lower is None:
        return f"not identified: below {UNITS[unit].from_si(coefficient.upper):.3g} {unit}"
    ends = (UNITS[unit].from_si(x) for x in (coefficient.value, coefficient.lower, coefficient.upper))
    return Estimate(*ends, unit=unit)


def exact(value: float, unit: str) -> Estimate:
    """Return a number without error, such as a count."""
    return Estimate(value, value, value, unit=unit)


def by_parts(
    series: Floats, whole: Floats, estimate: Callable[[Floats], Floats]
) -> Iterator[tuple[float, float, float]]:
    """Yield values of a whole record with the 95 % intervals that their scatter over ten parts gives.

    Args:
        series: (n,) samples.
        whole: (k,) values of the whole record.
        estimate: from the samples of a part to (k,) values.
    """
    parts = np.array([estimate(part) for part in np.array_split(series, PARTS)])
    half = NORMAL * parts.std(axis=0, ddof=1) / math.sqrt(PARTS)
    yield from zip(whole.tolist(), (whole - half).tolist(), (whole + half).tolist(), strict=True)


def mean_of(values: Sequence[float], unit: str) -> Estimate:
    """Return the mean of a few values with the 95 % interval of the mean."""
    from scipy.stats import t  # noqa: PLC0415 - slow to import

    array = np.asarray(values, dtype=float)
    if array.size < 2:  # noqa: PLR2004 - a spread needs two
        return Estimate(float(array.mean()), -math.inf, math.inf, unit=unit)
    half = float(t.ppf(0.975, array.size - 1)) * array.std(ddof=1) / math.sqrt(array.size)
    return Estimate(float(array.mean()), float(array.mean() - half), float(array.mean() + half), unit=unit)
