"""How estimators write a coefficient of a continuous process, as a value that depends on a rate, a step or a horizon."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from imuwb.errors import UsageError


@dataclass(frozen=True, slots=True)
class Setting:
    """What a value may depend on; nan where it is not known."""

    rate: float = math.nan  #: Hz, of the samples
    step: float = math.nan  #: s, of the estimator's prediction
    horizon: float = 60.0  #: s without aids, over which processes are matched


@dataclass(frozen=True, slots=True)
class Formula:
    """value = scale · c^power."""

    power: int
    scale: Callable[[Setting], float]
    continuous: bool  #: whether the value holds at any rate

    def value(self, coefficient: float, setting: Setting) -> float:
        """Return the value of a coefficient (SI)."""
        return self.scale(setting) * coefficient**self.power

    def coefficient(self, value: float, setting: Setting) -> float:
        """Return the coefficient (SI) of a value.

        Raises:
            UsageError: a negative variance.
        """
        if self.power > 1 and value < 0:
            raise UsageError(f"a variance is {value}; it must be 0 or more")
        return (value / self.scale(setting)) ** (1 / self.power)


#: c: the coefficient; f: rate of the samples; dt: step of the estimator; T: horizon
FORMULAS: Mapping[str, Formula] = {
    "c": Formula(1, lambda _: 1.0, continuous=True),
    "c²": Formula(2, lambda _: 1.0, continuous=True),
    "c √T": Formula(1, lambda s: math.sqrt(s.horizon), continuous=True),
    "c √f": Formula(1, lambda s: math.sqrt(s.rate), continuous=False),
    "c √(2f)": Formula(1, lambda s: math.sqrt(2 * s.rate), continuous=False),
    "c² f": Formula(2, lambda s: s.rate, continuous=False),
    "c/√dt": Formula(1, lambda s: 1 / math.sqrt(s.step), continuous=False),
}
