"""The answer of ``imuwb plan``: how long to record, and its figure."""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from imuwb.analysis import Answer, Curve, Figure, Step, Table
from imuwb.colors import color_at
from imuwb.identification import Need, RecordPlan, curve_of
from imuwb.identification.likelihood.planning import MOST_HOURS
from imuwb.noise_results import by_sensor
from imuwb.stochastic import ImuErrorModel
from imuwb.texts import duration_text, number_text
from imuwb.units import UNITS, coefficient_units

UNREACHED = "no"


def plan_answer(plan: RecordPlan, wants: Mapping[str, float], steps: Sequence[Step]) -> Answer:
    """Return the length that each coefficient needs, or what the stated length reaches, and what cannot be reached."""
    rows = [
        (axis.replace("_", " "), *(_reach_cell(need) if plan.stated else _hours_cell(need) for need in own))
        for axis, own in _by_axis(plan).items()
    ]
    headings = ("", *(f"{letter} ±{100 * want:.3g} %" for letter, want in wants.items()))
    about = f"{'a record of ' + _hours(plan.hours) if plan.stated else 'how long to record'}, {plan.rate:g} Hz, still"
    sentences = tuple(_sentences(plan))
    return Answer(
        about, headings, tuple(rows), sentences, tuple(steps), f"± half of the {100 * plan.level:g} % interval"
    )


def _sentences(plan: RecordPlan) -> Iterator[str]:
    reachable = [need for need in plan.needs if need.hours is not None and not need.at_limit]
    if not plan.stated and plan.hours is not None:
        worst = max(reachable, key=lambda need: need.hours or 0.0)
        yield f"Record {_hours(plan.hours)}: {worst.letter} of {worst.axis.replace('_', ' ')} needs the longest."
    if plan.stated:
        short = [need for need in reachable if (need.hours or 0.0) > (plan.hours or 0.0)]
        for letter in dict.fromkeys(need.letter for need in short):
            most = max((need for need in short if need.letter == letter), key=lambda need: need.hours or 0.0)
            yield f"{letter} to ±{100 * most.want:.3g} % needs {_hours(most.hours)} ({most.axis.replace('_', ' ')})."
    yield from _unreached(plan)
    if any(need.at_limit for need in plan.needs):
        yield "≥: only an upper limit is known, and stands for the term; a smaller one takes longer."
    if plan.slowest is not None and plan.slowest < plan.rate:
        yield f"{plan.slowest:.3g} Hz is enough, if the sensor averages over its samples."
    if plan.hours is not None:
        yield "This holds at one temperature, and for the terms that the model has."


def _unreached(plan: RecordPlan) -> Iterator[str]:
    """Yield what no record reaches, and why."""
    absent = [need for need in plan.needs if not need.known]
    for letter, own in _by_letter(absent).items():
        bound = [need for need in own if need.at_length is not None and math.isfinite(need.at_length.limit)]
        seen = "; ".join(
            f"{sensor}s {_size(worst, worst.at_length.limit)}"
            for sensor, needs in _by_kind(bound).items()
            if (worst := max(needs, key=lambda n: n.at_length.limit if n.at_length else 0.0)).at_length is not None
        )
        more = f"; {_hours(plan.hours)} would show it above: {seen}" if seen else ""
        yield f"{letter} is not in the model of {_axes(own)}, so no length is stated{more}."
    hidden = [need for need in plan.needs if need.known and need.hours is None]
    for letter, own in _by_letter(hidden).items():
        yield (
            f"{letter} of {_axes(own)} is not reached within {MOST_HOURS:g} h: the wanted width is too small, or the other terms cover "
            "it at all averaging times that such a record has."
        )


