"""One axis of a figure, logarithmic or linear: its limits, its ticks, and where a value lies on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
STEPS = 6  #: of a linear axis, about
EDGE = 1e-9  #: of an axis, by which rounding may put a tick outside


@dataclass(frozen=True, slots=True)
class Tick:
    """A grid line; a label where it is a major one."""

    at: float  #: 0 ... 1 along the axis
    label: str


@dataclass(frozen=True, slots=True)
class Scale:
    """An axis from ``low`` to ``high``, which are exponents of ten where it is logarithmic."""

    kind: Literal["log", "linear"]
    low: float
    high: float

    @staticmethod
    def around(kind: Literal["log", "linear"], parts: Iterable[object], limits: tuple[float, float] | None) -> Scale:
        """Return an axis that holds all finite values (positive ones, if logarithmic), with some air."""
        if limits is not None:
            low, high = limits
            return Scale(kind, math.log10(low), math.log10(high)) if kind == "log" else Scale(kind, low, high)
        arrays = [np.asarray(part, dtype=np.float64) for part in parts if part is not None]
        values = np.concatenate(arrays) if arrays else np.ones(1)
        values = values[np.isfinite(values) & ((values > 0) | (kind == "linear"))]
        if not values.size:
            values = np.ones(1)
        low, high = float(values.min()), float(values.max())
        if kind == "linear":
            air = (high - low) * 0.04 or abs(high) * 0.1 or 1.0
            return Scale(kind, low - air, high + air)
        low, high = math.floor(math.log10(low) * 3 - 0.2) / 3, math.ceil(math.log10(high) * 3 + 0.2) / 3
        if high - low < 1:
            middle = (low + high) / 2
            low, high = middle - 0.5, middle + 0.5
        return Scale(kind, low, high)

    def position(self, value: float) -> float:
        """Return where a value lies: 0 at the low end, 1 at the high one."""
        return ((math.log10(value) if self.kind == "log" else value) - self.low) / (self.high - self.low)

    def shows(self, value: float) -> bool:
        """Return whether a value can be drawn at all."""
        return math.isfinite(value) and (value > 0 or self.kind == "linear")

    def ticks(self) -> list[Tick]:
        """Return the grid: decades with their digits, or round steps."""
        if self.kind == "log":
            marks = [
                (decade + math.log10(digit), f"10{str(decade).translate(_SUPERSCRIPTS)}" if digit == 1 else "")
                for decade in range(math.floor(self.low), math.ceil(self.high) + 1)
                for digit in range(1, 10)
            ]
        else:
            step = 10 ** math.floor(math.log10((self.high - self.low) / STEPS))
            step *= next(f for f in (1, 2, 5, 10) if (self.high - self.low) / (step * f) <= STEPS * 1.5)
            digits = -math.floor(math.log10(step) + EDGE)
            first, last = math.ceil(self.low / step - EDGE), math.floor(self.high / step + EDGE)
            marks = [(k * step, _number(k * step, digits)) for k in range(first, last + 1)]
        places = [((at - self.low) / (self.high - self.low), label) for at, label in marks]
        return [Tick(at, label) for at, label in places if -EDGE <= at <= 1 + EDGE]


def _number(value: float, digits: int) -> str:
    """Return a tick's value with as many digits as tell it from the next one."""
    if digits <= 4 and abs(value) < 1e6:  # noqa: PLR2004 - what one reads at a glance
        return f"{value + 0.0:.{max(digits, 0)}f}"
    significant = max(math.floor(math.log10(abs(value) or 1.0)) + 1 + digits, 3)
    return f"{value:.{significant}g}"
