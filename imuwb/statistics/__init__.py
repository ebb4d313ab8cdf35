"""Statistics that several chapters use: the estimate with its interval, and the quantiles of a few distributions."""

from imuwb.statistics.estimate import UNKNOWN, Coefficient, Estimate

__all__ = ["UNKNOWN", "Coefficient", "Estimate"]
