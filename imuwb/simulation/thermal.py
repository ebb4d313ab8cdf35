"""How warm a sensor is over time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import UsageError

if TYPE_CHECKING:
    from imuwb.log import Floats

ABSOLUTE_ZERO, HOTTEST = -273.15, 1000.0  #: °C
ROOM_TEMPERATURE = 25.0  #: °C


@dataclass(frozen=True, slots=True)
class Temperature:
    """A sensor's temperature: that of its surroundings, and by how much its own electronics warm it.

    Raises:
        UsageError: no corner, times that do not rise, a temperature that no sensor is at.
    """

    corners: tuple[tuple[float, float], ...]  #: (s from the log's start, °C), rising; linear between, held beyond
    rise: float = 0.0  #: °C, by which it warms up of itself
    time_constant: float = 300.0  #: s, of that

    def __post_init__(self) -> None:
        """Check the corners and the time constant."""
        seconds, celsius = [t for t, _ in self.corners], [c for _, c in self.corners]
        if not seconds or not all(map(math.isfinite, seconds)) or any(b <= a for a, b in pairwise(seconds)):
            message = f"the times {seconds} s of a temperature's corners: there must be one, and they must rise"
            raise UsageError(message)
        for c in (*celsius, *(c + self.rise for c in celsius)):
            if not ABSOLUTE_ZERO < c < HOTTEST:
                message = f"a temperature of {c} °C: no sensor is at it"
                raise UsageError(message)
        if not (math.isfinite(self.time_constant) and self.time_constant > 0):
            message = f"a sensor that warms up with a time constant of {self.time_constant} s: it must be above 0"
            raise UsageError(message)

    @staticmethod
    def ramp(start: float, end: float, duration: float) -> Temperature:
        """Return a straight line from one temperature to another, °C, over ``duration`` s.

        Raises:
            UsageError: as the class.
        """
        return Temperature(((0.0, start), (duration, end)))

    @property
    def constant(self) -> float | None:
        """Return the temperature, °C, if it is the same all the while; else None."""
        first = self.corners[0][1]
        return first if self.rise == 0 and all(c == first for _, c in self.corners) else None

    def at(self, seconds: Floats) -> Floats:
        """Return the temperature at times from the log's start, (n,) s -> (n,) °C."""
        surroundings = np.interp(seconds, [t for t, _ in self.corners], [c for _, c in self.corners])
        return surroundings - self.rise * np.expm1(-seconds / self.time_constant)


def temperature(celsius: float | Temperature | None) -> Temperature:
    """Return what a sensor is at: a number is the same all the while, None is room temperature, 25 °C.

    Raises:
        UsageError: a temperature that no sensor is at.
    """
    if isinstance(celsius, Temperature):
        return celsius
    return Temperature(((0.0, ROOM_TEMPERATURE if celsius is None else celsius),))


def recipe_of(celsius: float | Temperature | None) -> float | Temperature | None:
    """Return what tells a temperature in a log's hash: one that is the same all the while is its number."""
    same = celsius.constant if isinstance(celsius, Temperature) else celsius
    return celsius if same is None else same
