"""How long to record a still sensor: every axis and wanted coefficient, the rate that is enough, and what cannot be reached."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.likelihood.fit import LikelihoodFit
from imuwb.identification.likelihood.planning import (
    LETTERS,
    MOST_HOURS,
    UNITS_OF_SIZE,
    Reach,
    hours_needed,
    rate_enough,
    reached,
)
from imuwb.stochastic import AxisModel, ImuErrorModel, Sum


@dataclass(frozen=True, slots=True)
class Need:
    """The record that one coefficient of one axis needs."""

    axis: str
    letter: str
    want: float  #: half the width of the interval over the value
    hours: float | None  #: shortest length; None: not within ``MOST_HOURS``, or no such term
    at_limit: bool  #: the model does not have the term, and its upper limit stands for it: a smaller one takes longer
    known: bool  #: the model has the term, or a limit of it
    at_length: Reach | None  #: what a record of the plan's length states; None: no length


@dataclass(frozen=True, slots=True)
class RecordPlan:
    """How long to record, for all axes and wanted coefficients."""

    name: str  #: of the model
    rate: float  #: Hz
    level: float
    needs: tuple[Need, ...]
    hours: float | None  #: the stated length, else the longest that is needed; None: nothing can be reached
    stated: bool  #: whether the length was stated
    slowest: float | None  #: Hz, the lowest rate at which the record need be hardly longer


def plan_record(
    model: ImuErrorModel, wants: Mapping[str, float], rate: float, *, hours: float | None = None, level: float = 0.95
) -> RecordPlan:
    """Return how long to record a sensor so that its coefficients are known to wanted widths.

    Args:
        model: of the sensor: N, B and so on with their values, or the upper limits of those that are not known.
        wants: one of Q, N, B, K -> half the width of the interval over the value.
        rate: Hz.
        hours: a length whose widths are wanted; by default the longest that is needed.
        level: of the intervals.

    Raises:
        ValueError: a record of fewer than 256 samples.
    """
    sums = {(axis, letter): _with_limit(own, letter) for axis, own in model.axes.items() for letter in wants}
    hours_of = {
        (axis, letter): hours_needed(own, letter, wants[letter], rate, level) for (axis, letter), own in sums.items()
    }
    own_terms = {axis: _letters(own.processes) for axis, own in model.axes.items()}
    sure = [length for (axis, letter), length in hours_of.items() if length is not None and letter in own_terms[axis]]
    longest = max(sure, default=None)
    length = longest if hours is None else hours
    needs = tuple(
        Need(
            axis,
            letter,
            wants[letter],
            hours_of[axis, letter],
            letter not in own_terms[axis] and letter in _letters(processes),
            letter in _letters(processes),
            None if length is None else reached(processes, rate, length, level, letter)[letter],
        )
        for (axis, letter), processes in sums.items()
    )
    slowest = None
    if longest is not None:
        slowest = max(rate_enough(own.processes, _within(needs, axis), rate, level) for axis, own in model.axes.items())
    return RecordPlan(model.name, rate, level, needs, length, hours is not None, slowest)


def _within(needs: tuple[Need, ...], axis: str) -> dict[str, float]:
    """Return the wanted widths of the terms that an axis has, and that can be reached."""
    return {n.letter: n.want for n in needs if n.axis == axis and n.hours is not None and not n.at_limit}


def _letters(processes: Sum) -> set[str]:
    return {LETTERS[type(term)] for term in processes.terms if type(term) in LETTERS}


def _with_limit(axis: AxisModel, letter: str) -> Sum:
    """Return the processes of an axis; if one that is wanted is absent, its upper limit stands for it, where that is known."""
    limit = 0.0 if letter in _letters(axis.processes) else axis.limits.get(letter, 0.0)
    return Sum((*axis.processes.terms, *((UNITS_OF_SIZE[letter](limit),) if limit > 0 else ())))


def model_of_fits(name: str, fits: Mapping[str, LikelihoodFit]) -> ImuErrorModel:
    """Return the error model of a short record's fits: the terms that it shows, and the limits of those that it does not show."""
    axes: dict[str, AxisModel] = {}
    for axis, fit in fits.items():
        own = fit.identified.terms
        shown = _letters(Sum(own))
        limits = {x: c.upper for x, c in fit.coefficients.items() if x in UNITS_OF_SIZE and x not in shown}
        kept = {x: limit for x, limit in limits.items() if np.isfinite(limit) and limit > 0}
        axes[axis] = AxisModel(Sum(tuple(term for term in own if type(term) in LETTERS)), limits=kept)
    return ImuErrorModel(name, axes)


def curve_of(
    model: ImuErrorModel, axis: str, letter: str, rate: float, longest: float, level: float
) -> tuple[Floats, Floats]:
    """Return lengths (h) and the widths that they reach, for a figure; only where the interval does not begin at 0."""
    processes = _with_limit(model.axes[axis], letter)
    hours = np.geomspace(max(1e-4 * longest, 600 / rate / 3600), min(3 * longest, MOST_HOURS), 40)
    widths = np.array([reached(processes, rate, float(h), level, letter)[letter].width for h in hours])
    shown = np.isfinite(widths)
    return hours[shown], widths[shown]
