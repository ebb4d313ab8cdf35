"""Result of the autoregressive analysis."""

from dataclasses import dataclass

from imuwb.health import Doubts
from imuwb.identification.correlation.autoregressive import Order, Whiteness
from imuwb.stochastic import Autoregressive


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class AutoregressiveAxis:
    """One axis. SI. x(n) = -sum alpha_k x(n-k) + beta0 w(n)."""

    orders: tuple[Order, ...]
    chosen: int | None  #: order, by BIC
    whiteness: tuple[Whiteness, ...]
    reading: str  #: what the model of order 1 means
    model: Autoregressive | None  #: the saved model
    poles: tuple[complex, ...]  #: of the saved model
    dt: float  #: s
    unit: str
    why_none: str | None

    def __repr__(self) -> str:
        """Return the chosen model, or why there is none."""
        return f"{self.orders[self.chosen - 1]}; {self.reading}" if self.chosen else str(self.why_none)


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Result:
    """All axes of one IMU."""

    imu: str
    source: str  #: path and hash of the log
    level: float
    convention: str
    conditioned: bool
    axes: dict[str, AutoregressiveAxis]
    notes: tuple[str, ...]
    doubts: Doubts  #: what the record itself shows against the models

    def __repr__(self) -> str:
        """Return the chosen model of each axis."""
        return "\n".join([f"autoregressive models of {self.imu}:", *(f"  {a}: {r}" for a, r in self.axes.items())])
