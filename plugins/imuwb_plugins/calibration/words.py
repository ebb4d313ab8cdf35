"""Parameters as text: as many digits as the interval is worth."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from imuwb.texts import decimals
from imuwb.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from imuwb_plugins.calibration.result import Parameter

DEGREE = math.pi / 180
#: unit of a parameter -> factor and unit that one reads it in
DISPLAY = {
    "rad/s": (DEGREE, "deg/s"), "m/s²": (STANDARD_GRAVITY * 1e-3, "mg"), "1": (1e-2, "%"), "rad": (1e-3, "mrad"),
    "rad/s/(m/s²)": (DEGREE / STANDARD_GRAVITY, "deg/s/g"),
}  # fmt: skip
#: unit behind that of a raw log -> likewise
_PER = {"/(rad/s)": (1 / DEGREE, "/(deg/s)"), "/(m/s²)": (1 / STANDARD_GRAVITY, "/g")}


def display(unit: str) -> tuple[float, str]:
    """Return the factor from what is read to what is stored, and the unit that is read."""
    if unit in DISPLAY:
        return DISPLAY[unit]
    for end, (factor, name) in _PER.items():
        if unit.endswith(end):
            return factor, unit.removesuffix(end) + name
    return 1.0, unit


def interval_text(p: Parameter | None) -> str:
    """Return a parameter with its interval in the unit that one reads it in; a dash for None."""
    if p is None:
        return "—"
    factor, unit = display(p.unit)
    value, low, high = p.value / factor, p.lower / factor, p.upper / factor
    digits = decimals(high - low)
    return f"{value:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}] {unit}"
