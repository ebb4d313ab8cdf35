"""The rules of an analysis."""

import copy
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, is_dataclass
from typing import Any, cast

import numpy as np

from imuwb.analysis import Answer, Drift, Finding, offers, takes_no_log
from imuwb.errors import ImuwbError, MissingDataError, UsageError
from imuwb.log import Log
from imuwb.review.answers.document import json_text
from imuwb.review.answers.panel import Origin, panel
from imuwb.stochastic import ImuErrorModel
from imuwb.testing import logs as made_logs
from imuwb.testing.options_rules import help_outcome, parameters_for, parameters_outcome
from imuwb.testing.outcomes import Outcome, attempt, error_text, outcome, skipped
from imuwb.testing.parts import parts_outcome
from imuwb.testing.shown import drawn, unit_faults
from imuwb.texts import counted, printable

PARTS = ("Parameters", "run", "draw")
MOST_ROWS = 8


@dataclass(frozen=True, slots=True)
class _Run:
    """An analysis that has run."""

    plugin: Any
    log: Log
    logs: tuple[Log, ...]
    parameters: Any
    result: Any


def analysis_outcomes(plugin: object, name: str, given: Sequence[Log], texts: Mapping[str, str]) -> Iterator[Outcome]:
    """Yield the outcome of each rule.

    Args:
        plugin: the analysis.
        name: its name.
        given: logs on which it runs; empty: simulated ones.
        texts: options and their values, as texts.
    """
    parts = parts_outcome(plugin, "analysis", PARTS, "imuwb.analysis")
    yield parts
    if parts.state == "failed":
        return
    yield help_outcome(plugin)
    yield parameters_outcome(plugin, texts)
    own = takes_no_log(plugin)
    if own and not texts:
        yield skipped("runs", "it makes its own logs, which may take long; give --with KEY=VALUE to run it")
        return
    parameters = parameters_for(plugin, texts)
    if parameters.error is not None:
        yield outcome("runs", [f"Parameters cannot be made: {parameters.error}; give --with KEY=VALUE"], "")
        return
    yield from _run_outcomes(plugin, name, () if own else tuple(given), parameters.value)


def _run_outcomes(plugin: object, name: str, given: tuple[Log, ...], parameters: object) -> Iterator[Outcome]:
    choices = _choices(plugin, given)
    run, lacking = None, list[str]()
    for logs in choices:
        before = [made_logs.fingerprint(log) for log in logs]
        done = attempt(lambda logs=logs: cast("Any", plugin).run(logs, parameters))
        if isinstance(done.error, MissingDataError | UsageError):
            lacking.append(str(done.error))
            continue
        if done.error is not None:
            yield outcome("runs", [f"run raises {done.fault}; a log that lacks data is a MissingDataError"], "")
            return
        run = _Run(plugin, logs[0] if logs else made_logs.still(), logs, parameters, done.value)
        yield outcome("runs", _runs(run, before), f"run returns a {type(done.value).__name__}")
        break
    if run is None:
        if given:
            yield outcome("runs", [f"it does not run on the given log: {lacking[-1]}"], "")
        else:
            yield skipped(
                "runs", f"it runs on no simulated log; give a log after the name, or --with KEY=VALUE ({lacking[-1]})"
            )
        return
    yield from _after(run, name)


def _choices(plugin: object, given: tuple[Log, ...]) -> Iterator[tuple[Log, ...]]:
    """Yield the logs on which a run is attempted, in order."""
    if takes_no_log(plugin):
        yield ()
    elif given:
        yield given
    else:
        many: object = getattr(plugin, "LOGS", (1, 1))
        fewest = cast("tuple[int, int | None]", many)[0] if isinstance(many, tuple) else 1
        makers = (made_logs.still, made_logs.driven, made_logs.turned)
        makers = makers[1:2] if getattr(plugin, "DEMO", "") == "drive" else makers
        for make in makers:
            yield (make(),) * max(fewest, 1)


def _runs(run: _Run, before: Sequence[object]) -> Iterator[str]:
    if not isinstance(run.result, Mapping) and not is_dataclass(run.result):
        yield f"run returns a {type(run.result).__name__}; return a frozen dataclass or a dict"
    elif is_dataclass(run.result) and not cast("Any", run.result).__dataclass_params__.frozen:
        yield f"the result {type(run.result).__name__} is not frozen; write @dataclass(frozen=True)"
    if [made_logs.fingerprint(log) for log in run.logs] != list(before):
        yield "run changes the samples of its log; make a new array"


def _after(run: _Run, name: str) -> Iterator[Outcome]:
    text = attempt(lambda: json_text(run.result))
    yield outcome("pure", _impure(run, text.value), "the same log and options give the same result")
    yield outcome("document", [text.fault] if text.fault else (), "the result becomes JSON")
    shown = attempt(lambda: drawn(run.log, lambda review: run.plugin.draw(run.result, review)))
    items = shown.value[0] if shown.value is not None else ()
    yield outcome(
        "draws",
        _drawing(run, text.value, shown.fault, len(items)),
        f"{counted(len(items), 'figure, table or note', 'figures, tables and notes')} drawn",
    )
    yield outcome("units", unit_faults(items), "every axis and every number of a table has its unit")
    yield _answer(run, name)
    yield outcome("parts that it offers", _offered(run), "what it offers besides is of the right type")
    yield _hostile(run)
    yield _lacking(run)


