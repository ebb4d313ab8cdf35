"""The deterministic errors of one sensor axis, as a calibration estimates them."""

from dataclasses import dataclass

from imuwb.statistics import Estimate
from imuwb.statistics.distributions import student_limit


@dataclass(frozen=True, slots=True, repr=False)
class AxisCalibration:
    """One axis: measured = (1 + s + s2 |true|/range) true + c . other axes + G . specific force + bias.

    A term is None where the method does not determine it.
    """

    bias: Estimate | None
    scale_factor: Estimate | None  #: s
    scale_factor_nonlinear: Estimate | None = None  #: s2
    #: c, rad, of the two other axes in the order x, y, z
    cross_coupling: tuple[Estimate | None, Estimate | None] = (None, None)
    g_sensitivity: tuple[Estimate, Estimate, Estimate] | None = None  #: G, rad/s per m/s²; gyros only

    def __repr__(self) -> str:
        """Return the terms that were determined, in one line."""
        terms = {
            "bias": self.bias, "scale factor": self.scale_factor, "non-linear": self.scale_factor_nonlinear,
            "cross-coupling": self.cross_coupling, "g-sensitivity": self.g_sensitivity,
        }  # fmt: skip
        return "; ".join(
            f"{name} {', '.join('—' if e is None else str(e) for e in term) if isinstance(term, tuple) else term}"
            for name, term in terms.items()
            if term is not None and term != (None, None)
        )


def student_estimate(value: float, variance: float, freedom: float, level: float) -> Estimate:
    """Return an estimate with the interval of Student's t distribution.

    Args:
        value: the estimated parameter.
        variance: variance of that parameter.
        freedom: degrees of freedom of the variance.
        level: confidence level of the interval.
    """
    sigma = max(variance, 0.0) ** 0.5
    half = sigma * student_limit(level, max(freedom, 1.0))
    return Estimate(float(value), float(value - half), float(value + half), float(sigma))
