"""Options of the autoregressive analysis."""

from dataclasses import dataclass
from typing import Annotated

from imuwb.options import POSITIVE, Between, check


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb autoregressive``."""

    orders: Annotated[int, "Highest order of the models.", Between(1, 200)] = 20
    order: Annotated[int | None, "Order of the saved model; default: the order of the least BIC.", Between(1)] = None
    resample: Annotated[
        float | None, "Rate of the saved model, the log's rate divided by a whole number; default: the log's rate (Hz).", POSITIVE
    ] = None  # fmt: skip
    level: Annotated[float, "Level of significance of the coefficients.", Between(0.5, 1.0, open_most=True)] = 0.99

    def __post_init__(self) -> None:
        """Check the values."""
        check(self)
        if self.order is not None and self.order > self.orders:
            raise ValueError(f"order is {self.order}; it must be 1 to orders, {self.orders}: raise orders")
