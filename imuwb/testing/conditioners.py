"""The rules of a conditioner."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from imuwb.analysis import offers
from imuwb.errors import ImuwbError
from imuwb.log import SECOND, Conditioning, Log, Triad
from imuwb.options import options_of
from imuwb.testing import logs as made_logs
from imuwb.testing.options_rules import help_outcome, parameters_for, parameters_outcome
from imuwb.testing.outcomes import Outcome, attempt, error_text, outcome, skipped
from imuwb.testing.parts import parts_outcome
from imuwb.testing.shown import drawn, unit_faults
from imuwb.texts import counted

PARTS = ("Parameters", "condition")
CHANGE = 0.7  #: share of the log after which it is changed, to see what a claim of causality is worth
NEAR = 1e-9  #: share of the change below which a difference is rounding
KEPT = ("gnss", "speeds", "references", "poses", "orientations", "provenance", "zero", "truth", "settings", "devices")


@dataclass(frozen=True, slots=True)
class _Done:
    """A conditioner that has changed a log."""

    plugin: Any
    parameters: Any
    log: Log
    changed: Log
    applied: Any  #: what ``draw`` shows


def conditioner_outcomes(
    plugin: object, name: str, given: Sequence[Log], texts: Mapping[str, str]
) -> Iterator[Outcome]:
    """Yield the outcome of each rule.

    Args:
        plugin: the conditioner.
        name: its name.
        given: logs that it changes; empty: a simulated one.
        texts: options and their values, as texts.
    """
    parts = parts_outcome(plugin, "conditioner", PARTS, "imuwb.analysis")
    yield parts
    if parts.state == "failed":
        return
    yield help_outcome(plugin)
    yield parameters_outcome(plugin, texts)
    parameters = parameters_for(plugin, texts)
    log = given[0] if given else made_logs.still()
    before = made_logs.fingerprint(log)
    done = (
        attempt(lambda: cast("Any", plugin).condition(log, parameters.value))
        if parameters.error is None
        else parameters
    )
    faults = list(_runs(done.value, done.error))
    yield outcome("runs", faults, "condition returns the changed log, and what draw shows")
    if faults:
        return
    changed, applied = cast("tuple[Log, Any]", done.value)
    kept = _Done(plugin, parameters.value, log, changed, applied)
    yield outcome(
        "pure", _impure(kept, before), "the same log and options give the same samples, and the log is not changed"
    )
    yield outcome("keeps", _lost(kept), "all that it does not change stays in the log")
    yield outcome(
        "states itself", _unstated(kept, name), "the changed log states the conditioner, its options and its delay"
    )
    yield _causality(kept)
    yield _drawing(kept)
    yield outcome("hostile words", _hostile(kept), "names with escapes, Markdown and HTML stay names")
    yield outcome(
        "logs that lack data", _lacking(kept), "an empty log and a single gyro are conditioned or refused with a reason"
    )


def _runs(value: object, error: Exception | None) -> Iterator[str]:
    if isinstance(error, ValueError):
        yield f"{error}; give --with KEY=VALUE, or a log that suits the options"
    elif error is not None:
        yield f"condition raises {error_text(error)}"
    elif not (isinstance(value, tuple) and len(cast("tuple[object, ...]", value)) == 2 and isinstance(value[0], Log)):  # noqa: PLR2004 - log and change
        yield f"condition returns {type(value).__name__}; return (log, what draw shows)"


def _impure(done: _Done, before: object) -> Iterator[str]:
    if made_logs.fingerprint(done.log) != before:
        yield "condition changes the samples of its log; make a new array"
    again = attempt(lambda: done.plugin.condition(done.log, done.parameters))
    if again.fault:
        yield f"the second run raises {again.fault}; keep no state between two runs"
    elif again.value is not None and made_logs.fingerprint(again.value[0]) != made_logs.fingerprint(done.changed):
        yield "two runs on one log give different samples; keep no state"


def _lost(done: _Done) -> Iterator[str]:
    for name in KEPT:
        if getattr(done.changed, name) != getattr(done.log, name):
            yield f"Log.{name} is not that of the log before; write dataclasses.replace(log, imus=...)"
    if [imu.name for imu in done.changed.imus] != [imu.name for imu in done.log.imus]:
        yield "the IMUs are not those of the log before; change each, and drop none"


def _unstated(done: _Done, name: str) -> Iterator[str]:
    before, after = done.log.conditioning, done.changed.conditioning
    if after[: len(before)] != before or len(after) != len(before) + 1:
        yield "Log.conditioning is not that of the log before with one step more; add imuwb.log.Conditioning(name, options, causal, delay)"
        return
    step = after[-1]
    known = {option.name for option in options_of(type(done.parameters))}
    if name and step.name != name:
        yield f"the step has the name {step.name!r}, and the conditioner is {name!r}; give both the same name"
    if not math.isfinite(step.delay) or step.delay < 0:
        yield f"the delay is {step.delay}; give it in seconds, 0 or more"
    if odd := [key for part in step.parameters.split(",") if (key := part.partition("=")[0]) and key not in known]:
        yield f"the step states the option {odd[0]!r}, which Parameters lacks; write the options as on the command line: key=value,key=value"


def _causality(done: _Done) -> Outcome:
    """Return whether the claims of causality are those that a changed future shows."""
    settings = [done.parameters]
    if isinstance(getattr(done.parameters, "causal", None), bool):
        other = attempt(lambda: replace(done.parameters, causal=not done.parameters.causal))
        settings += [other.value] if other.error is None else []
    faults: list[str] = []
    said: list[str] = []
    for parameters in settings:
        found = attempt(lambda parameters=parameters: _seen(done, parameters))
        if isinstance(found.error, ImuwbError | ValueError):
            continue  # the options do not suit the log
        if found.value is None:
            faults.append(f"condition raises {found.fault}")
            continue
        step, seen = found.value
        said.append("causal" if step.causal else "not causal")
        if step.causal and seen > NEAR:
            faults.append(
                f"with {step.parameters} it claims to be causal, but samples before a change of the log differ by {seen:.2g} of the change; "
                "use past samples only, or state causal=False"
            )
        elif not step.causal and seen <= NEAR:
            faults.append(
                f"with {step.parameters} it claims not to be causal, but no sample depends on later ones; state causal=True"
            )
    if not said and not faults:
        return skipped("causality", "no setting suits the log")
    return outcome("causality", faults, f"a changed future does what is claimed: {', '.join(dict.fromkeys(said))}")


def _seen(done: _Done, parameters: object) -> tuple[Conditioning, float]:
    """Return the step that is stated, and by which share of a change of the log the samples before it differ.

    A causal conditioner that is late by a delay may use samples up to that delay after a time.
    """
    other, moment = made_logs.changed_after(done.log, CHANGE)
    one, two = (done.plugin.condition(log, parameters)[0] for log in (done.log, other))
    most, late = 0.0, moment - round(one.conditioning[-1].delay * SECOND)
    for a, b, before, after in zip(_triads(one), _triads(two), _triads(done.log), _triads(other), strict=True):
        early, same = a.time < late, b.time < late
        if np.count_nonzero(early) != np.count_nonzero(same):
            return one.conditioning[-1], math.inf
        size = float(np.nanmax(np.abs(after.value - before.value), initial=0.0))
        change = float(np.nanmax(np.abs(a.value[early] - b.value[same]), initial=0.0))
        most = max(most, change / size if size else 0.0)
    return one.conditioning[-1], most


def _triads(log: Log) -> list[Triad]:
    return [t for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None]


def _drawing(done: _Done) -> Outcome:
    if not offers(done.plugin, "draw"):
        return skipped("draws", "it has no draw")
    shown = attempt(lambda: drawn(done.changed, lambda review: done.plugin.draw(done.applied, review)))
    if shown.value is None:
        return outcome("draws", [f"draw raises {shown.fault}"], "")
    items, faults = shown.value
    return outcome(
        "draws",
        (*faults, *unit_faults(items)),
        f"{counted(len(items), 'figure, table or note', 'figures, tables and notes')} drawn, each with its unit",
    )


def _hostile(done: _Done) -> Iterator[str]:
    log = made_logs.hostile(done.log)
    again = attempt(lambda: done.plugin.condition(log, done.parameters))
    if again.value is None:
        yield f"on a log with odd names, condition raises {again.fault}"
        return
    changed, applied = again.value
    if [imu.name for imu in changed.imus] != [imu.name for imu in log.imus]:
        yield "it changes the names of the IMUs; keep them"
    if offers(done.plugin, "draw"):
        shown = attempt(lambda: drawn(changed, lambda review: done.plugin.draw(applied, review)))
        if shown.fault:
            yield f"on a log with odd names, draw raises {shown.fault}"
        elif shown.value is not None:
            yield from shown.value[1]


def _lacking(done: _Done) -> Iterator[str]:
    for what, log in made_logs.lacking(done.log).items():
        error = attempt(lambda log=log: done.plugin.condition(log, done.parameters)).error
        if error is not None and not isinstance(error, ImuwbError | ValueError):
            yield f"on {what}, condition raises {error_text(error)}; raise MissingDataError or ValueError with the reason"
