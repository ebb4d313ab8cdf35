"""A noise coefficient with its interval, as every estimator gives it."""

from __future__ import annotations

from dataclasses import dataclass

#: averaging time at which IEEE reads a coefficient off its own line (B: off the flat part)
READ_OUT = {"Q": 3**0.5, "N": 1.0, "B": None, "K": 3.0, "R": 2**0.5}


@dataclass(frozen=True, slots=True)
class Coefficient:
    """One coefficient in SI. ``value`` None: not identified, ``upper`` its limit."""

    value: float | None
    lower: float | None
    upper: float
    at: float | None  #: s, where it is read off; None for B without a flat region
