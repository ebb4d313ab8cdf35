"""Where noise coefficients are read off, and the interval of one whose square is estimated."""

from __future__ import annotations

from imuwb.statistics.distributions import chi_square_limits, normal_limit

FEWEST_DEGREES = 3.0  #: of freedom of a square, for an interval that does not begin at 0
#: averaging time at which IEEE reads a coefficient off its own line (B: off the flat part)
READ_OUT = {"Q": 3**0.5, "N": 1.0, "B": None, "K": 3.0, "R": 2**0.5}


def interval(square: float, sigma: float, level: float) -> tuple[float, float]:
    """Return the ends of a coefficient whose square was estimated with this standard error.

    A positive quadratic estimate is about a scaled chi-square, skewed where few degrees of freedom are left. It never
    reaches 0: a term that chance may have made has its lower end there all the same.
    """
    z = normal_limit(level)
    freedom = 2 * square**2 / sigma**2
    if freedom < FEWEST_DEGREES:
        return 0.0, float(square + z * sigma) ** 0.5
    low, high = chi_square_limits(level, freedom)
    return (float(square * low) ** 0.5 if square > z * sigma else 0.0), float(square * high) ** 0.5
