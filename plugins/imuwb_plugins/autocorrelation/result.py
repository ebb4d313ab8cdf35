"""Result of the autocorrelation."""

from dataclasses import dataclass, field

from imuwb.arrays import Floats
from imuwb.identification import GaussMarkovFit
from imuwb.notes import Note

NO_VERDICT = Note("none", "no verdict")


@dataclass(frozen=True, eq=False, slots=True)
class CorrelationCurve:
    """A normalised autocorrelation, and the Gauss-Markov process that fits the series best. SI."""

    lag: Floats  #: s
    value: Floats
    band: float | None = None  #: white noise stays within +-band
    deviation: float | None = None  #: standard deviation of the series
    falls_to: float | None = None  #: s, lag of 1/e
    gauss_markov: GaussMarkovFit | None = None
    model: Floats | None = field(
        default=None, metadata={"document": False}
    )  #: correlation of the Gauss-Markov process, at the lags


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class CorrelationAxis(CorrelationCurve):
    """One axis, before and after denoising. SI."""

    unit: str = ""
    verdict: Note = NO_VERDICT
    denoised: CorrelationCurve | None = None
    why_none: str | None = None

    def __repr__(self) -> str:
        """Return the verdict, or why there is none."""
        return self.why_none or self.verdict


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Result:
    """All axes of one IMU."""

    imu: str
    level: float
    denoise: int  #: levels
    interval: dict[str, float]  #: s, of sampling
    axes: dict[str, CorrelationAxis]
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        """Return the verdict of each axis."""
        return "\n".join([f"autocorrelation of {self.imu}:", *(f"  {a}: {r}" for a, r in self.axes.items())])
