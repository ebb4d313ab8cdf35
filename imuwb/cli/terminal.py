"""Tables, notes and progress in the terminal."""

import re
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.table import Table as RichTable

from imuwb.analysis import Answer, Table
from imuwb.review.answers.panel import WIDTH, Origin, panel
from imuwb.texts import printable, printable_lines

NARROWEST, WIDEST = 30, 100  #: columns of a panel on a terminal
WIDE = 200  #: columns of an output that is no terminal


def console(*, data: bool) -> Console:
    """Return the console of stdout for data, and the console of stderr for everything else."""
    stream = sys.stdout if data else sys.stderr
    return Console(file=stream, width=None if stream.isatty() else WIDE, highlight=False)


def shower(*, data: bool) -> Callable[[Table | str], None]:
    """Return a function that prints tables to stdout if they are data, else to stderr, and notes always to stderr."""
    out, err = console(data=data), console(data=False)

    def show(item: Table | str) -> None:
        if isinstance(item, str):
            err.print(f"[yellow]note[/] {escape(printable(item))}", soft_wrap=True)
            return
        table = RichTable(title=_cell(item.title), title_justify="left", title_style="bold", caption=_cell(item.caption) or None,
                          caption_justify="left")  # fmt: skip
        for heading in item.headings:
            table.add_column(_cell(heading), overflow="fold")
        for row in item.rows:
            # A value and its unit stay on one line.
            table.add_row(*(re.sub(r"(?<=[\d\]]) (?=\S+$)", "\N{NO-BREAK SPACE}", _cell(cell)) for cell in row))
        out.print(table)

    return show


def _cell(text: str) -> str:
    """Return a text of a table, of one line or several, in which the terminal finds nothing to do."""
    return escape(printable_lines(text))


def print_panel(answer: Answer, origin: Origin, *, data: bool) -> None:
    """Print an answer; to stdout if it is data, else to stderr. Its first line is bold on a terminal."""
    out = console(data=data)
    width = min(max(out.width, NARROWEST), WIDEST) if out.is_terminal else WIDTH
    first, *rest = panel(answer, origin, width)
    out.print(f"[bold]{escape(first)}[/]", soft_wrap=True)
    for line in rest:
        out.print(escape(line), soft_wrap=True)


@contextmanager
def progress(text: str) -> Generator[Callable[[float, float], None]]:
    """Show a bar on stderr if this is a terminal; the function that is yielded takes (done, all).

    A command that needs slow libraries opens its first bar before it imports them.
    """
    screen = Console(file=sys.stderr)
    if not screen.is_terminal:
        yield lambda done, total: None  # noqa: ARG005 - nobody sees a bar
        return
    columns = TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn(), TimeRemainingColumn()
    with Progress(*columns, console=screen, transient=True) as bar:
        task = bar.add_task(printable(text), total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
