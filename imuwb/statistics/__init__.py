"""Statistics that several chapters use: quantiles and tails of the few distributions that estimates need."""

from imuwb.statistics.distributions import (
    chi_square_limits,
    chi_square_quantile,
    chi_square_tail,
    normal_limit,
    normal_quantile,
    pearson3_quantile,
    student_limit,
)

__all__ = [
    "chi_square_limits",
    "chi_square_quantile",
    "chi_square_tail",
    "normal_limit",
    "normal_quantile",
    "pearson3_quantile",
    "student_limit",
]
