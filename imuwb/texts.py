"""Numbers, times and estimates as a person reads them. A figure never goes without its unit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from imuwb.statistics.estimate import Coefficient, Estimate
    from imuwb.units import Unit

HOURS = 2  #: hours, from which a time is given in hours
LARGE = 100  #: from which a number of three digits has no decimals


def number_text(value: float) -> str:
    """Return a number with three digits, and without a power of ten if it is large: 0.0123, 4.56, 78901."""
    return f"{value:.0f}" if abs(value) >= LARGE else f"{value:.3g}"


def quantity_text(value: float | None, unit: str, digits: int = 3) -> str:
    """Return a value with its unit, with that many significant digits; a dash for None."""
    return "—" if value is None else f"{value:.{digits}g} {unit}"


def seconds_text(seconds: float) -> str:
    """Return a time: 0.35 s, 20.5 s, 655 s, 2.3 h."""
    return f"{seconds / 3600:.2g} h" if seconds >= HOURS * 3600 else f"{number_text(seconds)} s"


def interval_text(estimate: Estimate, unit: str = "") -> str:
    """Return an estimate in the unit it has, three digits each: 12.3 [10, 15] m; without its interval where it has none."""
    text = number_text(estimate.value)
    if not math.isnan(estimate.lower):
        text += f" [{number_text(estimate.lower)}, {number_text(estimate.upper)}]"
    return f"{text} {unit or estimate.unit}".rstrip()


def estimate_text(estimate: Estimate, unit: str, factor: float = 1.0) -> str:
    """Return an estimate with the decimals that its interval is worth: 0.123 [0.120, 0.126] deg/s.

    Args:
        estimate: with an interval.
        unit: name of the display unit; empty: no unit.
        factor: value of one display unit in the unit of the estimate.
    """
    value, low, high = (x / factor for x in (estimate.value, estimate.lower, estimate.upper))
    digits = decimals(high - low)
    return f"{value:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}] {unit}".rstrip()


def coefficient_text(coefficient: Coefficient, unit: Unit) -> str:
    """Return a coefficient with its interval in a display unit, with as many digits as the interval is worth.

    "<" stands before a limit; a dash stands for what nothing bounds.
    """
    c = coefficient
    if c.value is None:
        return f"< {unit.from_si(c.upper):.3g} {unit.name}" if math.isfinite(c.upper) else "—"
    low, value = unit.from_si(c.lower or 0.0), unit.from_si(c.value)
    if not math.isfinite(c.upper):
        return f"{value:.3g} [{low:.3g}, —] {unit.name}"
    high = unit.from_si(c.upper)
    digits = 3
    if high > low and value > 0:
        digits = min(max(math.floor(2 - math.floor(math.log10((high - low) / value))), 3), 6)
    return f"{value:.{digits}g} [{low:.{digits}g}, {high:.{digits}g}] {unit.name}"


def decimals(width: float) -> int:
    """Return how many decimals a value is worth whose interval is so wide: two digits of the width."""
    if not (width > 0 and math.isfinite(width)):
        return 6
    return min(max(1 - math.floor(math.log10(width)), 0), 9)
