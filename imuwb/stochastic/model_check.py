"""An error model compared with a data sheet, or with another sensor."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from imuwb.documents import document_of, shown
from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.stochastic.axis_model import AxisModel, of_either_sign
from imuwb.stochastic.description import LETTERS
from imuwb.stochastic.error_model import ImuErrorModel
from imuwb.units import coefficient_units, quantity


@dataclass(frozen=True, slots=True)
class Limit:
    """The largest value that a coefficient of an axis may have. SI."""

    axis: str
    letter: str
    at_most: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """One limit, and the coefficient of the model. SI."""

    limit: Limit
    coefficient: Coefficient
    outcome: str  #: "within", "beyond", "not sure" (the interval contains the limit), or "not known"


def coefficient(model: AxisModel, letter: str) -> Coefficient:
    """Return a coefficient of a model with its interval; or its limit, where the record does not show it."""
    for i, term in enumerate(model.processes.terms):
        if hasattr(term, letter):
            value = cast("float", getattr(term, letter))
            ends = model.intervals.get(f"{i}.{letter}", (value, value))
            return Coefficient(abs(value), *of_either_sign(value, *ends))
    return Coefficient(None, None, model.limits.get(letter, math.inf))


def limits(path: str | Path, factor: float = 1.0) -> tuple[Limit, ...]:
    """Return the limits of a file: a list of limits, or an error model, whose upper ends times ``factor`` are the limits.

    A list of limits has a table for each axis, or for ``gyro`` and ``accel``: ``[gyro] N = "0.3 deg/√h"``.

    Raises:
        UsageError: the file cannot be read, or is neither of them.
    """
    document = document_of(path, "limits")
    if any(isinstance(axis := document.get(name), dict) and "processes" in axis for name in AXES):
        model = ImuErrorModel.of_document(document, str(path))
        uppers = [(axis, x, coefficient(a, x).upper) for axis, a in model.axes.items() for x in LETTERS]
        return tuple(Limit(axis, x, upper * factor) for axis, x, upper in uppers if math.isfinite(upper))
    made: list[Limit] = []
    for name, table in document.items():
        axes = [axis for axis in AXES if axis == name or axis.startswith(f"{name}_")]
        if not axes or not isinstance(table, dict):
            raise UsageError(
                f'{path}: {shown(name)}; limits have tables gyro, accel or {", ".join(AXES)}, such as [gyro] N = "0.3 deg/√h"'
            )
        for letter, text in cast("Mapping[str, object]", table).items():
            made += [Limit(axis, letter, _si(path, axis, letter, text) * factor) for axis in axes]
    if not made:
        raise UsageError(f'{path}: it has no limits; write limits such as [gyro] N = "0.3 deg/√h"')
    return tuple(made)


def limits_of(model: ImuErrorModel, factor: float = 1.0) -> tuple[Limit, ...]:
    """Return the upper ends of a model's coefficients, times ``factor``, as limits."""
    uppers = [(axis, x, coefficient(a, x).upper) for axis, a in model.axes.items() for x in LETTERS]
    return tuple(Limit(axis, x, upper * factor) for axis, x, upper in uppers if math.isfinite(upper))


def _si(path: str | Path, axis: str, letter: str, text: object) -> float:
    if letter not in LETTERS:
        raise UsageError(f"{path}: {letter!r}; a limit must be one of {', '.join(LETTERS)}")
    si, display = coefficient_units(axis, letter)
    return quantity(text, si, f"{path}: {letter}", display.name)


def check(model: ImuErrorModel, wanted: tuple[Limit, ...]) -> tuple[Verdict, ...]:
    """Return a verdict for each limit."""
    return tuple(
        verdict(limit, UNKNOWN if (axis := model.axes.get(limit.axis)) is None else coefficient(axis, limit.letter))
        for limit in wanted
    )


def verdict(limit: Limit, stated: Coefficient) -> Verdict:
    """Return the verdict on a coefficient: within where the interval is below the limit, beyond where the interval is above it."""
    if not math.isfinite(stated.upper):
        outcome = "not known"
    elif stated.upper <= limit.at_most:
        outcome = "within"
    elif stated.lower is not None and stated.lower > limit.at_most:
        outcome = "beyond"
    else:
        outcome = "not sure"
    return Verdict(limit, stated, outcome)
