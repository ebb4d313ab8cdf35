"""What the spectrum shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from imuwb.analysis import LineResult
    from imuwb.identification.spectral.spectrum import SpectralRegion
    from imuwb.statistics import Coefficient
    from imuwb.stochastic import Sum


@dataclass(frozen=True, eq=False, slots=True)
class AxisResult:
    """One axis, SI."""

    frequency: NDArray[np.float64]
    density: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    sides: int  #: 1: a one-sided density, twice IEEE's
    coefficients: dict[str, Coefficient]
    regions: tuple[SpectralRegion, ...]
    lines: tuple[LineResult, ...]
    processes: Sum | None
    white_to: float | None  #: Hz, from which on the spectrum leaves its white level; None: never, or no white level
    excess: float  #: of the density there and beyond over the white level, geometric mean
    explained_to: float | None  #: Hz
    probability: float | None  #: of the misfit
    why_none: str | None
    resonances: tuple[float, ...] = ()  #: Hz, broad peaks above the fitted band


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """All axes of one IMU."""

    imu: str
    level: float
    rate_hz: dict[str, float]
    segment: dict[str, int]  #: samples
    axes: dict[str, AxisResult]
    notes: tuple[str, ...]
