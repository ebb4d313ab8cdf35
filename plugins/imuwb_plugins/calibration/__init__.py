"""Calibration: bias, scale factors, cross-couplings and g-sensitivity from still positions or a rate table.

Each method is a command: six-position (a cube's faces), multi-position (any attitudes) and rate-table (gyros).
"""

from __future__ import annotations

from imuwb_plugins.calibration import multi_position, rate_table, six_position

#: name of a command -> what is an analysis of its own
METHODS = {"six-position": six_position, "multi-position": multi_position, "rate-table": rate_table}

__all__ = ["METHODS"]
