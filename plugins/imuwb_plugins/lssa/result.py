"""The result of a least-squares spectrum."""

from dataclasses import dataclass

from imuwb.arrays import Floats
from imuwb.identification.lssa import Hypothesis
from imuwb.statistics import Estimate


@dataclass(frozen=True, slots=True)
class PeakResult:
    """A line in SI; intervals at the level ``confidence``."""

    frequency: (
        Estimate  #: Hz; the interval of a drifting line is the resolution of the segments' spectrum on both sides
    )
    amplitude: Estimate
    phase: Estimate | None  #: rad, of a cosine, at the axis's first sample; None: the line drifts
    percent: float  #: per cent of the residual, which is the series without the constituents
    probability: float | None  #: that noise alone shows as much anywhere in the record; None: below 1 - level
    significant: bool  #: in the record as a whole
    in_both_halves: bool  #: whether each half of the record shows the line by itself
    steady: bool  #: whether frequency and phase are constant over the record
    name: str  #: such as "2 × 0.56 Hz"

    @property
    def claimed(self) -> bool:
        """Return whether the line is reported as a line of the sensor."""
        return self.significant and self.in_both_halves


@dataclass(frozen=True, eq=False, slots=True)
class LssaAxis:
    """One axis in SI. Spectra are thinned: each bin of frequencies has its highest value."""

    frequency: Floats
    percent: Floats
    density: Floats  #: one-sided
    shown: Floats  #: in the scale of the figures
    shown_limit: Floats  #: limit of significance at one frequency, in that scale
    shown_record_limit: Floats  #: limit of significance in the record as a whole, in that scale
    fourier_frequency: Floats  #: of Welch's spectrum, for comparison
    fourier_density: Floats
    critical_percent: float | None  #: at one frequency; None: it depends on the frequency
    critical_percent_record: float | None
    peaks: tuple[PeakResult, ...]
    constituents: dict[str, Estimate]
    hypotheses: tuple[Hypothesis, ...]
    alpha: tuple[float, ...]  #: of autoregressive noise
    correlation_time: float | None  #: s, of Gauss-Markov noise
    frequencies: int  #: number of frequencies before thinning
    lowest: float  #: Hz, of the usable band
    highest: float  #: Hz, of the usable band
    searched: float  #: Hz, up to which lines are looked for
    mirror: float | None  #: Hz
    why_none: str | None  #: why the axis has no spectrum; None: it has one

    def __repr__(self) -> str:
        """Return the claimed lines, or why the axis has no spectrum, in one line."""
        lines = [f"{p.name}, amplitude {p.amplitude.value:.3g}" for p in self.peaks if p.claimed]
        return self.why_none or "; ".join(lines) or "no line"


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """All axes of one IMU."""

    imu: str
    level: float
    confidence: float
    noise: str
    scale: str
    axes: dict[str, LssaAxis]
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        """Return one line for each axis."""
        return "\n".join([self.imu, *(f"  {name}: {axis}" for name, axis in self.axes.items())])