def _impure(run: _Run, text: str | None) -> Iterator[str]:
    state = np.random.get_state()  # noqa: NPY002 - what a plugin may draw from
    try:
        np.random.seed(12345)  # noqa: NPY002 - as above
        options = repr(run.parameters)
        again = attempt(lambda: run.plugin.run(run.logs, run.parameters))
    finally:
        np.random.set_state(state)  # noqa: NPY002 - as above
    if again.fault:
        yield f"the second run raises {again.fault}; keep no state between two runs"
    elif text is not None and attempt(lambda: json_text(again.value)).value != text:
        yield "two runs of the same log give different results; keep no state, and take random numbers from a seed of the parameters"
    if repr(run.parameters) != options:
        yield "run changes its parameters"


def _drawing(run: _Run, text: str | None, fault: str, count: int) -> Iterator[str]:
    if fault:
        yield f"draw raises {fault}"
    elif not count:
        yield "draw shows nothing; call review.table, review.figure or review.note"
    if text is not None and attempt(lambda: json_text(run.result)).value != text:
        yield "draw changes the result; compute everything in run"


def _answer(run: _Run, name: str) -> Outcome:
    if not offers(run.plugin, "answer"):
        return skipped("answer", "it has none; its first table and its first notes take the place")
    made = attempt(lambda: run.plugin.answer(run.result))
    return outcome(
        "answer",
        [f"answer raises {made.fault}"] if made.fault else _answer_faults(made.value, name),
        "it fits into a panel",
    )


def _answer_faults(answer: object, name: str) -> Iterator[str]:
    if not isinstance(answer, Answer):
        yield f"answer returns a {type(answer).__name__}; return an imuwb.analysis.Answer"
        return
    if len(answer.rows) > MOST_ROWS:
        yield f"the answer has {len(answer.rows)} rows; leave {MOST_ROWS}, the most important first"
    if not answer.rows and not answer.sentences:
        yield "the answer has neither rows nor sentences; say what a person must know first"
    if any(not isinstance(cell, str) for row in answer.rows for cell in cast("tuple[object, ...]", row)):
        yield "a cell of the answer is no text; format it with its unit"
        return
    if fault := attempt(lambda: panel(answer, Origin(name, ("check.mcap",)))).fault:
        yield fault


def _offered(run: _Run) -> Iterator[str]:
    """Yield the parts that are offered and do not return what they must."""
    for part, right in _MAY_OFFER.items():
        if not offers(run.plugin, part):
            continue
        made = attempt(lambda part=part: getattr(run.plugin, part)(run.result))
        if isinstance(made.error, ImuwbError):
            continue  # the result has no such thing
        if made.fault:
            yield f"{part} raises {made.fault}"
        elif not right(made.value):
            yield f"{part} returns {made.value!r:.60}, which is not what imuwb.analysis states"
    many: object = getattr(run.plugin, "LOGS", (1, 1))
    if not (isinstance(many, tuple) and len(cast("tuple[object, ...]", many)) == 2):  # noqa: PLR2004 - fewest and most
        yield f"LOGS is {many!r}; write (fewest, most), with None for any number"


def _all(kind: type) -> Callable[[object], bool]:
    return lambda value: (
        isinstance(value, tuple | list) and all(isinstance(one, kind) for one in cast("Sequence[object]", value))
    )


_MAY_OFFER: dict[str, Callable[[object], bool]] = {
    "error_model": lambda value: (
        isinstance(value, ImuErrorModel) and ImuErrorModel.from_toml(value.to_toml()).axes.keys() == value.axes.keys()
    ),
    "objections": _all(str),
    "findings": _all(Finding),
    "drifts": _all(Drift),
}


def _hostile(run: _Run) -> Outcome:
    if not run.logs:
        return skipped("hostile words", "it reads no log")
    logs = tuple(made_logs.hostile(log) for log in run.logs)
    return outcome(
        "hostile words", _hostile_faults(run, logs), "names with escapes, Markdown and HTML are shown as letters"
    )


def _hostile_faults(run: _Run, logs: tuple[Log, ...]) -> Iterator[str]:
    done = attempt(lambda: run.plugin.run(logs, run.parameters))
    if done.fault:
        yield f"on a log with odd names, run raises {done.fault}"
        return
    shown = attempt(lambda: drawn(logs[0], lambda review: run.plugin.draw(done.value, review)))
    if shown.fault:
        yield f"on a log with odd names, draw raises {shown.fault}"
    elif shown.value is not None:
        yield from shown.value[1]
    answer = attempt(lambda: run.plugin.answer(done.value)).value if offers(run.plugin, "answer") else None
    if isinstance(answer, Answer):
        said = (answer.about, *answer.sentences, *(cell for row in answer.rows for cell in row))
        if odd := next((text for text in said if printable(text) != text), None):
            yield f"the answer has letters that are not shown ({odd!r:.60}); pass words of a log through imuwb.texts.printable"
    text = attempt(lambda: json.loads(json_text(done.value)))
    if text.fault:
        yield f"the result does not become JSON: {text.fault}"


def _lacking(run: _Run) -> Outcome:
    if not run.logs:
        return skipped("logs that lack data", "it reads no log")
    return outcome(
        "logs that lack data", _lacking_faults(run), "an empty log and a single gyro are a result or a MissingDataError"
    )


def _lacking_faults(run: _Run) -> Iterator[str]:
    parameters = copy.copy(run.parameters)
    for what, log in made_logs.lacking(run.log).items():
        logs = (log, *run.logs[1:])
        done = attempt(lambda logs=logs: run.plugin.run(logs, parameters))
        if done.error is None:
            shown = attempt(lambda log=log, done=done: drawn(log, lambda review: run.plugin.draw(done.value, review)))
            if shown.fault:
                yield f"on {what}, draw raises {shown.fault}"
        elif not isinstance(done.error, ImuwbError):
            yield f"on {what}, run raises {error_text(done.error)}; raise MissingDataError with what is lacking"
