"""The answer of ``imuwb model explain``, and its whole tables and notes."""

from collections.abc import Sequence

from imuwb.analysis import Answer, Step, Table
from imuwb.estimators import Explanation
from imuwb.names import shortened

NAME = 36  #: columns of the name of a value
ROWS = 6  #: values that leave room for what to believe


def explain_answer(found: Explanation, horizon: float, steps: Sequence[Step]) -> Answer:
    """Return what to write, the usual shortcuts from the most wrong one, and what was left out; ``horizon`` in s."""
    rows = [(shortened(key, NAME), _short(value), unit, what) for key, value, unit, what in found.rows]
    tool, values = found.export.tool, found.export.values
    absent = [field.key for field in tool.fields if field.sensor and not any(key in values for key in field.keys)]
    lacking = [f"! Not known, so not written: {', '.join(absent)}."] if absent else []
    more = [f"{len(rows) - ROWS} more values: --full."] if len(rows) > ROWS else []
    shortcuts = [f"{habit}: {ratios}" for habit, ratios in _by_habit(found).items()]
    wrong = (
        [f"Sigma of position after {horizon:g} s over the right one, by usual shortcuts: {'; '.join(shortcuts)}."]
        if shortcuts
        else []
    )
    sentences = (*more, *lacking, *found.sentences[:1], *wrong, *(_sentence(note) for note in found.export.notes))
    return Answer(tool.title, ("name", "value", "unit", "what it is"), tuple(rows[:ROWS]), sentences, tuple(steps))  # fmt: skip


def explain_tables(found: Explanation, horizon: float) -> tuple[Table, Table]:
    """Return all values, and all shortcuts from the most wrong one; ``horizon`` in s."""
    shortcuts = tuple((s.habit, s.sensor, f"{s.ratio:.3g} times") for s in found.shortcuts)
    caption = f"sigma of position after {horizon:g} s that the estimator then states, over the right one"
    return (
        Table(found.export.tool.title, ("name", "value", "unit", "what it is"), found.rows),
        Table("Usual shortcuts, for this sensor", ("habit", "sensor", "sigma"), shortcuts, caption),
    )


def explain_notes(found: Explanation) -> tuple[str, ...]:
    """Return all sentences."""
    return tuple(map(_sentence, (*found.sentences, *found.export.notes)))


def _sentence(note: str) -> str:
    return note if note.endswith(".") else f"{note}."  # its first word may be the name of a value


def _short(values: str) -> str:
    """Return values that are the same on all axes once."""
    parts = values.split(", ")
    return f"{len(parts)} × {parts[0]}" if len(parts) > 1 and len(set(parts)) == 1 else values


def _by_habit(found: Explanation) -> dict[str, str]:
    habits: dict[str, list[str]] = {}
    for shortcut in found.shortcuts:
        habits.setdefault(shortcut.habit, []).append(f"{shortcut.sensor} {shortcut.ratio:.3g}")
    return {habit: ", ".join(ratios) for habit, ratios in habits.items()}
