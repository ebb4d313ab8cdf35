"""The choice among several columns that may time the rows of a text log."""

from collections.abc import Sequence
from pathlib import Path

from imuwb.errors import UsageError
from imuwb.notes import Note
from imuwb.readers.read_options import TIME_SOURCES, ReadOptions
from imuwb.readers.text.column_names import Column, columns
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.stamps import Stamp, matches, stamps_of
from imuwb.readers.text.trust import is_number

RISING = 0.9  #: least share of the steps within a second in which the fraction of a second rises
SEVERAL = 2  #: least number of these steps for each second
FEWEST = 3  #: steps that show a fraction of a second


def chosen(
    path: Path, layout: Layout, options: ReadOptions, known: Sequence[Column] = ()
) -> tuple[Stamp | None, tuple[Column, ...], tuple[Note, ...]]:
    """Return the stamp that times the rows of a log, None without one, the columns of other stamps, and notes on these.

    A message's own stamp goes before that of its recording, as in logs of messages; ``options.time_source`` chooses.

    Args:
        path: the log.
        layout: of the log.
        options: what the user states.
        known: the columns that the log's known shape takes for its time; they go first.

    Raises:
        UsageError: no column has the name that the user states, or the stamp lacks the fraction of its seconds.
    """
    names = options.columns or layout.names
    stamps = stamps_of(names, layout)
    own = _of_shape(known, stamps)
    stamps = [*own, *(s for s in stamps if not _columns(s) & {c.index for c in known})]
    source, notes = options.time_source, list[Note]()
    if source not in TIME_SOURCES:
        first = [stamp for stamp in stamps if matches(stamp, source)]
        if not first:
            there = ", ".join(stamp.name for stamp in stamps) or "none"
            raise UsageError(f"{path}: there is no time column {source!r} for --time-source; the log has: {there}")
    elif source != "header":
        first = [stamp for stamp in stamps if stamp.source == source]
        if not first:
            text = f"--time-source not used: no column is known to have times of the kind {source!r}"
            notes.append(Note("time_source_unused", text))
    else:
        first = []
    stamp = next(iter([*first, *stamps]), None)
    if stamp is None:
        return None, (), tuple(notes)
    others = [other for other in stamps if other is not stamp]
    if others:
        names_of_others = ", ".join(other.name for other in others)
        text = f"time from column {stamp.name!r}; not used: {names_of_others} (another: --time-source NAME)"
        notes.append(Note("time_column", text))
    if not options.rate:
        _refuse_half(path, stamp, names, layout)
    return stamp, tuple(column for other in others for column in other.columns), tuple(notes)


def _columns(stamp: Stamp) -> set[int]:
    return {column.index for column in (*stamp.columns, *((stamp.week,) if stamp.week else ()))}


def _of_shape(known: Sequence[Column], stamps: Sequence[Stamp]) -> list[Stamp]:
    """Return the stamp of the columns that a known shape takes for its time."""
    times = [column for column in known if column.quantity == "time"]
    week = next((column for column in known if column.quantity == "week"), None)
    if not times:
        return []
    if len(times) > 1:  # whole seconds and parts of a second
        name = " ".join(column.name for column in times)
        return [Stamp(name, "number" if week is None else "week", tuple(times), week=week)]
    column = times[0]
    found = next((s for s in stamps if column.index in {c.index for c in s.columns}), None)
    if found is not None and found.kind != "week":
        week = None  # a GPS week beside a time that is not its time of week
    if found is not None and (column.unit is None or len(found.columns) > 1 or found.kind != "number") and week is None:
        return [found]
    return [Stamp(column.name, "number" if week is None else "week", (column,), week=week)]


def _refuse_half(path: Path, stamp: Stamp, names: Sequence[str], layout: Layout) -> None:
    """Refuse whole seconds beside an unknown column that counts up within each second and starts again at the next.

    Raises:
        UsageError: there is such a column.
    """
    if not (stamp.coarse and stamp.kind in ("number", "week") and len(stamp.columns) == 1):
        return
    seconds = layout.cells(stamp.columns[0].index)
    for index, name in enumerate(names):
        if index not in _columns(stamp) and not _is_measured(name) and _counts_within(seconds, layout.cells(index)):
            raise UsageError(
                f"{path}: time column {stamp.name!r} repeats, and column {name or index + 1!r} counts up between its steps, so it is likely "
                "the fraction of the second; name both with --columns, for example time_sec and time_nanosec (or time_usec, "
                "time_msec), or leave the second out with -"
            )


def _is_measured(name: str) -> bool:
    """Return whether a name is that of a quantity and not of a time."""
    return any(column.quantity != "time" for column in columns((name,), {}))


def _counts_within(seconds: Sequence[str], cells: Sequence[str]) -> bool:
    """Return whether a column rises while the seconds repeat, and falls whenever they step."""
    if not all(map(is_number, seconds)) or not all(map(is_number, cells)):
        return False
    numbers = [float(cell) for cell in cells]
    pairs = [(a == b, y - x) for a, b, x, y in zip(seconds, seconds[1:], numbers, numbers[1:], strict=False)]
    within, between = [step for same, step in pairs if same], [step for same, step in pairs if not same]
    rising = sum(step > 0 for step in within)
    if len(within) < SEVERAL * len(between):  # two rows of each time, as of two sensors
        return False
    return (
        len(within) >= FEWEST and bool(between) and rising >= RISING * len(within) and all(step < 0 for step in between)
    )
