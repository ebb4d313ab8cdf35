"""Result of the spectrum."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from imuwb.arrays import Floats
from imuwb.identification import Region
from imuwb.noise_results import LineResult, ModelCurves
from imuwb.statistics import Coefficient
from imuwb.stochastic import Sum
from imuwb.texts import coefficients_text


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class SpectrumAxis:
    """One axis. SI."""

    frequency: Floats
    density: Floats
    lower: Floats
    upper: Floats
    sides: int  #: 1: a one-sided density, twice IEEE's
    coefficients: Mapping[str, Coefficient]
    regions: tuple[Region, ...] = ()
    lines: tuple[LineResult, ...] = ()
    processes: Sum | None = None
    white_to: float | None = (
        None  #: Hz, above which the spectrum leaves its white level; None: it does not, or has none
    )
    excess: float = 1.0  #: ratio of the density above white_to to the white level, geometric mean
    explained_to: float | None = None  #: Hz
    probability: float | None = None  #: probability that chance makes a misfit as large
    why_none: str | None = None
    resonances: tuple[float, ...] = ()  #: Hz, broad peaks above the fitted band
    #: before frequency averaging: extremes of the densities in narrow columns of frequency, (2, r) Hz and SI; None: not wanted
    raw: Floats | None = field(default=None, metadata={"document": False})
    model_densities: ModelCurves | None = field(default=None, metadata={"document": False})

    def __repr__(self) -> str:
        """Return the coefficients, or why there are none."""
        return self.why_none or coefficients_text(self.coefficients)


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Result:
    """All axes of one IMU."""

    imu: str
    level: float
    rate_hz: dict[str, float]
    segment: dict[str, int]  #: samples
    axes: dict[str, SpectrumAxis]
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        """Return the coefficients of each axis."""
        return "\n".join([f"{self.imu}, by power spectral density:", *(f"  {a}: {r}" for a, r in self.axes.items())])
