"""The answer of the noise analysis: N, B and K of each axis, and whether to trust them."""

import math
from collections.abc import Mapping

from imuwb.analysis import Answer, Finding, Step
from imuwb.log import AXES
from imuwb.noise_results import by_sensor
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.texts import coefficient_cell, counted, estimate_text, number_text
from imuwb.units import Unit, coefficient_units
from imuwb_plugins.allan import imus_answer
from imuwb_plugins.allan.answer import about_record
from imuwb_plugins.allan.imus import ImuComparison
from imuwb_plugins.allan.result import Result as Allan
from imuwb_plugins.allan.trust import meanings, trust
from imuwb_plugins.noise.repeatability import Repeatability
from imuwb_plugins.noise.result import Result
from imuwb_plugins.noise.settings import Study

LETTERS = "NBK"
SETTINGS = 7  #: of a study, in its answer
DRIVE = Step("imuwb outage DRIVE --error-model {model}", "how far a drive drifts")


def answer(result: Result) -> Answer:
    """Return N, B and K of one log, or what differs between several logs."""
    if result.repeatability is not None:
        return _of_many(result.repeatability)
    allan: Allan = result.parts[0]["allan"]
    trusts = {axis: trust(allan, axis) for axis in result.axes}
    rows: list[tuple[str, ...]] = []
    for own in by_sensor(result.axes).values():
        for axis, r in own.items():
            rows.append((axis.replace("_", " "), *_cells(axis, r.coefficients), trusts[axis].word))
        rows.append(("", *(_unit(next(iter(own)), letter).name for letter in LETTERS)))
    shaken = any(t.word == "shaken" for t in trusts.values())
    first = Step("imuwb lssa {log}", "what shakes it, and how surely") if shaken else None
    return Answer(
        about_record(allan), ("", *LETTERS, "trust"), tuple(rows), tuple(meanings(trusts)),
        tuple(step for step in (first, *_uses(result)) if step is not None),
        f"{100 * allan.level:g} % intervals",
    )  # fmt: skip


def findings(result: Result) -> tuple[Finding, ...]:
    """Return the coefficients of the headline of each axis of the first log."""
    return tuple(
        Finding(axis, r.headline, r.coefficients, r.remarks, headline=True)
        for axis, r in result.axes.items()
        if r.headline is not None
    )


def _uses(result: Result) -> tuple[Step, ...]:
    """Return what can be done with the error model; a replay and an estimator need three axes of each sensor."""
    if len(result.axes) < len(AXES):
        return (Step("imuwb model show {model}", "the error model of these axes"),)
    return DRIVE, Step("imuwb model export {model} --to kalibr", "the numbers for an estimator")


def answer_imus(result: ImuComparison) -> Answer:
    """Return N of each IMU of a log."""
    return imus_answer.answer_imus(result)


def answer_study(result: Study) -> Answer:
    """Return N of each axis in each setting."""
    axes = [axis for axis in AXES if all(axis in case.axes for case in result.cases)]
    rows = tuple(
        (case.text,
         *(_short(case.axes[axis].coefficients.get("N", UNKNOWN), _unit(axis, "N")) for axis in axes))
        for case in result.cases[:SETTINGS]
    )  # fmt: skip
    units = ("", *(_unit(axis, "N").name for axis in axes))
    more = len(result.cases) - SETTINGS
    sentences = [f"{more} more settings: --full."] if more > 0 else []
    if result.rule:
        sentences.append(_rule_text(result))
    return Answer(
        counted(len(result.cases), "setting"),
        ("N", *(axis.replace("_", " ") for axis in axes)),
        (*rows, units),
        tuple(sentences),
    )


def _rule_text(result: Study) -> str:
    axes = {
        verdict: ", ".join(r.axis.replace("_", " ") for r in result.rule if r.holds == verdict)
        for verdict in ("yes", "no", "open")
    }
    if not axes["no"] and not axes["open"]:
        where = "on all axes"
    else:
        parts = ((axes["yes"], "on"), (axes["no"], "not on"), (axes["open"], "undecided on"))
        where = "; ".join(f"{word} {names}" for names, word in parts if names)
    sizes = {
        "there at most": [r.kept for r in result.rule if r.kept is not None],
        "at lower rates up to": [r.broken for r in result.rule if r.broken is not None],
    }
    largest = (
        f"{words} {estimate_text(max(found, key=lambda e: e.value), '')} times the best"
        for words, found in sizes.items()
        if found
    )
    return f"N stays the same where the rate is at least twice the bandwidth: {where} ({', '.join(largest)})."


def _short(coefficient: Coefficient, unit: Unit) -> str:
    if coefficient.value is None:
        return f"< {number_text(unit.from_si(coefficient.upper))}" if math.isfinite(coefficient.upper) else "—"
    return number_text(unit.from_si(coefficient.value))


def _cells(axis: str, coefficients: Mapping[str, Coefficient]) -> tuple[str, ...]:
    return tuple(coefficient_cell(coefficients.get(letter, UNKNOWN), _unit(axis, letter)) for letter in LETTERS)


def _unit(axis: str, letter: str) -> Unit:
    """Return the unit of data sheets."""
    return coefficient_units(axis, letter)[1]


def _of_many(repeatability: Repeatability) -> Answer:
    rows = tuple(
        (axis.replace("_", " "), coefficient_cell(own["N"].mean, _unit(axis, "N")), coefficient_cell(own["B"].mean, _unit(axis, "B")),
         coefficient_cell(repeatability.turn_on[axis].sigma, _unit(axis, "rate")) if axis in repeatability.turn_on else "—")
        for axis, own in repeatability.coefficients.items()
    )  # fmt: skip
    names = {"N": "N", "B": "B", "rate": "turn-on bias"}
    units = tuple(f"{name} [{_unit('gyro_x', key).name}; {_unit('accel_x', key).name}]" for key, name in names.items())
    count = len(repeatability.names)
    differ = ", ".join(repeatability.differ)
    text = (
        f"The logs differ in {differ}: more than chance explains (1 % over all comparisons)."
        if differ
        else "No coefficient differs from log to log by more than chance explains."
    )
    return Answer(
        f"{counted(count, 'log')} of one sensor", ("", *units), rows, (text,), (DRIVE,),
        f"{100 * repeatability.level:g} % intervals",
    )  # fmt: skip
