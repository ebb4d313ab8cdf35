"""A calibrated parameter with its interval, and the parameters of an axis."""

from __future__ import annotations

from dataclasses import dataclass

from scipy import special


@dataclass(frozen=True, slots=True)
class Estimate:
    """One parameter, SI."""

    value: float
    sigma: float
    lower: float
    upper: float


@dataclass(frozen=True, slots=True)
class AxisCalibration:
    """One axis: measured = (1 + s + s2 |true|/range) true + c . others + G . force + b. None: not found by this method."""

    bias: Estimate | None
    scale_factor: Estimate | None
    scale_factor_nonlinear: Estimate | None = None
    #: rad, of the two other axes in the order x, y, z
    cross_coupling: tuple[Estimate | None, Estimate | None] = (None, None)
    g_sensitivity: tuple[Estimate, Estimate, Estimate] | None = None  #: rad/s per m/s²; gyros only


def estimate(value: float, variance: float, freedom: float, level: float) -> Estimate:
    """Return a parameter with the interval of Student's t.

    Args:
        value: estimated.
        variance: of it.
        freedom: degrees of freedom of that variance.
        level: of the interval.
    """
    sigma = max(variance, 0.0) ** 0.5
    half = sigma * float(special.stdtrit(max(freedom, 1.0), (1 + level) / 2))
    return Estimate(float(value), float(sigma), float(value - half), float(value + half))
