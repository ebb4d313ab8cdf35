"""The answer of ``imuwb model explain``, and its whole tables and notes."""

from collections.abc import Sequence

from imuwb.analysis import Answer, Step, Table
from imuwb.estimators import Explanation
from imuwb.estimators.tool import Field
from imuwb.names import shortened

NAME = 36  #: columns of the name of a value
ROWS = 4  #: values that leave room for what to believe


def explain_answer(found: Explanation, horizon: float, steps: Sequence[Step]) -> Answer:
    """Return what to write, the usual shortcuts from the most wrong one, and what was left out; ``horizon`` in s."""
    rows = [(shortened(_name(key), NAME), _short(value), unit, what) for key, value, unit, what in found.rows]
    tool, values = found.export.tool, found.export.values
    lost = [field for field in tool.fields if field.sensor and not any(key in values for key in field.keys)]
    absent = [_name(field.key) for field in lost]
    said = [note for note in found.export.notes if not any(_says(note, field) for field in lost)]
    lacking = [f"! Not known, so not written: {', '.join(absent)}."] if absent else []
    hidden = len(rows) - ROWS
    more = [f"{hidden} more value{'s' if hidden > 1 else ''}: --full."] if hidden > 0 else []
    wrong = [
        f"The most wrong usual shortcut, {habit}, makes the sigma of position after {horizon:g} s {ratios}."
        for habit, ratios in list(_by_habit(found).items())[:1]
    ]
    sentences = (*more, *lacking, *found.sentences[:1], *wrong, *(_sentence(note) for note in said))
    return Answer(tool.title.partition(":")[0], ("name", "value", "unit", "what it is"), tuple(rows[:ROWS]), sentences, tuple(steps))  # fmt: skip


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


def _name(key: str) -> str:
    """Return the name of a value; of a path in XML the first and the last part."""
    parts = key.split("/")
    return key if len(parts) == 1 else f"{parts[0]} {parts[-1]}"


def _says(note: str, field: Field) -> bool:
    """Return whether a note says no more than that a value is not known."""
    return note.endswith(f"not known, so {', '.join(field.keys)} is not written")


def _sentence(note: str) -> str:
    return note if note.endswith(".") else f"{note}."  # its first word may be the name of a value


def _short(values: str) -> str:
    """Return values that are the same on all axes once."""
    parts = values.split(", ")
    return f"{len(parts)} × {parts[0]}" if len(parts) > 1 and len(set(parts)) == 1 else values


def _by_habit(found: Explanation) -> dict[str, str]:
    habits: dict[str, list[str]] = {}
    for shortcut in found.shortcuts:
        habits.setdefault(shortcut.habit, []).append(f"{shortcut.ratio:.3g} times ({shortcut.sensor})")
    return {habit: " and ".join(ratios) for habit, ratios in habits.items()}
