"""Where one process dominates a curve, and the slope of a free line there."""

from dataclasses import dataclass

from imuwb.statistics import Estimate

SHARE = 0.6  #: share of the variance or density, above which a term dominates


@dataclass(frozen=True, slots=True)
class Region:
    """Averaging times (s) or frequencies (Hz) where one term makes more than 60 % of a curve.

    The slope of a line fitted there is free, so it can be compared with the nominal slope of the term (El-Diasty, 4.1).
    """

    letter: str  #: letter of the term: Q, N, B, K or R
    start: float
    end: float
    slope: Estimate  #: on log-log axes
    nominal: float  #: slope that the pure process has

    @property
    def departure(self) -> float:
        """Return the free slope less the nominal one."""
        return self.slope.value - self.nominal

    @property
    def centre(self) -> float:
        """Return the middle on a logarithmic axis."""
        return (self.start * self.end) ** 0.5

    def __str__(self) -> str:
        """Return the term, where it dominates, and the slope."""
        return f"{self.letter} from {self.start:.3g} to {self.end:.3g}: slope {self.slope}, nominal {self.nominal:+g}"
