"""What all fits of a sum of processes have in common, whatever the sum is fitted to."""

from dataclasses import dataclass, replace

from imuwb.statistics import Coefficient
from imuwb.stochastic import Sum
from imuwb.texts import coefficients_text

ACCEPTED = 1e-3  #: probability that chance makes so large a misfit; below it the sum does not explain the record


def widening(misfit: float, probability: float) -> float:
    """Return the factor on variances: the misfit, chi-square over its degrees of freedom, of an unexplained record (Birge)."""
    return max(misfit, 1.0) if probability < ACCEPTED else 1.0


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class SumFit:
    """A sum of processes fitted to a record."""

    level: float
    coefficients: dict[str, Coefficient]  #: Q, N, B, K, and R if the fit can have a ramp
    processes: Sum  #: the terms that have a value
    misfit: float  #: chi-square over its degrees of freedom, where the sum explains the record
    probability: float  #: probability that chance makes so large a misfit

    def __post_init__(self) -> None:
        """Let each coefficient know its letter, so that it knows its units."""
        known = {letter: replace(own, letter=letter) for letter, own in self.coefficients.items()}
        object.__setattr__(self, "coefficients", known)

    def text(self, fit: str) -> str:
        """Return the name of the fit, its range, and the coefficients in one line."""
        coefficients = coefficients_text(self.coefficients)
        return f"{fit} (p = {self.probability:.2g}): {coefficients}; {100 * self.level:g} % intervals and limits"
