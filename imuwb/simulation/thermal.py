"""The temperature of a sensor over time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError

ABSOLUTE_ZERO, HOTTEST = -273.15, 1000.0  #: °C
ROOM_TEMPERATURE = 25.0  #: °C


@dataclass(frozen=True, slots=True)
class Temperature:
    """A sensor's temperature: that of its surroundings, and the rise by its own electronics.

    Raises:
        UsageError: no corner, times that do not rise, a temperature that no sensor has.
    """

    corners: tuple[
        tuple[float, float], ...
    ]  #: (s from the log's start, °C), rising; straight lines between, constant before and after
    rise: float = 0.0  #: °C, by which its own electronics warm it
    time_constant: float = 300.0  #: s, of that rise

    def __post_init__(self) -> None:
        """Check the corners and the time constant."""
        seconds, celsius = [t for t, _ in self.corners], [c for _, c in self.corners]
        if not seconds or not all(map(math.isfinite, seconds)) or any(b <= a for a, b in pairwise(seconds)):
            raise UsageError(
                f"the times of a temperature's corners are {seconds} s; there must be at least one, and they must rise"
            )
        for c in (*celsius, *(c + self.rise for c in celsius)):
            if not ABSOLUTE_ZERO < c < HOTTEST:
                raise UsageError(
                    f"the temperature is {c} °C; it must be above {ABSOLUTE_ZERO} and below {HOTTEST:g} °C"
                )
        if not (math.isfinite(self.time_constant) and self.time_constant > 0):
            raise UsageError(f"the time constant of a temperature is {self.time_constant} s; it must be above 0")

    @staticmethod
    def ramp(start: float, end: float, duration: float) -> Temperature:
        """Return a straight line from one temperature to another, °C, over ``duration`` s.

        Raises:
            UsageError: as the class.
        """
        return Temperature(((0.0, start), (duration, end)))

    @property
    def constant(self) -> float | None:
        """Return the temperature, °C, if it is constant; else None."""
        first = self.corners[0][1]
        return first if self.rise == 0 and all(c == first for _, c in self.corners) else None

    def at(self, seconds: Floats) -> Floats:
        """Return the temperature at times from the log's start, (n,) s -> (n,) °C."""
        surroundings = np.interp(seconds, [t for t, _ in self.corners], [c for _, c in self.corners])
        return surroundings - self.rise * np.expm1(-seconds / self.time_constant)


def temperature(celsius: float | Temperature | None) -> Temperature:
    """Return a temperature over time: a number is constant, None is room temperature, 25 °C.

    Raises:
        UsageError: a temperature that no sensor has.
    """
    if isinstance(celsius, Temperature):
        return celsius
    return Temperature(((0.0, ROOM_TEMPERATURE if celsius is None else celsius),))


def recipe_of(celsius: float | Temperature | None) -> float | Temperature | None:
    """Return a temperature in the form that goes into a log's hash: a constant temperature becomes a number."""
    constant = celsius.constant if isinstance(celsius, Temperature) else celsius
    return celsius if constant is None else constant