def plan_table(plan: RecordPlan) -> Table:
    """Return each axis and coefficient: value, want, length that it needs, and what the plan's length reaches."""
    rows = [
        (
            need.axis.replace("_", " "),
            need.letter,
            _size(need, need.at_length.value) if need.at_length and need.at_length.value else "-",
            f"±{100 * need.want:.3g} %",
            _hours_cell(need),
            _reach_cell(need),
        )
        for need in plan.needs
    ]
    reach = f"reached in {_hours(plan.hours)}" if plan.hours is not None else "reached"
    return Table("Lengths of a still record", ("axis", "term", "size", "wanted", "needs", reach), tuple(rows))


def by_length(plan: RecordPlan, sensors: Sequence[str]) -> list[str]:
    """Return sensors, the one first that needs the longest record: its figure shows the answer."""
    return sorted(sensors, key=lambda sensor: -_longest(plan, sensor))


def _longest(plan: RecordPlan, begin: str) -> float:
    """Return the longest record that a coefficient needs of the axes whose names begin so, h; limits do not count."""
    own = (need for need in plan.needs if need.axis.startswith(begin) and not need.at_limit)
    return max((need.hours or 0.0 for need in own), default=0.0)


def plan_figure(plan: RecordPlan, model: ImuErrorModel, wants: Mapping[str, float], sensor: str) -> Figure | None:
    """Return the width of each coefficient against the length of the record, of the axis that needs the longest; None without a curve."""
    axes = [axis for axis in model.axes if axis.startswith(sensor)]
    axis = max(axes, key=lambda name: _longest(plan, name), default=None)
    if axis is None or plan.hours is None:
        return None
    curves: list[Curve] = []
    for place, letter in enumerate(wants):
        hours, widths = curve_of(model, axis, letter, plan.rate, plan.hours, plan.level)
        if hours.size > 1:
            curves.append(Curve(letter, hours, 100 * widths, color_at(place), style="curve"))
            want = np.full(2, 100 * wants[letter])
            curves.append(Curve(f"{letter} wanted", hours[[0, -1]], want, color_at(place), style="faint"))
    title = f"{axis.replace('_', ' ')}: width of the intervals by the length of a still record"
    return Figure(title, "length [h]", "half width [%]", tuple(curves)) if curves else None


def _hours_cell(need: Need) -> str:
    if not need.known:
        return "not in the model"
    if need.hours is None:
        return f"> {MOST_HOURS:g} h"
    return f"{'≥ ' if need.at_limit else ''}{_hours(need.hours)}"


def _reach_cell(need: Need) -> str:
    reach = need.at_length
    if reach is None:
        return "-"
    if reach.value is None or not math.isfinite(reach.width):
        return f"< {_size(need, reach.limit)}"
    return f"±{number_text(100 * reach.width)} %"


def _size(need: Need, value: float) -> str:
    unit = (
        UNITS["µg"]
        if need.letter == "B" and need.axis.startswith("accel")
        else coefficient_units(need.axis, need.letter)[1]
    )
    return f"{unit.from_si(value):.3g} {unit.name}"


def _hours(hours: float | None) -> str:
    return "no time" if hours is None else duration_text(3600 * hours) if hours < 100 else f"{hours:.0f} h"  # noqa: PLR2004


def _by_axis(plan: RecordPlan) -> dict[str, list[Need]]:
    found: dict[str, list[Need]] = {}
    for need in plan.needs:
        found.setdefault(need.axis, []).append(need)
    return found


def _by_letter(needs: Sequence[Need]) -> dict[str, list[Need]]:
    found: dict[str, list[Need]] = {}
    for need in needs:
        found.setdefault(need.letter, []).append(need)
    return found


def _by_kind(needs: Sequence[Need]) -> dict[str, list[Need]]:
    found: dict[str, list[Need]] = {}
    for need in needs:
        found.setdefault(need.axis.partition("_")[0], []).append(need)
    return found


def _axes(needs: Sequence[Need]) -> str:
    """Return axes in words; three of one sensor together."""
    own = by_sensor({need.axis: need.axis for need in needs})
    if len(needs) == len(own) * 3:
        return " and ".join(f"all {sensor}s" for sensor in own)
    return ", ".join(need.axis.replace("_", " ") for need in needs)
