"""What the autoregressive models are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from imuwb.identification.correlation.autoregressive import Order, Whiteness
    from imuwb.stochastic import Autoregressive


@dataclass(frozen=True, eq=False, slots=True)
class AxisResult:
    """One axis, SI. x(n) = -sum alpha_k x(n-k) + beta0 w(n)."""

    orders: tuple[Order, ...]
    chosen: int | None  #: order, by BIC
    whiteness: tuple[Whiteness, ...]
    reading: str
    model: Autoregressive | None  #: what is saved
    poles: tuple[complex, ...]  #: of the model that is saved
    dt: float  #: s
    unit: str
    why_none: str | None


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """All axes of one IMU."""

    imu: str
    source: str  #: path and hash of the log
    level: float
    convention: str
    conditioned: bool
    axes: dict[str, AxisResult]
    notes: tuple[str, ...]
