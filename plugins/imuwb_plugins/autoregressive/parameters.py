"""What can be asked of the autoregressive analysis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

HIGHEST = 200


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb autoregressive``."""

    orders: Annotated[int, "highest order"] = 20
    order: Annotated[int | None, "of the model that is saved; default the one of the least BIC"] = None
    resample: Annotated[float | None, "Hz; give the saved model at this rate, a whole fraction of the log's"] = None
    level: Annotated[float, "at which a coefficient is called significant"] = 0.99

    def __post_init__(self) -> None:
        """Check the values."""
        if not 1 <= self.orders <= HIGHEST:
            message = f"orders is {self.orders}; it must be 1 to {HIGHEST}"
            raise ValueError(message)
        if self.order is not None and not 1 <= self.order <= self.orders:
            message = f"order is {self.order}; it must be 1 to orders, {self.orders}"
            raise ValueError(message)
        if self.resample is not None and not self.resample > 0:
            message = f"resample is {self.resample} Hz; it must be positive"
            raise ValueError(message)
        if not 0.5 <= self.level < 1:  # noqa: PLR2004 - less than even odds is no confidence
            message = f"level is {self.level}; it must be at least 0.5 and below 1"
            raise ValueError(message)
