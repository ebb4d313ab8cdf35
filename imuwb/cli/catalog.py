"""imuwb catalog: a page of a folder of recordings, and rerun's own catalog of it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.analysis import Answer, Step
from imuwb.cli.options import Force
from imuwb.cli.terminal import print_panel, progress
from imuwb.errors import ImuwbError, UsageError
from imuwb.review.answers.panel import Origin
from imuwb.texts import counted

if TYPE_CHECKING:  # it imports rerun, which is slow
    from imuwb.review.page.catalog import Entry

INDEX = "index.html"
PORTS = (1024, 65535)
ROWS = 7  #: recordings in the terminal


def catalog(
    folder: Annotated[Path, typer.Argument(help="Folder of recordings.", metavar="DIR")],
    *,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Page to write. Default: index.html in the folder.", metavar="FILE.html"),
    ] = None,
    serve: Annotated[
        bool, typer.Option("--serve", help="Serve the folder as a catalog for the Rerun viewer, on this machine only.")
    ] = False,
    port: Annotated[int, typer.Option(help="Port of --serve.")] = 51234,
    force: Force = False,
) -> None:
    """Write a page of a folder of recordings: what each found, with links, sortable.

    Example: imuwb catalog runs/ --force
    """
    from imuwb import __version__  # noqa: PLC0415 - help must not wait
    from imuwb.cli.places import check_place  # noqa: PLC0415
    from imuwb.writers import write_text  # noqa: PLC0415

    if serve and output is not None:
        raise UsageError("--serve writes no page; leave --output out, or run imuwb catalog twice")
    if serve:
        _rows(folder, folder / INDEX)
        _serve(folder, port)
        return
    place = output or folder / INDEX
    if place.suffix != ".html":
        raise UsageError(f"--output {place}: the name of the page must end in .html")
    rows = _rows(folder, place.resolve())
    check_place(place, force=force)
    from imuwb.review.page.catalog import catalog as page  # noqa: PLC0415 - the first line must not wait for it

    write_text(place, page(folder, rows, __version__))
    print_panel(_answer(rows), Origin("catalog", (str(folder),), wrote=(str(place),)), data=True)


def _rows(folder: Path, page: Path) -> tuple[Entry, ...]:
    """Return a row for each recording."""
    with progress(f"reading the recordings of {folder}") as report:
        from imuwb.review.page.catalog import entries  # noqa: PLC0415 - the viewer's library is slow to import

        return entries(folder, page, report)


def _answer(rows: Sequence[Entry]) -> Answer:
    """Return what each recording found, in few rows."""
    mute = sum(bool(row.remark) for row in rows)
    sentences = (f"{counted(mute, 'recording')} without a result: the row says why.",) if mute else ()
    shown = tuple((row.file, row.cells[0], row.cells[3]) if row.cells else (row.file, "", row.remark) for row in rows)
    more = (("", f"{counted(len(rows) - ROWS, 'more recording')}, on the page", ""),) if len(rows) > ROWS else ()
    return Answer(
        counted(len(rows), "recording"), ("recording", "analysis", "headline"), (*shown[:ROWS], *more), sentences,
        (Step("imuwb catalog {log} --serve", "the same rows in the Rerun viewer"),),
    )  # fmt: skip


def _serve(folder: Path, port: int) -> None:
    """Run rerun's server until it is stopped."""
    if not PORTS[0] <= port <= PORTS[1]:
        raise UsageError(f"--port is {port}; it must be from {PORTS[0]} to {PORTS[1]}")
    address = f"rerun+http://127.0.0.1:{port}"
    typer.echo(
        f"look at it with: rerun {address}\n"
        "A click on imuwb at the left shows a row for each recording and a column for each property. It does not show the tabs of a recording that it opens, "
        "and no file of a folder below; for the tabs, open the file: imuwb view FILE.rrd\nCtrl-C stops it.",
        err=True,
    )
    # With CI the server sends no usage statistics; there is no option for this.
    environment = {**os.environ, "CI": "true"}
    command = [sys.executable, "-m", "rerun", "server", "--host", "127.0.0.1", "--port", str(port), "--dataset"]
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # whoever ends this command ends the server
    command.append(f"imuwb={folder.resolve()}")
    own = os.name == "posix"  # a process group of its own, which ends as a whole
    server = subprocess.Popen(command, env=environment, start_new_session=own)  # noqa: S603 - our own interpreter
    try:
        code = server.wait()
    except KeyboardInterrupt:
        _end(server)
        return
    if code:
        raise ImuwbError(f"the server ended with exit code {code}; is port {port} in use? choose another with --port")


def _end(server: subprocess.Popen[bytes]) -> None:
    """End the server: a program that starts it, and the one that it starts."""
    if os.name == "posix":
        os.killpg(server.pid, signal.SIGTERM)
    else:
        server.terminate()
    server.wait()
