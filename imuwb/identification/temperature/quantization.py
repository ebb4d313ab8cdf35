"""Quantization is left out at all temperatures if all of them together show none."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from imuwb.identification.likelihood.fit import fit_problem
from imuwb.identification.temperature.pooled import pooled
from imuwb.identification.temperature.set_point import LETTERS, SetPoint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.statistics import Coefficient


def settled(points: Sequence[SetPoint], level: float = 0.95) -> tuple[tuple[SetPoint, ...], dict[str, Coefficient]]:
    """Return set-points of one axis, and the common coefficients; without quantization if all together do not show it.

    Quantization and random walk share the upper end of the spectrum: a free quantization term that is absent doubles the error of
    N. The limits of quantization remain those of the fit with the free term.
    """
    together = pooled(points, level)
    if together["Q"].value is not None:
        return tuple(points), together
    without = tuple(_without_quantization(p, level) for p in points)
    return without, pooled(without, level) | {"Q": together["Q"]}


def _without_quantization(point: SetPoint, level: float) -> SetPoint:
    if point.coefficients["Q"].value is None:
        return replace(point, absent=("Q",))
    fit = fit_problem(point.problem, level, without="Q")
    coefficients = {letter: fit.coefficients[letter] for letter in LETTERS}
    absent = replace(point.coefficients["Q"], value=None, lower=None)
    return replace(point, coefficients=coefficients | {"Q": absent}, fit=fit, absent=("Q",))
