"""Notes on the error model of a replay: what puts it in doubt, filters that cannot run with it, and lines without states."""

from collections.abc import Iterator

from imuwb.navigation.lines import LEAST, LineShare
from imuwb.notes import Note
from imuwb.replay import Replay

NAMED = 4  #: lines that a note names


def left_out(replay: Replay) -> Iterator[Note]:
    """Yield the doubts of the error model, a note for each filter that cannot run, and for the lines that filters leave out."""
    doubts = (doubt for run in replay.runs.values() for doubt in run.solution.model.error_model.doubts)
    for doubt in dict.fromkeys(doubts):
        yield Note("model-doubt", f"the error model is in doubt: {doubt}")
    for name, reason in replay.failed.items():
        yield Note("failed", f"{name} cannot run: {reason}")
    lines: dict[tuple[LineShare, ...], list[str]] = {}
    for name, run in replay.runs.items():
        own = run.solution.model.lines_left_out(run.solution.measurement.interval)
        if own:
            lines.setdefault(own, []).append(name)
    for own, names in lines.items():
        yield Note("lines-left-out", _lines_text(own, names))


def _lines_text(lines: tuple[LineShare, ...], names: list[str]) -> str:
    """Return the lines that some filters leave out, the largest first, and why."""
    largest = lines[::-1]
    text = ", ".join(map(str, largest[:NAMED])) + (f" and {len(lines) - NAMED} more" if len(lines) > NAMED else "")
    percent = 100 * largest[0].share
    why = (
        f"together they make less than {100 * LEAST:g} % of the variance of the drift by lines and white noise"
        if percent <= 100 * LEAST
        else f"a filter has no room for them; the first makes {percent:.2g} % of the variance of the drift by lines and white noise"
    )
    count = f"{len(lines)} periodic line{'s' if len(lines) > 1 else ''} of the error model without states"
    return f"{', '.join(names)}: {count} ({text}): {why}"
