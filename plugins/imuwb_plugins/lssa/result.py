"""What a least-squares spectrum shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from imuwb.identification.lssa import ChiSquare

    Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PeakResult:
    """A line, SI; ends of intervals at the confidence asked for."""

    frequency: float  #: Hz
    frequency_lower: float  #: of a drifting line: by the resolution of its spectrum
    frequency_upper: float
    amplitude: float
    lower: float  #: of the amplitude
    upper: float
    phase: float | None  #: rad, of a cosine, at the axis's first sample; None: it drifts
    phase_lower: float | None
    phase_upper: float | None
    percent: float  #: of what the constituents leave
    probability: float | None  #: that noise alone shows as much anywhere in the record; None: below 1 - level
    significant: bool  #: in the record as a whole
    in_both_halves: bool
    steady: bool  #: keeps its frequency and phase over the record
    name: str  #: such as "2 × 0.56 Hz"


@dataclass(frozen=True, slots=True)
class HypothesisResult:
    """A test of the noise's structure."""

    hypothesis: str
    tenable: bool
    p_value: float
    correlations: ChiSquare  #: of short lags (Ljung and Box)
    octaves: ChiSquare  #: of slow drifts (Bartlett)
    alpha: tuple[float, ...]  #: x(n) = -sum alpha x(n-k) + w(n)
    alpha_sigma: tuple[float, ...]
    lowest_octave: float  #: power of the slowest octave over the mean: 1 if tenable
    words: str


@dataclass(frozen=True, slots=True)
class ConstituentResult:
    """A known constituent: its size, SI."""

    name: str
    value: float
    lower: float
    upper: float


@dataclass(frozen=True, eq=False, slots=True)
class AxisResult:
    """One axis, SI. Spectra are thinned: of each bin of frequencies the highest value."""

    frequency: Floats
    percent: Floats
    density: Floats  #: one-sided
    shown: Floats  #: in the scale asked for
    shown_one: Floats  #: what is significant at one frequency, in that scale
    shown_record: Floats  #: in the record as a whole
    fourier_frequency: Floats  #: of Welch's spectrum beside it
    fourier_density: Floats
    critical_percent: float | None  #: at one frequency; None: it depends on frequency
    critical_percent_record: float | None
    peaks: tuple[PeakResult, ...]
    constituents: tuple[ConstituentResult, ...]
    hypotheses: tuple[HypothesisResult, ...]
    alpha: tuple[float, ...]  #: of the noise, where it is autoregressive
    correlation_time: float | None  #: s, where it is Gauss-Markov
    frequencies: int  #: how many were looked at
    lowest: float  #: Hz, of the usable band
    highest: float
    mirror: float | None  #: Hz
    why_none: str | None


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """All axes of one IMU."""

    imu: str
    level: float
    confidence: float
    noise: str
    scale: str
    axes: dict[str, AxisResult]
    notes: tuple[str, ...]
