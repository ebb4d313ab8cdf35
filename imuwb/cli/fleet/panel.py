"""What a run over a fleet states at its end, in at most 15 lines."""

import shlex
from collections import Counter
from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import Any

from imuwb.analysis import Answer, Step
from imuwb.cli.terminal import print_panel
from imuwb.errors import ImuwbError, MissingDataError, UnreadableLogError, UsageError
from imuwb.fleet.owned import owned
from imuwb.fleet.parquet import table_in
from imuwb.fleet.progress import faults_text, quarantined_text
from imuwb.fleet.run_state import RunState
from imuwb.fleet.schemas import file_of
from imuwb.fleet.store import Store
from imuwb.review.answers.panel import Origin
from imuwb.texts import counted, printable

MOST = 4  #: faults that are named
#: kind of the faults of all logs -> error
NOTHING = {"lacks data": MissingDataError, "unreadable": UnreadableLogError, "usage": UsageError}


def print_ending(
    state: RunState, store: Store, patterns: Sequence[str], place: str, worked: int, *, wrote: bool, unused: str = ""
) -> None:
    """Print how many logs gave a result, the faults by kind with an example, and where the tables are.

    Args:
        state: of the run that has ended.
        store: of the results.
        patterns: that were given.
        place: of the results.
        worked: logs that were worked on in this run.
        wrote: whether this run wrote the tables.
        unused: rows of the table of owners that are of no log, as a sentence; empty: none.

    Raises:
        ImuwbError: no log gave a result; the error is that of one log where all logs have the same kind of fault.
    """
    answer = answer_of(state, store, place, worked, unused)
    files = tuple(file_of(name) for name in ("sensors", "outages", "logs", "quarantine")) if wrote else ()
    shown = (f"{place.rstrip('/')}/: {files[0]}", *files[1:]) if files else ()
    print_panel(
        answer,
        Origin(f"fleet {state.analysis}", tuple(patterns), wrote=shown),
        data=False,
    )
    if state.logs and not _results(state, store):
        faults = _columns(store, "quarantine", ("kind", "message", "path"))
        kinds = {row["kind"] for row in faults}
        error = NOTHING.get(kinds.pop(), ImuwbError) if len(kinds) == 1 else ImuwbError
        first = f" The first is {_named(faults[0])}." if faults else ""
        raise error(f"no log gave a result; {place.rstrip('/')}/{file_of('quarantine')} has the reason of each.{first}")


def answer_of(state: RunState, store: Store, place: str, worked: int, unused: str = "") -> Answer:
    """Return the answer of a run; arguments as in ``print_ending``."""
    logs = _columns(store, "logs", ("vehicle", "serial"))
    faults = _columns(store, "quarantine", ("kind", "message", "path"))
    kinds = Counter(row["kind"] for row in faults)
    examples = {row["kind"]: row for row in reversed(faults)}
    rows = tuple((kind, str(count), _named(examples[kind])) for kind, count in kinds.most_common(MOST))
    whose = owned((row["vehicle"], row["serial"]) for row in logs)
    sentences = [
        f"{state.done} of {counted(state.logs, 'log')} gave a result, {quarantined_text(state.quarantined)}: {faults_text(kinds)}."
    ]
    sentences += [*whose.sentences(), *filter(None, (unused,))]
    if not worked:
        sentences.append("All of it was there: nothing was left to do.")
    about = f"{counted(state.logs, 'log')} of {whose.text}, {state.executor}"
    compared = _compared(store)
    if not compared and _results(state, store):
        sentences.append(
            "No known sensor has a headline value with an interval, so imuwb fleet report has no family to judge."
        )
    report = Step(f"imuwb fleet report {shlex.quote(place)}", "which sensors are out of family, and which drift")
    return Answer(
        about, ("quarantine", "logs", "the first") if rows else (), rows, tuple(sentences), (report,) if compared else (),
    )  # fmt: skip


def _results(state: RunState, store: Store) -> bool:
    """Return whether any log gave a result; one with a fault in a part may."""
    return state.done > 0 or any(_columns(store, table, ("log",)) for table in ("sensors", "outages"))


def _compared(store: Store) -> bool:
    """Return whether the tables have a headline value with an interval of a known sensor, or an outage, by which a fleet is compared."""
    content = store.read(file_of("sensors"))
    if content is not None:
        names = ("value", "lower", "upper", "headline", "vehicle", "serial")
        table = table_in(content, names)
        rows = zip(*(table[name].to_pylist() for name in names), strict=True)
        if any(None not in row[:3] and row[3] is not False and (row[4] or row[5]) for row in rows):
            return True
    return bool(_columns(store, "outages", ("log",)))


def _named(fault: dict[str, Any]) -> str:
    return printable(f"{PurePosixPath(fault['path']).name}: {fault['message']}")


def _columns(store: Store, table: str, columns: Sequence[str]) -> list[dict[str, Any]]:
    content = store.read(file_of(table))
    return [] if content is None else table_in(content, columns).to_pylist()
