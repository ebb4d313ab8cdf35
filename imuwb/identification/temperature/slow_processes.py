"""The slow processes that count in the comparison of means."""

from collections.abc import Mapping, Sequence

from imuwb.identification.likelihood.fit import TERMS
from imuwb.statistics import Coefficient
from imuwb.stochastic import Sum

SLOW = ("B", "K")


def size_of(here: Coefficient, everywhere: Coefficient | None) -> float:
    """Return the size of a coefficient at one temperature: identified there, else common to all, else the smallest limit."""
    for coefficient in (here, everywhere):
        if coefficient is not None and coefficient.value is not None and coefficient.lower:
            return coefficient.value
    return min(coefficient.upper for coefficient in (here, everywhere) if coefficient is not None)


def slow_processes(points: Sequence[Mapping[str, Coefficient]], common: Mapping[str, Coefficient | None]) -> Sum:
    """Return the flicker and random walk that change the bias between temperatures: root mean squares over temperatures.

    Args:
        points: coefficients at each temperature.
        common: coefficients common to all temperatures; None: not known.
    """
    squares = {
        letter: sum(size_of(p[letter], common.get(letter)) ** 2 for p in points) / len(points) for letter in SLOW
    }
    return Sum(tuple(TERMS[letter](square**0.5) for letter, square in squares.items() if square > 0))
