"""One axis of a figure, logarithmic, linear or of whole numbers: its limits, its ticks, and where a value lies on it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from imuwb.analysis import AxisScale

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
STEPS = 6  #: approximate number of steps of a linear axis
EDGE = 1e-9  #: share of an axis; rounding may put a value outside by this much
AIR = 0.04  #: space on both sides of the values on a linear axis, as a share of their range
FLAT_AIR = 0.1  #: the same space if all values are equal, as a share of the value
THIRDS = 3  #: a logarithmic axis begins and ends at a third of a decade
LOG_AIR = 0.2  #: least space on both sides of the values on a logarithmic axis, in thirds of a decade
SMALLEST = 1.0  #: least length of a logarithmic axis, in decades


@dataclass(frozen=True, slots=True)
class Tick:
    """A grid line; a major line has a label."""

    at: float  #: 0 ... 1 along the axis
    label: str


@dataclass(frozen=True, slots=True)
class Scale:
    """An axis from ``low`` to ``high``; on a logarithmic axis they are exponents of ten."""

    kind: AxisScale
    low: float
    high: float

    @staticmethod
    def around(kind: AxisScale, parts: Iterable[object], limits: tuple[float, float] | None) -> Scale:
        """Return an axis with the given limits; without limits, an axis around all values that it can show."""
        if limits is not None:
            low, high = limits
            return Scale(kind, math.log10(low), math.log10(high)) if kind == "log" else Scale(kind, low, high)
        arrays = [np.asarray(part, dtype=np.float64) for part in parts if part is not None]
        values = np.concatenate(arrays) if arrays else np.ones(1)
        values = values[np.isfinite(values) & ((values > 0) | (kind != "log"))]
        if not values.size:
            values = np.ones(1)
        low, high = float(values.min()), float(values.max())
        if kind != "log":
            air = (high - low) * AIR or abs(high) * FLAT_AIR or 1.0
            return Scale(kind, low - air, high + air)
        low = math.floor(math.log10(low) * THIRDS - LOG_AIR) / THIRDS
        high = math.ceil(math.log10(high) * THIRDS + LOG_AIR) / THIRDS
        if high - low < SMALLEST:
            middle = (low + high) / 2
            low, high = middle - SMALLEST / 2, middle + SMALLEST / 2
        return Scale(kind, low, high)

    def position(self, value: float) -> float:
        """Return where a value lies: 0 at the low end, 1 at the high end."""
        return ((math.log10(value) if self.kind == "log" else value) - self.low) / (self.high - self.low)

    def shows(self, value: float) -> bool:
        """Return whether a value has a position: it is finite, and positive on a logarithmic axis."""
        return math.isfinite(value) and (value > 0 or self.kind != "log")

    def contains(self, value: float) -> bool:
        """Return whether a value lies between the ends."""
        return self.shows(value) and -EDGE <= self.position(value) <= 1 + EDGE

    def ticks(self) -> list[Tick]:
        """Return the grid: decades with their digits, or round steps."""
        marks = self._decades() if self.kind == "log" else self._steps()
        places = [((at - self.low) / (self.high - self.low), label) for at, label in marks]
        return [Tick(at, label) for at, label in places if -EDGE <= at <= 1 + EDGE]

    def _decades(self) -> list[tuple[float, str]]:
        """Return the decades and their digits; where the axis has a single decade, 2 and 5 have a label too."""
        short = math.floor(self.high + EDGE) - math.ceil(self.low - EDGE) < 1
        label = _digit_text if short else _decade_text
        return [
            (decade + math.log10(digit), label(digit, decade))
            for decade in range(math.floor(self.low), math.ceil(self.high) + 1)
            for digit in range(1, 10)
        ]

    def _steps(self) -> list[tuple[float, str]]:
        span = self.high - self.low
        step = 10 ** math.floor(math.log10(span / STEPS))
        step *= next(factor for factor in (1, 2, 5, 10) if span / (step * factor) <= STEPS * 1.5)
        step = max(step, 1.0) if self.kind == "whole" else step
        digits = -math.floor(math.log10(step) + EDGE)
        first, last = math.ceil(self.low / step - EDGE), math.floor(self.high / step + EDGE)
        return [(k * step, _tick_text(k * step, digits)) for k in range(first, last + 1)]


def _decade_text(digit: int, decade: int) -> str:
    return f"10{str(decade).translate(_SUPERSCRIPTS)}" if digit == 1 else ""


def _digit_text(digit: int, decade: int) -> str:
    """Return the label of 1, 2 and 5 in a decade: 0.5, 200, 5·10⁻⁷."""
    if digit not in {1, 2, 5}:
        return ""
    if abs(decade) < 4:  # noqa: PLR2004 - longer numbers are hard to read
        return f"{digit * 10.0**decade:g}"
    power = _decade_text(1, decade)
    return power if digit == 1 else f"{digit}·{power}"


def _tick_text(value: float, digits: int) -> str:
    """Return a tick's value with as many digits as its distance to the next tick needs."""
    if digits <= 4 and abs(value) < 1e6:  # noqa: PLR2004 - longer numbers are hard to read
        return f"{value + 0.0:.{max(digits, 0)}f}"
    significant = max(math.floor(math.log10(abs(value) or 1.0)) + 1 + digits, 3)
    return f"{value:.{significant}g}"
