"""What the autocorrelation shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from imuwb.identification import GaussMarkovFit


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """A normalised autocorrelation, and the Gauss-Markov process that fits the series best."""

    lag: NDArray[np.float64]  #: s
    value: NDArray[np.float64]
    band: float  #: of white noise, +-
    deviation: float  #: of the series, SI
    falls_to: float | None  #: s, where it is 1/e
    gauss_markov: GaussMarkovFit | None


@dataclass(frozen=True, eq=False, slots=True)
class AxisResult:
    """One axis, SI: as it is, and denoised."""

    lag: NDArray[np.float64]
    value: NDArray[np.float64]
    band: float | None
    deviation: float | None
    falls_to: float | None
    gauss_markov: GaussMarkovFit | None
    denoised: Curve | None
    unit: str
    why_none: str | None


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """All axes of one IMU."""

    imu: str
    level: float
    denoise: int  #: levels
    interval: dict[str, float]  #: s, of sampling
    axes: dict[str, AxisResult]
    notes: tuple[str, ...]
