"""The answers of ``imuwb model show``, ``compare`` and ``check``."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any, cast

from imuwb.analysis import Answer, Step
from imuwb.log import AXES
from imuwb.names import distinct
from imuwb.noise_results import by_sensor
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.stochastic import AxisModel, ImuErrorModel
from imuwb.stochastic.description import LETTERS, deterministic_texts
from imuwb.stochastic.model_check import Verdict, coefficient
from imuwb.texts import coefficient_cell
from imuwb.units import Unit, coefficient_units

SHOWN = "NBK"  #: columns of the answer; the other terms are named
NAME = 20  #: columns of a model's name in a heading
MODELS, LIMITS = 3, 8  #: columns of a comparison, and rows of a check
WORST_FIRST = ("beyond", "not sure", "not known", "within")


def show_answer(model: ImuErrorModel, steps: Sequence[Step]) -> Answer:
    """Return N, B and K of each axis, the names of the other terms, and what puts the model in doubt."""
    rows: list[tuple[str, ...]] = []
    for own in by_sensor({axis: model.axes[axis] for axis in AXES if axis in model.axes}).values():
        for axis, terms in own.items():
            cells = (_cell(coefficient(terms, letter), _unit(axis, letter)) for letter in SHOWN)
            rows.append((_words(axis), *cells, ", ".join(_others(axis, terms))))
        rows.append(("", *(_unit(next(iter(own)), letter).name for letter in SHOWN)))
    made = "; ".join(
        re.sub(r" sha256:\w+", "", f"{key} {text}") for key, text in model.provenance.items() if key != "run"
    )
    sentences = (*(f"! {doubt}." for doubt in model.doubts), *((f"Made of: {made}.",) if made else ()))
    count = f"{len(model.axes)} ax{'i' if len(model.axes) == 1 else 'e'}s"
    has_intervals = any(axis.intervals for axis in model.axes.values())
    aside = "value [interval]" if has_intervals else ""
    return Answer(f"{model.name}, {count}", ("", *SHOWN, "other terms"), tuple(rows), sentences, tuple(steps), aside)


def _others(axis: str, model: AxisModel) -> Iterator[str]:
    """Yield the names of the terms that have no column."""
    for term in model.processes.terms:
        if not any(hasattr(term, letter) for letter in SHOWN):
            yield cast("Any", term).name.replace("_", " ")
    for text in deterministic_texts(axis, model):
        words = text.split(" by temperature")[0].split()
        named = " ".join(word for word in words[:2] if word[0].isalpha()) or words[0]
        yield f"{named} by °C" if " by temperature" in text else named


def compare_answer(models: Mapping[str, ImuErrorModel], steps: Sequence[Step]) -> Answer:
    """Return N of each axis in each model, and which coefficients differ by more than their intervals."""
    names = list(models)
    shown = names[:MODELS]
    axes = [axis for axis in AXES if any(axis in model.axes for model in models.values())]
    rows: list[tuple[str, ...]] = []
    for own in by_sensor({axis: axis for axis in axes}).values():
        for axis in own:
            cells = (_cell(_stated(models[name], axis, "N"), _unit(axis, "N")) for name in shown)
            rows.append((_words(axis), *cells))
        rows.append(("", *(_unit(next(iter(own)), "N").name for _ in shown)))
    more = f"{len(names) - MODELS} more: --full." if len(names) > MODELS else ""
    doubts = tuple(f"! {name}: {doubt}." for name, model in models.items() for doubt in model.doubts[:1])
    sentences = (*_apart(models, axes), *doubts, *((more,) if more else ()))
    return Answer("which differ, and by how much", ("N", *distinct(shown, NAME)), tuple(rows), sentences, tuple(steps))


def _apart(models: Mapping[str, ImuErrorModel], axes: Sequence[str]) -> Iterator[str]:
    """Yield which coefficients have intervals that do not overlap, letter by letter."""
    apart: list[str] = []
    for letter in LETTERS:
        own = [axis for axis in axes if _differ([_stated(model, axis, letter) for model in models.values()])]
        if own:
            apart.append(f"{letter} of {_together(own)}")
    yield (
        f"Apart by more than their intervals: {'; '.join(apart)}. B, K and the other terms: --full."
        if apart
        else "No coefficient differs by more than its intervals. B, K and the other terms: --full."
    )


def _differ(stated: Sequence[Coefficient]) -> bool:
    """Return whether the intervals of two coefficients do not overlap; one that only has a limit begins at 0."""
    known = [(c.lower or 0.0, c.upper) for c in stated if math.isfinite(c.upper)]
    return any(a[1] < b[0] or b[1] < a[0] for a, b in combinations(known, 2))


def check_answer(verdicts: Sequence[Verdict], against: str, steps: Sequence[Step]) -> Answer:
    """Return how many limits are kept, and those that are not, the worst first."""
    found = sorted(verdicts, key=lambda v: (WORST_FIRST.index(v.outcome), -_ratio(v)))
    counts = {outcome: sum(v.outcome == outcome for v in verdicts) for outcome in WORST_FIRST}
    rows = tuple(_verdict_row(v) for v in found[:LIMITS])
    listed = ", ".join(f"{n} {outcome}" for outcome, n in counts.items() if n)
    meaning = {
        "beyond": "beyond: the whole interval is above the limit.",
        "not sure": "not sure: the interval contains the limit.",
        "not known": "not known: the model does not state the term.",
    }
    sentences = [text for outcome, text in meaning.items() if counts[outcome]]
    if len(found) > LIMITS:
        sentences.append(f"{len(found) - LIMITS} more limits: --full.")
    return Answer(
        f"{listed} of {len(verdicts)} limits of {against}", ("axis", "term", "limit", "model", "verdict"), rows,
        tuple(sentences), tuple(steps),
    )  # fmt: skip


def _ratio(verdict: Verdict) -> float:
    """Return how large a coefficient is over its limit."""
    upper = verdict.coefficient.upper
    return upper / verdict.limit.at_most if verdict.limit.at_most > 0 else upper


def _verdict_row(v: Verdict) -> tuple[str, ...]:
    unit = coefficient_units(v.limit.axis, v.limit.letter)[1]
    limit = f"{unit.from_si(v.limit.at_most):.4g} {unit.name}"
    return _words(v.limit.axis), v.limit.letter, limit, f"{_cell(v.coefficient, unit)} {unit.name}", v.outcome


def _together(axes: Sequence[str]) -> str:
    """Return axes in words; three axes of one sensor together."""
    words: list[str] = []
    for sensor, own in by_sensor({axis: axis for axis in axes}).items():
        words += [f"all {sensor}s"] if len(own) == len("xyz") else [_words(axis) for axis in own]
    return ", ".join(words)


def _cell(stated: Coefficient, unit: Unit) -> str:
    """Return a coefficient with its interval; without it, if the model states none."""
    if stated.value is not None and stated.lower == stated.upper:
        return f"{unit.from_si(stated.value):.3g}"
    return coefficient_cell(stated, unit)


def _stated(model: ImuErrorModel, axis: str, letter: str) -> Coefficient:
    return coefficient(model.axes[axis], letter) if axis in model.axes else UNKNOWN


def _unit(axis: str, letter: str) -> Unit:
    """Return the unit of data sheets."""
    return coefficient_units(axis, letter)[1]


def _words(axis: str) -> str:
    return axis.replace("_", " ")
