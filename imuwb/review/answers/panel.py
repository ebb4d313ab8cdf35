"""The panel: the answer of an analysis in at most 15 lines of 80 columns, the same in the terminal and in the recording."""

import textwrap
from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace

from imuwb.analysis import Answer, Step
from imuwb.names import CUT, shortened
from imuwb.texts import printable

WIDTH, HEIGHT = 80, 15  #: columns and lines
WHOLE_HEIGHT = 40  #: lines in a recording, which has room for every sentence
GAP = 2  #: columns between cells
NAMED = 16  #: columns that the name of the log has at least
INDENT = 7  #: columns of "Next" and "Wrote" with the blanks after them
MOST_NEXT = 2  #: commands
LEAST = 2  #: lines of sentences that a long table leaves room for
WHOLE = 60  #: columns; on a narrower screen a row takes several lines, and the panel as many as it needs


@dataclass(frozen=True, slots=True)
class Origin:
    """What the panel says besides the answer."""

    analysis: str
    logs: tuple[str, ...]  #: as they were given
    model: str = ""  #: path of the saved error model; empty: none
    wrote: tuple[str, ...] = ()  #: files; the recording is the first
    command: str = ""  #: that was typed
    options: tuple[str, ...] = ()  #: words that say how the logs are read


def panel(answer: Answer, origin: Origin, width: int = WIDTH, height: int = HEIGHT) -> tuple[str, ...]:
    """Return the lines of the panel.

    The first line, the commands and the files are always there; rows and sentences are cut to the lines that are left, and then
    the last of them says so. On a screen that is too narrow for a table, nothing is cut.
    """
    if width < WHOLE:
        return _narrow(answer, origin, width)
    first = _first_line(answer, origin, width)
    rows = _rows(answer, width)
    sentences = [line for sentence in answer.sentences for line in textwrap.wrap(sentence, width)]
    wrote = _labelled("Wrote", ", ".join(origin.wrote), width) if origin.wrote else []
    left = height - 1 - len(wrote)
    room = left - len(rows) - min(len(sentences), LEAST)
    steps = next((found for found in _shorter_steps(answer, origin, width) if len(found) <= room), None)
    if steps is None:
        *_, steps = _shorter_steps(answer, origin, width)
    left -= len(steps)
    least = min(len(sentences), max(left - len(rows), LEAST))  # a long table leaves room for what to believe
    kept = _cut(rows, left - least, width)
    lines = (first, *kept, *_cut(sentences, left - len(kept), width), *steps, *wrote)
    return tuple(map(printable, lines))


def _narrow(answer: Answer, origin: Origin, width: int) -> tuple[str, ...]:
    """Return the panel for a screen on which a table is too wide: each row as a sentence."""
    head = f"{origin.analysis.upper()}  {_named(origin)}: {answer.about}"
    lines = [line for text in (head, answer.aside) for line in textwrap.wrap(text, width)]
    for row in answer.rows:
        name, *cells = row
        named = [f"{head} {cell}".strip() for head, cell in zip(answer.headings[1:], cells, strict=False) if cell]
        text = f"{name}: {', '.join(named)}" if name else f"({', '.join(named)})"
        lines += textwrap.wrap(text, width, subsequent_indent="  ")
    lines += [line for sentence in answer.sentences for line in textwrap.wrap(sentence, width)]
    lines += _steps(answer.next[:MOST_NEXT], origin, width)
    lines += _labelled("Wrote", ", ".join(origin.wrote), width) if origin.wrote else []
    return tuple(map(printable, lines))


def _first_line(answer: Answer, origin: Origin, width: int) -> str:
    name = _named(origin)
    more = f" and {len(origin.logs) - 1} more" if len(origin.logs) > 1 else ""
    aside = f"  {answer.aside}" if answer.aside else ""
    head = f"{origin.analysis.upper()}  "
    room = max(NAMED, width - len(head) - len(f"{more}: {answer.about}{aside}"))
    text = f"{head}{shortened(name, room)}{more}: {answer.about}" if name else f"{head}{answer.about}"
    if len(text) + len(aside) > width:
        return text if len(text) <= width else f"{text[: width - 1]}{CUT}"
    return f"{text}{aside.rjust(width - len(text))}" if aside else text


def _named(origin: Origin) -> str:
    """Return the name of the first log, without its folder."""
    return origin.logs[0].replace("\\", "/").rpartition("/")[2] if origin.logs else ""


def _rows(answer: Answer, width: int) -> list[str]:
    cells = [row for row in (answer.headings, *answer.rows) if row]
    if not cells:
        return []
    count = max(map(len, cells))
    widths = [max(len(row[i]) if i < len(row) else 0 for row in cells) for i in range(count)]
    lines = [
        (" " * GAP).join(cell.ljust(size) for cell, size in zip(row, widths, strict=False)).rstrip() for row in cells
    ]
    return [line if len(line) <= width else f"{line[: width - 1]}{CUT}" for line in lines]


def filled(steps: Sequence[Step], origin: Origin) -> tuple[Step, ...]:
    """Return steps whose commands have the names of the logs and of the model; one that needs a model is left out if none was saved."""
    logs, model = " ".join((*map(_quoted, origin.logs), *origin.options)), _quoted(origin.model)
    return tuple(
        replace(step, command=step.command.replace("{log}", logs).replace("{model}", model).replace("{command}", origin.command))
        for step in steps
        if origin.model or "{model}" not in step.command
    )  # fmt: skip


def _steps(steps: Sequence[Step], origin: Origin, width: int) -> list[str]:
    lines: list[str] = []
    for step in filled(steps, origin):
        label = "Next" if not lines else ""
        text = f"{label.ljust(INDENT)}{step.command}"
        whole = f"{text}  {step.why}".rstrip()
        lines += [whole] if len(whole) <= width else [text, *_labelled("", step.why, width)]
    return lines


def _shorter_steps(answer: Answer, origin: Origin, width: int) -> Generator[list[str]]:
    """Yield the lines of the next steps, then of the first one, then of its command alone."""
    yield _steps(answer.next[:MOST_NEXT], origin, width)
    yield _steps(answer.next[:1], origin, width)
    yield _steps([replace(step, why="") for step in answer.next[:1]], origin, width)


def _quoted(path: str) -> str:
    """Return a path as a shell takes it."""
    return f'"{path}"' if any(c in path for c in " ()&;'") else path


def _labelled(label: str, text: str, width: int) -> list[str]:
    return textwrap.wrap(
        f"{label.ljust(INDENT)}{text}",
        width,
        subsequent_indent=" " * INDENT,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _cut(lines: list[str], most: int, width: int) -> list[str]:
    """Return at most so many lines; the last one says if more follow."""
    if len(lines) <= most:
        return lines
    if most < 1:
        return []
    return [*lines[: most - 1], f"{lines[most - 1][: width - GAP].rstrip(CUT).rstrip()} {CUT}"]
