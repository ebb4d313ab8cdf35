"""What the processes have in common: frozen parameters, their checks, and a text form."""

from dataclasses import fields
from typing import Any, ClassVar, cast

from imuwb.stochastic.sums import Addable, short_text

POSITIVE = ("Tc", "frequency", "dt")  #: parameters that must be above 0; the others must not be negative
SIGNED = ("R",)  #: parameters of either sign
LARGEST = 1e100  #: SI; the square of a parameter must still be a finite number


class Elementary(Addable):
    """A process with parameters of its own; a subclass is a frozen dataclass of them.

    Raises:
        ValueError: a parameter that is not finite, or is out of its range.
    """

    __slots__ = ()
    name: ClassVar[str]  #: name of the process in documents

    def __post_init__(self) -> None:
        """Make whole numbers floats, so that 1 and 1.0 are the same process in every respect, and check the ranges."""
        for f in fields(cast("Any", self)):
            value: Any = getattr(self, f.name)
            if isinstance(value, int):
                object.__setattr__(self, f.name, float(value))
            if isinstance(value, int | float):
                _check(f.name, abs(value) if f.name in SIGNED else value)

    def __str__(self) -> str:
        """Return the process with its parameters, four digits each, such as ``WhiteNoise(N=0.001)``."""
        parameters = (f"{f.name}={short_text(getattr(self, f.name))}" for f in fields(cast("Any", self)))
        return f"{type(self).__name__}({', '.join(parameters)})"


def _check(name: str, value: float) -> None:
    if not 0 <= value < LARGEST or (value == 0 and name in POSITIVE):
        rule = "positive" if name in POSITIVE else "0 or more"
        raise ValueError(f"{name} is {value}; it must be {rule if value < LARGEST else f'below {LARGEST:g}'}")
