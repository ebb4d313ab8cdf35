"""The processes that a mean, or a comparison of means, must reckon with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.identification.likelihood.fit import TERMS
from imuwb.stochastic import Sum

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from imuwb.statistics import Coefficient

SLOW = ("B", "K")


def size_of(here: Coefficient, everywhere: Coefficient | None) -> float:
    """Return what a coefficient counts at one temperature: identified there, else common to all, else the least limit."""
    for found in (here, everywhere):
        if found is not None and found.value is not None and found.lower:
            return found.value
    return min(found.upper for found in (here, everywhere) if found is not None)


def slow_processes(points: Sequence[Mapping[str, Coefficient]], common: Mapping[str, Coefficient | None]) -> Sum:
    """Return flicker and random walk as they count for the bias's walk through all temperatures: root mean squares.

    Args:
        points: coefficients of each temperature.
        common: to all temperatures; None: unknown.
    """
    found = {letter: sum(size_of(p[letter], common.get(letter)) ** 2 for p in points) / len(points) for letter in SLOW}
    return Sum(tuple(TERMS[letter](square**0.5) for letter, square in found.items() if square > 0))
