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
    sums = {axis: _with_limits(own, wants) for axis, own in model.axes.items()}
    found = [
        (axis, letter, want, hours_needed(sums[axis], letter, want, rate, level))
        for axis in model.axes
        for letter, want in wants.items()
    ]
    longest = max((needed for *_, needed in found if needed is not None), default=None)
    length = longest if hours is None else hours
    states = {
        axis: {} if length is None else reached(own, rate, length, level, "".join(wants)) for axis, own in sums.items()
    }
    needs = tuple(
        Need(
            axis,
            letter,
            want,
            needed,
            letter not in _letters(model.axes[axis].processes) and letter in _letters(sums[axis]),
            letter in _letters(sums[axis]),
            states[axis].get(letter),
        )
        for axis, letter, want, needed in found
    )
    slowest = None
    if longest is not None:
        slowest = max(rate_enough(sums[axis], _within(needs, axis), rate, level) for axis in model.axes)
    return RecordPlan(model.name, rate, level, needs, length, hours is not None, slowest)


def _within(needs: tuple[Need, ...], axis: str) -> dict[str, float]:
    return {need.letter: need.want for need in needs if need.axis == axis and need.hours is not None}


def _letters(processes: Sum) -> set[str]:
    return {LETTERS[type(term)] for term in processes.terms if type(term) in LETTERS}


def _with_limits(axis: AxisModel, wants: Mapping[str, float]) -> Sum:
    """Return the processes of an axis; a wanted one that is absent has its upper limit, where that is known."""
    absent = [letter for letter in wants if letter not in _letters(axis.processes) and axis.limits.get(letter, 0.0) > 0]
    return Sum((*axis.processes.terms, *(UNITS_OF_SIZE[letter](axis.limits[letter]) for letter in absent)))


def model_of_fits(name: str, fits: Mapping[str, LikelihoodFit]) -> ImuErrorModel:
    """Return the error model of a short record's fits: the likeliest terms, and the limits of those that it does not show."""
    axes = {
        axis: AxisModel(
            Sum(tuple(term for term in fit.processes.terms if type(term) in LETTERS)),
            limits={
                x: c.upper
                for x, c in fit.coefficients.items()
                if x in UNITS_OF_SIZE and _only_limited(c.value, c.upper)
            },
        )
        for axis, fit in fits.items()
    }
    return ImuErrorModel(name, axes)


def _only_limited(value: float | None, upper: float) -> bool:
    return value is None and bool(np.isfinite(upper)) and upper > 0


def curve_of(
    model: ImuErrorModel, axis: str, letter: str, wants: Mapping[str, float], rate: float, longest: float, level: float
) -> tuple[Floats, Floats]:
    """Return lengths (h) and the widths that they reach, for a figure; only where the interval does not begin at 0."""
    processes = _with_limits(model.axes[axis], wants)
    hours = np.geomspace(max(1e-4 * longest, 600 / rate / 3600), min(3 * longest, MOST_HOURS), 40)
    widths = np.array([reached(processes, rate, float(h), level, letter)[letter].width for h in hours])
    shown = np.isfinite(widths)
    return hours[shown], widths[shown]
