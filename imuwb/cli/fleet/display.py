"""The progress of a fleet on a terminal."""

import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, TextColumn
from rich.progress import Progress as Bars

from imuwb.fleet.progress import Progress


@contextmanager
def watching(progress: Progress, link: str) -> Generator[Callable[[], None]]:
    """Show a bar with rate, time left and faults on stderr if this is a terminal; the function that is yielded shows the state.

    Args:
        progress: of the run.
        link: address of a page that shows more; empty: there is none.
    """
    screen = Console(file=sys.stderr)
    if link:
        screen.print(f"Dask's dashboard: {escape(link)}", soft_wrap=True, highlight=False)
    if not screen.is_terminal:
        yield lambda: None
        return
    with Bars(BarColumn(20), TextColumn("{task.description}"), console=screen, transient=True) as bars:
        bar = bars.add_task(escape(progress.text()), total=progress.total)
        yield lambda: bars.update(bar, completed=progress.done, description=escape(progress.text()))
